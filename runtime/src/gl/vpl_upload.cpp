// Making a light map of virtual lights: surfaces, programs, targets.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/geometry.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/gl/vpl_gl.h"
#include "runtime/src/texel_surface.h"
#include "runtime/src/virtual_lights.h"

namespace lightwell::runtime::gl {
namespace {

class Uploader : ListUploader {
 public:
  Uploader(lw_gl_vpl& out, const lw_container& container)
      : ListUploader(out.context->api, out.host, out.texture_bytes), out_(out), container_(container) {}

  lw_result upload() {
    api_.clearErrors();
    uploadTexels();
    if (out_.options.shadow_map_side > 0) uploadTriangles();
    makeLayers();
    makeAtlas();
    if (!result_) compilePrograms();
    if (!result_)
      if (const Enum error = api_.GetError(); error != kNoError)
        result_ = out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading surfaces: GL error 0x%04x", error);
    return result_;
  }

 private:
  void uploadTexels() {
    TexelSurface surface;
    if ((result_ = findTexelSurface(container_, out_.options.fill != 0, surface))) return;
    out_.values = surface.values();
    if (out_.values > kMaxTargetElements)
      result_ = out_.host.fail(LW_LIMIT_EXCEEDED, "%u texels with a value are more than the %llu that a light map on OpenGL can have", out_.values,
                               static_cast<unsigned long long>(kMaxTargetElements));
    if (int32_t(std::max(surface.width, surface.height)) > api_.max_texture_size)
      result_ = out_.host.fail(LW_LIMIT_EXCEEDED, "an atlas of %u x %u texels is more than this context takes", surface.width, surface.height);
    list(out_.place, kTexelRgba32f, out_.values, surface.place.data());
    list(out_.normal, kTexelRgba32f, out_.values, surface.normal.data());
    list(out_.axes, kTexelRgba16f, uint64_t(out_.values) * 2, surface.axes.data());
    if (result_) return;
    out_.atlas.width = int32_t(surface.width), out_.atlas.height = int32_t(surface.height);
    out_.shown = createPicture(api_, kTexelR32ui, out_.atlas.width, out_.atlas.height, kNearest, surface.value_of_texel.data(), out_.texture_bytes);
  }

  void uploadTriangles() {
    Array<float> position_m;
    Array<uint32_t> index;
    Array<uint8_t> flags;
    AlphaSurfaces alpha;
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_POSITION, position_m);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_INDEX, index);
    if (!result_) result_ = decodeArray(&container_, LW_ARRAY_TRIANGLE_FLAGS, flags);
    if (!result_) result_ = loadAlpha(&container_, flags, alpha);
    if (result_) return;
    const size_t triangles = flags.size();
    const auto materialOf = [&](size_t t) { return alpha.triangle_material.empty() ? uint16_t(0xffff) : alpha.triangle_material[t]; };
    size_t opaque = 0;
    for (size_t t = 0; t < triangles; ++t) opaque += materialOf(t) == 0xffff;
    Array<float> corner, alpha_corner;
    if (!allocate(corner, uint64_t(triangles) * 12) || !allocate(alpha_corner, uint64_t(triangles - opaque) * 12)) return;
    size_t next[2] = {0, opaque};
    for (size_t t = 0; t < triangles; ++t) {
      const bool has_alpha = materialOf(t) != 0xffff;
      const size_t to = next[has_alpha]++;
      for (size_t c = 0; c < 3; ++c) {
        const size_t v = index[t * 3 + c];
        std::memcpy(&corner[(to * 3 + c) * 4], &position_m[v * 3], 3 * sizeof(float));
        corner[(to * 3 + c) * 4 + 3] = 0;
        if (!has_alpha) continue;
        const float values[4] = {alpha.uv[v * 2], alpha.uv[v * 2 + 1], float(materialOf(t)), 0};
        std::memcpy(&alpha_corner[((to - opaque) * 3 + c) * 4], values, sizeof values);
      }
    }
    if (triangles > uint64_t(INT32_MAX) / 3) result_ = out_.host.fail(LW_LIMIT_EXCEEDED, "%zu triangles are too many to be drawn at once", triangles);
    out_.triangles = uint32_t(triangles), out_.opaque_triangles = uint32_t(opaque);
    list(out_.corner, kTexelRgba32f, uint64_t(triangles) * 3, corner.data());
    list(out_.alpha_corner, kTexelRgba32f, uint64_t(triangles - opaque) * 3, alpha_corner.data());
    uploadAlpha(alpha, out_.alpha_material, out_.alpha);
    measureExtent(position_m);
    makeDepthMap();
  }

