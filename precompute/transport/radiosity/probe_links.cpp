#include "precompute/transport/radiosity/probe_links.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "precompute/transport/sphere_rays.h"
#include "precompute/transport/radiosity/spherical_harmonics.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kProbeStream = 7ull << 40;
constexpr float kFaintest = 0.1f;         // of the scene's mean irradiance: darker probes need not be relatively as exact
constexpr int kCorrectionSteps = 6;
constexpr double kMostCorrection = 0.7;   // of a link's logarithm in a step

using Errors = Eigen::ArrayXf;            // [light][harmonic], as parts of irradiance

/// A link of the probe that is being compressed, and what it gets wrong.
struct Link {
  uint32_t node;
  float value;
  Errors error;
};

Vec3 unit(const Vec3& sum) { return sum.length2() > 0 ? sum.normalized() : Vec3(0, 0, 1); }

class ProbeMerger {
 public:
  ProbeMerger(const ProbeHits& hits, std::span<const Vec3> positions, const ProbeSurroundings& surroundings, const RadiosityTraining& training,
              const ProbeLinkOptions& options)
      : hits_(hits), positions_(positions), tree_(surroundings.tree), surroundings_(surroundings), options_(options), lights_(std::min<Eigen::Index>(training.lights(), options.most_lights)),
        node_radiosity_(tree_.nodeCount(), lights_) {
    node_radiosity_.topRows(training.radiosity.rows()) = training.radiosity.leftCols(lights_);
    for (uint32_t i = tree_.level_first[1]; i < tree_.nodeCount(); ++i) {
      const uint32_t index = i - tree_.level_first[1];
      node_radiosity_.row(i).setZero();
      for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) node_radiosity_.row(i) += node_radiosity_.row(child) * tree_.area[child];
      node_radiosity_.row(i) /= tree_.area[i];
    }
  }

  /// From now on links() is about this one.
  void begin(uint32_t probe) {
    probe_ = probe;
    scale_ = error_ = Errors::Zero(lights_ * kHarmonics);
    for (uint64_t i = hits_.group_first[hits_.first[probe]]; i < hits_.group_first[hits_.first[probe + 1]]; ++i) {
      const Errors exact = light(shareOf(i), unit(hits_.direction[i]), hits_.patch[i]);
      error_ += light(shareOf(i), wayTo(hits_.patch[i]), hits_.patch[i]) - exact;
      scale_ += exact;
    }
    for (Eigen::Index l = 0; l < lights_; ++l) scale_.segment(l * kHarmonics, kHarmonics).setConstant(1 / (std::abs(scale_[l * kHarmonics]) + kFaintest));
    unmerged_ = rms(error_);
  }

  /// Those of a group of hits.
  std::vector<Link> links(uint32_t group) {
    begin_ = hits_.group_first[group];
    met_ = std::span(hits_.patch).subspan(begin_, hits_.group_first[group + 1] - begin_);
    links_.clear();
    for (uint64_t i = begin_; i < hits_.group_first[group + 1]; ++i) {
      const Errors exact = light(shareOf(i), unit(hits_.direction[i]), hits_.patch[i]);
      links_.push_back({hits_.patch[i], shareOf(i), light(shareOf(i), wayTo(hits_.patch[i]), hits_.patch[i]) - exact});
    }
    for (uint32_t level = 1; level < tree_.levelCount(); ++level) mergeInto(level);
    return std::move(links_);
  }
  Vec3 wayTo(uint32_t node) const { return unit(surroundings_.position[node] - positions_[probe_]); }

 private:
  /// What a link adds to the irradiance: coefficients of the bands, scaled so that the sum of their squares is the mean square over all normals.
  Errors light(float value, const Vec3& direction, uint32_t node) const {
    const auto y = sphericalHarmonics(direction);
    Errors part(lights_ * kHarmonics);
    for (Eigen::Index l = 0; l < lights_; ++l)
      for (int k = 0; k < kHarmonics; ++k)
        part[l * kHarmonics + k] = value * 4 * node_radiosity_(node, l) * y[size_t(k)] * kCosineBand[size_t(k)] * 0.28209479f;
    return part;
  }
  float rms(const Errors& error) const { return std::sqrt((error * scale_).square().sum() / float(lights_)); }

  float shareOf(uint64_t hit) const { return float(hits_.count[hit]) / float(options_.rays); }

  /// Whether what the probe sees of `node`, together `value`, spreads over it as its area does, seen at its patches and at its children.
  bool isEven(uint32_t node, uint32_t level, double value) const {
    const double most2 = double(options_.uneven) * options_.uneven + value / options_.rays;
    const double per_area = value / tree_.area[node];
    const auto at = [&](uint32_t patch) { return size_t(std::lower_bound(met_.begin(), met_.end(), patch) - met_.begin()); };
    const auto shareAt = [&](size_t i) { return double(hits_.count[begin_ + i]) / options_.rays; };
    const size_t begin = at(tree_.first_patch[node]), end = at(tree_.end_patch[node]);
    double deviation2 = 0, missed_area = tree_.area[node];
    for (size_t i = begin; i < end; ++i) {
      const double area = tree_.area[met_[i]], difference = shareAt(i) - per_area * area;
      deviation2 += difference * difference;
      missed_area = std::max(0.0, missed_area - area);
    }
    const double missed = double(tree_.end_patch[node] - tree_.first_patch[node]) - double(end - begin);
    if (missed > 0) deviation2 += per_area * per_area * missed_area * missed_area / missed;
    if (deviation2 > most2 || level == 1) return deviation2 <= most2;
    deviation2 = 0;
    const uint32_t index = node - tree_.level_first[1];
    for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) {
      double difference = -per_area * tree_.area[child];
      for (size_t i = at(tree_.first_patch[child]), stop = at(tree_.end_patch[child]); i < stop; ++i) difference += shareAt(i);
      deviation2 += difference * difference;
    }
    return deviation2 <= most2;
  }

  /// Merges the links below nodes of `level`, those that cost least first, while the probe's error allows. Links are in the order of their patches.
  void mergeInto(uint32_t level) {
    struct Candidate {
      size_t begin, end;  // links
      Link merged;
      float cost;
    };
    std::vector<Candidate> candidates;
    uint32_t node = tree_.level_first[level];
    for (size_t begin = 0, end; begin < links_.size(); begin = end) {
      while (tree_.end_patch[node] <= tree_.first_patch[links_[begin].node]) ++node;
      for (end = begin; end < links_.size() && tree_.first_patch[links_[end].node] < tree_.end_patch[node];) ++end;
      if (end - begin < 2 || !surroundings_.mergeable[node]) continue;
      Link merged{node, 0.0f, Errors::Zero(lights_ * kHarmonics)};
      for (size_t i = begin; i < end; ++i) {
        merged.value += links_[i].value;
        merged.error += links_[i].error - light(links_[i].value, wayTo(links_[i].node), links_[i].node);
      }
      if (!isEven(node, level, merged.value)) continue;
      merged.error += light(merged.value, wayTo(node), node);
      const float cost = rms(merged.error) / float(end - begin - 1);
      candidates.push_back({begin, end, std::move(merged), cost});
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    // Every level may use a part of the error, so that the lowest does not spend it all.
    const float most = std::hypot(unmerged_, options_.error * float(level) / float(tree_.levelCount() - 1));
    std::vector<char> gone(links_.size(), 0);
    for (Candidate& candidate : candidates) {
      Errors error = error_ + candidate.merged.error;
      for (size_t i = candidate.begin; i < candidate.end; ++i) error -= links_[i].error;
      if (rms(error) > most) continue;
      error_ = error;
      for (size_t i = candidate.begin + 1; i < candidate.end; ++i) gone[i] = 1;
      links_[candidate.begin] = std::move(candidate.merged);
    }
    size_t kept = 0;
    for (size_t i = 0; i < links_.size(); ++i)
      if (!gone[i]) {
        if (kept != i) links_[kept] = std::move(links_[i]);
        ++kept;
      }
    links_.resize(kept);
  }

  const ProbeHits& hits_;
  std::span<const Vec3> positions_;
  const PatchTree& tree_;
  const ProbeSurroundings& surroundings_;
  ProbeLinkOptions options_;
  Eigen::Index lights_;
  RadiosityTraining::Matrix node_radiosity_;
  uint32_t probe_ = 0;
  uint64_t begin_ = 0;                    // the first hit of the group that is being compressed
  std::span<const uint32_t> met_;         // its patches
  std::vector<Link> links_;
  Errors scale_, error_;
  float unmerged_ = 0;  // what the directions of patches close by get wrong, merged or not
};

