// The atlas of local bases where shaders would run on the CPU anyway: made there by vectors of what has changed, and uploaded.
#include <cstring>

#include "runtime/src/gl/prm_gl.h"
#include "runtime/src/prm_state.h"

namespace lightwell::runtime::gl {

bool isSoftware(const Api& api) {
  const auto* renderer = reinterpret_cast<const char*>(api.GetString(kRenderer));
  if (!renderer) return false;
  for (const char* name : {"llvmpipe", "softpipe", "SwiftShader", "Software", "Basic Render"})
    if (std::strstr(renderer, name)) return true;
  return false;
}

lw_result prepareOnCpu(lw_gl_prm& prm) {
  if (const lw_result result = lw_prm_state_create(prm.transport, &prm.state)) return result;
  const size_t values = size_t(prm.width) * prm.height * 4;
  if (prm.max_value < 1e5f ? !prm.atlas_half.allocate(prm.host, values) : !prm.atlas_rgba.allocate(prm.host, values))
    return prm.host.fail(LW_OUT_OF_MEMORY, "no memory for an atlas of %u x %u texels", prm.width, prm.height);
  return LW_OK;
}

lw_result evaluateOnCpu(lw_gl_prm& prm, const lw_prm_options& options) {
  const bool halfs = !prm.atlas_half.empty();
  const float* cluster_rgb = prm.cluster_rgb.data();
  lw_prm_changes changes;
  if (const lw_result result = halfs ? updateHalfs(*prm.state, cluster_rgb, options, prm.atlas_half.data(), changes)
                                     : lw_prm_state_update(prm.state, cluster_rgb, &options, prm.atlas_rgba.data(), &changes))
    return result;
  if (!changes.rows) return LW_OK;
  const size_t first = size_t(changes.first_row) * prm.width * 4;
  const TexelFormat& format = halfs ? kTexelRgba16f : kTexelRgba32f;
  bindUnit(prm.context->api, 0, kTexture2d, prm.atlas.texture);
  prm.context->api.TexSubImage2D(kTexture2d, 0, 0, int32_t(changes.first_row), int32_t(prm.width), int32_t(changes.rows), format.format, format.type,
                                 halfs ? static_cast<const void*>(&prm.atlas_half[first]) : &prm.atlas_rgba[first]);
  return LW_OK;
}

}  // namespace lightwell::runtime::gl