  void measureExtent(const Array<float>& position_m) {
    float low[3], high[3], square = 0;
    for (size_t k = 0; k < 3; ++k) low[k] = HUGE_VALF, high[k] = -HUGE_VALF;
    for (size_t i = 0; i < position_m.size(); ++i) low[i % 3] = std::min(low[i % 3], position_m[i]), high[i % 3] = std::max(high[i % 3], position_m[i]);
    for (size_t k = 0; k < 3 && !position_m.empty(); ++k) square += (high[k] - low[k]) * (high[k] - low[k]);
    out_.extent_m = std::max(0.5f * std::sqrt(square), 1e-12f);
  }

  void makeDepthMap() {
    if (result_) return;
    const auto side = int32_t(out_.options.shadow_map_side);
    Target& map = out_.depth_map;
    map.width = 2 * side, map.height = side + side / 2;
    map.texture = createPicture(api_, kTexelDepth32f, map.width, map.height, kNearest, nullptr, out_.texture_bytes);
    api_.GenFramebuffers(1, &map.framebuffer);
    api_.BindFramebuffer(kDrawFramebuffer, map.framebuffer);
    api_.FramebufferTexture2D(kDrawFramebuffer, kDepthAttachment, kTexture2d, map.texture, 0);
    constexpr Enum kNoBuffer = 0;
    api_.DrawBuffers(1, &kNoBuffer);
    checkFramebuffer();
  }

  void makeLayers() {
    if (result_) return;
    const uint32_t width = std::max(std::min(out_.values, uint32_t(glsl::kRow)), 1u), rows = std::max((out_.values + glsl::kRow - 1) / glsl::kRow, 1u), layers = out_.layers + 1;
    out_.layer_width = int32_t(width), out_.layer_height = int32_t(rows);
    api_.GenTextures(1, &out_.layer_texture);
    api_.BindTexture(kTexture2dArray, out_.layer_texture);
    for (const Enum filter : {kTextureMinFilter, kTextureMagFilter}) api_.TexParameteri(kTexture2dArray, filter, int32_t(kNearest));
    api_.TexParameteri(kTexture2dArray, kTextureMaxLevel, 0);
    api_.TexImage3D(kTexture2dArray, 0, int32_t(kTexelRgba32f.internal), out_.layer_width, out_.layer_height, int32_t(layers), 0, kTexelRgba32f.format, kTexelRgba32f.type, nullptr);
    out_.texture_bytes += uint64_t(width) * rows * layers * kTexelRgba32f.bytes;
    api_.GenFramebuffers(int32_t(layers), out_.layer_framebuffer);
    constexpr float kDark[4] = {};
    for (uint32_t i = 0; i < layers && !result_; ++i) {
      out_.texture_layer[i] = i;
      if (i < out_.layers) out_.changes[i] = kNeverDrawn;
      api_.BindFramebuffer(kDrawFramebuffer, out_.layer_framebuffer[i]);
      api_.FramebufferTextureLayer(kDrawFramebuffer, kColorAttachment0, out_.layer_texture, 0, int32_t(i));
      checkFramebuffer();
      if (!result_) api_.ClearBufferfv(kColor, 0, kDark);
    }
  }

  void makeAtlas() {
    if (result_) return;
    const bool full = out_.options.atlas_format == LW_GL_ATLAS_RGBA32F;
    out_.max_value = full ? 1e30f : 65504.0f;
    out_.owns_atlas = out_.options.atlas_texture == 0;
    out_.atlas.texture = out_.options.atlas_texture;
    if (out_.owns_atlas)
      out_.atlas.texture = createPicture(api_, full ? kTexelRgba32f : kTexelRgba16f, out_.atlas.width, out_.atlas.height, kLinear, nullptr, out_.texture_bytes);
    result_ = attachTarget(api_, out_.host, out_.atlas);
  }

