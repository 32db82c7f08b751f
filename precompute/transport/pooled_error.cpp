#include "precompute/transport/pooled_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lightwell::transport {
namespace {

constexpr double kDark = 0.1;         // of the mean: what a dark texel's error is measured against at least
constexpr double kUnlitShare = 1e-4;  // of the mean: a texel is lit when the mean of its channels is above this
constexpr double kDeviations = 2.0;   // of a normal distribution: 95.4 % lie within
constexpr double kOutside = 0.05;     // chance that an interval does not hold the true value
constexpr double kPriorNoise = 1.0;   // what all texels have in common says so much of a texel's noise, compared with the scatter of its own references
constexpr size_t kRetracedTexels = 32;
constexpr double kMedianVariance = 0.789;  // median of the variance of four values, in true variances

double signedRoot(double square) { return std::copysign(std::sqrt(std::abs(square)), square); }

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

/// What one lit texel adds to the sums.
struct Sums {
  double weight = 1;
  double square = 0, relative = 0, reference_square = 0;  // over the channels
  double candidate = 0, reference = 0;
  double one = 1;
};

struct Ratio {
  double value = 0;
  Interval interval_95;
};

/// Σ weight × above ÷ Σ weight × below.
Ratio ratioOfSums(std::span<const Sums> texels, double Sums::*above, double Sums::*below) {
  double numerator = 0, denominator = 0;
  for (const Sums& t : texels) numerator += t.weight * t.*above, denominator += t.weight * t.*below;
  Ratio ratio{.value = numerator / denominator};
  // What each texel adds to the ratio's deviation.
  const double count = double(texels.size());
  double second = 0, third = 0;
  for (const Sums& t : texels) {
    const double influence = t.weight * (t.*above - ratio.value * t.*below) * count / denominator;
    second += influence * influence, third += influence * influence * influence;
  }
  const double spread = std::sqrt(second / std::max(1.0, count - 1)), root = std::sqrt(count);
  if (!(spread > 0)) {
    ratio.interval_95 = {ratio.value, ratio.value};
    return ratio;
  }
  const double skewness = third / count / (spread * spread * spread), bend = skewness / (3 * root);
  const auto straightened = [&](double deviations) {
    const double x = deviations - skewness / (6 * root);
    return std::abs(bend) < 1e-9 ? x : (std::cbrt(1 + 3 * bend * x) - 1) / bend;
  };
  ratio.interval_95 = {ratio.value - spread / root * straightened(kDeviations), ratio.value - spread / root * straightened(-kDeviations)};
  return ratio;
}

Interval rootOf(const Interval& squares) { return {std::sqrt(std::max(0.0, squares.low)), std::sqrt(std::max(0.0, squares.high))}; }

/// Candidate and references of one texel and channel.
struct Values {
  std::span<const std::vector<Rgb>> references;
  size_t texel;       // in the references
  double v, w;        // two estimates of the candidate, or twice the same
  int channel;

  double reference(size_t i) const { return references[i][texel][channel]; }
  double sum() const {
    double all = 0;
    for (size_t i = 0; i < references.size(); ++i) all += reference(i);
    return all;
  }
  void addTo(Sums& sums, double dark) const {
    const size_t count = references.size();
    const double pairs = double(count * (count - 1) / 2), all = sum(), rest = double(count - 2);
    double squares = 0;
    for (size_t i = 0; i < count; ++i) squares += reference(i) * reference(i);
    sums.candidate += (v + w) / 2;
    sums.reference += all / double(count);
    for (size_t i = 0; i < count; ++i)
      for (size_t j = i + 1; j < count; ++j) {
        const double a = reference(i), b = reference(j), others = (all - a - b) / rest;
        const double product = ((v - a) * (w - b) + (w - a) * (v - b)) / (2 * pairs), scale = std::max(others, 0.0) + dark;
        // Noise of a divisor raises the mean of the quotients: 1 / (s + noise)² is on the mean about 1 / s² + 3 noise² / s⁴.
        const double noise2 = rest > 1 ? std::max(0.0, (squares - a * a - b * b) / rest - others * others) / (rest - 1) : 0.0;
        sums.square += product;
        sums.relative += product / (3 * (scale * scale + 3 * noise2));
        sums.reference_square += a * b / pairs;
      }
  }
};

/// How far a channel of a texel is off, by each half of what is known of it, and the variances of the mean of both.
struct Difference {
  uint32_t texel = 0;
  double half[2] = {0, 0};
  double scale2 = 0;  // what noise is about proportional to
  double of_references = 0, of_candidate = 0;
  double mean() const { return (half[0] + half[1]) / 2; }
};

Difference differenceOf(const Values& values, uint32_t texel, double dark) {
  const size_t count = values.references.size(), first = count / 2;
  const double all = values.sum(), mean = all / double(count), scale = std::max(mean, 0.0) + dark;
  double part = 0, scatter = 0;
  for (size_t i = 0; i < count; ++i) {
    if (i < first) part += values.reference(i);
    scatter += (values.reference(i) - mean) * (values.reference(i) - mean);
  }
  return {.texel = texel,
          .half = {values.v - part / double(first), values.w - (all - part) / double(count - first)},
          .scale2 = scale * scale,
          .of_references = scatter / double(count * (count - 1)),
          .of_candidate = (values.v - values.w) * (values.v - values.w) / 4};
}

struct Maximum {
  double value = 0;
  Interval interval_95;
};

/// Found with one half, measured with the other: the largest of many noisy values is too large.
class MaximumOf {
 public:
  explicit MaximumOf(std::span<const Difference> differences) {
    std::vector<double> relative;
    for (const Difference& d : differences) relative.push_back(d.of_references / d.scale2);
    common_ = medianOf(std::move(relative)) / kMedianVariance;
    // Chernoff's bound for the normal distribution, half of the chance, shared by all values.
    deviations_ = std::sqrt(2 * std::log(double(differences.size()) * 2 / kOutside));
  }
  /// `paths`: how many times as many as the references had that the common noise is from.
  double variance(const Difference& d, double paths) const {
    return (d.of_references + kPriorNoise * common_ / paths * d.scale2) / (1 + kPriorNoise) + d.of_candidate;
  }
  double most(const Difference& d, double paths) const { return std::abs(d.mean()) + deviations_ * std::sqrt(variance(d, paths)); }

