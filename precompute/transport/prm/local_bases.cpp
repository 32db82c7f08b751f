#include "precompute/transport/prm/local_bases.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <numeric>

#include "precompute/transport/prm/product.h"

namespace lightwell::transport {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXf;
using RowMajor = RowMajorMatrix;
using Part = std::vector<Eigen::Index>;  // some of a block's texels, by their places in it

constexpr float kBasisSteps = 127.0f;
// The share of a light's mean that bounds the weight of dark texels, as in the definition of texrel (docs/cli.md).
constexpr float kDarkFloor = 0.1f;
// The brightness, of that of the whole atlas, below which a block's texels are not weighed up any more: no texrel asks for more, and where no training light
// arrives there would be no bound.
constexpr float kDarkestBlock = 0.05f;
// Beside the training lights, the basis is made for light on each single cluster: as strong as it typically is (at least this share of the mean), with
// this weight against the training lights.
constexpr float kUnseenFloor = 0.3f, kUnseenWeight = 0.25f;
// The weight of evenly spread light against that of all training lights.
constexpr float kEvenWeight = 0.5f;
// A wavelet that no training light excites is taken to be as large as this share of the light around it.
constexpr float kUnseenWavelet = 0.1f;
// Coefficients of differences round away from half a step toward zero: what just reaches it costs more bytes than it is worth.
constexpr float kRounding = 0.4f;
// The first map has nearly all of the block's light, and all clusters add to it: what rounding drops of it adds up, and shows as steps between blocks.
constexpr float kFirstMapStep = 0.4f;
// A coefficient is linked as often as it needs bytes; this bounds what a degenerate block can ask for.
constexpr float kMostSteps = 127.0f * 512;

ChannelMatrices rowsOf(const ChannelMatrices& matrices, const Part& part) {
  ChannelMatrices rows;
  for (int channel = 0; channel < 3; ++channel) rows[channel] = matrices[channel](part, Eigen::all);
  return rows;
}

/// Principal components in the metric of `texel_weight`, from the Gram matrix of the weighted texels.
struct Components {
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
  Eigen::Index rank = 0;  // that leaves the residual asked for; may be more than most_rank

