// One reflection of lamps that were not baked, as lightwell_dynamic finds it on OpenGL.
#pragma once
#include <vector>

#include "cli/runtime_handles.h"

namespace lightwell::cli {

struct DynamicEvaluation {
  const RuntimeContainer& container;
  const scene::Scene& scene;     // its lights shine
  bool incremental = false;
  uint32_t lights = 256;         // virtual lights of each lamp
  uint32_t shadow_side = 32;     // texels along a virtual light's shadow map; 0: none
};

/// Irradiance of the atlas, [height][width][4].
std::vector<float> evaluateDynamicOnGl(const DynamicEvaluation& evaluation);

}  // namespace lightwell::cli
