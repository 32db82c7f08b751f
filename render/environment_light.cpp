#include "render/environment_light.h"

#include <algorithm>

#include "render/error.h"
#include "render/shaders.h"

namespace lightwell::render {
namespace {

constexpr uint32_t kFirstUnit = 8, kBinding = 0;  // beyond the renderer's own units

struct Release {
  void operator()(lw_environment* environment) const { lw_environment_release(environment); }
};

std::unique_ptr<lw_environment, Release> load(const lw_container* container) {
  lw_environment* loaded = nullptr;
  check(lw_environment_load(container, &loaded), "the container's environment");
  return std::unique_ptr<lw_environment, Release>(loaded);
}

std::string withSky(uint32_t cells, const std::string& source) {
  return "#define LW_ENVIRONMENT_CELLS " + std::to_string(std::max(cells, 256u)) + "\n" + lw_glsl_source(LW_GLSL_ENVIRONMENT) + source;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const lw_container* container, lw_gl* gl, const SceneMesh& mesh, const EnvironmentSettings& settings)
    : mesh_(mesh),
      settings_(settings),
      depth_program_(kSceneVertexGlsl, std::string(kAlphaGlsl) + kDepthFragmentGlsl),
      no_attributes_(VertexArray::make()) {
  const auto environment = load(container);
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.cells = settings.cells;
  options.map_texels = settings.map_texels;
  options.sun_map_texels = settings.sun_map_texels;
  const lw_scene_info& scene = mesh.info();
  if (scene.bounds_min_m[0] <= scene.bounds_max_m[0]) {
    std::copy_n(scene.bounds_min_m, 3, options.bounds_min_m);
    std::copy_n(scene.bounds_max_m, 3, options.bounds_max_m);
  }
  lw_gl_environment* made = nullptr;
  check(lw_gl_environment_create(gl, environment.get(), &options, &made), "the environment on OpenGL");
  environment_.reset(made);
  const uint32_t cells = lw_gl_environment_cells(made);
  surface_program_ = Program(kSceneVertexGlsl, withSky(cells, std::string(kAlphaGlsl) + lw_glsl_source(LW_GLSL_ATLAS) + kEnvironmentFragmentGlsl));
  background_program_ = Program(kBackgroundVertexGlsl, withSky(cells, kBackgroundFragmentGlsl));
  point_program_ = Program(kScreenVertexGlsl, withSky(cells, kEnvironmentPointFragmentGlsl));
}

void EnvironmentLight::update() {
  if (has_maps_ || settings_.technique == LW_ENVIRONMENT_UNSHADOWED) return;
  const auto draw = [](void* user, uint32_t, const float* matrix) { static_cast<const EnvironmentLight*>(user)->drawCasters(matrix); };
  check(lw_gl_environment_refresh(environment_.get(), lw_gl_environment_cells(environment_.get()), draw, this, nullptr), "the depth maps of the sky");
  has_maps_ = true;
}

void EnvironmentLight::drawCasters(const float view_projection[16]) const {
  Matrix4 matrix;
  std::copy_n(view_projection, 16, matrix.begin());
  depth_program_.use();
  depth_program_.set("view_projection", matrix);
  mesh_.draw(SceneMesh::Kind::solid, depth_program_, 0, false);
  mesh_.draw(SceneMesh::Kind::blended, depth_program_, 0, false);
}

void EnvironmentLight::bindTo(const Program& program) const {
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  shading.technique = settings_.technique;
  shading.filter_taps = 4;
  check(lw_gl_bind_environment(environment_.get(), program.name(), kFirstUnit, kBinding, &shading), "the environment on OpenGL");
}

void EnvironmentLight::bind() const { bindTo(surface_program_); }

void EnvironmentLight::drawBackground(const Float3& forward, const Float3& right, const Float3& up, float exposure) const {
  bindTo(background_program_);
  background_program_.use();
  background_program_.set("forward", forward);
  background_program_.set("right", right);
  background_program_.set("up", up);
  background_program_.set("exposure", exposure);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(no_attributes_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

std::vector<Float3> EnvironmentLight::irradianceAt(std::span<const EnvironmentPoint> points) const {
  constexpr int kWidth = 1024, kMostRows = 256;
  std::vector<Float3> irradiance;
  irradiance.reserve(points.size());
  for (size_t first = 0; first < points.size(); first += size_t(kWidth) * kMostRows) {
    const auto part = points.subspan(first, std::min(points.size() - first, size_t(kWidth) * kMostRows));
    const int rows = int((part.size() + kWidth - 1) / kWidth);
    constexpr int kFields = 3;
    std::vector<float> values[kFields];
    for (auto& list : values) list.resize(size_t(rows) * kWidth * 3);
    for (size_t i = 0; i < part.size(); ++i) {
      const Float3* const fields[kFields] = {&part[i].position_m, &part[i].facing, &part[i].normal};
      for (size_t f = 0; f < kFields; ++f) std::copy_n(fields[f]->data(), 3, &values[f][i * 3]);
    }
    const Texture target = makeTexture2D(GL_RGBA32F, kWidth, rows, GL_RGBA, GL_FLOAT, nullptr, GL_NEAREST);
    Texture textures[kFields];
    for (size_t f = 0; f < kFields; ++f)
      textures[f] = makeTexture2D(GL_RGB32F, kWidth, rows, GL_RGB, GL_FLOAT, values[f].data(), GL_NEAREST);
    const Framebuffer framebuffer = Framebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target, 0);
    glViewport(0, 0, kWidth, rows);
    for (const GLenum off : {GL_SCISSOR_TEST, GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE}) glDisable(off);
    bindTo(point_program_);
    point_program_.use();
    constexpr const char* kNames[kFields] = {"positions", "facings", "normals"};
    for (int f = 0; f < kFields; ++f) {
      point_program_.set(kNames[f], f);
      glBindSampler(GLuint(f), 0);
      bindTexture(f, GL_TEXTURE_2D, textures[f]);
    }
    glBindVertexArray(no_attributes_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    std::vector<float> rgba(size_t(rows) * kWidth * 4);
    glReadPixels(0, 0, kWidth, rows, GL_RGBA, GL_FLOAT, rgba.data());
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    for (size_t i = 0; i < part.size(); ++i) irradiance.push_back({rgba[i * 4], rgba[i * 4 + 1], rgba[i * 4 + 2]});
  }
  return irradiance;
}

}  // namespace lightwell::render
