#include "precompute/transport/prm/local_bases.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>
#include <tuple>

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
// Groups are alike when their direct light under the training lights correlates by more than this.
constexpr float kAlike = 0.5f;
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

/// Which groups a block links to, and how.
struct LinkedGroups {
  std::vector<char> merged;             // [group]: takes the place of its fine clusters
  std::vector<char> kept;               // [group]
  std::array<MatrixXf, 3> coordinates;  // per channel [rank][group]
};

/// `coordinates`: per channel [rank][cluster], the block's answer to direct light on the fine clusters it sees. Errors are those of the training lights,
/// each weighted by `light_weight`, in the norm of the weighted basis.
LinkedGroups linkGroups(const EntryClusters& clusters, const MultiBounce& multi_bounce, const TrainingLights& training, const std::vector<uint32_t>& cluster,
                        const std::array<MatrixXf, 3>& coordinates, const VectorXf& light_weight, const VectorXf& basis_norm2, double signal2,
                        const LocalBasesOptions& options) {
  const Eigen::Index groups = clusters.group_count, rank = basis_norm2.size();
  const MatrixXf group_direct = training.direct.bottomRows(groups) * light_weight.asDiagonal();
  const auto norm2 = [&](const MatrixXf& answer) { return (answer.array().square().colwise() * basis_norm2.array()).cast<double>().sum(); };
  LinkedGroups linked;
  linked.merged.assign(groups, 0);
  linked.kept.assign(groups, 0);
  for (int channel = 0; channel < 3; ++channel) linked.coordinates[channel] = multi_bounce.groupResponse(channel, cluster, coordinates[channel]);

  // Merge: what would go wrong if all clusters of a group shared the group's irradiance?
  struct Range {
    double error2;
    size_t begin, end;  // into `cluster`
  };
  std::vector<Range> ranges;
  for (size_t begin = 0, end = 0; begin < cluster.size(); begin = end) {
    const uint32_t group = clusters.group_of_cluster[cluster[begin]];
    while (end < cluster.size() && clusters.group_of_cluster[cluster[end]] == group) ++end;
    MatrixXf deviation(end - begin, training.count);
    for (size_t l = begin; l < end; ++l)
      deviation.row(l - begin) = training.direct.row(cluster[l]) - training.direct.row(clusters.cluster_count + group);
    deviation = deviation * light_weight.asDiagonal();
    double error2 = 0;
    for (const auto& matrix : coordinates) error2 += norm2(matrix.middleCols(begin, end - begin) * deviation);
    ranges.push_back({error2, begin, end});
  }
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return std::tie(a.error2, a.begin) < std::tie(b.error2, b.begin); });
  double spent2 = 0;
  for (const auto& range : ranges) {
    spent2 += range.error2;
    if (spent2 > double(options.link_error) * options.link_error * signal2) break;
    const uint32_t group = clusters.group_of_cluster[cluster[range.begin]];
    linked.merged[group] = 1;
    for (int channel = 0; channel < 3; ++channel)
      linked.coordinates[channel].col(group) += coordinates[channel].middleCols(range.begin, range.end - range.begin).rowwise().sum();
  }

  // Prune: light of groups that hardly matter adds up in one sense, so its sum is what is limited.
  std::vector<std::pair<double, uint32_t>> importance;
  for (uint32_t g = 0; g < groups; ++g) {
    double importance2 = 0;
    for (const auto& matrix : linked.coordinates) importance2 += norm2(matrix.col(g));
    importance.emplace_back(importance2 * group_direct.row(g).cast<double>().squaredNorm(), g);
  }
  std::sort(importance.begin(), importance.end());
  std::array<MatrixXf, 3> lost;
  for (auto& matrix : lost) matrix.setZero(rank, training.count);
  size_t pruned = 0;
  for (; pruned < importance.size(); ++pruned) {
    const uint32_t group = importance[pruned].second;
    double lost2 = 0;
    for (int channel = 0; channel < 3; ++channel) {
      lost[channel] += linked.coordinates[channel].col(group) * group_direct.row(group);
      lost2 += norm2(lost[channel]);
    }
    if (lost2 > double(options.prune_error) * options.prune_error * signal2) break;
  }
  // Their light is carried by groups that are lit alike, as it is: evenly spread light keeps its energy exactly. Without one a group stays.
  for (size_t i = pruned; i < importance.size(); ++i) linked.kept[importance[i].second] = 1;
  for (size_t i = 0; i < pruned; ++i) {
    const uint32_t group = importance[i].second;
    const auto alike = std::span(training.stand_ins.group).subspan(size_t(group) * StandIns::kMost, StandIns::kMost);
    const auto other = std::find_if(alike.begin(), alike.end(), [&](uint32_t g) { return g != kNone && linked.kept[g]; });
    if (importance[i].first == 0) continue;  // no light at all
    if (other == alike.end()) linked.kept[group] = 1;
    else for (auto& matrix : linked.coordinates) matrix.col(*other) += matrix.col(group);
  }
  return linked;
}