  /// `residual2`: the square that may be left. The noise of the texels' rays is the same in all directions: what the lesser half of the components have is
  /// taken for it, and only what stands out of it counts.
  Components(const MatrixXf& gram, double residual2) : solver(gram.cast<double>()) {
    const auto& value = solver.eigenvalues();
    const Eigen::Index count = value.size();
    const double noise = count > 3 ? std::max(0.0, value[count / 4]) : 0.0;
    double rest = 0;
    for (Eigen::Index k = 0; k < count; ++k) rest += std::max(0.0, value[k] - noise);
    while (rank < count && rest > residual2) {
      rest -= std::max(0.0, value[count - 1 - rank] - noise);
      ++rank;
    }
  }
  /// The first `rank` components as basis maps, quantised.
  MatrixXf basis(Eigen::Index rank_of_basis, const VectorXf& texel_weight) const {
    const Eigen::Index texels = texel_weight.size();
    MatrixXf result(texels, rank_of_basis);
    for (Eigen::Index k = 0; k < rank_of_basis; ++k) {
      VectorXf column = solver.eigenvectors().col(texels - 1 - k).cast<float>().cwiseQuotient(texel_weight);
      Eigen::Index largest;
      column.cwiseAbs().maxCoeff(&largest);
      column /= column[largest];  // the sign of an eigenvector is arbitrary: make its largest value +1
      result.col(k) = (column * kBasisSteps).array().round() / kBasisSteps;
    }
    return result;
  }
};

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

/// Steps may be a few hundredths finer or coarser: few different ones take a quarter of the bytes.
float nearestEighthOctave(float v) { return std::exp2(std::round(8 * std::log2(v)) / 8); }

/// What a wavelet costs in bits: about those that its link and its coefficients take, and what is worth that of the error that rounding leaves. Errors of differences
/// add up like noise. Means are never negative and lost in one sense: what is dropped of them is dear, or thousands of small ones would go together.
float costOf(const float* value, const int32_t* steps, uint32_t width, bool is_mean) {
  constexpr float kLink = 8, kPerSquaredStep = 8, kPerLostStep = 40;
  float bits = 0, lost = 0;
  for (uint32_t i = 0; i < width; ++i) {
    if (steps[i]) bits += float(1 + 2 * std::bit_width(uint32_t(std::abs(steps[i]))));
    const float rest = value[i] - float(steps[i]);
    lost += is_mean && !steps[i] ? kPerLostStep * std::abs(rest) : kPerSquaredStep * rest * rest;
  }
  return (bits > 0 ? bits + kLink : 0) + lost;
}

/// Adds the block's amounts as rows over wavelets. `from_leaf`, per channel [rank][leaf of the tree]: what comes straight from there or is reflected once on its way; `from_group`,
/// [rank][group]: what comes from groups after further bounces; rows from `first_leaf_row` and `first_group_row` on.
///
/// Light on a subtree is known by its mean and the differences below; or by that of the two children, each on its own. Of all such bases the one that
/// costs least is found from the leaves up (Coifman, Wickerhauser: "Entropy-Based Algorithms for Best Basis Selection"): where a block is
/// lit from one room only, the light of all others need not be cancelled.
void linkWavelets(const ResponseTree& tree, const TrainingLights& training, const std::array<MatrixXf, 3>& from_leaf, Eigen::Index first_leaf_row,
                  const ChannelMatrices& from_group, Eigen::Index first_group_row, const VectorXf& basis_norm, const LocalBasesOptions& options, BasisBlock& block) {
  const uint32_t count = tree.leaves, width = block.rank * 3, rank = block.rank;
  std::vector<float> response(size_t(waveletCount(count)) * width);  // [wavelet][channel][rank]
  for (int channel = 0; channel < 3; ++channel) {
    const auto add = [&](uint32_t wavelet, const auto& column) {
      Eigen::Map<VectorXf>(&response[size_t(wavelet) * width + uint32_t(channel) * rank], Eigen::Index(rank)) += column;
    };
    for (uint32_t l = 0; l < count; ++l) add(l, from_leaf[channel].col(Eigen::Index(l)).segment(first_leaf_row, rank));
    for (size_t g = 0; g < tree.group_mean.size(); ++g) add(tree.group_mean[g], from_group[channel].col(Eigen::Index(g)).segment(first_group_row, rank));
  }
  responseToWavelets(tree.shares, tree.children, width, response);

  for (uint32_t k = 0; k < rank; ++k) {
    const float step = nearestEighthOctave((k == 0 ? kFirstMapStep : 1.0f) * options.wavelet_step / (basis_norm[k] * training.mean_unit));
    for (int channel = 0; channel < 3; ++channel) block.scale.push_back(step / training.channel_gain[channel]);
  }
  std::vector<float> steps_per_unit(width);
  for (uint32_t i = 0; i < width; ++i) steps_per_unit[i] = 1.0f / block.scale[i % rank * 3 + i / rank];
  std::vector<int32_t> steps(response.size());
  std::vector<float> cost(waveletCount(count));
  for (uint32_t w = 0; w < cost.size(); ++w) {
    const bool is_mean = w < differenceIndex(count, 0);
    const float unit = waveletUnit(training.wavelet_unit[tree.wavelet[w]]);
    for (uint32_t i = 0; i < width; ++i) {
      float& value = response[size_t(w) * width + i];
      value = std::clamp(value * (unit * steps_per_unit[i]), -kMostSteps, kMostSteps);
      const int32_t whole = int32_t(std::abs(value) + (is_mean ? 0.5f : kRounding));
      steps[size_t(w) * width + i] = value < 0 ? -whole : whole;
    }
    cost[w] = costOf(&response[size_t(w) * width], &steps[size_t(w) * width], width, is_mean);
  }
  // Of each child, the cost of all differences below, and that of its best basis. A mean may not stand for a subtree of which some part gives the block nothing at
  // all: that part lies beyond a wall, and however strong its light is, nothing of it may pass.
  constexpr float kNever = std::numeric_limits<float>::infinity();
  std::vector<float> below(count, 0), best(count, 0);
  std::vector<char> dark(waveletCount(count), 1);  // of means: no response at all
  for (uint32_t w = 0; w < differenceIndex(count, 0); ++w)
    for (uint32_t i = 0; i < width && dark[w]; ++i) dark[w] = response[size_t(w) * width + i] == 0;
  const auto belowChild = [&](uint32_t child) { return child & WaveletTree::kLeaf ? 0 : below[child]; };
  const auto bestOf = [&](uint32_t child) { return child & WaveletTree::kLeaf ? cost[child & ~WaveletTree::kLeaf] : best[child]; };
  for (uint32_t n = count - 1; n-- > 0;) {
    const auto [first, second] = tree.children[n];
    below[n] = cost[differenceIndex(count, n)] + belowChild(first) + belowChild(second);
    if (dark[meanIndex(count, first)] != dark[meanIndex(count, second)]) below[n] = kNever;
    best[n] = std::min(cost[meanIndex(count, n)] + below[n], bestOf(first) + bestOf(second));
  }
  std::vector<char> chosen(cost.size(), 0);
  if (count == 1) chosen[0] = 1;
  std::vector<std::pair<uint32_t, bool>> open;  // child, whether its mean is known from above
  if (count > 1) open.emplace_back(0, false);
  while (!open.empty()) {
    const auto [child, known] = open.back();
    open.pop_back();
    if (child & WaveletTree::kLeaf) {
      if (!known) chosen[child & ~WaveletTree::kLeaf] = 1;
      continue;
    }
    const auto [first, second] = tree.children[child];
    const bool whole = known || cost[meanIndex(count, child)] + below[child] <= bestOf(first) + bestOf(second);
    if (whole && !known) chosen[meanIndex(count, child)] = 1;
    if (whole) chosen[differenceIndex(count, child)] = 1;
    open.emplace_back(first, whole);
    open.emplace_back(second, whole);
  }
  std::vector<std::pair<uint32_t, uint32_t>> links;  // wavelet of all, place here
  for (uint32_t w = 0; w < cost.size(); ++w)
    if (chosen[w]) links.emplace_back(tree.wavelet[w], w);
  std::sort(links.begin(), links.end());
  for (const auto& [wavelet, w] : links) {
    int32_t* rest = &steps[size_t(w) * width];
    for (bool any = std::any_of(rest, rest + width, [](int32_t v) { return v != 0; }); any;) {  // in parts that a byte holds
      any = false;
      block.link_wavelet.push_back(wavelet);
      for (uint32_t i = 0; i < width; ++i) {
        int32_t& own = rest[i % 3 * rank + i / 3];  // coefficients are stored by map, then channel
        const int32_t part = std::clamp(own, -127, 127);
        block.coefficient.push_back(int8_t(part));
        own -= part;
        any |= own != 0;
      }
    }
  }
}

}  // namespace

