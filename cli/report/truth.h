// The path-traced maps that everything is compared with, and how sure they are.
#pragma once
#include <vector>

#include "cli/report/result.h"
#include "precompute/core/image.h"

namespace lightwell::report {

struct Truth {
  ImageRgba first, second;  // independent
};

/// Noise and resolution of the references, into `reference`. The product of their errors (A − r)(B − r) has mean 0 and, in each texel, the standard deviation σ²; what a mean over all texels cannot
/// tell from 0 is 1.96 times that of the mean.
void describeNoise(const Truth& truth, Reference& reference);

/// The figures that `lightwell compare FIRST MAP --second-reference SECOND` prints, by the same code, with the interval of relrmse.
void compareWith(const Truth& truth, const ImageRgba& map, Evaluated& evaluated);

/// The covered texel with the largest |c − r|, r the mean of the references: its column and row; (−1, −1) when nothing is covered.
std::pair<int, int> worstTexel(const Truth& truth, const ImageRgba& map);

}  // namespace lightwell::report