StandIns makeStandIns(const TrainingLights& training, uint32_t groups) {
  const Eigen::Map<const VectorXf> weight(training.weight.data(), Eigen::Index(training.weight.size()));
  const MatrixXf direct = training.direct.bottomRows(groups) * weight.asDiagonal();
  const MatrixXf product = direct * direct.transpose();
  StandIns result;
  result.group.assign(size_t(groups) * StandIns::kMost, kNone);
  std::vector<std::pair<float, uint32_t>> alike;  // correlation, group
  for (uint32_t g = 0; g < groups; ++g) {
    alike.clear();
    for (uint32_t other = 0; other < groups; ++other) {
      const float norm2 = product(g, g) * product(other, other);
      const float correlation = norm2 > 0 ? product(g, other) / std::sqrt(norm2) : 0.0f;
      if (other != g && correlation > kAlike) alike.emplace_back(-correlation, other);
    }
    std::sort(alike.begin(), alike.end());
    for (size_t i = 0; i < std::min<size_t>(alike.size(), StandIns::kMost); ++i) result.group[g * StandIns::kMost + i] = alike[i].second;
  }
  return result;
}

}  // namespace

TrainingLights makeTrainingLights(const EntryClusters& clusters, const MultiBounce& multi_bounce,
                                  std::vector<std::vector<float>> direct_irradiance) {
  TrainingLights training;
  training.count = uint32_t(direct_irradiance.size());
  const uint32_t rows = clusters.cluster_count + clusters.group_count;
  training.direct.resize(rows, training.count);
  for (uint32_t light = 0; light < training.count; ++light)
    for (uint32_t row = 0; row < rows; ++row) training.direct(row, light) = direct_irradiance[light][row];
  for (int channel = 0; channel < 3; ++channel)
    training.cluster_indirect[channel] = multi_bounce.received(channel, training.direct.bottomRows(clusters.group_count));

  // Sealed pockets: their light is nearly zero everywhere, and a weight of one over it would let them rule the basis.
  training.weight.assign(training.count, 0.0f);
  std::vector<double> mean(training.count, 0.0);
  double area = 0;
  for (uint32_t cluster = 0; cluster < clusters.cluster_count; ++cluster) {
    area += clusters.area[cluster];
    for (uint32_t light = 0; light < training.count; ++light) mean[light] += double(clusters.area[cluster]) * training.cluster_indirect[1](cluster, light);
  }
  std::vector<double> sorted = mean;
  if (!sorted.empty()) std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double median = sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
  for (uint32_t light = 0; light < training.count; ++light)
    if (mean[light] > 0.1 * median) training.weight[light] = float(area / mean[light]);
  training.stand_ins = makeStandIns(training, clusters.group_count);
  return training;
}

BasisBlock fitBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, const MultiBounce& multi_bounce,
                    const TrainingLights& training, const EmitterLight& emitters, std::span<const float> slot_area, const LocalBasesOptions& options) {
  BasisBlock result;
  result.slot.assign(slots.begin(), slots.end());
  const BlockTransport transport = gatherBlock(slots, gatherer, options.rays);
  const Eigen::Index texels = slots.size(), links = transport.cluster.size(), lights = training.count;

  if (!emitters.direct_rgb.empty()) {
    result.emitter_indirect_rgb.assign(slots.size(), Rgb(0.0f));
    for (Eigen::Index t = 0; t < texels; ++t)
      for (int channel = 0; channel < 3; ++channel) {
        double sum = 0;
        for (Eigen::Index l = 0; l < links; ++l) {
          const uint32_t cluster = transport.cluster[l];
          sum += transport.from_cluster[channel](t, l) * (emitters.direct_rgb[cluster][channel] + emitters.cluster_indirect_rgb[cluster][channel]);
        }
        result.emitter_indirect_rgb[t][channel] = float(sum);
      }
  }

  // The block's indirect light under every training light.
  MatrixXf direct(links, lights);
  for (Eigen::Index l = 0; l < links; ++l) direct.row(l) = training.direct.row(transport.cluster[l]);
  MatrixXf samples(texels, 3 * lights);
  for (int channel = 0; channel < 3; ++channel) {
    MatrixXf total = direct;
    for (Eigen::Index l = 0; l < links; ++l) total.row(l) += training.cluster_indirect[channel].row(transport.cluster[l]);
    samples.middleCols(channel * lights, lights).noalias() = transport.from_cluster[channel] * total;
  }
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

  const LinkedGroups linked = linkGroups(clusters, multi_bounce, training, transport.cluster, coordinates, light_weight, basis_norm2, signal2, options);
  const auto emit = [&](uint32_t cluster, const std::array<MatrixXf, 3>& columns, Eigen::Index column) {
    result.link_cluster.push_back(cluster);
    for (Eigen::Index k = 0; k < rank; ++k)
      for (int channel = 0; channel < 3; ++channel) result.coefficient.push_back(columns[channel](k, column));
  };
  for (Eigen::Index l = 0; l < links; ++l)
    if (!linked.merged[clusters.group_of_cluster[transport.cluster[l]]]) emit(transport.cluster[l], coordinates, l);
  for (uint32_t g = 0; g < clusters.group_count; ++g)
    if (linked.kept[g]) emit(clusters.cluster_count + g, linked.coordinates, g);

  result.basis.resize(texels * rank);
  for (Eigen::Index t = 0; t < texels; ++t)
    for (Eigen::Index k = 0; k < rank; ++k) result.basis[t * rank + k] = basis(t, k);
  return result;
}

}  // namespace lightwell::transport