TrainingLights makeTrainingLights(const EntryClusters& clusters, const WaveletIndex& wavelets, const MultiBounce& multi_bounce, bool grey,
                                  const std::vector<std::vector<float>>& direct_irradiance) {
  TrainingLights training;
  training.count = uint32_t(direct_irradiance.size());
  training.grey = grey;
  training.total.resize(clusters.cluster_count, training.count);
  for (uint32_t light = 0; light < training.count; ++light)
    for (uint32_t c = 0; c < clusters.cluster_count; ++c) training.total(c, light) = direct_irradiance[light][c];
  const RowMajor direct = training.total;

  std::vector<double> mean(training.count, 0.0);
  double area = 0;
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) area += clusters.area[c];
  for (int channel = 0; channel < 3; ++channel) {
    const Eigen::Index first = training.first(channel), count = Eigen::Index(training.first(channel + 1)) - first;
    if (count == 0) continue;
    const RowMajor indirect = multi_bounce.received(channel, clusters, direct.middleCols(first, count));
    for (Eigen::Index light = 0; light < count; ++light)
      for (uint32_t c = 0; c < clusters.cluster_count; ++c) mean[size_t(first + light)] += double(clusters.area[c]) * indirect(c, light);
    training.total.middleCols(first, count) += indirect;
  }

  // Sealed pockets: their light is nearly zero everywhere, and a weight of one over it would let them rule the basis.
  training.weight.assign(training.count, 0.0f);
  for (int channel = 0; channel < 3; ++channel) {
    const std::span<const double> means(mean.data() + training.first(channel), mean.data() + training.first(channel + 1));
    if (means.empty()) continue;
    std::vector<double> sorted(means.begin(), means.end());
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
    for (size_t i = 0; i < means.size(); ++i)
      if (means[i] > 0.1 * sorted[sorted.size() / 2]) training.weight[training.first(channel) + i] = float(area / means[i]);
  }

  const Eigen::Map<const Eigen::RowVectorXf> weight(training.weight.data(), training.count);
  const RowMajor weighted = direct * weight.asDiagonal();
  const auto wavelet = toWavelets(clusters.tree, wavelets.children, training.count, std::span(weighted.data(), size_t(weighted.size())));
  const float per_light = 1.0f / float(std::max(1u, training.count));
  const uint32_t count = clusters.cluster_count;
  const auto sizeOf = [&](uint32_t w) {
    return std::sqrt(Eigen::Map<const VectorXf>(wavelet.data() + size_t(w) * training.count, training.count).squaredNorm() * per_light);
  };
  if (count > 0 && training.count > 0)
    if (const float size = sizeOf(meanIndex(count, count == 1 ? WaveletTree::kLeaf : 0)); size > 0) training.mean_unit = size;
  const auto gain2 = [&](uint32_t first, uint32_t end) {
    double sum = 0;
    for (uint32_t light = first; light < end; ++light) sum += double(training.weight[light]) * training.weight[light];
    return end > first ? sum / (end - first) : 0.0;
  };
  const double all_gain2 = gain2(0, training.count);
  for (int channel = 0; channel < 3 && !grey; ++channel)
    if (const double own = gain2(training.first(channel), training.first(channel + 1)); own > 0) training.channel_gain[channel] = float(std::sqrt(own / all_gain2));
  for (uint32_t w = 0; w < waveletCount(count); ++w) {
    float size = sizeOf(w) / training.mean_unit;
    if (w >= differenceIndex(count, 0)) {
      const uint32_t node = w - differenceIndex(count, 0);
      size = std::max(size, kUnseenWavelet * waveletUnit(training.wavelet_unit[meanIndex(count, node)]));
    }
    training.wavelet_unit.push_back(waveletUnitCode(size));
  }
  return training;
}

