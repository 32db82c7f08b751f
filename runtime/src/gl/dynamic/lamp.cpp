// A lamp: what it sees, and virtual lights there.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/gl/dynamic/dynamic_gl.h"
#include "runtime/src/gl/lamp_view.h"

namespace lightwell::runtime::gl {
namespace {

constexpr double kNearestSeen = 1e-5;    // of the scene: nothing closer to the lamp is seen
constexpr uint32_t kCellsEach = 24;      // of the flux, at least, for each light that shares it
constexpr Enum kNearestMipmapNearest = 0x2700, kStreamRead = 0x88E1;
constexpr uint32_t kMapRead = 1;

bool isPowerOfTwo(uint32_t v) { return v != 0 && (v & (v - 1)) == 0; }
int32_t levelsOf(int32_t size) {
  int32_t levels = 1;
  while (size >>= 1) ++levels;
  return levels;
}

double extentOf(const lw_gl_dynamic& scene) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += std::pow(0.5 * (double(scene.bounds_max_m[k]) - double(scene.bounds_min_m[k])), 2);
  return std::max(std::sqrt(square), 1e-12);
}

LampUniforms uniformsOf(const lw_gl_lamp& lamp, const PackedLight& light, const LampViews& views, double scale) {
  const View& view = views.view[0];
  LampUniforms u{};
  for (int k = 0; k < 3; ++k) {
    u.value[0][k] = float(view.eye_m[k]);
    u.value[1][k] = float(view.right[k] / dot(view.right, view.right));
    u.value[2][k] = float(view.up[k] / dot(view.up, view.up));
    u.value[3][k] = float(view.forward[k]);
    u.value[5][k] = light.intensity_rgb[k];
    u.value[6][k] = light.direction[k];
  }
  u.value[0][3] = !view.perspective ? 2 : views.count == 6 ? 0 : 1;
  u.value[4][0] = float(lamp.options.view_side);
  u.value[4][1] = light.spot_scale, u.value[4][2] = light.spot_offset;
  u.value[4][3] = float(scale);
  u.value[5][3] = light.range_m;
  return u;
}

LampProjection projectionOf(const PackedLight& light, const LampViews& views) {
  LampProjection p;
  const View& view = views.view[0];
  std::memcpy(p.axis, light.direction, sizeof p.axis);
  if (isType(light, LW_LIGHT_DIRECTIONAL)) {
    p.kind = LampProjection::plane;
    p.half[0] = float(std::sqrt(dot(view.right, view.right))), p.half[1] = float(std::sqrt(dot(view.up, view.up)));
  } else if (isType(light, LW_LIGHT_SPOT)) {
    p.kind = LampProjection::cone;
    p.cos_outer = std::clamp(-light.spot_offset / light.spot_scale, 0.0f, 1.0f);
  } else {
    p.axis[0] = p.axis[2] = 0, p.axis[1] = -1;
  }
  return p;
}

/// Scale of the pixels' solid angles, so that a spot's power is exact; orthographic: a pixel's area.
double pixelScale(lw_gl_lamp& lamp, const PackedLight& light, const LampViews& views) {
  const View& first = views.view[0];
  const double side = lamp.options.view_side;
  return first.perspective ? spotScale(light, views, lamp.options.view_side, lamp.corner.data())
                           : std::sqrt(dot(first.right, first.right) * dot(first.up, first.up)) * 4 / (side * side);
}

void destroyViews(lw_gl_lamp& lamp) {
  const Api& api = lamp.scene->gl.api;
  for (Name* name : {&lamp.position, &lamp.normal, &lamp.flux, &lamp.depth, &lamp.sum}) {
    if (*name) api.DeleteTextures(1, name);
    *name = 0;
  }
  if (lamp.view_framebuffer) api.DeleteFramebuffers(1, &lamp.view_framebuffer);
  lamp.view_framebuffer = 0;
  lamp.views = 0;
  lamp.view_bytes = 0;
}

lw_result makeViews(lw_gl_lamp& lamp, uint32_t views) {
  if (lamp.views == views) return LW_OK;
  destroyViews(lamp);
  const Api& api = lamp.scene->gl.api;
  const auto side = int32_t(lamp.options.view_side);
  lamp.width = side * (views == 6 ? 4 : 1), lamp.height = side * (views == 6 ? 2 : 1);
  lamp.sum_levels = levelsOf(std::max(lamp.width, lamp.height));
  if (lamp.width > api.max_texture_size) return lamp.host.fail(LW_LIMIT_EXCEEDED, "six views of %d pixels are larger than the context's textures", side);
  api.ActiveTexture(kTexture0);
  api.GenFramebuffers(1, &lamp.view_framebuffer);
  api.BindFramebuffer(kDrawFramebuffer, lamp.view_framebuffer);
  Name* const colors[] = {&lamp.position, &lamp.normal, &lamp.flux};
  Enum buffers[3];
  for (uint32_t i = 0; i < 3; ++i) {
    *colors[i] = createPicture(api, kTexelRgba32f, lamp.width, lamp.height, kNearest, nullptr, lamp.view_bytes);
    buffers[i] = kColorAttachment0 + i;
    api.FramebufferTexture2D(kDrawFramebuffer, buffers[i], kTexture2d, *colors[i], 0);
  }
  lamp.depth = createPicture(api, kTexelDepth32f, lamp.width, lamp.height, kNearest, nullptr, lamp.view_bytes);
  api.FramebufferTexture2D(kDrawFramebuffer, kDepthAttachment, kTexture2d, lamp.depth, 0);
  api.DrawBuffers(3, buffers);
  if (const Enum status = api.CheckFramebufferStatus(kDrawFramebuffer); status != kFramebufferComplete)
    return lamp.host.fail(LW_GL_FAILED, "the framebuffer of a lamp's views is incomplete (0x%04x)", status);
  lamp.sum = createLevels(api, kTexelRgba32f, lamp.width, lamp.height, lamp.sum_levels, lamp.view_bytes);
  lamp.views = views;
  return LW_OK;
}

void see(lw_gl_lamp& lamp, const LampUniforms& uniforms, const LampViews& views) {
  const lw_gl_dynamic& scene = *lamp.scene;
  const Api& api = scene.gl.api;
  constexpr float kNothing[4] = {}, kFarthest = 0;
  const double extent = extentOf(scene);
  const auto side = int32_t(lamp.options.view_side);
  api.BindFramebuffer(kDrawFramebuffer, lamp.view_framebuffer);
  api.Enable(kDepthTest);
  api.DepthFunc(kGreater);
  api.DepthMask(1);
  for (int32_t i = 0; i < 3; ++i) api.ClearBufferfv(kColor, i, kNothing);
  api.ClearBufferfv(kDepth, 0, &kFarthest);
  api.UseProgram(scene.see.name);
  useLamp(api, scene.see.uniform[see_uniform::lamp], uniforms);
  bindTexture(api, 0, kTexture2dArray, scene.corners);
  bindTexture(api, 1, kTexture2dArray, scene.triangle);
  bindTexture(api, 2, kTexture2d, scene.albedo);
  bindTexture(api, 3, kTexture2dArray, scene.alpha_material);
  bindTexture(api, 4, kTexture2dArray, scene.alpha);
  for (int v = 0; v < views.count; ++v) {
    setView(api, scene.see.uniform, views.view[v], kNearestSeen * extent, extent);
    api.Viewport(v % 4 * side, v / 4 * side, side, side);
    api.DrawArrays(kTriangles, 0, int32_t(scene.triangles * 3));
    ++lamp.draws;
  }
  api.Disable(kDepthTest);
}

void addUp(lw_gl_lamp& lamp, const LampUniforms& uniforms, const lw_gl_reflective_shadow_map& map) {
  const lw_gl_dynamic& scene = *lamp.scene;
  const Api& api = scene.gl.api;
  api.UseProgram(scene.flux_sum.name);
  useLamp(api, scene.flux_sum.uniform[flux_sum_uniform::lamp], uniforms);
  bindTexture(api, 0, kTexture2d, map.position_texture);
  bindTexture(api, 1, kTexture2d, map.normal_texture);
  bindTexture(api, 2, kTexture2d, map.flux_texture);
  bindTexture(api, 3, kTexture2d, lamp.sum);
  drawIntoLevel(scene, lamp.sum, 0, 0);
  drawOver(lamp, lamp.width, lamp.height);
  api.UseProgram(scene.flux_reduce.name);
  bindTexture(api, 0, kTexture2d, lamp.sum);
  for (int32_t level = 1; level < lamp.sum_levels; ++level) {
    drawIntoLevel(scene, lamp.sum, level, level - 1);
    drawOver(lamp, std::max(lamp.width >> level, 1), std::max(lamp.height >> level, 1));
  }
  setLevels(api, 0, lamp.sum_levels - 1);
}

void uploadRequests(lw_gl_lamp& lamp, uint32_t count) {
  const Api& api = lamp.scene->gl.api;
  static_assert(sizeof(LightRequest) == 4 * sizeof(float));
  bindTexture(api, 0, kTexture2d, lamp.request);
  if (count) api.TexSubImage2D(kTexture2d, 0, 0, 0, int32_t(count), 1, kRgba, kFloat, lamp.requests.data());
}

/// Lights by flux, all of them.
void sampleLights(lw_gl_lamp& lamp, const lw_gl_reflective_shadow_map& map) {
  const lw_gl_dynamic& scene = *lamp.scene;
  const Api& api = scene.gl.api;
  api.UseProgram(scene.sample.name);
  api.Uniform1i(scene.sample.uniform[sample_uniform::levels], lamp.sum_levels);
  api.Uniform1i(scene.sample.uniform[sample_uniform::lights], int32_t(lamp.options.lights));
  bindTexture(api, 0, kTexture2d, map.position_texture);
  bindTexture(api, 1, kTexture2d, map.normal_texture);
  bindTexture(api, 2, kTexture2d, lamp.sum);
  for (const auto& [target, row] : {std::pair{&lamp.place, 0}, {&lamp.light_flux, 2}}) {
    api.Uniform1i(scene.sample.uniform[sample_uniform::row], row);
    api.BindFramebuffer(kDrawFramebuffer, target->framebuffer);
    drawOver(lamp, target->width, target->height);
  }
}

/// What became of the lights, into lamp.aims. Late: of the last time; false when there was none.
bool readAims(lw_gl_lamp& lamp) {
  const Api& api = lamp.scene->gl.api;
  const auto lights = int32_t(lamp.options.lights);
  api.BindFramebuffer(kReadFramebuffer, lamp.aim.framebuffer);
  if (!lamp.options.late) {
    api.ReadPixels(0, 0, lights, 1, kRgba, kFloat, lamp.aims.data());
    return true;
  }
  api.BindBuffer(kPixelPackBuffer, lamp.pack_buffer);
  const bool had = lamp.has_late_aims;
  if (had)
    if (const void* mapped = api.MapBufferRange(kPixelPackBuffer, 0, ptrdiff_t(lamp.aims.bytes()), kMapRead)) {
      std::memcpy(lamp.aims.data(), mapped, lamp.aims.bytes());
      api.UnmapBuffer(kPixelPackBuffer);
    }
  api.ReadPixels(0, 0, lights, 1, kRgba, kFloat, nullptr);
  api.BindBuffer(kPixelPackBuffer, 0);
  lamp.has_late_aims = true;
  return had;
}

/// Lights that stay, go and come; their flux. Returns how many came.
uint32_t updateLights(lw_gl_lamp& lamp, const LampUniforms& uniforms, const LampProjection& projection, const lw_gl_reflective_shadow_map& map, const SumGuard& sum, uint32_t& shining) {
  lw_gl_dynamic& scene = *lamp.scene;
  const Api& api = scene.gl.api;
  const uint32_t lights = lamp.options.lights;
  uint32_t count = 0;
  if (lamp.started) {
    api.UseProgram(scene.check.name);
    useLamp(api, scene.check.uniform[check_uniform::lamp], uniforms);
    bindTexture(api, 0, kTexture2d, lamp.place.texture);
    bindTexture(api, 1, kTexture2d, map.position_texture);
    api.BindFramebuffer(kDrawFramebuffer, lamp.aim.framebuffer);
    drawOver(lamp, lamp.aim.width, lamp.aim.height);
    shining = lights;
    if (readAims(lamp)) count = lamp.set.update(projection, lamp.aims.data(), lamp.options.most_updates, lamp.requests.data(), shining);
  } else {
    count = shining = lamp.set.restart(projection, lamp.requests.data());
    lamp.has_late_aims = false;
  }
  uploadRequests(lamp, count);
  if (count) {
    api.UseProgram(scene.place.name);
    useLamp(api, scene.place.uniform[place_uniform::lamp], uniforms);
    api.Uniform1i(scene.place.uniform[place_uniform::lights], int32_t(lights));
    bindTexture(api, 1, kTexture2d, map.position_texture);
    bindTexture(api, 2, kTexture2d, map.normal_texture);
    for (const auto& [target, rows] : {std::pair{&lamp.place, 2}, {&lamp.aim, 1}}) {
      api.Uniform1i(scene.place.uniform[place_uniform::rows], rows);
      api.BindFramebuffer(kDrawFramebuffer, target->framebuffer);
      api.Viewport(0, 0, target->width, target->height);
      api.DrawArrays(kPoints, 0, int32_t(count) * rows);
      ++lamp.draws;
    }
  }
  int32_t level = 0;
  const auto cells = [&](int32_t l) { return uint32_t(lamp.width >> l) * uint32_t(lamp.height >> l); };
  while ((lamp.options.view_side >> (level + 1)) > 0 && cells(level + 1) >= kCellsEach * lights) ++level;
  clearTarget(api, lamp.light_flux);
  api.UseProgram(scene.share.name);
  useLamp(api, scene.share.uniform[share_uniform::lamp], uniforms);
  api.Uniform1i(scene.share.uniform[share_uniform::level], level);
  api.Uniform1i(scene.share.uniform[share_uniform::lights], int32_t(lights));
  bindTexture(api, 0, kTexture2d, lamp.sum);
  bindTexture(api, 1, kTexture2d, lamp.aim.texture);
  api.Viewport(0, 0, lamp.light_flux.width, 1);
  sum.blend(true);
  api.DrawArrays(kPoints, 0, int32_t(cells(level)));
  sum.blend(false);
  ++lamp.draws;
  return count;
}

lw_result update(lw_gl_lamp& lamp, const lw_light& given, const lw_gl_reflective_shadow_map* map, lw_gl_lamp_work* work) {
  lw_gl_dynamic& scene = *lamp.scene;
  PackedLight light;
  if (const char* reason = packLight(given, light)) return lamp.host.fail(LW_INVALID_ARGUMENT, "the light: %s", reason);
  const LampViews views = lampViews(light, scene.bounds_min_m, scene.bounds_max_m);
  const Api& api = scene.gl.api;
  const StateGuard guard(api);
  const DepthStateGuard depth(api);
  const SumGuard sum(api);
  api.Disable(kStencilTest);
  api.Disable(kPolygonOffsetFill);
  api.Disable(kDepthTest);
  api.BindVertexArray(scene.gl.vertex_array);
  if (const lw_result result = makeViews(lamp, uint32_t(views.count))) {
    destroyViews(lamp);
    return result;
  }
  if (lamp.type != given.type) lamp.started = false;
  lamp.type = given.type;
  lamp.draws = 0;
  const LampUniforms uniforms = uniformsOf(lamp, light, views, pixelScale(lamp, light, views));
  const lw_gl_reflective_shadow_map own{lamp.position, lamp.normal, lamp.flux};
  if (!map) see(lamp, uniforms, views);
  const lw_gl_reflective_shadow_map& seen = map ? *map : own;
  addUp(lamp, uniforms, seen);
  uint32_t count = lamp.options.lights, shining = count;
  if (lamp.options.incremental) {
    count = updateLights(lamp, uniforms, projectionOf(light, views), seen, sum, shining);
  } else {
    sampleLights(lamp, seen);
    for (uint32_t i = 0; i < count; ++i) lamp.requests[i] = {{0, 0, 0}, float(i)};
    uploadRequests(lamp, count);
  }
  lamp.started = true;
  const uint64_t points = drawShadowMaps(lamp, count);
  if (work) *work = {shining, count, lamp.draws, points};
  return LW_OK;
}

/// A target of lights × rows.
lw_result makeRows(lw_gl_lamp& lamp, int32_t rows, Target& target) {
  const Api& api = lamp.scene->gl.api;
  target.width = int32_t(lamp.options.lights), target.height = rows;
  target.texture = createPicture(api, kTexelRgba32f, target.width, rows, kNearest, nullptr, lamp.texture_bytes);
  const lw_result result = attachTarget(api, lamp.host, target);
  if (!result) clearTarget(api, target);
  return result;
}

lw_result makeShadowMaps(lw_gl_lamp& lamp) {
  const uint32_t side = lamp.options.shadow_side;
  if (side == 0) return LW_OK;
  const Api& api = lamp.scene->gl.api;
  while (lamp.row * lamp.row < lamp.options.lights) ++lamp.row;
  lamp.rows = (lamp.options.lights + lamp.row - 1) / lamp.row;
  const auto width = int32_t(lamp.row * side), height = int32_t(lamp.rows * side);
  if (width > api.max_texture_size) return lamp.host.fail(LW_LIMIT_EXCEEDED, "%u shadow maps of %u texels are more than one texture of this context holds", lamp.options.lights, side);
  lamp.points_each = std::min(lamp.options.shadow_points, lamp.scene->points);
  lamp.shadow_levels = levelsOf(int32_t(side));
  lamp.pulled = createLevels(api, kTexelR32f, width, height, lamp.shadow_levels, lamp.texture_bytes);
  lamp.pushed = createLevels(api, kTexelR32f, width, height, lamp.shadow_levels, lamp.texture_bytes);
  lamp.shadow_depth = createPicture(api, kTexelDepth32f, width, height, kNearest, nullptr, lamp.texture_bytes);
  api.GenFramebuffers(1, &lamp.shadow_framebuffer);
  api.BindFramebuffer(kDrawFramebuffer, lamp.shadow_framebuffer);
  api.FramebufferTexture2D(kDrawFramebuffer, kColorAttachment0, kTexture2d, lamp.pulled, 0);
  api.FramebufferTexture2D(kDrawFramebuffer, kDepthAttachment, kTexture2d, lamp.shadow_depth, 0);
  if (const Enum status = api.CheckFramebufferStatus(kDrawFramebuffer); status != kFramebufferComplete)
    return lamp.host.fail(LW_GL_FAILED, "the framebuffer of shadow maps is incomplete (0x%04x)", status);
  return LW_OK;
}

lw_result make(lw_gl_lamp& lamp) {
  const Api& api = lamp.scene->gl.api;
  const uint32_t lights = lamp.options.lights;
  const StateGuard guard(api);
  api.clearErrors();
  api.ActiveTexture(kTexture0);
  if (!lamp.set.allocate(lamp.host, lights) || !lamp.requests.allocate(lamp.host, lights) || !lamp.aims.allocate(lamp.host, size_t(lights) * 4) ||
      !lamp.corner.allocate(lamp.host, (size_t(lamp.options.view_side) + 1) * 2))
    return lamp.host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", lights);
  lw_result result = makeRows(lamp, 2, lamp.place);
  if (!result) result = makeRows(lamp, 1, lamp.light_flux);
  if (!result) result = makeRows(lamp, 1, lamp.aim);
  if (result) return result;
  lamp.request = createPicture(api, kTexelRgba32f, int32_t(lights), 1, kNearest, nullptr, lamp.texture_bytes);
  if ((result = makeShadowMaps(lamp))) return result;
  if (lamp.options.late) {
    api.GenBuffers(1, &lamp.pack_buffer);
    api.BindBuffer(kPixelPackBuffer, lamp.pack_buffer);
    api.BufferData(kPixelPackBuffer, ptrdiff_t(lamp.aims.bytes()), nullptr, kStreamRead);
    api.BindBuffer(kPixelPackBuffer, 0);
  }
  if (const Enum error = api.GetError(); error != kNoError)
    return lamp.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "making a lamp: GL error 0x%04x", error);
  return LW_OK;
}

}  // namespace

