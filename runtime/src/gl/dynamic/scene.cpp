// Uploading what lamps that move shine on, and the irradiance of its texels.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/geometry.h"
#include "runtime/src/gl/dynamic/dynamic_gl.h"
#include "runtime/src/gl/dynamic/shaders.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/texel_surface.h"

namespace lightwell::runtime::gl {
namespace {

/// Makes the textures one by one; the first failure stays in `result`.
class Uploader : ListUploader {
 public:
  Uploader(lw_gl_dynamic& out, const lw_container& container) : ListUploader(out.gl.api, out.host, out.texture_bytes), out_(out), container_(container) {}

  lw_result upload(const lw_gl_dynamic_options& options) {
    api_.clearErrors();
    lw_scene_info scene;
    result_ = lw_get_scene_info(&container_, &scene);
    if (!result_) std::memcpy(out_.bounds_min_m, scene.bounds_min_m, sizeof out_.bounds_min_m), std::memcpy(out_.bounds_max_m, scene.bounds_max_m, sizeof out_.bounds_max_m);
    uploadTriangles();
    uploadAlbedo();
    uploadPoints();
    uploadTexels(options.fill != 0);
    makeAtlas(options);
    if (!result_) api_.GenFramebuffers(1, &out_.framebuffer);
    if (!result_)
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading a scene: GL error 0x%04x", error);
    return result_;
  }

 private:
  void uploadTriangles() {
    Array<float> position, lightmap_uv;
    Array<uint32_t> index;
    Array<uint8_t> flags;
    AlphaSurfaces alpha;
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_POSITION, position);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_LIGHTMAP_UV, lightmap_uv);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_INDEX, index);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_TRIANGLE_FLAGS, flags);
    if (!result_) result_ = loadAlpha(&container_, flags, alpha);
    if (result_) return;
    out_.triangles = uint32_t(flags.size());
    Array<float> corner;
    Array<uint32_t> triangle;
    if (!allocate(corner, index.size() * 8) || !allocate(triangle, uint64_t(out_.triangles) * 2)) return;
    for (size_t c = 0; c < index.size(); ++c) {
      const size_t v = index[c];
      float* values = &corner[c * 8];
      std::memcpy(values, &position[v * 3], 3 * sizeof(float));
      std::memcpy(values + 3, &lightmap_uv[v * 2], 2 * sizeof(float));
      for (size_t k = 0; k < 2; ++k) values[5 + k] = alpha.uv.empty() ? 0 : alpha.uv[v * 2 + k];
      values[7] = 0;
    }
    for (size_t t = 0; t < out_.triangles; ++t) {
      const uint32_t material = alpha.triangle_material.empty() ? kNone : alpha.triangle_material[t];
      triangle[t * 2] = flags[t] & LW_TRIANGLE_DOUBLE_SIDED ? 1 : 0;
      triangle[t * 2 + 1] = material < alpha.material.size() ? material : kNone;
    }
    list(out_.corners, kTexelRgba32f, index.size() * 2, corner.data());
    list(out_.triangle, kTexelRg32ui, out_.triangles, triangle.data());
    uploadAlpha(alpha);
  }

  void uploadAlpha(const AlphaSurfaces& alpha) {
    Array<uint32_t> material;
    if (!allocate(material, alpha.material.size() * 8)) return;
    for (size_t m = 0; m < alpha.material.size(); ++m) {
      const lw_alpha_material& surface = alpha.material[m];
      const bool textured = surface.texture >= 0;
      const uint32_t values[8] = {uint32_t(alpha.first_alpha[m]), textured ? surface.texture_width : 0, textured ? surface.texture_height : 0,
                                  (surface.wrap_u & 3) | surface.wrap_v << 2, std::bit_cast<uint32_t>(surface.factor),
                                  std::bit_cast<uint32_t>(surface.mode == LW_ALPHA_MASK ? surface.cutoff : 0.5f), 0, 0};
      std::memcpy(&material[m * 8], values, sizeof values);
    }
    list(out_.alpha_material, kTexelRgba32ui, alpha.material.size() * 2, material.data());
    list(out_.alpha, kTexelR8, alpha.alpha.size(), alpha.alpha.data());
  }

  void uploadAlbedo() {
    Array<uint8_t> srgb;
    if (!result_) result_ = lw_get_atlas_info(&container_, &atlas_);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_ATLAS_ALBEDO, srgb);
    Array<float> linear;
    const size_t texels = size_t(atlas_.width) * atlas_.height;
    if (!allocate(linear, texels * 4)) return;
    for (size_t i = 0; i < texels; ++i)
      for (size_t k = 0; k < 4; ++k) linear[i * 4 + k] = k < 3 ? format::decodeSrgb(srgb[i * 3 + k]) : 1.0f;
    TexelFormat format = kTexelRgba16f;
    format.type = kFloat;
    out_.albedo = createPicture(api_, format, int32_t(atlas_.width), int32_t(atlas_.height), kNearest, linear.data(), out_.texture_bytes);
  }

  void uploadPoints() {
    if (result_ || !lw_has_section(&container_, "points")) return;
    lw_points* points = nullptr;
    if ((result_ = lw_points_load(&container_, &points))) return;
    lw_points_info info;
    lw_points_get_info(points, &info);
    Array<float> values;
    if (allocate(values, uint64_t(info.points) * 8)) {
      for (size_t i = 0; i < info.points; ++i) {
        std::memcpy(&values[i * 8], info.position_m + i * 3, 3 * sizeof(float));
        std::memcpy(&values[i * 8 + 4], info.normal + i * 3, 3 * sizeof(float));
        values[i * 8 + 3] = values[i * 8 + 7] = 0;
      }
      list(out_.point, kTexelRgba32f, uint64_t(info.points) * 2, values.data());
      out_.points = info.points;
      out_.points_area_m2 = info.area_m2;
    }
    lw_points_release(points);
  }

  /// A texture that is addressed as a Target of `count` elements.
  Name picture(const TexelFormat& format, uint64_t count, const Array<float>& values) {
    const int32_t width = int32_t(std::min<uint64_t>(std::max<uint64_t>(count, 1), glsl::kRow)), height = int32_t((std::max<uint64_t>(count, 1) + glsl::kRow - 1) / glsl::kRow);
    Array<float> padded;
    if (!allocate(padded, uint64_t(width) * uint64_t(height) * 4)) return 0;
    std::fill(padded.begin(), padded.end(), 0.0f);
    std::memcpy(padded.data(), values.data(), std::min(values.bytes(), padded.bytes()));
    return createPicture(api_, format, width, height, kNearest, padded.data(), out_.texture_bytes);
  }

  void uploadTexels(bool fill) {
    TexelSurface surface;
    if (!result_) result_ = findTexelSurface(container_, fill, surface);
    if (result_) return;
    out_.values = surface.values();
    if (out_.values > kMaxTargetElements) {
      result_ = out_.host.fail(LW_LIMIT_EXCEEDED, "%u texels with a value are more than a texture of 2048 x 2048 holds", out_.values);
      return;
    }
    out_.texel_map = createPicture(api_, kTexelR32ui, int32_t(surface.width), int32_t(surface.height), kNearest, surface.value_of_texel.data(), out_.texture_bytes);
    out_.texel_place = picture(kTexelRgba32f, out_.values, surface.place);
    out_.texel_normal = picture(kTexelRgba32f, out_.values, surface.normal);
    if (!result_) result_ = createTarget(api_, out_.host, kTexelRgba32f, out_.values, out_.value, out_.texture_bytes);
  }

  void makeAtlas(const lw_gl_dynamic_options& options) {
    if (result_) return;
    const bool full = options.atlas_format == LW_GL_ATLAS_RGBA32F;
    out_.max_value = full ? 1e30f : 65504.0f;
    out_.atlas.width = int32_t(atlas_.width), out_.atlas.height = int32_t(atlas_.height);
    out_.owns_atlas = options.atlas_texture == 0;
    out_.atlas.texture = options.atlas_texture ? options.atlas_texture
                                               : createPicture(api_, full ? kTexelRgba32f : kTexelRgba16f, out_.atlas.width, out_.atlas.height, kLinear, nullptr, out_.texture_bytes);
    result_ = attachTarget(api_, out_.host, out_.atlas);
    if (!result_ && out_.owns_atlas) clearTarget(api_, out_.atlas);
  }

  lw_gl_dynamic& out_;
  const lw_container& container_;
  lw_atlas_info atlas_{};
};

}  // namespace

