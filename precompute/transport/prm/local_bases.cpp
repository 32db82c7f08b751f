#include "precompute/transport/prm/local_bases.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "precompute/transport/prm/block_transport.h"

namespace lightwell::transport {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXf;

// Basis values are stored in eight bits with a sign.
constexpr float kBasisSteps = 127.0f;
// The share of a light's mean that bounds the weight of dark texels, as in the definition of texrel (docs/cli.md).
constexpr float kDarkFloor = 0.1f;
// Beside the training lights, the basis is made for light on each single cluster: as strong as it typically is (at least this share of the
// mean), with this weight against the training lights.
constexpr float kUnseenFloor = 0.3f, kUnseenWeight = 0.5f;

/// Principal components of the columns of `samples` (texels × samples), rows weighted by `texel_weight`: the fewest that leave the residual asked
/// for, quantised.
MatrixXf principalBasis(const MatrixXf& samples, const VectorXf& texel_weight, const LocalBasesOptions& options) {
  const MatrixXf weighted = texel_weight.asDiagonal() * samples;
  const Eigen::Index texels = samples.rows();
  MatrixXf gram = MatrixXf::Zero(texels, texels);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram.cast<double>());
  const double total = std::max(0.0, solver.eigenvalues().sum());
  double residual = total;
  Eigen::Index rank = 0;
  const Eigen::Index most_rank = std::min<Eigen::Index>(options.most_rank, texels);
  while (rank < most_rank && residual > double(options.rank_error) * options.rank_error * total && residual > 0) {
    residual -= std::max(0.0, solver.eigenvalues()[texels - 1 - rank]);
    ++rank;
  }
  MatrixXf basis(texels, rank);
  for (Eigen::Index k = 0; k < rank; ++k) {
    VectorXf column = solver.eigenvectors().col(texels - 1 - k).cast<float>().cwiseQuotient(texel_weight);
    Eigen::Index largest;
    column.cwiseAbs().maxCoeff(&largest);
    column /= column[largest];  // the sign of an eigenvector is arbitrary: make its largest value +1
    basis.col(k) = (column * kBasisSteps).array().round() / kBasisSteps;
  }
  return basis;
}

/// The linear map (rank × texels) from a column of irradiance to its coordinates: weighted least squares in the quantised basis U, under the constraint
/// that the area integral is kept. Without it every light that the basis was not made for would lose the part of its energy that lies outside.
///   M = UᵀWU, P = M⁻¹UᵀW, a = Uᵀα;   P + M⁻¹a (aᵀM⁻¹a)⁻¹ (αᵀ − aᵀP)      with texel areas α (Lagrange multiplier)
MatrixXf energyKeepingCoordinates(const MatrixXf& basis, const VectorXf& texel_weight, const VectorXf& area) {
  const MatrixXd u = basis.cast<double>();
  const Eigen::VectorXd weight = texel_weight.cast<double>().array().square();
  const Eigen::VectorXd alpha = area.cast<double>();
  const Eigen::LDLT<MatrixXd> normal_equations(u.transpose() * weight.asDiagonal() * u);
  const MatrixXd coordinates = normal_equations.solve(u.transpose() * weight.asDiagonal());
  const Eigen::VectorXd integral = u.transpose() * alpha;
  const Eigen::VectorXd direction = normal_equations.solve(integral);
  const double curvature = integral.dot(direction);
  if (!(curvature > 0)) return coordinates.cast<float>();
  return (coordinates + direction / curvature * (alpha.transpose() - integral.transpose() * coordinates)).cast<float>();
}

}  // namespace