Name createLevels(const Api& api, const TexelFormat& format, int32_t width, int32_t height, int32_t levels, uint64_t& texture_bytes) {
  const Name texture = createPicture(api, format, width, height, kNearest, nullptr, texture_bytes);
  api.TexParameteri(kTexture2d, kTextureMinFilter, int32_t(kNearestMipmapNearest));
  for (int32_t level = 1; level < levels; ++level) {
    const int32_t w = std::max(width >> level, 1), h = std::max(height >> level, 1);
    api.TexImage2D(kTexture2d, level, int32_t(format.internal), w, h, 0, format.format, format.type, nullptr);
    texture_bytes += uint64_t(w) * uint64_t(h) * format.bytes;
  }
  return texture;
}

void drawIntoLevel(const lw_gl_dynamic& scene, Name texture, int32_t level, int32_t readable) {
  const Api& api = scene.gl.api;
  setLevels(api, readable, readable);
  api.BindFramebuffer(kDrawFramebuffer, scene.framebuffer);
  api.FramebufferTexture2D(kDrawFramebuffer, kColorAttachment0, kTexture2d, texture, level);
}

void lampNumbers(const lw_gl_lamp& lamp, const lw_gl_gathering& gathering, float numbers[8]) {
  const float each = lamp.points_each ? lamp.scene->points_area_m2 / float(lamp.points_each) : 0;
  const float values[8] = {float(lamp.options.lights), float(lamp.options.shadow_side), float(lamp.row), 0.5f * std::sqrt(each * 0.318309886f), gathering.softness, gathering.most_form, 0, 0};
  std::memcpy(numbers, values, sizeof values);
}

}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_lamp_create(lw_gl_dynamic* scene, const lw_gl_lamp_options* given, lw_gl_lamp** out) {
  if (!scene || !out) return LW_INVALID_ARGUMENT;
  lw_gl_lamp_options options = given ? *given : lw_gl_lamp_options LW_GL_LAMP_OPTIONS_INIT;
  if (!given && scene->points == 0) options.shadow_side = 0;
  const bool shadows = options.shadow_side != 0;
  if (options.size < sizeof options || options.lights < 16 || options.lights > 1024 || !gl::isPowerOfTwo(options.view_side) || options.view_side < 16 || options.view_side > 1024 ||
      (shadows && (!gl::isPowerOfTwo(options.shadow_side) || options.shadow_side < 8 || options.shadow_side > 128 || options.shadow_points < 1)) || options.incremental > 1 ||
      options.late > 1 || (options.incremental && (options.most_updates < 1 || options.most_updates > options.lights)))
    return scene->host.fail(LW_INVALID_ARGUMENT, "lw_gl_lamp_options: a value is out of range");
  if (shadows && scene->points == 0)
    return scene->host.fail(LW_NOT_FOUND, "shadow maps of virtual lights are splatted from the section points, which the container has not (bake --points N)");
  lw_gl_lamp* lamp = createHandle<lw_gl_lamp>(scene->host);
  if (!lamp) return scene->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the lamp");
  lamp->scene = scene;
  lamp->options = options;
  if (const lw_result result = gl::make(*lamp)) {
    lw_gl_lamp_destroy(lamp);
    return result;
  }
  *out = lamp;
  return LW_OK;
}

