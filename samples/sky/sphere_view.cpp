#include "samples/sky/sphere_view.h"

#include <algorithm>
#include <cmath>

#include "render/error.h"
#include "render/shaders.h"
#include "samples/scenes/sample_scene.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {
namespace {

using render::Float3;
using render::Matrix4;
using render::operator*;

constexpr float kSlope = 0.268f;  // tangent of half the vertical field of view
constexpr Float3 kEye{0, 1.9f, 6.4f}, kTarget{0, 0.55f, 0};

const char* const kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 view_projection;
uniform vec3 offset;
out vec3 v_position;
out vec3 v_normal;
void main() {
  v_position = position + offset;
  v_normal = normal;
  gl_Position = view_projection * vec4(v_position, 1.0);
}
)";

const char* const kDepthFragment = "void main() {}\n";

// Diffuse and mirror reflection, the latter by Schlick's approximation of Fresnel's formulas. A Phong lobe of shininess n is as wide as GGX's of
// alpha^2 = 2 / (n + 2).
const char* const kSurfaceFragment = R"(
in vec3 v_position;
in vec3 v_normal;
uniform vec3 eye, albedo;
uniform float roughness, reflectance, exposure;
uniform int phong;
out vec4 color;
void main() {
  vec3 normal = normalize(v_normal), view = normalize(eye - v_position);
  vec3 facing = normalize(cross(dFdx(v_position), dFdy(v_position)));
  if (dot(facing, normal) < 0.0) facing = -facing;
  vec3 mirror = reflect(-view, normal);
  float shininess = 2.0 / pow(roughness, 4.0) - 2.0;
  LwEnvironmentLight light;
  if (phong != 0) {
    light = lwEnvironmentPhong(v_position, facing, normal, mirror, max(shininess, 1.0));
    light.lobe *= (max(shininess, 1.0) + 1.0) / 6.2831853;
  } else {
    light = lwEnvironmentRough(v_position, facing, normal, mirror, roughness);
  }
  float fresnel = reflectance + (1.0 - reflectance) * pow(1.0 - max(dot(normal, view), 0.0), 5.0) * (1.0 - roughness);
  vec3 radiance = albedo * light.irradiance * 0.31830989 * (1.0 - fresnel) + light.lobe * fresnel;
  color = vec4(min(radiance * exposure, vec3(60000.0)), 1.0);
}
)";

std::string withSky(const char* source) { return std::string("#define LW_ENVIRONMENT_CELLS 1024\n") + lw_glsl_source(LW_GLSL_ENVIRONMENT) + source; }

}  // namespace

SphereView::SphereView(lw_gl* gl, const lw_environment* environment, const SphereSettings& settings)
    : settings_(settings),
      depth_program_(kVertex, kDepthFragment),
      surface_program_(kVertex, withSky(kSurfaceFragment)),
      background_program_(render::kBackgroundVertexGlsl, withSky(render::kBackgroundFragmentGlsl)),
      tone_map_program_(render::kScreenVertexGlsl, render::kToneMapFragmentGlsl),
      vertex_array_(render::VertexArray::make()),
      no_attributes_(render::VertexArray::make()),
      buffer_(render::Buffer::make()) {
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.cells = settings.cells;
  options.map_texels = settings.map_texels;
  options.sun_map_texels = settings.sun_map_texels;
  const float low[3] = {-4, 0, -4}, high[3] = {4, 2, 4};
  std::copy_n(low, 3, options.bounds_min_m);
  std::copy_n(high, 3, options.bounds_max_m);
  lw_gl_environment* made = nullptr;
  render::check(lw_gl_environment_create(gl, environment, &options, &made), "the environment on OpenGL");
  environment_.reset(made);
  // Incident metering: middle grey on the ground becomes middle grey (ISO 2720, constant 12.5; saturation at 1.2 · 2^EV).
  const float up[3] = {0, 1, 0};
  float irradiance[3];
  render::check(lw_environment_irradiance(environment, up, nullptr, irradiance), "the irradiance of the ground");
  const float grey = 0.18f / 3.14159265f * (0.2126f * irradiance[0] + 0.7152f * irradiance[1] + 0.0722f * irradiance[2]);
  exposure_ = grey > 0 ? 0.125f / grey / 1.2f : 1.0f;
  addScene();
  moveBall(0);
}

