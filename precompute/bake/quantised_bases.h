// Local bases in the element types of the container: as small as the light maps that come out allow.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/transport/prm/prm.h"

namespace lightwell::bake {

/// Integers and the scale of each row or column; of the integers one is filled. Layouts: docs/format.md, section prm.
struct QuantisedBases {
  std::vector<float> coefficient_scale;
  std::vector<int8_t> coefficient_i8;
  std::vector<int16_t> coefficient_i16;
};

/// Eight bits where that changes light maps little, else sixteen: measured by evaluating the map under a few unshadowed point lights above
/// its entry points, as the rms of the change over the rms of the light. Eight bits may change it by kMostCoefficientChange. Sixteen bits are not
/// all used: the step is that which changes the light maps by about kWideCoefficientChange, since finer steps are noise that does not compress.
QuantisedBases quantiseBases(const transport::PrmResult& prm);
inline constexpr double kMostCoefficientChange = 0.003, kWideCoefficientChange = 0.001;

}  // namespace lightwell::bake