bool isGathering(const lw_gl_gathering& g) { return g.size >= sizeof g && g.softness >= 0 && g.softness <= 4 && g.most_form >= 0 && g.most_form <= 1e30f; }

}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_dynamic_create(const lw_gl_config* config, const lw_container* container, const lw_gl_dynamic_options* given, lw_gl_dynamic** out) {
  if (!config || config->size < sizeof *config || !config->loader || !config->allocate != !config->release || !container || !out) return LW_INVALID_ARGUMENT;
  const Host host({config->allocate, config->release, config->allocator_user}, config->message, config->message_user);
  const lw_gl_dynamic_options options = given ? *given : lw_gl_dynamic_options LW_GL_DYNAMIC_OPTIONS_INIT;
  if (options.size < sizeof options || options.atlas_format > LW_GL_ATLAS_RGBA32F || options.fill > 1)
    return host.fail(LW_INVALID_ARGUMENT, "lw_gl_dynamic_options: a value is out of range");
  lw_gl_dynamic* scene = createHandle<lw_gl_dynamic>(host);
  if (!scene) return host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the scene");
  scene->gl.host = host;
  lw_result result = scene->gl.api.load(*config, host);
  if (!result && !scene->gl.api.blends_floats) result = host.fail(LW_GL_UNSUPPORTED, "lights of lamps add up 32-bit floats; the context has no EXT_float_blend");
  if (result) {
    destroyHandle(scene);
    return result;
  }
  const gl::Api& api = scene->gl.api;
  {
    const gl::StateGuard guard(api);
    api.GenVertexArrays(1, &scene->gl.vertex_array);
    result = gl::compileDynamicPrograms(*scene);
    if (!result) result = gl::Uploader(*scene, *container).upload(options);
    api.clearErrors();
  }
  if (result) {
    lw_gl_dynamic_destroy(scene);
    return result;
  }
  *out = scene;
  return LW_OK;
}