void SphereView::addScene() {
  SampleScene scene = makeSkySpheres();
  Node& ball = scene.nodes.emplace_back();
  addSphere(ball, scene.addMaterial("ball", {0.7f, 0.7f, 0.7f}), Vec3(0, 0, 0), 0.28f, 32, 16);
  std::vector<float> vertices;
  for (const Node& node : scene.nodes)
    for (uint32_t m = 0; m < scene.materials.size(); ++m) {
      const GLint first = GLint(vertices.size() / 6);
      for (const Chart& chart : node.charts)
        if (chart.material == m)
          for (const auto& triangle : chart.triangles)
            for (const uint32_t v : triangle)
              for (const Vec3& vector : {chart.positions[v], chart.normals[v]})
                vertices.insert(vertices.end(), {vector.x, vector.y, vector.z});
      const GLsizei count = GLsizei(vertices.size() / 6) - first;
      const Material& material = scene.materials[m];
      if (count > 0)
        parts_.push_back({first, count, {material.albedo_rgb.x, material.albedo_rgb.y, material.albedo_rgb.z}, material.roughness, &node == &ball});
    }
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(float)), vertices.data(), GL_STATIC_DRAW);
  for (GLuint attribute = 0; attribute < 2; ++attribute) {
    glEnableVertexAttribArray(attribute);
    glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float), reinterpret_cast<const void*>(size_t(attribute) * 3 * sizeof(float)));
  }
  glBindVertexArray(0);
}

void SphereView::moveBall(float t) {
  const float angle = 6.2831853f * t;
  ball_m_ = {2.4f * std::sin(angle), 1.45f, 0.9f * std::cos(angle)};
}

uint32_t SphereView::cells() const { return lw_gl_environment_cells(environment_.get()); }

void SphereView::drawParts(const render::Program& program) const {
  glBindVertexArray(vertex_array_);
  for (const Part& part : parts_) {
    program.set("offset", part.moves ? ball_m_ : Float3{0, 0, 0});
    program.set("albedo", part.albedo_rgb);
    program.set("roughness", part.roughness);
    program.set("reflectance", part.roughness < 1 ? 0.35f : 0.0f);
    glDrawArrays(GL_TRIANGLES, part.first_vertex, part.vertices);
  }
  glBindVertexArray(0);
}

void SphereView::refresh(uint32_t most_maps) {
  const auto draw = [](void* user, uint32_t, const float* view_projection) {
    const auto& view = *static_cast<const SphereView*>(user);
    Matrix4 matrix;
    std::copy_n(view_projection, 16, matrix.begin());
    view.depth_program_.use();
    view.depth_program_.set("view_projection", matrix);
    view.drawParts(view.depth_program_);
  };
  render::check(lw_gl_environment_refresh(environment_.get(), most_maps, draw, this, nullptr), "the depth maps of the sky");
}

render::Image8 SphereView::draw() const {
  const Float3 forward = render::normalized(kTarget - kEye), right = render::normalized(render::cross(forward, Float3{0, 1, 0}));
  const Float3 up = render::cross(right, forward);
  const float aspect = float(settings_.width) / float(settings_.height);
  const Matrix4 view_projection = render::perspective(kSlope * aspect, kSlope, 0.1f, 50) * render::lookAlong(kEye, forward, up);
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  shading.technique = settings_.technique;
  shading.filter_taps = 4;

  target_.resize(settings_.width, settings_.height);
  target_.bind();
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  render::check(lw_gl_bind_environment(environment_.get(), background_program_.name(), 0, 0, &shading), "the background");
  background_program_.use();
  background_program_.set("forward", forward);
  background_program_.set("right", right * (kSlope * aspect));
  background_program_.set("up", up * kSlope);
  background_program_.set("exposure", exposure_);
  glBindVertexArray(no_attributes_);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  render::check(lw_gl_bind_environment(environment_.get(), surface_program_.name(), 0, 0, &shading), "the surfaces");
  surface_program_.use();
  surface_program_.set("view_projection", view_projection);
  surface_program_.set("eye", kEye);
  surface_program_.set("exposure", exposure_);
  surface_program_.set("phong", settings_.lobe == Lobe::phong ? 1 : 0);
  drawParts(surface_program_);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  const GLuint radiance = target_.resolve();

  const render::Texture color =
      render::makeTexture2D(GL_RGBA8, settings_.width, settings_.height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr, GL_NEAREST);
  const render::Framebuffer framebuffer = render::Framebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  glViewport(0, 0, settings_.width, settings_.height);
  tone_map_program_.use();
  tone_map_program_.set("radiance", 0);
  tone_map_program_.set("dither", 0.0f);
  glBindSampler(0, 0);
  render::bindTexture(0, GL_TEXTURE_2D, radiance);
  glBindVertexArray(no_attributes_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  render::Image8 image{settings_.width, settings_.height, std::vector<uint8_t>(size_t(settings_.width) * size_t(settings_.height) * 4)};
  const size_t row = size_t(settings_.width) * 4;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (int y = 0; y < settings_.height; ++y)
    glReadPixels(0, settings_.height - 1 - y, settings_.width, 1, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data() + size_t(y) * row);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

}  // namespace lightwell::samples