  void checkFramebuffer() {
    if (const Enum status = api_.CheckFramebufferStatus(kDrawFramebuffer); status != kFramebufferComplete)
      result_ = out_.host.fail(LW_GL_FAILED, "a framebuffer is incomplete (0x%04x)", status);
  }

  void compilePrograms() {
    using namespace glsl;
    const lw_gl& gl = *out_.context;
    const auto depth = [&](Program& program, const char* switches) {
      return compileProgram(gl, "depth of a virtual light", {switches, kAddress, kHash, kAlphaTest, kVplDepth}, {"u_corner", "u_alpha_corner", "u_alpha_material", "u_alpha"},
                            {"u_right", "u_up", "u_forward", "u_eye"}, program, {switches, kAddress, kVplDepthVertex});
    };
    if (out_.triangles > 0) result_ = depth(out_.depth, "");
    if (!result_ && out_.triangles > out_.opaque_triangles) result_ = depth(out_.depth_alpha, kVplAlphaOn);
    if (!result_)
      result_ = compileProgram(gl, "virtual light", {kAddress, kHash, kVplIrradiance, kVplLight}, {"u_place", "u_normal", "u_axes", "u_depth"}, {"u_light", "u_values"}, out_.light);
    if (!result_) result_ = compileProgram(gl, "light map", {kAddress, kVplShow}, {"u_layer", "u_shown"}, {"u_weight", "u_layers", "u_max"}, out_.show);
  }

  lw_gl_vpl& out_;
  const lw_container& container_;
};

/// Null, or what is wrong.
const char* checkOptions(const lw_gl_vpl_options& o) {
  if (o.size < sizeof o || o.atlas_format > LW_GL_ATLAS_RGBA32F || o.fill > 1) return "a value is out of range";
  if (o.component < 1 || o.component > (LW_GL_VPL_DIRECT | LW_GL_VPL_INDIRECT)) return "component has no bit of LW_GL_VPL_…, or others";
  if (o.layers < 1 || o.layers > kMostVplLayers) return "layers is not 1 to 32";
  if (o.shadow_map_side != 0 && (o.shadow_map_side < 16 || o.shadow_map_side > 2048 || o.shadow_map_side % 2 != 0)) return "shadow_map_side is not even and 16 to 2048, or 0";
  if (o.blocker_samples > 32 || o.filter_samples < 1 || o.filter_samples > 32) return "there are 0 to 32 blocker_samples and 1 to 32 filter_samples";
  if (!(o.pieces >= 1 && o.pieces <= 16)) return "pieces is not 1 to 16";
  if (!(o.epsilon >= 0 && o.epsilon <= 2)) return "epsilon is not 0 to 2";
  return nullptr;
}

/// The lights of each source, one after the other.
lw_result takeAll(lw_gl_vpl& vpl, const lw_virtual_lights& lights) {
  Array<lw_virtual_light> of_source;
  if (!of_source.allocate(vpl.host, lights.header.lights)) return vpl.host.fail(LW_OUT_OF_MEMORY, "no memory for %u lights", lights.header.lights);
  for (uint32_t s = 0; s < vpl.sources.size(); ++s) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < lights.header.lights; ++i)
      if (lights.source[i] == s) lw_virtual_lights_get(&lights, i, &of_source[count++]);
    if (const lw_result result = takeLights(vpl, of_source.data(), count, vpl.sources[s].pieces)) return result;
  }
  return LW_OK;
}

}  // namespace