void lw_gl_lamp_destroy(lw_gl_lamp* lamp) {
  if (!lamp) return;
  const gl::Api& api = lamp->scene->gl.api;
  gl::destroyViews(*lamp);
  for (gl::Target* target : {&lamp->place, &lamp->light_flux, &lamp->aim}) gl::destroyTarget(api, *target);
  for (const gl::Name name : {lamp->request, lamp->pulled, lamp->pushed, lamp->shadow_depth})
    if (name) api.DeleteTextures(1, &name);
  if (lamp->shadow_framebuffer) api.DeleteFramebuffers(1, &lamp->shadow_framebuffer);
  if (lamp->pack_buffer) api.DeleteBuffers(1, &lamp->pack_buffer);
  destroyHandle(lamp);
}

uint64_t lw_gl_lamp_texture_bytes(const lw_gl_lamp* lamp) { return lamp ? lamp->texture_bytes + lamp->view_bytes : 0; }

lw_result lw_gl_lamp_update(lw_gl_lamp* lamp, const lw_light* light, lw_gl_lamp_work* work) {
  return lamp && light ? gl::update(*lamp, *light, nullptr, work) : LW_INVALID_ARGUMENT;
}

lw_result lw_gl_lamp_update_from(lw_gl_lamp* lamp, const lw_light* light, const lw_gl_reflective_shadow_map* map, lw_gl_lamp_work* work) {
  if (!lamp || !light || !map) return LW_INVALID_ARGUMENT;
  if (!map->position_texture || !map->normal_texture || !map->flux_texture) return lamp->host.fail(LW_INVALID_ARGUMENT, "lw_gl_reflective_shadow_map: a texture is missing");
  return gl::update(*lamp, *light, map, work);
}

