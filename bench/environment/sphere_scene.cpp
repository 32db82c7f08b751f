#include "bench/environment/sphere_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "precompute/bake/sections.h"
#include "render/egl_context.h"
#include "render/error.h"

namespace lightwell::bench {
namespace {

constexpr int kSegments = 96, kRings = 48;

const char* const kDepthVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 view_projection;
void main() { gl_Position = view_projection * vec4(position, 1.0); }
)";
const char* const kScreenVertex =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }";
const char* const kPlaneFragment = R"(
uniform float side, half_m;
uniform int with_lobe;
out vec4 color;
void main() {
  vec3 position = vec3((gl_FragCoord.x / side * 2.0 - 1.0) * half_m, 0.0, (gl_FragCoord.y / side * 2.0 - 1.0) * half_m), up = vec3(0.0, 1.0, 0.0);
  if (with_lobe != 0) {
    LwEnvironmentLight light = lwEnvironmentRough(position, up, up, normalize(vec3(position.x, 1.5, position.z)), 0.3);
    color = vec4(light.irradiance + light.lobe, 1.0);
  } else {
    color = vec4(lwEnvironmentDiffuse(position, up, up), 1.0);
  }
}
)";

std::vector<float> sceneTriangles() {
  std::vector<float> points;
  const auto add = [&](double x, double y, double z) { points.insert(points.end(), {float(x), float(y), float(z)}); };
  const double h = kPlaneHalf_m, r = kSphereRadius_m;
  for (const auto& [x, z] : {std::pair{-h, -h}, {-h, h}, {h, h}, {-h, -h}, {h, h}, {h, -h}}) add(x, 0, z);
  const auto corner = [&](int segment, int ring) {
    const double theta = std::numbers::pi * ring / kRings, phi = 2 * std::numbers::pi * segment / kSegments;
    add(r * std::sin(theta) * std::cos(phi), r + r * std::cos(theta), r * std::sin(theta) * std::sin(phi));
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int s = 0; s < kSegments; ++s)
      for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) corner(s + i, ring + j);
  return points;
}

}  // namespace

SphereScene::SphereScene()
    : depth_program_(kDepthVertex, "void main() {}\n"),
      plane_program_(kScreenVertex, std::string("#define LW_ENVIRONMENT_CELLS 1024\n") + lw_glsl_source(LW_GLSL_ENVIRONMENT) + kPlaneFragment),
      vertices_(render::VertexArray::make()),
      no_attributes_(render::VertexArray::make()),
      buffer_(render::Buffer::make()) {
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  config.message = [](void*, lw_result result, const char* text) { std::fprintf(stderr, "%s: %s\n", lw_result_name(result), text); };
  lw_gl* made = nullptr;
  render::check(lw_gl_create(&config, &made), "OpenGL evaluation");
  gl_.reset(made);
  const std::vector<float> points = sceneTriangles();
  vertex_count_ = int(points.size() / 3);
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(points.size() * sizeof(float)), points.data(), GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindVertexArray(0);
}

SphereScene::~SphereScene() = default;

void SphereScene::setSky(const transport::Environment& environment, uint32_t map_texels) {
  format::Writer writer;
  bake::addEnvironmentSection(writer, environment, {});
  const std::vector<uint8_t> bytes = writer.bytes();
  lw_container* container = nullptr;
  render::check(lw_open_memory(bytes.data(), bytes.size(), nullptr, &container), "the sky's container");
  lw_environment* loaded = nullptr;
  const lw_result load_result = lw_environment_load(container, &loaded);
  lw_close(container);
  render::check(load_result, "the sky");
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.map_texels = map_texels;
  const float low[3] = {-kPlaneHalf_m, 0, -kPlaneHalf_m}, high[3] = {kPlaneHalf_m, 2 * kSphereRadius_m, kPlaneHalf_m};
  std::copy_n(low, 3, options.bounds_min_m);
  std::copy_n(high, 3, options.bounds_max_m);
  lw_gl_environment* made = nullptr;
  const lw_result result = lw_gl_environment_create(gl_.get(), loaded, &options, &made);
  lw_environment_release(loaded);
  render::check(result, "the sky on OpenGL");
  environment_.reset(made);
  drawMaps(cells());
}

uint32_t SphereScene::cells() const { return lw_gl_environment_cells(environment_.get()); }

void SphereScene::drawMaps(uint32_t count) {
  const auto draw = [](void* user, uint32_t, const float* view_projection) {
    const auto& scene = *static_cast<const SphereScene*>(user);
    render::Matrix4 matrix;
    std::copy_n(view_projection, 16, matrix.begin());
    scene.depth_program_.use();
    scene.depth_program_.set("view_projection", matrix);
    glBindVertexArray(scene.vertices_);
    glDrawArrays(GL_TRIANGLES, 0, scene.vertex_count_);
  };
  render::check(lw_gl_environment_refresh(environment_.get(), count, draw, this, nullptr), "the depth maps");
}

void SphereScene::drawPlane(int side, uint32_t technique, bool lobe) {
  if (side != side_) {
    target_ = render::makeTexture2D(GL_RGBA32F, side, side, GL_RGBA, GL_FLOAT, nullptr, GL_NEAREST);
    framebuffer_ = render::Framebuffer::make();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target_, 0);
    side_ = side;
  }
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  shading.technique = technique;
  render::check(lw_gl_bind_environment(environment_.get(), plane_program_.name(), 0, 0, &shading), "the plane");
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, side, side);
  plane_program_.use();
  plane_program_.set("side", float(side));
  plane_program_.set("half_m", kPlaneHalf_m);
  plane_program_.set("with_lobe", lobe ? 1 : 0);
  glBindVertexArray(no_attributes_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

std::vector<float> SphereScene::planeIrradiance(int side, uint32_t technique) {
  drawPlane(side, technique, false);
  std::vector<float> rgba(size_t(side) * size_t(side) * 4);
  glReadPixels(0, 0, side, side, GL_RGBA, GL_FLOAT, rgba.data());
  return rgba;
}

}  // namespace lightwell::bench