  /// The largest of `looked_at`; `others` are below `most_of_others`.
  Maximum operator()(std::span<const Difference> looked_at, double paths, double most_of_others) const {
    Maximum maximum{.interval_95 = {0, most_of_others}};
    double deviation2 = 0;
    for (const int finds : {0, 1}) {
      const Difference& found = *std::max_element(looked_at.begin(), looked_at.end(),
                                                  [&](const Difference& a, const Difference& b) { return std::abs(a.half[finds]) < std::abs(b.half[finds]); });
      maximum.value += std::copysign(found.half[1 - finds], found.half[0] * found.half[1]) / 2;
      deviation2 += variance(found, paths) / 2;
    }
    for (const Difference& d : looked_at) maximum.interval_95.high = std::max(maximum.interval_95.high, most(d, paths));
    maximum.interval_95.low = std::clamp(maximum.value - kDeviations * std::sqrt(deviation2), 0.0, maximum.interval_95.high);
    maximum.value = std::clamp(maximum.value, maximum.interval_95.low, maximum.interval_95.high);
    return maximum;
  }

 private:
  double common_ = 0, deviations_ = 0;
};

/// The texels where most is possible are looked at again, in the light of `retrace`.
Maximum largest(std::span<const Difference> differences, const std::array<std::span<const Rgb>, 2>& candidate, double dark, const Retrace& retrace) {
  const MaximumOf maximum(differences);
  if (!retrace) return maximum(differences, 1, 0);
  std::vector<std::pair<double, uint32_t>> most;  // per texel, the largest first
  for (const Difference& d : differences) {
    const double value = maximum.most(d, 1);
    if (most.empty() || most.back().second != d.texel) most.push_back({value, d.texel});
    else most.back().first = std::max(most.back().first, value);
  }
  std::stable_sort(most.begin(), most.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<uint32_t> texels;
  for (size_t i = 0; i < std::min(kRetracedTexels, most.size()); ++i) texels.push_back(most[i].second);
  const auto references = retrace(texels);
  std::vector<Difference> again;
  for (size_t i = 0; i < texels.size(); ++i)
    for (int c = 0; c < 3; ++c) again.push_back(differenceOf({references, i, candidate[0][texels[i]][c], candidate[1][texels[i]][c], c}, texels[i], dark));
  return maximum(again, kRetracedPaths, texels.size() < most.size() ? most[texels.size()].first : 0);
}

/// How many of `count` values in order lie outside of the interval for their median, at either end: the chance of fewer than that many below the true median is that of so few heads among as many
/// coins. `count` when no interval is sure enough.
size_t outsideOfInterval(size_t count) {
  double term = std::exp2(-double(count)), chance = 0;
  for (size_t k = 0; k < count; ++k) {
    chance += term;
    if (2 * chance > kOutside) return k == 0 ? count : k - 1;
    term *= double(count - k) / double(k + 1);
  }
  return count;
}

/// From the values' own order; `lows` and `highs` of them may differ from the values where these are not known exactly.
Interval medianInterval(std::vector<double> lows, std::vector<double> highs) {
  const size_t outside = outsideOfInterval(lows.size());
  if (outside >= lows.size()) return {};
  std::sort(lows.begin(), lows.end());
  std::sort(highs.begin(), highs.end());
  return {lows[outside], highs[highs.size() - 1 - outside]};
}

}  // namespace

PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate, std::span<const float> weight, const Retrace& retrace) {
  return compareWithReferences(references, {candidate, candidate}, weight, retrace);
}

PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, const std::array<std::span<const Rgb>, 2>& candidate, std::span<const float> weight,
                                  const Retrace& retrace) {
  const size_t count = references.size(), size = candidate[0].size();
  if (count < 3) throw std::logic_error("compareWithReferences: at least three references are needed");
  for (const auto& reference : references)
    if (reference.size() != size) throw std::logic_error("compareWithReferences: the maps differ in size");
  if (candidate[1].size() != size || (!weight.empty() && weight.size() != size)) throw std::logic_error("compareWithReferences: the maps differ in size");

  std::vector<double> brightness(size, 0.0);  // summed over channels and references
  double all = 0, weights = 0;
  for (size_t t = 0; t < size; ++t) {
    for (const auto& reference : references) brightness[t] += double(reference[t].x) + double(reference[t].y) + double(reference[t].z);
    const double w = weight.empty() ? 1 : double(weight[t]);
    all += w * brightness[t], weights += w;
  }
  const double mean = weights > 0 ? all / (3 * double(count) * weights) : 0, dark = kDark * mean;

  std::vector<Sums> texels;
  std::vector<Difference> differences;
  for (uint32_t t = 0; t < size; ++t) {
    if (!(brightness[t] > 3 * double(count) * kUnlitShare * mean)) continue;
    Sums& sums = texels.emplace_back();
    if (!weight.empty()) sums.weight = weight[t];
    for (int c = 0; c < 3; ++c) {
      const Values values{references, t, candidate[0][t][c], candidate[1][t][c], c};
      values.addTo(sums, dark);
      differences.push_back(differenceOf(values, t, dark));
    }
  }
  PooledError error;
  error.texels = texels.size();
  double lit_weight = 0, reference_square_sum = 0;
  for (const Sums& t : texels) lit_weight += t.weight, reference_square_sum += t.weight * t.reference_square;
  if (texels.empty() || !(reference_square_sum > 0)) {
    error.relrmse = error.texrel = error.bias = error.maximum = std::numeric_limits<double>::infinity();
    return error;
  }
  const Ratio relrmse = ratioOfSums(texels, &Sums::square, &Sums::reference_square), bias = ratioOfSums(texels, &Sums::candidate, &Sums::reference),
              texrel = ratioOfSums(texels, &Sums::relative, &Sums::one);
  const double rms = std::sqrt(reference_square_sum / (3 * lit_weight));
  const Maximum maximum = largest(differences, candidate, dark, retrace);
  error.relrmse = signedRoot(relrmse.value), error.relrmse_95 = rootOf(relrmse.interval_95);
  error.texrel = signedRoot(texrel.value), error.texrel_95 = rootOf(texrel.interval_95);
  error.bias = bias.value - 1, error.bias_95 = {bias.interval_95.low - 1, bias.interval_95.high - 1};
  error.maximum_95 = {maximum.interval_95.low / rms, maximum.interval_95.high / rms};
  error.maximum = std::clamp(std::max(maximum.value / rms, error.relrmse), error.maximum_95.low, error.maximum_95.high);  // no less than the mean
  return error;
}

PooledError medianError(std::span<const PooledError> errors) {
  const auto values = [&](const auto& field) {
    std::vector<double> list;
    for (const PooledError& error : errors) list.push_back(field(error));
    return list;
  };
  PooledError result;
  const auto takeMedian = [&](double PooledError::*field, Interval PooledError::*interval_95) {
    const auto list = values([&](const PooledError& error) { return error.*field; });
    result.*field = medianOf(list);
    // Of few paths the estimates themselves are skewed: most lie below what they estimate, and so does their median. Their own intervals know.
    const Interval between = medianInterval(list, list);
    const Interval own = medianInterval(values([&](const PooledError& error) { return (error.*interval_95).low; }),
                                        values([&](const PooledError& error) { return (error.*interval_95).high; }));
    result.*interval_95 = {std::min(between.low, own.low), std::max(between.high, own.high)};
  };
  for (const PooledError& error : errors) result.texels = std::max(result.texels, error.texels);
  takeMedian(&PooledError::relrmse, &PooledError::relrmse_95);
  takeMedian(&PooledError::texrel, &PooledError::texrel_95);
  takeMedian(&PooledError::bias, &PooledError::bias_95);
  takeMedian(&PooledError::maximum, &PooledError::maximum_95);
  result.maximum_95 = medianInterval(values([](const PooledError& error) { return error.maximum_95.low; }), values([](const PooledError& error) { return error.maximum_95.high; }));
  return result;
}

}  // namespace lightwell::transport