lw_result lw_gl_lamp_get_views(const lw_gl_lamp* lamp, const lw_light* given, lw_gl_lamp_views* out) {
  if (!lamp || !given || !out) return LW_INVALID_ARGUMENT;
  PackedLight light;
  if (const char* reason = packLight(*given, light)) return lamp->host.fail(LW_INVALID_ARGUMENT, "the light: %s", reason);
  const LampViews views = lampViews(light, lamp->scene->bounds_min_m, lamp->scene->bounds_max_m);
  const double extent = gl::extentOf(*lamp->scene);
  *out = {};
  out->count = uint32_t(views.count);
  out->width = lamp->options.view_side * (views.count == 6 ? 4 : 1), out->height = lamp->options.view_side * (views.count == 6 ? 2 : 1);
  for (int v = 0; v < views.count; ++v) {
    const View& view = views.view[v];
    float* m = out->view[v].clip_from_container;
    double row[4][4] = {};
    for (int k = 0; k < 3; ++k) {
      row[0][k] = view.right[k] / dot(view.right, view.right);
      row[1][k] = view.up[k] / dot(view.up, view.up);
      row[2][k] = view.perspective ? view.forward[k] : view.forward[k] * 0.99 / extent;
      row[3][k] = view.perspective ? view.forward[k] : 0;
    }
    for (auto& r : row) r[3] = -dot(r, view.eye_m);
    if (view.perspective) row[2][3] -= 2 * gl::kNearestSeen * extent;
    else row[3][3] = 1;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) m[c * 4 + r] = float(row[r][c]);
  }
  return LW_OK;
}

