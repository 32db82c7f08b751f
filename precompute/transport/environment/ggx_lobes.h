// The GGX lobe of glTF's rough materials as a few Phong lobes, so that one evaluator and one set of cell averages serve both.
#pragma once
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// weight × (shininess + 1) / 2π × max(0, cos ψ)^shininess: a lobe whose integral over directions is its weight.
struct PhongLobe {
  float weight, shininess;
};

/// At most four lobes, weights positive and adding to 1, for a perceptual roughness in [0, 1] (alpha = roughness²; below 0.075 as 0.075).
/// Fits the filter of prefiltered environment maps, view = normal = mirror direction (Karis, "Real Shading in Unreal Engine 4", 2013,
/// section "Pre-filtered environment map"), k(ψ) ∝ cos ψ · D(ψ/2), to 4 % of its integral at roughness 0.15 and 1 % at 0.45 and above.
/// Multiply the result with the split sum's reflectance.
std::vector<PhongLobe> ggxLobes(float roughness);

}  // namespace lightwell::transport
