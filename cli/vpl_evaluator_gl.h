// What the virtual lights of a container make of the atlas, on OpenGL without a window: the light map that a game draws while it loads.
#pragma once
#include <functional>
#include <vector>

#include "cli/runtime_handles.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::cli {

struct VplGlEvaluation {
  const RuntimeContainer& container;
  transport::Component component;    // direct: what emitters give; indirect: what has been reflected
  uint32_t shadow_map_side;          // 0: without shadows
  float pieces;                      // as in lw_gl_vpl_options
  std::function<void(double fraction)> progress;
};
struct VplGlResult {
  std::vector<float> atlas_rgba;     // [height * width][4]: each texel's own irradiance
  uint32_t lights;                   // drawn, pieces included
  double setup_ms, draw_ms;          // until the first light; all lights
};

/// Throws UsageError when this machine gives no context.
VplGlResult evaluateVplOnGl(const VplGlEvaluation& evaluation);

}  // namespace lightwell::cli
