#include "cli/report/frame_cost.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>

#include "cli/gl_context.h"
#include "lightwell/lightwell_gl_dynamic.h"
#include "precompute/bake/bake.h"
#include "render/gl_objects.h"

namespace lightwell::report {
namespace {

constexpr int kMostRepeats = 11, kFewestRepeats = 3;
constexpr double kEnough_ms = 1500;      // of one thing; slower ones are repeated less often
constexpr uint32_t kInjectionSide = 128;

double medianMs(const std::function<void(const lw_light& lamp)>& work, const std::array<lw_light, 2>& lamps) {
  size_t at = 0;  // the light moves: what has not changed would cost nothing
  const auto frame = [&] { work(lamps[at ^= 1]); };
  frame(), frame();  // compiles shaders, touches memory
  std::vector<double> ms;
  double all = 0;
  while (int(ms.size()) < kFewestRepeats || (int(ms.size()) < kMostRepeats && all < kEnough_ms)) {
    const auto begin = std::chrono::steady_clock::now();
    frame();
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    all += ms.back();
  }
  std::nth_element(ms.begin(), ms.begin() + std::ptrdiff_t(ms.size() / 2), ms.end());
  return ms[ms.size() / 2];
}

/// Two places of a point light, a twentieth of the scene apart about its middle.
std::array<lw_light, 2> lampsOf(const cli::RuntimeContainer& container) {
  lw_scene_info scene;
  container.check(lw_get_scene_info(container.get(), &scene));
  std::array<lw_light, 2> lamps{};
  for (size_t k = 0; k < 2; ++k) {
    lamps[k].type = LW_LIGHT_POINT;
    for (int i = 0; i < 3; ++i) {
      const float middle = 0.5f * (scene.bounds_min_m[i] + scene.bounds_max_m[i]), extent = scene.bounds_max_m[i] - scene.bounds_min_m[i];
      lamps[k].position_m[i] = middle + (k == 0 ? -0.025f : 0.025f) * extent;
      lamps[k].direction[i] = i == 1 ? -1.0f : 0.0f;
      lamps[k].intensity_rgb[i] = 1;
    }
    lamps[k].outer_cone_angle_rad = 0.7853982f;
  }
  return lamps;
}

/// A cube depth map in which nothing is in the way.
render::Texture clearShadowCube() {
  constexpr int kSize = 256;
  render::Texture cube = render::Texture::make();
  render::bindTexture(0, GL_TEXTURE_CUBE_MAP, cube);
  const std::vector<float> far(size_t(kSize) * kSize, 1.0f);
  for (int face = 0; face < 6; ++face)
    glTexImage2D(GLenum(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face), 0, GL_DEPTH_COMPONENT32F, kSize, kSize, 0, GL_DEPTH_COMPONENT, GL_FLOAT, far.data());
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, 0);
  return cube;
}

uint64_t decodedBytes(const format::Reader& reader, const std::string& section) {
  for (const bake::SectionSize& size : bake::sectionSizes(reader))
    if (size.type == section) return size.raw_bytes;
  return 0;
}

void measurePrm(const cli::RuntimeContainer& container, const format::Reader& reader, const FrameSettings& settings, Evaluated& evaluated) {
  const auto prm = container.loadPrm();
  lw_prm_info info;
  container.check(lw_prm_get_info(prm.get(), &info));
  const std::array<lw_light, 2> lamps = lampsOf(container);
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.brightest = settings.brightest;
  std::vector<float> entry_rgb(size_t(info.entries) * 3), cluster_rgb(size_t(info.clusters) * 3), atlas_rgba(size_t(info.width) * info.height * 4);
  std::vector<float> scratch(lw_prm_scratch_bytes(prm.get()) / sizeof(float) + 1);
  evaluated.cpu_ms = medianMs([&](const lw_light& lamp) {
    container.check(lw_prm_entry_irradiance(prm.get(), &lamp, 1, nullptr, nullptr, entry_rgb.data()));
    container.check(lw_prm_cluster_irradiance(prm.get(), entry_rgb.data(), cluster_rgb.data()));
    container.check(lw_prm_evaluate(prm.get(), cluster_rgb.data(), &options, scratch.data(), scratch.size() * sizeof(float), atlas_rgba.data()));
  }, lamps);
  const double texels = double(std::max(info.texels, 1u));
  if (info.layout == LW_PRM_PANES) {  // RGB9E5, one a pane; the place of the texel
    const double panes = settings.brightest && settings.brightest < info.clusters ? settings.brightest : info.clusters;
    evaluated.fetched_bytes_per_texel = 8 + 4 * (panes + (info.has_emitter ? 1 : 0) + (info.has_sky ? 1 : 0));
  } else {  // everything is read once
    evaluated.fetched_bytes_per_texel = double(decodedBytes(reader, "prm")) / texels;
  }
  if (!settings.gl) return;
  const cli::GlContext gl(container);
  lw_gl_prm* raw = nullptr;
  container.check(lw_gl_prm_create(gl.get(), prm.get(), nullptr, &raw));
  const cli::GlPrmHandle gl_prm(raw);
  const render::Texture shadow = clearShadowCube();
  lw_gl_light light = LW_GL_LIGHT_INIT;
  light.shadow = LW_GL_SHADOW_CUBE;
  light.shadow_texture = shadow;
  evaluated.gl_ms = medianMs([&](const lw_light& lamp) {
    light.light = lamp;
    container.check(lw_gl_update_entries(gl_prm.get(), &light, 1));
    container.check(lw_gl_evaluate(gl_prm.get(), &options));
    glFinish();
  }, lamps);
  evaluated.texture_bytes = lw_gl_prm_texture_bytes(gl_prm.get());
}

void measureRadiosity(const cli::RuntimeContainer& container, const format::Reader& reader, const FrameSettings& settings, Evaluated& evaluated) {
  const auto radiosity = container.loadRadiosity();
  const auto state = container.createState(radiosity.get());
  lw_radiosity_info info;
  container.check(lw_radiosity_get_info(radiosity.get(), &info));
  const std::array<lw_light, 2> lamps = lampsOf(container);
  std::vector<float> direct_rgb(size_t(info.patches) * 3), atlas_rgba(size_t(info.width) * info.height * 4);
  lw_radiosity_injector* raw_injector = nullptr;
  container.check(lw_radiosity_injector_create(container.get(), radiosity.get(), kInjectionSide, &raw_injector));
  const std::unique_ptr<lw_radiosity_injector, decltype(&lw_radiosity_injector_destroy)> injector(raw_injector, lw_radiosity_injector_destroy);
  evaluated.cpu_ms = medianMs([&](const lw_light& lamp) {
    container.check(lw_radiosity_inject(injector.get(), &lamp, 1, direct_rgb.data()));
    container.check(lw_radiosity_set_direct(state.get(), direct_rgb.data()));
    container.check(lw_radiosity_step(state.get(), settings.sweeps));
    container.check(lw_radiosity_shade(state.get(), nullptr, atlas_rgba.data()));
  }, lamps);
  // Every sweep reads all links; texels are read once.
  evaluated.fetched_bytes_per_texel = double(decodedBytes(reader, "radiosity")) * settings.sweeps / double(std::max(info.texels, 1u));
  if (!settings.gl) return;
  const cli::GlContext gl(container);
  lw_gl_radiosity* raw = nullptr;
  container.check(lw_gl_radiosity_create(gl.get(), radiosity.get(), nullptr, &raw));
  const cli::GlRadiosityHandle gl_radiosity(raw);
  lw_gl_radiosity_injector* raw_gl_injector = nullptr;
  container.check(lw_gl_radiosity_injector_create(gl_radiosity.get(), container.get(), radiosity.get(), kInjectionSide, &raw_gl_injector));
  const cli::GlRadiosityInjectorHandle gl_injector(raw_gl_injector);
  evaluated.gl_ms = medianMs([&](const lw_light& lamp) {
    container.check(lw_gl_radiosity_inject(gl_injector.get(), &lamp, 1));
    container.check(lw_gl_radiosity_step(gl_radiosity.get(), settings.sweeps));
    container.check(lw_gl_radiosity_shade(gl_radiosity.get(), nullptr));
    glFinish();
  }, lamps);
  evaluated.texture_bytes = lw_gl_radiosity_texture_bytes(gl_radiosity.get());
}

void measureLightmap(const cli::RuntimeContainer& container, const FrameSettings& settings, Evaluated& evaluated) {
  struct Release {
    void operator()(lw_lightmap* map) const { lw_lightmap_release(map); }
    void operator()(lw_gl_lightmap* map) const { lw_gl_lightmap_destroy(map); }
  };
  evaluated.cpu_ms = 0;
  evaluated.fetched_bytes_per_texel = 0;
  if (!settings.gl) return;
  lw_lightmap* raw = nullptr;
  container.check(lw_lightmap_load(container.get(), &raw));
  const std::unique_ptr<lw_lightmap, Release> map(raw);
  const cli::GlContext gl(container);
  lw_gl_lightmap_options options = LW_GL_LIGHTMAP_OPTIONS_INIT;
  lw_gl_lightmap* raw_gl = nullptr;
  const auto begin = std::chrono::steady_clock::now();
  lw_result result = lw_gl_lightmap_create(gl.get(), map.get(), &options, &raw_gl);
  if (result == LW_LIMIT_EXCEEDED) {  // light beyond half floats
    options.atlas_format = LW_GL_ATLAS_RGBA32F;
    result = lw_gl_lightmap_create(gl.get(), map.get(), &options, &raw_gl);
  }
  container.check(result);
  glFinish();
  const std::unique_ptr<lw_gl_lightmap, Release> texture(raw_gl);
  evaluated.load_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  evaluated.gl_ms = 0;
  evaluated.texture_bytes = lw_gl_lightmap_texture_bytes(texture.get());
}

}  // namespace