/// Links have one direction each, which bends the harmonics of light from all around a little. Changes the values as little as can be (least relative entropy: each by a factor
/// exp(Σ λ_k Y_k)) until even light gives just what the rays found of it: the same from all sides in a closed room. Newton's method on the nine λ.
void keepEvenLightEven(const ProbeMerger& merger, std::vector<Link>& links, const std::array<float, kHarmonics>& moments) {
  using Moments = Eigen::Matrix<double, kHarmonics, 1>;
  std::vector<Moments> basis;
  double sum = 0;
  for (const Link& link : links) {
    const auto y = sphericalHarmonics(merger.wayTo(link.node));
    basis.push_back(Eigen::Map<const Eigen::Matrix<float, kHarmonics, 1>>(y.data()).cast<double>());
    sum += link.value;
  }
  const Moments wanted = Eigen::Map<const Eigen::Matrix<float, kHarmonics, 1>>(moments.data()).cast<double>();
  for (int step = 0; step < kCorrectionSteps; ++step) {
    Eigen::Matrix<double, kHarmonics, kHarmonics> gram = Eigen::Matrix<double, kHarmonics, kHarmonics>::Zero();
    Moments missing = wanted;
    for (size_t i = 0; i < links.size(); ++i) {
      missing -= double(links[i].value) * basis[i];
      gram += double(links[i].value) * basis[i] * basis[i].transpose();
    }
    gram.diagonal().array() += 1e-9 + 1e-6 * gram.trace();  // few links cannot have nine moments
    const Moments lambda = gram.ldlt().solve(missing);
    for (size_t i = 0; i < links.size(); ++i) links[i].value *= float(std::exp(std::clamp(lambda.dot(basis[i]), -kMostCorrection, kMostCorrection)));
  }
  double corrected = 0;
  for (const Link& link : links) corrected += link.value;
  for (Link& link : links) link.value *= float(sum / corrected);
}

}  // namespace

