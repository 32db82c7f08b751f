// Is the TEXCOORD_1 of each object fit for a light map: there, finite, inside the atlas, spread out, and laid over nothing else?
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::atlas {

enum class UvProblem : uint8_t { none, missing, not_finite, out_of_range, collapsed, overlaps_itself, overlaps_another };

/// The reason in words, for a warning about TEXCOORD_1.
const char* describe(UvProblem problem);

struct UvCheck {
  std::vector<UvProblem> problem;   // per object
  std::vector<float> occupied;      // width * height: share of each texel that sound objects cover
  double sound_uv_area_texels = 0;  // of the sound objects
  double sound_area = 0;            // of the sound objects, internal units²
};

/// Checks every object. Overlap is judged at the resolution of the atlas: triangles may share a texel at their borders, but where
/// more than a whole texel's area lies on one texel, something lies over something else. Of two objects over one another the first
/// one counts as sound.
UvCheck checkLightmapUv(const scene::Scene& scene, int width, int height);

}  // namespace lightwell::atlas