TrainingLights makeTrainingLights(const EntryClusters& clusters, const ChannelMatrices& multi_bounce,
                                  std::vector<std::vector<float>> direct_irradiance) {
  TrainingLights training;
  training.count = uint32_t(direct_irradiance.size());
  const uint32_t rows = clusters.cluster_count + clusters.group_count;
  training.direct.resize(rows, training.count);
  for (uint32_t light = 0; light < training.count; ++light)
    for (uint32_t row = 0; row < rows; ++row) training.direct(row, light) = direct_irradiance[light][row];
  for (int channel = 0; channel < 3; ++channel)
    training.group_indirect[channel] = multi_bounce[channel] * training.direct.bottomRows(clusters.group_count);

  // Sealed pockets: their light is nearly zero everywhere, and a weight of one over it would let them rule the basis.
  training.weight.assign(training.count, 0.0f);
  std::vector<double> mean(training.count, 0.0);
  double area = 0;
  for (uint32_t group = 0; group < clusters.group_count; ++group) {
    const double group_area = clusters.area[clusters.cluster_count + group];
    area += group_area;
    for (uint32_t light = 0; light < training.count; ++light) mean[light] += group_area * training.group_indirect[1](group, light);
  }
  std::vector<double> sorted = mean;
  if (!sorted.empty()) std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double median = sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
  for (uint32_t light = 0; light < training.count; ++light)
    if (mean[light] > 0.1 * median) training.weight[light] = float(area / mean[light]);
  return training;
}

