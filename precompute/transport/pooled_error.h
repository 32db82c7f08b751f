// The errors of the outside contract against several noisy references, free of their noise, and how sure they are.
#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// Holds the true value in about 95 of 100 cases.
struct Interval {
  double low = 0, high = 0;
};

struct PooledError {
  size_t texels = 0;   // compared
  double relrmse = 0;  // rms(c − r) / rms(r)
  double texrel = 0;   // sqrt(mean(((c − r) / (r + 0.1 mean r))²))
  double bias = 0;     // mean c / mean r − 1
  double maximum = 0;  // the largest |c − r| of a texel's channel / rms(r), among the texels given
  Interval relrmse_95, texrel_95, bias_95, maximum_95;
};

/// New references of texels, by their numbers in the maps: as many as there were, independent of them, of kRetracedPaths times as many paths.
using Retrace = std::function<std::vector<std::vector<Rgb>>(std::span<const uint32_t> texels)>;
inline constexpr uint32_t kRetracedPaths = 16;

/// Errors of `candidate` against independent noisy `references` of the same texels, three at least. Products over pairs of references replace
/// squares, as in compareMaps; a pair's products are weighted (texrel) by the mean of the other references, whose noise is not theirs: a
/// weight from the pair itself would be large just where both happen to be dark, and raise the error.
/// The sums estimate squares and may fall below zero; the roots keep their sign. Texels lit above 1e-4 of the mean are compared; without
/// one the errors are infinite. `weight`: what each texel of a sample stands for; empty: 1.
///
/// Intervals of the means are those of ratios of two sums over the texels (Cochran, "Sampling Techniques", 1977, chapter 6), with the skewness taken out that few large errors among many small
/// ones make (Hall, "On the Removal of Skewness by Transformation", 1992). They hold for all texels that the sample was drawn from; where all were measured, they are wider than they must be. The
/// maximum is that of the texels given: it is looked up with one half of the references and measured with the other, and its interval says what noise leaves open, at each of the texels at once.
/// With `retrace` that is done for those texels again where most is left open.
/// Throws std::logic_error for fewer references or different sizes.
PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate, std::span<const float> weight = {}, const Retrace& retrace = {});

/// Of a candidate that is known with noise only: two independent estimates of it, whose noise drops out of the means in the same way.
PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, const std::array<std::span<const Rgb>, 2>& candidate, std::span<const float> weight = {},
                                  const Retrace& retrace = {});

/// The medians of errors under independent conditions, lights drawn at random say. Intervals for the median over all such conditions come from the order of the values alone; of fewer than six they
/// are not known (high = 0). That of the maximum is made of the maxima's own intervals. `errors` is not empty.
PooledError medianError(std::span<const PooledError> errors);

}  // namespace lightwell::transport