void lw_gl_lamp_reset(lw_gl_lamp* lamp) {
  if (lamp) lamp->started = false;
}

lw_result lw_gl_lamp_lookup(const lw_gl_lamp* lamp, const lw_gl_gathering* given, lw_gl_lamp_lookup_values* values) {
  if (!lamp || !values) return LW_INVALID_ARGUMENT;
  const lw_gl_gathering gathering = given ? *given : lw_gl_gathering LW_GL_GATHERING_INIT;
  if (!gl::isGathering(gathering)) return lamp->host.fail(LW_INVALID_ARGUMENT, "lw_gl_gathering: a value is out of range");
  values->place_texture = lamp->place.texture, values->flux_texture = lamp->light_flux.texture, values->shadow_texture = lamp->pushed;
  gl::lampNumbers(*lamp, gathering, values->numbers);
  return LW_OK;
}

lw_result lw_gl_lamp_read_lights(lw_gl_lamp* lamp, lw_virtual_light* lights) {
  if (!lamp || !lights) return LW_INVALID_ARGUMENT;
  const uint32_t count = lamp->options.lights;
  Array<float> place, flux;
  if (!place.allocate(lamp->host, size_t(count) * 8) || !flux.allocate(lamp->host, size_t(count) * 4)) return lamp->host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", count);
  const gl::Api& api = lamp->scene->gl.api;
  lw_result result = gl::readTarget(api, lamp->host, lamp->place, place.data());
  if (!result) result = gl::readTarget(api, lamp->host, lamp->light_flux, flux.data());
  if (result) return result;
  for (size_t i = 0; i < count; ++i) {
    lw_virtual_light& light = lights[i];
    light = {};
    light.type = LW_VIRTUAL_DISK, light.bounce = 1;
    if (place[i * 4 + 3] != 1.0f) continue;
    std::memcpy(light.position_m, &place[i * 4], sizeof light.position_m);
    std::memcpy(light.normal, &place[(count + i) * 4], sizeof light.normal);
    std::memcpy(light.flux_rgb, &flux[i * 4], sizeof light.flux_rgb);
    light.area_m2 = flux[i * 4 + 3];
    light.radius_m = std::sqrt(light.area_m2 * 0.318309886f);
  }
  return LW_OK;
}

