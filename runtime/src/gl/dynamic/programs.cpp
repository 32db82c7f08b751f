// The programs of lamps that move.
#include "runtime/src/gl/dynamic/dynamic_gl.h"
#include "runtime/src/gl/dynamic/shaders.h"

namespace lightwell::runtime::gl {

lw_result compileDynamicPrograms(lw_gl_dynamic& s) {
  using namespace glsl;
  const lw_gl& gl = s.gl;
  lw_result result = compileProgram(gl, "lamp's view", {kAddress, kAlphaTest, kLampSee}, {"u_corner", "u_triangle", "u_albedo", "u_alpha_material", "u_alpha"},
                                    {"u_eye", "u_right", "u_up", "u_forward", "u_lamp"}, s.see, {kAddress, kLampViewVertex});
  if (!result) result = compileProgram(gl, "flux", {kLampViews, kFluxSum}, {"u_position", "u_normal", "u_flux"}, {"u_lamp"}, s.flux_sum);
  if (!result) result = compileProgram(gl, "flux level", {kFluxReduce}, {"u_sum"}, {}, s.flux_reduce);
  if (!result) result = compileProgram(gl, "light sampling", {kSampleLights}, {"u_position", "u_normal", "u_sum"}, {"u_levels", "u_lights", "u_row"}, s.sample);
  if (!result) result = compileProgram(gl, "light check", {kLampViews, kCheckLights}, {"u_place", "u_position"}, {"u_lamp"}, s.check);
  if (!result)
    result = compileProgram(gl, "light placing", {kLampViews, kPlaceLights}, {"u_request", "u_position", "u_normal"}, {"u_lamp", "u_lights", "u_rows"}, s.place, {kPlaceVertex});
  if (!result)
    result = compileProgram(gl, "light share", {kShareFlux}, {"u_sum", "u_aim"}, {"u_lamp", "u_level", "u_lights"}, s.share, {kLampViews, kShareVertex});
  if (!result) result = compileProgram(gl, "shadow map clearing", {kTilesClear}, {"u_request"}, {"u_atlas"}, s.clear, {kTilesVertex});
  if (!result)
    result = compileProgram(gl, "shadow map", {kSplat}, {"u_request", "u_place", "u_point"}, {"u_atlas", "u_points"}, s.splat, {kAddress, kOctahedron, kSplatVertex});
  if (!result) result = compileProgram(gl, "pull", {kTilesPull}, {"u_request", "u_fine"}, {"u_atlas", "u_level", "u_threshold"}, s.pull, {kTilesVertex});
  if (!result) result = compileProgram(gl, "push", {kTilesPush}, {"u_request", "u_fine", "u_coarse"}, {"u_atlas", "u_level", "u_threshold"}, s.push, {kTilesVertex});
  if (!result)
    result = compileProgram(gl, "gathering", {kLampLookup, kAddress, kOctahedron, kGatherTexels}, {"lw_lamp_place", "lw_lamp_flux", "lw_lamp_shadow", "u_place", "u_normal"},
                            {"u_values", "lw_lamp_numbers"}, s.gather);
  if (!result) result = compileProgram(gl, "texel", {kAddress, kShowTexels}, {"u_texel_map", "u_value"}, {"u_max"}, s.show);
  if (!result)
    result = compileProgram(gl, "visibility", {kLampLookup, kLampVisibility}, {"lw_lamp_place", "lw_lamp_flux", "lw_lamp_shadow"},
                            {"u_point", "u_point_normal", "lw_lamp_numbers"}, s.visibility);
  return result;
}

}  // namespace lightwell::runtime::gl
