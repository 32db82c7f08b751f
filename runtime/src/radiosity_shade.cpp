// From patches to the texels of the atlas.
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/radiosity.h"

using namespace lightwell::runtime;

lw_result lw_radiosity_shade(lw_radiosity_state* state, const lw_radiosity_shading* given, float* atlas_rgba) {
  if (!state || !atlas_rgba) return LW_INVALID_ARGUMENT;
  const lw_radiosity_shading shading = given ? *given : lw_radiosity_shading LW_RADIOSITY_SHADING_INIT;
  if (shading.size < sizeof shading || shading.fill > 1) return state->host.fail(LW_INVALID_ARGUMENT, "lw_radiosity_shading: a value is out of range");
  const lw_radiosity& r = *state->radiosity;
  Array<float> patch_rgb;
  if (!patch_rgb.allocate(state->host, size_t(r.patches()) * 3)) return state->host.fail(LW_OUT_OF_MEMORY, "no memory for %u patches", r.patches());
  if (const lw_result result = lw_radiosity_get_irradiance(state, shading.light, patch_rgb.data())) return result;

  std::memset(atlas_rgba, 0, r.source.size() * 4 * sizeof(float));
  for (size_t i = 0; i < r.header.texels; ++i) {
    float sum[3] = {};
    for (size_t k = i * 4; k < i * 4 + 4; ++k) {
      if (r.texel_patch[k] == kNone) continue;
      for (int c = 0; c < 3; ++c) sum[c] += float(r.texel_weight[k]) * patch_rgb[size_t(r.texel_patch[k]) * 3 + c];
    }
    const float scale = (shading.fill ? 1.0f : float(r.texel_exposed[i]) / 255.0f) / 255.0f;
    float* texel = atlas_rgba + size_t(r.texel[i]) * 4;
    for (int c = 0; c < 3; ++c) texel[c] = sum[c] * scale;
    texel[3] = 1.0f;
  }
  if (shading.fill) fillFromSources(r.source.data(), r.source.size(), atlas_rgba);
  return LW_OK;
}