namespace {

/// A basis, and the transport of its texels in its coordinates.
struct Projection {
  Part part;
  BasisBlock block;              // without links
  VectorXf basis_norm;           // [rank]
  ChannelMatrices from_cluster;  // [rank][cluster met]
};

/// The bases of a set of texels whose transport is known, as a whole or in parts. Parts are lists of rows of `transport`.
class BlockFit {
 public:
  BlockFit(const BlockTransport& transport, const std::vector<float>& area, const TrainingLights& training, const LocalBasesOptions& options)
      : training_(training), options_(options), area_(area), samples_(Eigen::Index(area.size()), Eigen::Index(training.count)) {
    for (int channel = 0; channel < 3; ++channel) {
      from_cluster_[channel] = transport.from_cluster[channel];
      const Eigen::Index first = training.first(channel), count = Eigen::Index(training.first(channel + 1)) - first;
      if (count == 0) continue;
      SparseRows gathered;
      for (Eigen::Index t = 0; t < from_cluster_[channel].rows(); ++t) {
        for (Eigen::Index l = 0; l < from_cluster_[channel].cols(); ++l)
          if (const float share = from_cluster_[channel](t, l); share != 0) gathered.column.push_back(transport.cluster[size_t(l)]), gathered.value.push_back(share);
        gathered.first.push_back(uint32_t(gathered.column.size()));
      }
      multiply(gathered, training.total.middleCols(first, count), samples_.middleCols(first, count));
    }
    // How strong light on each cluster typically is.
    const VectorXf light_weight = lightWeights(samples_);
    typical_.resize(Eigen::Index(transport.cluster.size()));
    for (size_t l = 0; l < transport.cluster.size(); ++l)
      typical_[Eigen::Index(l)] = training.total.row(transport.cluster[l]).cwiseProduct(light_weight.transpose()).norm() / std::sqrt(float(std::max(1u, training.count)));
  }

  /// The whole as one block.
  Projection fitWhole() const {
    Part part(area_.size());
    std::iota(part.begin(), part.end(), Eigen::Index(0));
    return project(part, componentsOf(part));
  }

  /// A part as one block, or, where that has more components than maps, as several: halved by `halves`.
  template <class Halves>
  void fit(const Part& part, const Halves& halves, std::vector<Projection>& projections) const {
    const Weighted weighted = componentsOf(part);
    if (weighted.components.rank > Eigen::Index(options_.most_rank) && part.size() >= 2 * size_t(options_.least_texels)) {
      for (const Part& half : halves(part)) fit(half, halves, projections);
      return;
    }
    projections.push_back(project(part, weighted));
  }