lw_result lw_gl_lamp_read_visibility(lw_gl_lamp* lamp, const float position_m[3], const float normal[3], float* visibility) {
  if (!lamp || !position_m || !normal || !visibility) return LW_INVALID_ARGUMENT;
  lw_gl_dynamic& scene = *lamp->scene;
  const gl::Api& api = scene.gl.api;
  const uint32_t count = lamp->options.lights;
  Array<float> rgba;
  if (!rgba.allocate(lamp->host, size_t(count) * 4)) return lamp->host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", count);
  const gl::StateGuard guard(api);
  const gl::DepthStateGuard depth(api);
  api.Disable(gl::kDepthTest);
  api.Disable(gl::kStencilTest);
  api.BindVertexArray(scene.gl.vertex_array);
  float numbers[8];
  const float point[4] = {position_m[0], position_m[1], position_m[2], 0}, about[4] = {normal[0], normal[1], normal[2], 0};
  gl::lampNumbers(*lamp, LW_GL_GATHERING_INIT, numbers);
  gl::Target target;
  uint64_t bytes = 0;
  target.width = int32_t(count), target.height = 1;
  api.ActiveTexture(gl::kTexture0);
  target.texture = gl::createPicture(api, gl::kTexelRgba32f, target.width, 1, gl::kNearest, nullptr, bytes);
  lw_result result = gl::attachTarget(api, lamp->host, target);
  if (!result) {
    api.UseProgram(scene.visibility.name);
    api.Uniform4fv(scene.visibility.uniform[gl::visibility_uniform::point], 1, point);
    api.Uniform4fv(scene.visibility.uniform[gl::visibility_uniform::normal], 1, about);
    api.Uniform4fv(scene.visibility.uniform[gl::visibility_uniform::numbers], 2, numbers);
    gl::bindTexture(api, 0, gl::kTexture2d, lamp->place.texture);
    gl::bindTexture(api, 1, gl::kTexture2d, lamp->light_flux.texture);
    gl::bindTexture(api, 2, gl::kTexture2d, lamp->pushed);
    api.Viewport(0, 0, target.width, 1);
    api.DrawArrays(gl::kTriangles, 0, 3);
    result = gl::readTarget(api, lamp->host, target, rgba.data());
  }
  gl::destroyTarget(api, target);
  for (size_t i = 0; i < count && !result; ++i) visibility[i] = rgba[i * 4];
  return result;
}