BasisBlock fitBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters,
                    const TrainingLights& training, const EmitterLight& emitters, std::span<const float> slot_area, const LocalBasesOptions& options) {
  BasisBlock result;
  result.slot.assign(slots.begin(), slots.end());
  const BlockTransport transport = gatherBlock(slots, gatherer, clusters, options.rays);
  const Eigen::Index texels = slots.size(), links = transport.cluster.size(), groups = transport.group.size(), lights = training.count;

  if (!emitters.direct_rgb.empty()) {
    result.emitter_indirect_rgb.assign(slots.size(), Rgb(0.0f));
    for (Eigen::Index t = 0; t < texels; ++t)
      for (int channel = 0; channel < 3; ++channel) {
        double sum = 0;
        for (Eigen::Index l = 0; l < links; ++l) sum += transport.from_cluster[channel](t, l) * emitters.direct_rgb[transport.cluster[l]][channel];
        for (Eigen::Index g = 0; g < groups; ++g) sum += transport.from_group[channel](t, g) * emitters.group_indirect_rgb[transport.group[g]][channel];
        result.emitter_indirect_rgb[t][channel] = float(sum);
      }
  }

  // The block's indirect light under every training light.
  MatrixXf direct(links, lights);
  for (Eigen::Index l = 0; l < links; ++l) direct.row(l) = training.direct.row(transport.cluster[l]);
  MatrixXf group_direct(groups, lights);
  for (Eigen::Index g = 0; g < groups; ++g) group_direct.row(g) = training.direct.row(clusters.cluster_count + transport.group[g]);
  MatrixXf samples(texels, 3 * lights);
  for (int channel = 0; channel < 3; ++channel)
    samples.middleCols(channel * lights, lights) = transport.from_cluster[channel] * direct +
                                                   transport.from_group[channel] * groupRows(transport.group, training.group_indirect[channel]);
  // texrel weighs every texel under every light by one over (its light + a tenth of the light's mean). A least-squares fit takes weights that are a
  // product of one factor per light and one per texel: those of the block's mean and of the mean light.
  VectorXf light_weight(lights);
  for (Eigen::Index m = 0; m < lights; ++m) {
    const float global_mean = training.weight[m] > 0 ? 1.0f / training.weight[m] : 0.0f;
    light_weight[m] = global_mean > 0 ? 1.0f / (kDarkFloor * global_mean + samples.col(lights + m).mean()) : 0.0f;
  }
  for (int channel = 0; channel < 3; ++channel)
    samples.middleCols(channel * lights, lights) = samples.middleCols(channel * lights, lights) * light_weight.asDiagonal();

  VectorXf texel_weight = samples.rowwise().mean();
  texel_weight = (texel_weight.array() + kDarkFloor * texel_weight.mean() + std::numeric_limits<float>::min()).inverse();

  // Beside the training lights, light on any single cluster must find some answer in the basis.
  const VectorXf typical_direct = (direct * light_weight.asDiagonal()).rowwise().norm() / std::sqrt(float(std::max<Eigen::Index>(1, lights)));
  const float typical_floor = kUnseenFloor * (links > 0 ? typical_direct.mean() : 0.0f);
  MatrixXf extended(texels, 3 * lights + 3 * links);
  extended.leftCols(3 * lights) = samples;
  for (int channel = 0; channel < 3; ++channel)
    extended.middleCols(3 * lights + channel * links, links) =
        transport.from_cluster[channel] * ((typical_direct.array() + typical_floor) * (kUnseenWeight * std::sqrt(float(lights)))).matrix().asDiagonal();
  VectorXf area(texels);
  for (Eigen::Index t = 0; t < texels; ++t) area[t] = slot_area[t];
  const MatrixXf basis = principalBasis(extended, texel_weight, options);
  if (basis.cols() == 0) return result;
  const MatrixXf to_coordinates = energyKeepingCoordinates(basis, texel_weight, area);
  const Eigen::Index rank = basis.cols();
  result.rank = uint32_t(rank);
  const VectorXf basis_norm2 = (texel_weight.asDiagonal() * basis).colwise().squaredNorm();
  const double signal2 = (texel_weight.asDiagonal() * samples).cast<double>().squaredNorm();

  std::array<MatrixXf, 3> coordinates;
  for (int channel = 0; channel < 3; ++channel) coordinates[channel] = to_coordinates * transport.from_cluster[channel];

  // Merge: what would go wrong if all clusters of a group shared the group's irradiance?
  std::vector<Eigen::Index> first_link(groups + 1, links);
  for (Eigen::Index l = links - 1; l >= 0; --l) first_link[transport.group_index[l]] = l;
  std::vector<std::pair<double, Eigen::Index>> merge_error(groups);
  for (Eigen::Index g = 0; g < groups; ++g) {
    const Eigen::Index begin = first_link[g], count = first_link[g + 1] - begin;
    const MatrixXf deviation = (direct.middleRows(begin, count).rowwise() - group_direct.row(g)) * light_weight.asDiagonal();
    double error2 = 0;
    for (int channel = 0; channel < 3; ++channel) {
      const MatrixXf wrong = coordinates[channel].middleCols(begin, count) * deviation;
      error2 += (wrong.array().square().colwise() * basis_norm2.array()).cast<double>().sum();
    }
    merge_error[g] = {error2, g};
  }
  std::sort(merge_error.begin(), merge_error.end());
  std::vector<char> merged(groups, 0);
  double spent2 = 0;
  for (const auto& [error2, g] : merge_error) {
    spent2 += error2;
    if (spent2 > double(options.link_error) * options.link_error * signal2) break;
    merged[g] = 1;
  }

  const auto emit = [&](uint32_t cluster, Eigen::Index begin, Eigen::Index count) {
    result.link_cluster.push_back(cluster);
    for (Eigen::Index k = 0; k < rank; ++k)
      for (int channel = 0; channel < 3; ++channel) result.coefficient.push_back(coordinates[channel].row(k).segment(begin, count).sum());
  };
  for (Eigen::Index l = 0; l < links; ++l)
    if (!merged[transport.group_index[l]]) emit(transport.cluster[l], l, 1);
  for (Eigen::Index g = 0; g < groups; ++g)
    if (merged[g]) emit(clusters.cluster_count + transport.group[g], first_link[g], first_link[g + 1] - first_link[g]);

  result.basis.resize(texels * rank);
  for (Eigen::Index t = 0; t < texels; ++t)
    for (Eigen::Index k = 0; k < rank; ++k) result.basis[t * rank + k] = basis(t, k);
  return result;
}

}  // namespace lightwell::transport
