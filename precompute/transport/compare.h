// The two errors of the outside contract, over texels covered and lit in both maps.
#pragma once
#include "precompute/core/image.h"

namespace lightwell::transport {

struct MapError {
  size_t texels = 0;      // compared
  size_t missing = 0;     // covered in the reference only
  size_t nonfinite = 0, negative = 0;  // texels of the candidate
  double relrmse = 0;     // rms(c − r) / rms(r)
  double relrmse_low = 0, relrmse_high = 0;  // 95 % interval from the texels' scatter: mean square ± 1.96 standard errors, roots with their sign
  double texrel = 0;      // sqrt(mean(((c − r) / (r + 0.1 mean r))²))
  double bias = 0;        // mean c / mean r − 1
  double p99 = 0;         // 99th percentile of |c − r| / rms(r)
  double max = 0;
};

/// `reference_b`, when given, is a second independent noisy reference: mean((c − A)(c − B)) replaces the square, so that the references' own
/// noise drops out. Lit means above 1e-4 of the mean; without a texel to compare the errors are infinite.
/// Throws UsageError when the sizes differ.
MapError compareMaps(const ImageRgba& reference, const ImageRgba& candidate, const ImageRgba* reference_b = nullptr);

}  // namespace lightwell::transport
