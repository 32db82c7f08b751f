// Light of lamps on patches, as in "Realtime global illumination (part 1)" (Rasmus' blog, 2016), section Light injection: views from the lamp, in patch numbers, whose
// pixels are added to the patches as points.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/gl/lamp_view.h"
#include "runtime/src/gl/radiosity_gl.h"
#include "runtime/src/radiosity_injector.h"

namespace lightwell::runtime::gl {
namespace {

/// Half of the diagonal of the bounds.
double extentOf(const lw_gl_radiosity_injector& injector) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += std::pow(0.5 * (double(injector.bounds_max_m[k]) - double(injector.bounds_min_m[k])), 2);
  return std::max(std::sqrt(square), 1e-12);
}

/// What the pixels of a view see.
void see(const lw_gl_radiosity_injector& injector, const PackedLight& light, const View& view) {
  const lw_gl& context = *injector.target->context;
  const Api& api = context.api;
  constexpr double kNearest = 1e-5;  // of the scene: nothing closer to the lamp is seen
  constexpr uint32_t kNothing[4] = {0xffffffffu, 0, 0, 0};
  constexpr float kFarthest = 0;
  const Program& program = context.inject_see;
  api.UseProgram(program.name);
  const double extent_m = extentOf(injector);
  setView(api, program.uniform, view, kNearest * extent_m, extent_m);
  api.Uniform1f(program.uniform[inject_see_uniform::range], light.range_m);
  bind(api, 0, kTexture2dArray, injector.corners);
  bind(api, 1, kTexture2dArray, injector.triangle);
  bind(api, 2, kTexture2d, injector.texel_patches);
  bind(api, 3, kTexture2dArray, injector.patch);
  bind(api, 4, kTexture2dArray, injector.alpha_material);
  bind(api, 5, kTexture2dArray, injector.alpha);
  bind(api, 6, kTexture2dArray, injector.leaf);
  api.BindFramebuffer(kDrawFramebuffer, injector.seen.framebuffer);
  api.Viewport(0, 0, injector.seen.width, injector.seen.height);
  api.Enable(kDepthTest);
  api.ClearBufferuiv(kColor, 0, kNothing);
  api.ClearBufferfv(kDepth, 0, &kFarthest);
  api.DrawArrays(kTriangles, 0, int32_t(injector.triangles * 3));
}

/// Adds the light of the pixels. scale: of their solid angles; orthographic: their area.
void add(const lw_gl_radiosity_injector& injector, const PackedLight& light, const View& view, double tangent, double scale, const SumGuard& sum) {
  const lw_gl& context = *injector.target->context;
  const Api& api = context.api;
  const Target& target = injector.target->direct;
  const double direction[3] = {double(light.direction[0]), double(light.direction[1]), double(light.direction[2])};
  const float values[4] = {light.intensity_rgb[0], light.intensity_rgb[1], light.intensity_rgb[2], float(scale)};
  const float cone[4] = {float(dot(direction, view.right)), float(dot(direction, view.up)), float(dot(direction, view.forward)),
                         view.perspective ? float(tangent) : 0};
  const float spot[4] = {light.spot_scale, light.spot_offset, float(target.width), float(target.height)};
  const Program& program = context.inject_add;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[inject_add_uniform::side], int32_t(injector.side));
  api.Uniform4fv(program.uniform[inject_add_uniform::light], 1, values);
  api.Uniform4fv(program.uniform[inject_add_uniform::cone], 1, cone);
  api.Uniform4fv(program.uniform[inject_add_uniform::spot], 1, spot);
  bind(api, 0, kTexture2d, injector.seen.texture);
  bind(api, 1, kTexture2dArray, injector.patch);
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  api.Viewport(0, 0, target.width, target.height);
  api.Disable(kDepthTest);
  sum.blend(true);
  api.DrawArrays(kPoints, 0, int32_t(injector.side * injector.side));
  sum.blend(false);
}

/// What the game has changed of portals since the last call.
void uploadPortals(lw_gl_radiosity_injector& injector) {
  const lw_gl_radiosity& target = *injector.target;
  if (injector.portals_seen == target.portals_uploaded) return;
  injector.portals_seen = target.portals_uploaded;
  if (target.gate_open.empty()) return;
  std::memcpy(injector.leaf_values.data() + (injector.leaf_values.size() - target.gate_open.size()), target.gate_open.data(), target.gate_open.bytes());
  const Api& api = target.context->api;
  api.ActiveTexture(kTexture0);
  uploadList(api, injector.leaf, kTexelR32f, injector.leaf_values.size(), injector.leaf_values.data());
}

void inject(lw_gl_radiosity_injector& injector, const PackedLight& light, const SumGuard& sum) {
  const LampViews views = lampViews(light, injector.bounds_min_m, injector.bounds_max_m);
  const View& first = views.view[0];
  const double scale = first.perspective ? spotScale(light, views, injector.side, injector.corner.data())
                                         : std::sqrt(dot(first.right, first.right) * dot(first.up, first.up)) * 4 / (double(injector.side) * injector.side);
  if (!(scale > 0)) return;
  for (int v = 0; v < views.count; ++v) {
    see(injector, light, views.view[v]);
    add(injector, light, views.view[v], views.tangent, scale, sum);
  }
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_radiosity_inject(lw_gl_radiosity_injector* injector, const lw_light* lights, uint32_t light_count) {
  if (!injector || (light_count && !lights)) return LW_INVALID_ARGUMENT;
  PackedLight light;
  for (uint32_t l = 0; l < light_count; ++l)
    if (const char* reason = packLight(lights[l], light)) return injector->host.fail(LW_INVALID_ARGUMENT, "light %u: %s", l, reason);
  const lw_gl& context = *injector->target->context;
  const gl::Api& api = context.api;
  const gl::StateGuard guard(api);
  const gl::DepthStateGuard depth_guard(api);
  const gl::SumGuard sum(api);
  api.DepthFunc(gl::kGreater);
  api.DepthMask(1);
  api.Disable(gl::kStencilTest);
  api.Disable(gl::kPolygonOffsetFill);
  gl::clearTarget(api, injector->target->direct);
  gl::uploadPortals(*injector);
  api.BindVertexArray(context.vertex_array);
  for (uint32_t l = 0; l < light_count; ++l) {
    packLight(lights[l], light);
    gl::inject(*injector, light, sum);
  }
  return LW_OK;
}
