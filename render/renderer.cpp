#include "render/renderer.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "render/error.h"
#include "render/render_target.h"
#include "render/scene_mesh.h"
#include "render/shaders.h"
#include "render/shadow_maps.h"

namespace lightwell::render {
namespace {

constexpr int kAlbedoUnit = 0, kIrradianceUnit = 1, kEmissionUnit = 2, kShadowUnit = 3, kAlphaUnit = 4;
constexpr float kSaturation = 1.2f;           // radiance of saturation at EV 0
constexpr float kMeterConstant = 12.5f / 100; // mean radiance at EV 0 (ISO 2720, ISO 100)
constexpr float kNeutralAlbedo = 0.5f;

struct ReleaseGl {
  void operator()(lw_gl* gl) const { lw_gl_destroy(gl); }
};

std::string lightProgram(bool cube) {
  return std::string(cube ? "#define SHADOW_CUBE\n" : "") + kAlphaGlsl + lw_glsl_source(LW_GLSL_ATLAS) + lw_glsl_source(LW_GLSL_LIGHT) +
         kLightFragmentGlsl;
}

Float3 vector(const float v[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

struct Renderer::Impl {
  Impl(const lw_container* container, lw_gl_proc (*loader)(void*, const char*), void* loader_user, const RendererOptions& options)
      : mesh(container, leavesOf(container, options.portals)),
        shadows(mesh),
        base_program(kSceneVertexGlsl, std::string(kAlphaGlsl) + lw_glsl_source(LW_GLSL_ATLAS) + kBaseFragmentGlsl),
        cube_light_program(kSceneVertexGlsl, lightProgram(true)),
        flat_light_program(kSceneVertexGlsl, lightProgram(false)),
        lamp_program(kLampVertexGlsl, kLampFragmentGlsl),
        tone_map_program(kScreenVertexGlsl, kToneMapFragmentGlsl),
        no_attributes(VertexArray::make()) {
    const float nothing[4] = {};
    no_irradiance = makeTexture2D(GL_RGBA16F, 1, 1, GL_RGBA, GL_FLOAT, nothing, GL_NEAREST);
    lights.resize(mesh.info().light_count);
    for (uint32_t i = 0; i < lights.size(); ++i) check(lw_get_light(container, i, &lights[i]), "the container's lights");
    const bool has_environment = lw_has_section(container, "environment");
    const auto has = [&](const char* section) { return lw_has_section(container, section) != 0; };
    if (!has_environment && !has("prm") && !has("radiosity") && !has("lightmap")) return;
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = loader;
    config.loader_user = loader_user;
    config.message_user = &last_message;
    config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
    lw_gl* made_gl = nullptr;
    checkGl(lw_gl_create(&config, &made_gl), "OpenGL evaluation");
    gl.reset(made_gl);
    if (has_environment) makeEnvironment(container, options.environment);
    // Where the sky itself is there to be drawn, it lights the surfaces too, and its pane must not.
    transport = makeIndirectLight(options.technique, container, gl.get(), options.portals, has_environment, last_message);
  }

  void makeEnvironment(const lw_container* container, const EnvironmentSettings& settings) {
    try {
      environment.emplace(container, gl.get(), mesh, settings);
    } catch (const RenderError& error) {
      // More or fewer cells than can be, or larger maps: this machine's limits, not the container's fault.
      if (error.result != LW_LIMIT_EXCEEDED && error.result != LW_INVALID_ARGUMENT) throw;
      throw RenderError(LW_GL_UNSUPPORTED, "the environment: " + last_message);
    }
  }

  void checkGl(lw_result result, const char* what) const {
    if (result != LW_OK) throw RenderError(result, std::string(what) + ": " + last_message);
  }

  /// Runs `work` and, when measuring, adds its wall time with the GPU's to `sum_ms`.
  template <class Work>
  void timed(double& sum_ms, Work&& work) {
    if (!measure) return work();
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    work();
    glFinish();
    sum_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  /// Brings shadow maps and atlas up to date with the lights and the part of the light that is asked for.
  void updateLight(LightPart part) {
    if (lights_changed) timed(times.shadows_ms, [&] { shadows.update(lights); });
    if (environment) timed(times.environment_ms, [&] { environment->update(); });
    if (transport && (lights_changed || atlas_part != part)) timed(times.transport_ms, [&] { transport->update(part, shadows.maps()); });
    lights_changed = false;
    atlas_part = part;
  }

  Matrix4 viewProjection(const View& view, Float3& eye) const {
    for (size_t axis = 0; axis < 3; ++axis) eye[axis] = float(view.eye_m[axis] - mesh.info().origin_m[axis]);
    const float slope = std::tan(view.vertical_fov_rad / 2), aspect = float(view.width) / float(view.height);
    const float near = 5e-4f * mesh.diagonal_m(), far = std::max(1.01f * mesh.farthest_m(eye), 2 * near);
    return perspective(slope * aspect, slope, near, far) * lookAlong(eye, view.forward, view.up);
  }

  void setSurface(const Program& program, const View& view, const Matrix4& view_projection, float exposure) const {
    program.use();
    program.set("view_projection", view_projection);
    program.set("albedo_atlas", kAlbedoUnit);
    program.set("uniform_albedo", view.lighting_only ? kNeutralAlbedo : -1.0f);
    program.set("exposure", exposure);
  }

  /// The picture's radiance times `exposure` into `target`, resolved.
  GLuint drawRadiance(const View& view, float exposure, RenderTarget& target) {
    Float3 eye;
    const Matrix4 view_projection = viewProjection(view, eye);
    target.resize(view.width, view.height);
    target.bind();
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
    const Float3 background = view.background_radiance_rgb * exposure;
    glClearColor(std::min(background[0], 6e4f), std::min(background[1], 6e4f), std::min(background[2], 6e4f), 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const bool shows_sky = environment && view.part != LightPart::indirect;
    if (shows_sky) {
      const Float3 right = normalized(cross(view.forward, view.up)), up = cross(right, view.forward);
      const float slope = std::tan(view.vertical_fov_rad / 2), aspect = float(view.width) / float(view.height);
      environment->drawBackground(view.forward, right * (slope * aspect), up * slope, exposure);
    }
    for (const SceneMesh::Kind kind : {SceneMesh::Kind::solid, SceneMesh::Kind::blended}) {
      drawBase(kind, view, view_projection, exposure);
      if (shows_sky) drawEnvironment(kind, view, view_projection, exposure);
      if (view.part != LightPart::indirect && !(transport && transport->hasLamps()))
        for (const ShadowMap& map : shadows.maps()) drawLight(kind, map, view, view_projection, exposure);
    }
    if (view.show_lamps) drawLamps(view, view_projection);
    return target.resolve();
  }

  void drawBase(SceneMesh::Kind kind, const View& view, const Matrix4& view_projection, float exposure) const {
    setSurface(base_program, view, view_projection, exposure);
    base_program.set("irradiance_atlas", kIrradianceUnit);
    base_program.set("emission_atlas", kEmissionUnit);
    base_program.set("emission_scale", view.part == LightPart::indirect ? 0.0f : 1.0f);
    bindTexture(kAlbedoUnit, GL_TEXTURE_2D, mesh.albedoAtlas());
    bindTexture(kIrradianceUnit, GL_TEXTURE_2D, transport ? transport->atlas() : no_irradiance);
    bindTexture(kEmissionUnit, GL_TEXTURE_2D, mesh.emissionAtlas());
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    if (kind == SceneMesh::Kind::blended) {
      glEnable(GL_BLEND);
      glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    } else {
      glDisable(GL_BLEND);
    }
    mesh.draw(kind, base_program, kAlphaUnit, true);
  }

  /// Adds light to the surfaces that drawBase has drawn, and to nothing else.
  void addToSurfaces(SceneMesh::Kind kind, const Program& program) const {
    bindTexture(kAlbedoUnit, GL_TEXTURE_2D, mesh.albedoAtlas());
    glDepthFunc(GL_EQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    mesh.draw(kind, program, kAlphaUnit, true);
    glDepthMask(GL_TRUE);
  }

  void drawEnvironment(SceneMesh::Kind kind, const View& view, const Matrix4& view_projection, float exposure) const {
    environment->bind();
    setSurface(environment->surfaceProgram(), view, view_projection, exposure);
    addToSurfaces(kind, environment->surfaceProgram());
  }

  void drawLight(SceneMesh::Kind kind, const ShadowMap& map, const View& view, const Matrix4& view_projection, float exposure) const {
    const bool cube = map.light.shadow == LW_GL_SHADOW_CUBE;
    const Program& program = cube ? cube_light_program : flat_light_program;
    setSurface(program, view, view_projection, exposure);
    float packed[16];
    check(lw_gl_pack_light(&map.light.light, packed), "a light");
    program.set4("light.position_range", packed);
    program.set4("light.direction_type", packed + 4);
    program.set4("light.intensity", packed + 8);
    program.set4("light.spot", packed + 12);
    program.set("texel_slope", map.texel_slope);
    program.set("depth_bias", map.light.depth_bias);
    program.set2("shadow_planes", map.light.near_m, map.light.far_m);
    Matrix4 shadow_matrix;
    std::copy(std::begin(map.light.shadow_matrix), std::end(map.light.shadow_matrix), shadow_matrix.begin());
    program.set("shadow_matrix", shadow_matrix);
    program.set("shadow_texel", 1 / float(map.resolution));
    program.set("shadow_map", kShadowUnit);
    bindTexture(kShadowUnit, cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D, map.texture);
    addToSurfaces(kind, program);
  }

  void drawLamps(const View& view, const Matrix4& view_projection) const {
    const Float3 right = normalized(cross(view.forward, view.up)), up = cross(right, view.forward);
    const float radius = std::min(0.35f, 0.02f * mesh.diagonal_m());
    lamp_program.use();
    lamp_program.set("view_projection", view_projection);
    lamp_program.set("right", right * radius);
    lamp_program.set("up", up * radius);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(no_attributes);
    for (const lw_light& light : lights) {
      const Float3 intensity = vector(light.intensity_rgb);
      const float brightest = std::max({intensity[0], intensity[1], intensity[2]});
      if (light.type == LW_LIGHT_DIRECTIONAL || !(brightest > 0)) continue;
      lamp_program.set("center", vector(light.position_m));
      lamp_program.set("hue", intensity * (1 / brightest));
      glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
    glBindVertexArray(0);
    glDepthMask(GL_TRUE);
  }

  void draw(const View& view, GLuint framebuffer, bool dither) {
    const float ev = view.exposure_ev ? *view.exposure_ev : meter(view);
    times = {};
    updateLight(view.part);
    timed(times.shading_ms, [&] {
      const GLuint radiance = drawRadiance(view, std::exp2(-ev) / kSaturation, target);
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
      glViewport(0, 0, view.width, view.height);
      glDisable(GL_DEPTH_TEST);
      glDisable(GL_BLEND);
      glDisable(GL_CULL_FACE);
      tone_map_program.use();
      tone_map_program.set("radiance", 0);
      tone_map_program.set("dither", dither ? 1.0f : 0.0f);
      bindTexture(0, GL_TEXTURE_2D, radiance);
      glBindVertexArray(no_attributes);
      glDrawArrays(GL_TRIANGLES, 0, 3);
      glBindVertexArray(0);
    });
  }

  float meter(const View& view) {
    View small = view;
    const float scale = std::min(1.0f, 96.0f / float(std::max(view.width, view.height)));
    small.width = std::max(1, int(float(view.width) * scale));
    small.height = std::max(1, int(float(view.height) * scale));
    small.show_lamps = false;
    updateLight(view.part);
    // The stored halfs span 2^-14 to 60000: a few steps bring any scene's mean into their middle.
    float ev = metered_ev;
    std::vector<float> rgba(size_t(small.width) * size_t(small.height) * 4);
    for (int step = 0; step < 8; ++step) {
      drawRadiance(small, std::exp2(-ev) / kSaturation, meter_target);
      glBindFramebuffer(GL_FRAMEBUFFER, meter_target.resolvedFramebuffer());
      glPixelStorei(GL_PACK_ALIGNMENT, 4);
      glReadPixels(0, 0, small.width, small.height, GL_RGBA, GL_FLOAT, rgba.data());
      double log_sum = 0;
      size_t lit = 0, saturated = 0;
      for (size_t i = 0; i < rgba.size(); i += 4) {
        const float y = 0.2126f * rgba[i] + 0.7152f * rgba[i + 1] + 0.0722f * rgba[i + 2];
        if (!(y > 1e-6f)) continue;
        log_sum += std::log2(double(y));
        ++lit;
        if (y > 3e4f) ++saturated;
      }
      if (lit == 0) {
        // Black, or far too dark for half floats: look again with a longer exposure.
        if (ev < -60) return metered_ev = 0;
        ev -= 14;
        continue;
      }
      const float step_ev = float(log_sum / double(lit)) + std::log2(kSaturation / kMeterConstant);
      ev += step_ev;
      if (saturated * 10 < lit && std::abs(step_ev) < 6) return metered_ev = ev;
    }
    return metered_ev = ev;
  }

  // Destroyed in reverse order: the transport before the lw_gl that made it.
  std::string last_message;
  SceneMesh mesh;
  ShadowMaps shadows;
  Program base_program, cube_light_program, flat_light_program, lamp_program, tone_map_program;
  VertexArray no_attributes;
  Texture no_irradiance;
  std::unique_ptr<lw_gl, ReleaseGl> gl;
  std::unique_ptr<IndirectLight> transport;
  std::optional<EnvironmentLight> environment;
  RenderTarget target, meter_target;
  std::vector<lw_light> lights;
  bool lights_changed = true;
  std::optional<LightPart> atlas_part;
  float metered_ev = 0;
  bool measure = false;
  FrameTimes times;
};

Renderer::Renderer(const lw_container* container, lw_gl_proc (*loader)(void*, const char*), void* loader_user,
                   const RendererOptions& options)
    : impl_(std::make_unique<Impl>(container, loader, loader_user, options)) {}
Renderer::~Renderer() = default;

void Renderer::setLights(std::span<const lw_light> lights) {
  impl_->lights.assign(lights.begin(), lights.end());
  impl_->lights_changed = true;
}
const std::vector<lw_light>& Renderer::lights() const { return impl_->lights; }
const lw_scene_info& Renderer::sceneInfo() const { return impl_->mesh.info(); }
bool Renderer::hasTransport() const { return impl_->transport != nullptr; }
bool Renderer::hasEnvironment() const { return impl_->environment.has_value(); }
void Renderer::draw(const View& view, uint32_t framebuffer) { impl_->draw(view, framebuffer, true); }
float Renderer::meterExposure(const View& view) { return impl_->meter(view); }
void Renderer::measureTimes(bool on) { impl_->measure = on; }
const FrameTimes& Renderer::times() const { return impl_->times; }

Image8 Renderer::render(const View& view) {
  const Texture color = makeTexture2D(GL_RGBA8, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr, GL_NEAREST);
  const Framebuffer framebuffer = Framebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  impl_->draw(view, framebuffer, false);
  Image8 image{view.width, view.height, std::vector<uint8_t>(size_t(view.width) * size_t(view.height) * 4)};
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  const size_t row = size_t(view.width) * 4;
  for (int y = 0; y < view.height / 2; ++y)
    std::swap_ranges(image.rgba.begin() + long(size_t(y) * row), image.rgba.begin() + long((size_t(y) + 1) * row),
                     image.rgba.begin() + long(size_t(view.height - 1 - y) * row));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (glGetError() == GL_OUT_OF_MEMORY) throw RenderError(LW_OUT_OF_MEMORY, "the picture");
  return image;
}

}  // namespace lightwell::render
