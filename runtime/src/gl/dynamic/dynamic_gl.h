// A scene for lamps that move, and one lamp: what both keep on the GPU.
#pragma once
#include "lightwell/lightwell_gl_dynamic.h"
#include "runtime/src/dynamic/light_set.h"
#include "runtime/src/gl/context.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/light.h"
#include "runtime/src/radiosity_injector.h"

struct lw_gl_dynamic {
  using Name = lightwell::runtime::gl::Name;
  using Target = lightwell::runtime::gl::Target;
  using Program = lightwell::runtime::gl::Program;

  lightwell::runtime::Host host;
  lw_gl gl;                               // functions and an empty vertex array; its programs are not made
  Program see, flux_sum, flux_reduce, sample, check, place, share, clear, splat, pull, push, gather, show, visibility;
  uint64_t texture_bytes = 0;
  float bounds_min_m[3] = {}, bounds_max_m[3] = {};
  uint32_t triangles = 0, points = 0, values = 0;
  float points_area_m2 = 0, max_value = 0;

  Name corners = 0, triangle = 0;         // RGBA32F, RG32UI lists: see kLampSee
  Name alpha_material = 0, alpha = 0;     // as in lw_gl_radiosity_injector
  Name albedo = 0;                        // RGBA16F, width × height, linear
  Name point = 0;                         // RGBA32F list, two for each
  Name texel_map = 0;                     // R32UI, width × height: which value a texel shows
  Name texel_place = 0, texel_normal = 0; // RGBA32F, as Targets are addressed: see TexelSurface
  Target value, atlas;
  bool owns_atlas = true;
  Name framebuffer = 0;                   // for levels of textures
};

struct lw_gl_lamp {
  using Name = lightwell::runtime::gl::Name;
  using Target = lightwell::runtime::gl::Target;
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lw_gl_dynamic* scene = nullptr;
  lw_gl_lamp_options options{};
  uint64_t texture_bytes = 0, view_bytes = 0;

  // What the lamp sees; made when the number of views is known.
  uint32_t views = 0;
  int32_t width = 0, height = 0, sum_levels = 0;
  Name position = 0, normal = 0, flux = 0, depth = 0, view_framebuffer = 0;
  Name sum = 0;                           // RGBA32F with levels: light in lumen and surface in m² of the pixels, added up

  Target place;                           // lights × 2: position and 0 none, 1 light, 2 direction without surface; normal
  Target light_flux;                      // lights × 1: lumen; m²
  Target aim;                             // lights × 1: see kCheckLights
  Name request = 0;                       // RGBA32F, lights × 1: LightRequest

  uint32_t row = 0, rows = 0, points_each = 0;  // shadow maps in a row, rows of them
  int32_t shadow_levels = 0;
  Name pulled = 0, pushed = 0, shadow_depth = 0, shadow_framebuffer = 0;  // R32F with levels: distances, 0: none

  lightwell::runtime::LightSet set;
  Array<lightwell::runtime::LightRequest> requests;
  Array<float> aims;                      // [lights][4], as read back
  Array<double> corner;                   // [2][view_side + 1]: for spotScale
  Name pack_buffer = 0;
  bool started = false, has_late_aims = false;
  uint32_t type = 0;                      // of the last light
  uint32_t draws = 0;
};

namespace lightwell::runtime::gl {

/// The uniforms u_lamp of kLampViews.
struct LampUniforms {
  float value[7][4];
};

namespace see_uniform {
enum { eye, right, up, forward, lamp };  // the first four as setView has them
}
namespace flux_sum_uniform {
enum { lamp };
}
namespace sample_uniform {
enum { levels, lights, row };
}
namespace check_uniform {
enum { lamp };
}
namespace place_uniform {
enum { lamp, lights, rows };
}
namespace share_uniform {
enum { lamp, level, lights };
}
namespace tiles_uniform {
enum { atlas, level, threshold };
}
namespace splat_uniform {
enum { atlas, points };
}
namespace gather_uniform {
enum { values, numbers };
}
namespace show_uniform {
enum { max };
}
namespace visibility_uniform {
enum { point, normal, numbers };
}

lw_result compileDynamicPrograms(lw_gl_dynamic& scene);

inline constexpr Enum kTextureBaseLevel = 0x813C;

inline void bindTexture(const Api& api, uint32_t unit, Enum target, Name texture) {
  api.ActiveTexture(kTexture0 + unit);
  api.BindTexture(target, texture);
}
inline void useLamp(const Api& api, int32_t location, const LampUniforms& lamp) { api.Uniform4fv(location, 7, lamp.value[0]); }
/// Draws with what is bound into a target that is `width` × `height`; counted.
inline void drawOver(lw_gl_lamp& lamp, int32_t width, int32_t height) {
  const Api& api = lamp.scene->gl.api;
  api.Viewport(0, 0, width, height);
  api.DrawArrays(kTriangles, 0, 3);
  ++lamp.draws;
}
/// A texture with levels from width × height down to 1 × 1, or `levels` of them. 0: too large.
Name createLevels(const Api& api, const TexelFormat& format, int32_t width, int32_t height, int32_t levels, uint64_t& texture_bytes);
/// The levels that shaders see of the texture that is bound to the active unit.
inline void setLevels(const Api& api, int32_t base, int32_t most) {
  api.TexParameteri(kTexture2d, kTextureBaseLevel, base);
  api.TexParameteri(kTexture2d, kTextureMaxLevel, most);
}
/// Makes one level of `texture`, which is bound to the active unit, the only colour that the scene's framebuffer draws into, and `readable` the only one that shaders see of it.
void drawIntoLevel(const lw_gl_dynamic& scene, Name texture, int32_t level, int32_t readable);

/// Shadow maps of the lights that the first `count` requests on the GPU name. Returns the points that were splatted.
uint64_t drawShadowMaps(lw_gl_lamp& lamp, uint32_t count);
void lampNumbers(const lw_gl_lamp& lamp, const lw_gl_gathering& gathering, float numbers[8]);
bool isGathering(const lw_gl_gathering& gathering);

}  // namespace lightwell::runtime::gl