double dynamicFrameMs(const cli::RuntimeContainer& container, bool incremental, uint32_t lights, uint32_t shadow_side) {
  struct Destroy {
    void operator()(lw_gl_dynamic* scene) const { lw_gl_dynamic_destroy(scene); }
    void operator()(lw_gl_lamp* lamp) const { lw_gl_lamp_destroy(lamp); }
  };
  const cli::GlContext gl(container);
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  lw_gl_dynamic* raw_scene = nullptr;
  container.check(lw_gl_dynamic_create(&config, container.get(), nullptr, &raw_scene));
  const std::unique_ptr<lw_gl_dynamic, Destroy> scene(raw_scene);
  lw_gl_lamp_options options = LW_GL_LAMP_OPTIONS_INIT;
  options.lights = lights, options.shadow_side = shadow_side, options.incremental = incremental;
  lw_gl_lamp* raw_lamp = nullptr;
  container.check(lw_gl_lamp_create(scene.get(), &options, &raw_lamp));
  const std::unique_ptr<lw_gl_lamp, Destroy> lamp(raw_lamp);
  return medianMs([&](const lw_light& light) {
    container.check(lw_gl_lamp_update(lamp.get(), &light, nullptr));
    container.check(lw_gl_dynamic_gather(scene.get(), &raw_lamp, 1, nullptr));
    glFinish();
  }, lampsOf(container));
}

void measureFrame(const cli::RuntimeContainer& container, const format::Reader& reader, const std::string& technique, const FrameSettings& settings, Evaluated& evaluated) {
  if (technique == "prm") measurePrm(container, reader, settings, evaluated);
  else if (technique == "radiosity") measureRadiosity(container, reader, settings, evaluated);
  else if (technique == "lightmap") measureLightmap(container, settings, evaluated);
}

}  // namespace lightwell::report
