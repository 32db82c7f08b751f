// The two errors of the outside contract against several noisy references, free of their noise.
#pragma once
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

struct PooledError {
  size_t texels = 0;   // compared
  double relrmse = 0;  // rms(c − r) / rms(r)
  double texrel = 0;   // sqrt(mean(((c − r) / (r + 0.1 mean r))²))
  double bias = 0;     // mean c / mean r − 1
};

/// Errors of `candidate` against independent noisy `references` of the same texels, three at least. Products over pairs of references replace
/// squares, as in compareMaps; a pair's products are weighted (texrel) by the mean of the other references, whose noise is not theirs: a
/// weight from the pair itself would be large just where both happen to be dark, and raise the error.
/// The sums estimate squares and may fall below zero; the roots keep their sign. Texels lit above 1e-4 of the mean are compared; without
/// one the errors are infinite. Throws std::logic_error for fewer references or different sizes.
PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate);

}  // namespace lightwell::transport