void ProbeLinkValues::append(const ProbeLinkValues& other) {
  const uint32_t base = uint32_t(node.size());
  for (size_t i = 1; i < other.first.size(); ++i) first.push_back(base + other.first[i]);
  const auto number = addSets(other.sets, sets);
  for (const uint32_t other_set : other.set) set.push_back(number[other_set]);
  node.insert(node.end(), other.node.begin(), other.node.end());
  value.insert(value.end(), other.value.begin(), other.value.end());
}

ProbeHits countProbeHits(const GatedTracer& tracer, const Probes& probes, uint32_t rays, uint64_t seed, uint32_t begin, uint32_t end) {
  ProbeHits result;
  std::vector<GatedHit> hits;
  for (uint32_t probe = begin; probe < end; ++probe) {
    const auto list = sphereRays(probes.position[probe], rays, seed, kProbeStream + probe);
    tracer.trace(list, kNone, result.sets, hits);
    std::sort(hits.begin(), hits.end(), [](const GatedHit& a, const GatedHit& b) { return std::tie(a.set, a.patch, a.ray) < std::tie(b.set, b.patch, b.ray); });
    for (size_t first = 0, last; first < hits.size(); first = last) {
      std::array<double, kHarmonics> moments{};
      for (last = first; last < hits.size() && hits[last].set == hits[first].set; ++last) {
        const Vec3& direction = list[hits[last].ray].direction;
        const auto y = sphericalHarmonics(direction);
        for (size_t k = 0; k < kHarmonics; ++k) moments[k] += double(y[k]) / rays;
        if (last == first || hits[last].patch != hits[last - 1].patch) {
          result.patch.push_back(hits[last].patch);
          result.count.push_back(0);
          result.direction.emplace_back(0.0f);
        }
        ++result.count.back();
        result.direction.back() += direction;
      }
      result.set.push_back(hits[first].set);
      result.group_first.push_back(result.patch.size());
      std::copy(moments.begin(), moments.end(), result.moments.emplace_back().begin());
    }
    result.first.push_back(uint32_t(result.set.size()));
  }
  return result;
}

std::vector<Vec3> nodePositions(const Patches& patches, const PatchTree& tree) {
  std::vector<Vec3> position = patches.position;
  for (uint32_t node = patches.count(); node < tree.nodeCount(); ++node) {
    Vec3 sum(0.0f);
    for (uint32_t child = tree.first_child[node - patches.count()]; child < tree.first_child[node - patches.count() + 1]; ++child) sum += position[child] * tree.area[child];
    position.push_back(sum / tree.area[node]);
  }
  return position;
}

ProbeLinkValues makeProbeLinks(const ProbeHits& hits, std::span<const Vec3> positions, const ProbeSurroundings& surroundings, const RadiosityTraining& training,
                               const ProbeLinkOptions& options) {
  ProbeLinkValues result;
  ProbeMerger merger(hits, positions, surroundings, training, options);
  result.sets = hits.sets;
  for (uint32_t probe = 0; probe < hits.probes(); ++probe) {
    merger.begin(probe);
    for (uint32_t group = hits.first[probe]; group < hits.first[probe + 1]; ++group) {
      std::vector<Link> links = merger.links(group);
      keepEvenLightEven(merger, links, hits.moments[group]);
      std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.node < b.node; });
      for (const Link& link : links) {
        result.set.push_back(hits.set[group]);
        result.node.push_back(link.node);
        result.value.push_back(link.value);
      }
    }
    result.first.push_back(uint32_t(result.node.size()));
  }
  return result;
}

ProbeLinks quantiseProbeLinks(const ProbeLinkValues& links) {
  ProbeLinks result;
  result.first = links.first;
  result.set = links.set;
  result.sets = sortSets(links.sets, result.set);
  const std::vector<uint32_t> unsorted_set = result.set;
  for (uint32_t probe = 0; probe < links.probes(); ++probe) {
    const uint32_t first = links.first[probe], end = links.first[probe + 1];
    std::vector<uint32_t> order(end - first);
    std::iota(order.begin(), order.end(), first);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return unsorted_set[a] < unsorted_set[b]; });
    double sum = 0, largest = 0;
    for (uint32_t l = first; l < end; ++l) {
      sum += links.value[l];
      largest = std::max(largest, double(links.value[l]));
    }
    uint64_t codes = 0;
    for (uint32_t i = 0; i < order.size(); ++i) {
      result.set[first + i] = unsorted_set[order[i]];
      result.node.push_back(links.node[order[i]]);
      result.code.push_back(linkCode(float(links.value[order[i]] / largest * linkWeight(255))));
      codes += linkWeight(result.code.back());
    }
    result.scale.push_back(codes ? float(sum / double(codes)) : 0.0f);
  }
  return result;
}

}  // namespace lightwell::transport