 private:
  struct Weighted {
    VectorXf texel_weight;
    Components components;
  };

  /// relrmse weighs a texel's error by one over the light's mean, texrel by one over the texel's own light. A least-squares fit takes weights that are a
  /// product of one factor per light and one per texel: the first from the light's mean over everything and over the block, the second from the mean light.
  template <class Samples>
  VectorXf lightWeights(const Samples& samples) const {
    VectorXf weights(samples.cols());
    for (Eigen::Index m = 0; m < samples.cols(); ++m) weights[m] = training_.weight[m] > 0 ? 1.0f / (1.0f / training_.weight[m] + samples.col(m).mean()) : 0.0f;
    return weights;
  }

  Weighted componentsOf(const Part& part) const {
    const Eigen::Index texels = Eigen::Index(part.size()), links = typical_.size(), lights = training_.count;
    MatrixXf samples = samples_(part, Eigen::all);  // the part's indirect light under every training light
    const ChannelMatrices from_cluster = rowsOf(from_cluster_, part);
    const VectorXf light_weight = lightWeights(samples);
    const Eigen::Index counted = (light_weight.array() > 0).count();
    samples = samples * light_weight.asDiagonal();
    VectorXf texel_weight = samples.rowwise().mean();
    texel_weight = (texel_weight.array() + kDarkFloor * texel_weight.mean() + kDarkestBlock).inverse();

    const float typical_floor = kUnseenFloor * (links > 0 ? typical_.mean() : 0.0f);
    MatrixXf gram = MatrixXf::Zero(texels, texels);
    const auto addToGram = [&](const MatrixXf& columns, float weight) {
      if (columns.cols() == 0) return;
      gram.selfadjointView<Eigen::Lower>().rankUpdate(texel_weight.asDiagonal() * columns, weight);
    };
    addToGram(samples, 1.0f);
    for (int channel = 0; channel < 3; ++channel)
      if (!training_.grey || channel == 1)
        addToGram(from_cluster[channel] * (typical_.array() + typical_floor).matrix().asDiagonal(),
                  kUnseenWeight * kUnseenWeight * float(lights) * (training_.grey ? 1.0f : 1.0f / 3.0f));
    // And evenly spread light, in which a texel's share of the sky is all that counts.
    VectorXf even = VectorXf::Zero(texels);
    for (const auto& matrix : from_cluster) even += matrix.rowwise().sum();
    const float even_mean = even.cwiseProduct(texel_weight).mean();
    if (even_mean > 0) addToGram(even / even_mean, kEvenWeight * float(lights));
    return {texel_weight, Components(gram, double(options_.rank_error) * options_.rank_error * double(texels) * double(std::max<Eigen::Index>(1, counted)))};
  }

  Projection project(const Part& part, const Weighted& weighted) const {
    const VectorXf& texel_weight = weighted.texel_weight;
    const Eigen::Index texels = texel_weight.size();
    Projection projection{part, {}, {}, {}};
    BasisBlock& block = projection.block;
    block.rank = uint32_t(std::min<Eigen::Index>(weighted.components.rank, options_.most_rank));
    if (block.rank == 0) return projection;
    const MatrixXf basis = weighted.components.basis(block.rank, texel_weight);
    VectorXf area(texels);
    for (Eigen::Index t = 0; t < texels; ++t) area[t] = area_[size_t(part[size_t(t)])];
    const MatrixXf to_coordinates = energyKeepingCoordinates(basis, texel_weight, area);
    projection.basis_norm = (texel_weight.asDiagonal() * basis).colwise().norm() / std::sqrt(float(texels));
    for (int channel = 0; channel < 3; ++channel) projection.from_cluster[channel] = to_coordinates * from_cluster_[channel](part, Eigen::all);
    for (Eigen::Index t = 0; t < texels; ++t)
      for (Eigen::Index k = 0; k < basis.cols(); ++k) block.basis.push_back(int8_t(std::lround(basis(t, k) * kBasisSteps)));
    return projection;
  }