lw_result takeLights(const lw_gl_vpl& vpl, const lw_virtual_light* lights, uint32_t count, Array<LightPiece>& pieces) {
  const auto isChosen = [&](const lw_virtual_light& light) { return (vpl.options.component & (light.bounce == 0 ? LW_GL_VPL_DIRECT : LW_GL_VPL_INDIRECT)) != 0; };
  uint32_t chosen = 0, taken = 0;
  for (uint32_t i = 0; i < count; ++i) {
    if (const char* wrong = checkVirtualLight(lights[i])) return vpl.host.fail(LW_INVALID_ARGUMENT, "virtual light %u: %s", i, wrong);
    chosen += isChosen(lights[i]);
  }
  const auto most = uint32_t(std::min(double(vpl.options.pieces) * chosen, 1e8));
  Array<LightPiece> room;
  if (!room.allocate(vpl.host, most)) return vpl.host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", most);
  for (uint32_t i = 0; i < count; ++i)
    if (isChosen(lights[i])) room[taken++] = wholeLight(lights[i]);
  taken = cutLights(room.data(), taken, most);
  if (!pieces.allocate(vpl.host, taken)) return vpl.host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", taken);
  std::copy_n(room.data(), taken, pieces.data());
  return LW_OK;
}

}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_vpl_create(lw_gl* context, const lw_container* container, const lw_virtual_lights* lights, const lw_gl_vpl_options* given, lw_gl_vpl** out) {
  if (!context || !container || !out) return LW_INVALID_ARGUMENT;
  const lw_gl_vpl_options options = given ? *given : lw_gl_vpl_options LW_GL_VPL_OPTIONS_INIT;
  if (const char* wrong = gl::checkOptions(options)) return context->host.fail(LW_INVALID_ARGUMENT, "lw_gl_vpl_options: %s", wrong);
  if (!context->api.blends_floats) return context->host.fail(LW_GL_UNSUPPORTED, "virtual lights are added up in 32-bit floats; the context has no EXT_float_blend");
  lw_gl_vpl* vpl = createHandle<lw_gl_vpl>(context->host);
  if (!vpl) return context->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the light map");
  vpl->context = context;
  vpl->options = options;
  const uint32_t sources = lights ? lights->header.sources : 1;
  lw_result result = LW_OK;
  if (vpl->sources.allocate(vpl->host, sources))
    for (gl::VplSource& source : vpl->sources) new (&source) gl::VplSource;
  else
    result = vpl->host.fail(LW_OUT_OF_MEMORY, "no memory for %u sources", sources);
  vpl->layers = std::min(options.layers, std::max(sources, 1u));
  if (!result && lights) result = gl::takeAll(*vpl, *lights);
  if (!result) {
    const gl::StateGuard guard(context->api);
    result = gl::Uploader(*vpl, *container).upload();
    if (!result) gl::clearTarget(context->api, vpl->atlas);
    context->api.clearErrors();
  }
  if (result) {
    lw_gl_vpl_destroy(vpl);
    return result;
  }
  *out = vpl;
  return LW_OK;
}

void lw_gl_vpl_destroy(lw_gl_vpl* vpl) {
  if (!vpl) return;
  const gl::Api& api = vpl->context->api;
  if (!vpl->owns_atlas) vpl->atlas.texture = 0;
  gl::destroyTarget(api, vpl->atlas);
  gl::destroyTarget(api, vpl->depth_map);
  if (vpl->layer_texture) api.DeleteFramebuffers(int32_t(vpl->layers) + 1, vpl->layer_framebuffer);
  for (const gl::Name name : {vpl->place, vpl->normal, vpl->axes, vpl->shown, vpl->corner, vpl->alpha_corner, vpl->alpha_material, vpl->alpha, vpl->layer_texture})
    if (name) api.DeleteTextures(1, &name);
  for (const gl::Program* program : {&vpl->depth, &vpl->depth_alpha, &vpl->light, &vpl->show})
    if (program->name) api.DeleteProgram(program->name);
  for (gl::VplSource& source : vpl->sources) source.~VplSource();
  destroyHandle(vpl);
}

uint32_t lw_gl_vpl_texture(const lw_gl_vpl* vpl) { return vpl ? vpl->atlas.texture : 0; }

uint64_t lw_gl_vpl_texture_bytes(const lw_gl_vpl* vpl) { return vpl ? vpl->texture_bytes : 0; }

lw_result lw_gl_vpl_read(lw_gl_vpl* vpl, float* rgba) { return vpl && rgba ? gl::readTarget(vpl->context->api, vpl->host, vpl->atlas, rgba) : LW_INVALID_ARGUMENT; }