void lw_gl_dynamic_destroy(lw_gl_dynamic* s) {
  if (!s) return;
  const gl::Api& api = s->gl.api;
  for (const gl::Program* program : {&s->see, &s->flux_sum, &s->flux_reduce, &s->sample, &s->check, &s->place, &s->share, &s->clear, &s->splat, &s->pull, &s->push, &s->gather, &s->show, &s->visibility})
    if (program->name) api.DeleteProgram(program->name);
  for (const gl::Name name : {s->corners, s->triangle, s->alpha_material, s->alpha, s->albedo, s->point, s->texel_map, s->texel_place, s->texel_normal})
    if (name) api.DeleteTextures(1, &name);
  if (!s->owns_atlas) s->atlas.texture = 0;
  gl::destroyTarget(api, s->value);
  gl::destroyTarget(api, s->atlas);
  if (s->framebuffer) api.DeleteFramebuffers(1, &s->framebuffer);
  if (s->gl.vertex_array) api.DeleteVertexArrays(1, &s->gl.vertex_array);
  destroyHandle(s);
}

uint32_t lw_gl_dynamic_atlas_texture(const lw_gl_dynamic* scene) { return scene ? scene->atlas.texture : 0; }
uint64_t lw_gl_dynamic_texture_bytes(const lw_gl_dynamic* scene) { return scene ? scene->texture_bytes : 0; }

lw_result lw_gl_dynamic_gather(lw_gl_dynamic* scene, lw_gl_lamp* const* lamps, uint32_t count, const lw_gl_gathering* given) {
  if (!scene || (count && !lamps)) return LW_INVALID_ARGUMENT;
  const lw_gl_gathering gathering = given ? *given : lw_gl_gathering LW_GL_GATHERING_INIT;
  if (!gl::isGathering(gathering)) return scene->host.fail(LW_INVALID_ARGUMENT, "lw_gl_gathering: a value is out of range");
  for (uint32_t l = 0; l < count; ++l)
    if (!lamps[l] || lamps[l]->scene != scene) return scene->host.fail(LW_INVALID_ARGUMENT, "lamp %u is not of this scene", l);
  const gl::Api& api = scene->gl.api;
  const gl::StateGuard guard(api);
  const gl::DepthStateGuard depth(api);
  const gl::SumGuard sum(api);
  api.Disable(gl::kDepthTest);
  api.Disable(gl::kStencilTest);
  api.BindVertexArray(scene->gl.vertex_array);
  gl::clearTarget(api, scene->value);
  api.Viewport(0, 0, scene->value.width, scene->value.height);
  api.UseProgram(scene->gather.name);
  api.Uniform1i(scene->gather.uniform[gl::gather_uniform::values], int32_t(scene->values));
  gl::bindTexture(api, 3, gl::kTexture2d, scene->texel_place);
  gl::bindTexture(api, 4, gl::kTexture2d, scene->texel_normal);
  sum.blend(true);
  for (uint32_t l = 0; l < count; ++l) {
    const lw_gl_lamp& lamp = *lamps[l];
    if (!lamp.started) continue;
    float numbers[8];
    gl::lampNumbers(lamp, gathering, numbers);
    api.Uniform4fv(scene->gather.uniform[gl::gather_uniform::numbers], 2, numbers);
    gl::bindTexture(api, 0, gl::kTexture2d, lamp.place.texture);
    gl::bindTexture(api, 1, gl::kTexture2d, lamp.light_flux.texture);
    gl::bindTexture(api, 2, gl::kTexture2d, lamp.pushed);
    api.DrawArrays(gl::kTriangles, 0, 3);
  }
  sum.blend(false);
  api.UseProgram(scene->show.name);
  api.Uniform1f(scene->show.uniform[gl::show_uniform::max], scene->max_value);
  gl::bindTexture(api, 0, gl::kTexture2d, scene->texel_map);
  gl::bindTexture(api, 1, gl::kTexture2d, scene->value.texture);
  api.BindFramebuffer(gl::kDrawFramebuffer, scene->atlas.framebuffer);
  api.Viewport(0, 0, scene->atlas.width, scene->atlas.height);
  api.DrawArrays(gl::kTriangles, 0, 3);
  return LW_OK;
}

lw_result lw_gl_dynamic_read_atlas(lw_gl_dynamic* scene, float* rgba) {
  return scene && rgba ? gl::readTarget(scene->gl.api, scene->host, scene->atlas, rgba) : LW_INVALID_ARGUMENT;
}

const char* lw_glsl_lamp(void) { return gl::glsl::kLampLookup; }