  const TrainingLights& training_;
  const LocalBasesOptions& options_;
  const std::vector<float>& area_;  // [texel]
  ChannelMatrices from_cluster_;  // [texel][cluster met]
  RowMajor samples_;              // [texel][light]: indirect light under every training light
  VectorXf typical_;              // [cluster met]: root mean square of training light
};

/// The bases of texels that met the same clusters.
struct ProjectedBlock {
  std::vector<uint32_t> cluster;  // met
  ResponseTree tree;
  std::vector<Projection> projections;

  Eigen::Index ranks() const {
    return std::accumulate(projections.begin(), projections.end(), Eigen::Index(0), [](Eigen::Index sum, const Projection& p) { return sum + Eigen::Index(p.block.rank); });
  }
};

/// Links the bases of some blocks, and lets go of the projections' transport. Further bounces are followed in the bases' coordinates, which are fewer than texels, of all blocks
/// together.
void linkAll(std::span<ProjectedBlock> blocks, const EntryClusters& clusters, const MultiBounce& multi_bounce, const TrainingLights& training, const LocalBasesOptions& options) {
  Eigen::Index ranks = 0;
  for (const ProjectedBlock& block : blocks) ranks += block.ranks();
  std::vector<std::array<MatrixXf, 3>> from_leaf;  // of each block, [its coordinates][leaf]
  std::array<MatrixXf, 3> once;                    // [coordinate of all][group]
  for (MatrixXf& matrix : once) matrix.setZero(ranks, clusters.group_count);
  Eigen::Index row = 0;
  for (ProjectedBlock& block : blocks) {
    std::array<MatrixXf, 3> from_cluster;
    for (int channel = 0; channel < 3; ++channel) {
      from_cluster[channel].resize(block.ranks(), Eigen::Index(block.cluster.size()));
      Eigen::Index own = 0;
      for (Projection& p : block.projections) {
        if (p.block.rank > 0) from_cluster[channel].middleRows(own, Eigen::Index(p.block.rank)) = p.from_cluster[channel], own += Eigen::Index(p.block.rank);
        p.from_cluster[channel].resize(0, 0);
      }
    }
    auto& leaves = from_leaf.emplace_back(multi_bounce.onceReflected(block.cluster, from_cluster, block.tree.leaf_of_cluster, block.tree.leaves));
    for (int channel = 0; channel < 3; ++channel) {
      for (uint32_t leaf = 0; leaf < block.tree.leaves; ++leaf)
        once[channel].col(block.tree.group_of_leaf[leaf]).segment(row, block.ranks()) += leaves[channel].col(leaf);
      for (size_t l = 0; l < block.cluster.size(); ++l) leaves[channel].col(block.tree.leaf_of_cluster[block.cluster[l]]) += from_cluster[channel].col(Eigen::Index(l));
    }
    row += block.ranks();
  }
  ChannelMatrices from_group;
  for (int channel = 0; channel < 3; ++channel) from_group[channel] = multi_bounce.furtherReflected(channel, once[channel]);
  row = 0;
  for (size_t b = 0; b < blocks.size(); ++b) {
    Eigen::Index own_row = 0;
    for (Projection& p : blocks[b].projections) {
      const Eigen::Index rank = Eigen::Index(p.block.rank);
      if (rank == 0) continue;
      linkWavelets(blocks[b].tree, training, from_leaf[b], own_row, from_group, row + own_row, p.basis_norm, options, p.block);
      own_row += rank;
    }
    row += own_row;
    for (MatrixXf& matrix : from_leaf[b]) matrix.resize(0, 0);
  }
}

/// Texels that share what they see with others of the same part only: a block must not reach through a wall, for its maps would let light pass. Lists of
/// places in the block; texels that see nothing are a part of their own.
std::vector<Part> partsBySight(const BlockTransport& transport, const EntryClusters& clusters) {
  constexpr float kCommonSight = 0.1f;  // the common share of the groups seen, of 1
  const Eigen::Index texels = transport.from_cluster[1].rows();
  std::vector<uint32_t> column;
  uint32_t groups = 0;
  for (size_t l = 0; l < transport.cluster.size(); ++l) {
    if (l > 0 && clusters.group_of_cluster[transport.cluster[l]] != clusters.group_of_cluster[transport.cluster[l - 1]]) ++groups;
    column.push_back(groups);
  }
  RowMajor seen = RowMajor::Zero(texels, Eigen::Index(groups) + 1);
  for (size_t l = 0; l < transport.cluster.size(); ++l)
    for (const auto& matrix : transport.from_cluster) seen.col(column[l]) += matrix.col(Eigen::Index(l));
  std::vector<Part> parts;
  Part blind, rest;
  for (Eigen::Index t = 0; t < texels; ++t) {
    const float sum = seen.row(t).sum();
    (sum > 0 ? rest : blind).push_back(t);
    if (sum > 0) seen.row(t) /= sum;
  }
  while (!rest.empty()) {
    Part part = {rest.front()};
    rest.erase(rest.begin());
    for (size_t i = 0; i < part.size(); ++i) {
      const auto joined = std::stable_partition(rest.begin(), rest.end(), [&](Eigen::Index t) {
        return seen.row(part[i]).cwiseMin(seen.row(t)).sum() < kCommonSight;
      });
      part.insert(part.end(), joined, rest.end());
      rest.erase(joined, rest.end());
    }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  if (!blind.empty()) parts.push_back(std::move(blind));
  return parts;
}

}  // namespace

std::vector<BasisBlock> fitWhole(std::span<const BlockTransport> transports, const std::vector<float>& weight, const EntryClusters& clusters, const WaveletIndex& wavelets,
                                 const MultiBounce& multi_bounce, const TrainingLights& training, const LocalBasesOptions& options) {
  std::vector<ProjectedBlock> projected;
  for (const BlockTransport& transport : transports) {
    projected.push_back({transport.cluster, {clusters, wavelets, transport.cluster}, {}});
    projected.back().projections.push_back(BlockFit(transport, weight, training, options).fitWhole());
  }
  linkAll(projected, clusters, multi_bounce, training, options);
  std::vector<BasisBlock> blocks;
  for (ProjectedBlock& p : projected) blocks.push_back(std::move(p.projections.front().block));
  return blocks;
}

std::vector<std::vector<BasisBlock>> fitBlocks(std::span<const std::vector<uint32_t>> slots_of_blocks, const atlas::Atlas& atlas, const Gatherer& gatherer,
                                               const EntryClusters& clusters, const WaveletIndex& wavelets, const MultiBounce& multi_bounce,
                                               const TrainingLights& training, const EmitterLight& emitters, const LocalBasesOptions& options) {
  std::vector<ProjectedBlock> projected;
  for (const auto& slots : slots_of_blocks) {
    const BlockTransport transport = gatherBlock(slots, gatherer, options.rays, clusters.cluster_count);
    std::vector<float> area;
    for (const uint32_t slot : slots) area.push_back(atlas.slots[slot].area);
    const BlockFit block_fit(transport, area, training, options);
    const auto halves = [&](const Part& part) {  // as partitions are cut
      std::vector<SurfaceElement> elements;
      for (const Eigen::Index t : part) elements.push_back({atlas.slots[slots[size_t(t)]].position, atlas.slots[slots[size_t(t)]].normal});
      std::array<Part, 2> halves;
      const auto places = bisect(elements);
      for (size_t i = 0; i < 2; ++i)
        for (const uint32_t place : places[i]) halves[i].push_back(part[place]);
      return halves;
    };
    ProjectedBlock& block = projected.emplace_back(ProjectedBlock{transport.cluster, {clusters, wavelets, transport.cluster}, {}});
    for (const Part& part : partsBySight(transport, clusters)) block_fit.fit(part, halves, block.projections);
    for (Projection& p : block.projections)
      for (const Eigen::Index t : p.part) {
        p.block.slot.push_back(slots[size_t(t)]);
        if (emitters.cluster_rgb.empty()) continue;
        Rgb& sum = p.block.emitter_indirect_rgb.emplace_back(0.0f);
        for (size_t l = 0; l < transport.cluster.size(); ++l)
          for (int channel = 0; channel < 3; ++channel)
            sum[channel] += transport.from_cluster[channel](t, Eigen::Index(l)) * emitters.cluster_rgb[transport.cluster[l]][channel];
      }
  }
  linkAll(projected, clusters, multi_bounce, training, options);
  std::vector<std::vector<BasisBlock>> blocks;
  for (ProjectedBlock& block : projected) {
    auto& own = blocks.emplace_back();
    for (Projection& p : block.projections) own.push_back(std::move(p.block));
  }
  return blocks;
}

}  // namespace lightwell::transport
