// A sky in the game's shaders against the CPU: unoccluded, cell by cell, and behind casters.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "lightwell/lightwell_gl.h"
#include "precompute/bake/sections.h"
#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/reflectivity.h"
#include "tests/environment/skies.h"
#include "tests/runtime/gl_program.h"
#include "tests/runtime/support.h"

namespace lightwell {
namespace {

using namespace transport;
using test::Api;
using test::ListProgram;

Environment bakeOf(const std::function<Rgb(const Vec3&)>& radiance, uint32_t samples) {
  EnvironmentMap map = makeSky(256, 128, radiance);
  Diagnostics diagnostics;
  EnvironmentSettings settings;
  settings.decomposition.samples = samples;
  return bakeEnvironment(map, settings, diagnostics, nullptr);
}

/// The outdoor sky; baked once for all tests of the program.
const Environment& outdoors(uint32_t samples) {
  static std::map<uint32_t, Environment> baked;
  const auto found = baked.find(samples);
  return found != baked.end() ? found->second : baked.emplace(samples, bakeOf(outdoorRadiance, samples)).first->second;
}

std::vector<Vec3> directions(uint32_t count) {
  std::vector<Vec3> result;
  const Sampler sampler(29, 6);
  for (uint32_t i = 0; i < count; ++i) result.push_back(uniformDirection(sampler.get2D(i, 0)));
  return result;
}

std::vector<float> listOf(const std::vector<Vec3>& vectors) {
  std::vector<float> list;
  for (const Vec3& v : vectors) list.insert(list.end(), {v.x, v.y, v.z, 0});
  return list;
}

Rgb rgbAt(const std::vector<float>& rgba, size_t i) { return {rgba[i * 4], rgba[i * 4 + 1], rgba[i * 4 + 2]}; }

struct RelativeRms {
  double difference = 0, power = 0;
  void add(const Rgb& exact, const Rgb& answer) { difference += (answer - exact).length2(), power += exact.length2(); }
  double value() const { return std::sqrt(difference / power); }
};

struct Release {
  void operator()(lw_gl* gl) const { lw_gl_destroy(gl); }
  void operator()(lw_gl_environment* environment) const { lw_gl_environment_destroy(environment); }
  void operator()(lw_environment* environment) const { lw_environment_release(environment); }
};

/// Boxes as casters, drawn as the callback must.
class Casters {
 public:
  explicit Casters(Api api) : api_(api) {
    glGenVertexArrays(1, &vertex_array_);
    glGenBuffers(1, &buffer_);
    const std::string version = api == Api::desktop33 ? "#version 330 core\n" : "#version 300 es\nprecision highp float;\n";
    const std::string vertex = version + "layout(location = 0) in vec3 p; uniform mat4 m; void main() { gl_Position = m * vec4(p, 1.0); }";
    const std::string fragment = version + "void main() {}";
    program_ = glCreateProgram();
    for (const auto& [type, text] : {std::pair{GL_VERTEX_SHADER, &vertex}, {GL_FRAGMENT_SHADER, &fragment}}) {
      const GLuint shader = glCreateShader(GLenum(type));
      const char* pointer = text->c_str();
      glShaderSource(shader, 1, &pointer, nullptr);
      glCompileShader(shader);
      glAttachShader(program_, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(program_);
  }
  ~Casters() {
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteBuffers(1, &buffer_);
    glDeleteProgram(program_);
  }
  void addBox(const Vec3& low, const Vec3& high) {
    for (int axis = 0; axis < 3; ++axis)
      for (const float at : {low[axis], high[axis]}) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3 corner[4];
        for (int k = 0; k < 4; ++k) {
          corner[k][axis] = at;
          corner[k][u] = k == 1 || k == 2 ? high[u] : low[u];
          corner[k][v] = k >= 2 ? high[v] : low[v];
        }
        for (const int k : {0, 1, 2, 0, 2, 3}) points_.push_back(corner[k]);
      }
  }
  void draw(uint32_t cell, const float* matrix) {
    drawn.push_back(cell);
    GLint before = 0;
    glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &before);  // the library leaves this one alone, so the game has to
    glUseProgram(program_);
    glUniformMatrix4fv(glGetUniformLocation(program_, "m"), 1, GL_FALSE, matrix);
    glBindVertexArray(vertex_array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(points_.size() * sizeof(Vec3)), points_.data(), GL_STREAM_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glDrawArrays(GL_TRIANGLES, 0, GLsizei(points_.size()));
    glBindBuffer(GL_ARRAY_BUFFER, GLuint(before));
  }
  static void callback(void* user, uint32_t cell, const float* matrix) { static_cast<Casters*>(user)->draw(cell, matrix); }
  std::vector<uint32_t> drawn;

 private:
  Api api_;
  GLuint vertex_array_ = 0, buffer_ = 0, program_ = 0;
  std::vector<Vec3> points_;
};

class GlEnvironment : public testing::TestWithParam<Api> {
 protected:
  GlEnvironment() : context(GetParam()) {}
  void SetUp() override {
    ASSERT_TRUE(context.good()) << "no surfaceless EGL context";
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = test::GlContext::load;
    config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
    config.message_user = &message;
    lw_gl* made = nullptr;
    ASSERT_EQ(lw_gl_create(&config, &made), LW_OK) << message;
    gl.reset(made);
  }
  void TearDown() override { EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)); }

  void load(const Environment& given) {
    format::Writer writer;
    bake::addEnvironmentSection(writer, given, {});
    bytes = writer.bytes();
    const test::Container container = test::openMemory(bytes);
    lw_environment* loaded = nullptr;
    ASSERT_EQ(lw_environment_load(container.get(), &loaded), LW_OK);
    environment.reset(loaded);
  }
  void upload(const lw_gl_environment_options& options = LW_GL_ENVIRONMENT_OPTIONS_INIT) {
    lw_gl_environment* made = nullptr;
    ASSERT_EQ(lw_gl_environment_create(gl.get(), environment.get(), &options, &made), LW_OK) << message;
    gl_environment.reset(made);
  }
  ListProgram program(const std::string& expression) const {
    return ListProgram(GetParam(), lw_glsl_source(LW_GLSL_ENVIRONMENT), expression);
  }
  std::vector<float> run(const ListProgram& program, const std::vector<Vec3>& a, const std::vector<Vec3>& b, float n = 0,
                         uint32_t technique = LW_ENVIRONMENT_SHARE) {
    lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
    shading.technique = technique;
    EXPECT_EQ(lw_gl_bind_environment(gl_environment.get(), program.name(), 2, 1, &shading), LW_OK) << message;
    return program.run(listOf(a), listOf(b), n);
  }

  test::GlContext context;
  std::string message;
  std::unique_ptr<lw_gl, Release> gl;
  std::vector<uint8_t> bytes;
  std::unique_ptr<lw_environment, Release> environment;
  std::unique_ptr<lw_gl_environment, Release> gl_environment;
};
INSTANTIATE_TEST_SUITE_P(Contexts, GlEnvironment, testing::Values(Api::desktop33, Api::embedded30),
                         [](const auto& info) { return info.param == Api::desktop33 ? "Core33" : "Es30"; });

TEST_P(GlEnvironment, UnoccludedLightIsTheCpus) {
  load(outdoors(128));
  upload();
  const std::vector<Vec3> axes = directions(400);
  const ListProgram lobe = program("lwEnvironmentLobe(a.xyz, n)"), ggx = program("lwEnvironmentGgx(a.xyz, n)"),
                    diffuse = program("lwEnvironmentIrradiance(a.xyz)");
  const auto compare = [&](const ListProgram& of, float n, auto&& answer) {
    const std::vector<float> pixels = run(of, axes, axes, n);
    RelativeRms error;
    for (size_t i = 0; i < axes.size(); ++i) {
      Rgb expected;
      EXPECT_EQ(answer(&axes[i].x, &expected.x), LW_OK);
      error.add(expected, rgbAt(pixels, i));
    }
    return error.value();
  };
  EXPECT_LT(compare(diffuse, 1, [&](const float* axis, float* rgb) {
              return lw_environment_irradiance(environment.get(), axis, nullptr, rgb);
            }), 0.004);
  for (const float n : {1.0f, 1.7f, 2.9f, 10.0f, 47.0f, 100.0f, 333.0f, 1000.0f, 1345.0f, 2e4f, 1e5f})
    EXPECT_LT(compare(lobe, n, [&](const float* axis, float* rgb) {
                return lw_environment_phong(environment.get(), axis, n, nullptr, rgb);
              }), 0.01) << n;
  for (const float roughness : {0.0f, 0.1f, 0.31f, 0.5f, 0.74f, 1.0f})
    EXPECT_LT(compare(ggx, roughness, [&](const float* axis, float* rgb) {
                return lw_environment_ggx(environment.get(), axis, roughness, nullptr, rgb);
              }), 0.01) << roughness;
}

/// Irradiance has an edge where a lamp crosses the horizon: a floor with lamps all around at its own height.
TEST_P(GlEnvironment, LampsAtTheHorizonLightAFloor) {
  load(bakeOf([](const Vec3& d) { return std::abs(d.y) < 0.2f ? Rgb(5, 5, 5) : Rgb(0.05f, 0.05f, 0.05f); }, 32));
  upload();
  const std::vector<Vec3> up{{0, 1, 0}, Vec3(0.02f, 1, 0.01f).normalized()};
  const std::vector<float> pixels = run(program("lwEnvironmentIrradiance(a.xyz)"), up, up, 1);
  for (size_t i = 0; i < up.size(); ++i) {
    Rgb expected;
    ASSERT_EQ(lw_environment_irradiance(environment.get(), &up[i].x, nullptr, &expected.x), LW_OK);
    EXPECT_NEAR(rgbAt(pixels, i).x / expected.x, 1, 0.002) << i;
  }
}

/// Cells of every size, one at a time: no cancellation in the shader's floats.
TEST_P(GlEnvironment, CellsOfAnySizeAreTheCpus) {
  Environment one;
  one.sky.face_cells = 16;
  one.sky.value.assign(6 * 17 * 17 * 3, 0);
  one.cells.cos_radius = {0};
  for (const float radius : {1e-4f, 1e-3f, 0.02f, 0.3f, 1.2f, 3.14159f}) {
    const Vec3 direction = Vec3(0.3f, 0.5f, -0.7f).normalized();
    const float depth = 2 * std::pow(std::sin(radius / 2), 2.0f), variance = std::min(0.25f, 0.25f * radius * radius);
    one.cells.direction = {direction};
    one.cells.flux_rgb = {Rgb(1, 1, 1)};
    one.cells.solid_angle_sr = {2 * kPi * depth};
    one.cells.spread = {0.5f * depth};
    one.cells.covariance = {{variance, 0.1f * variance, 0.8f * variance}};
    load(one);
    upload();
    Vec3 tangent, bitangent;
    orthonormalBasis(direction, tangent, bitangent);
    std::vector<Vec3> mirrors;
    for (const float angle : {0.0f, 1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f, 1.2f, 2.0f})
      mirrors.push_back((direction * std::cos(angle) + (tangent * 0.6f + bitangent * 0.8f) * std::sin(angle)).normalized());
    const CellShape cell = cellShape(one.cells, 0);
    // Upward surfaces, so that the cell is above and nothing is hidden: the shadowed sum has this one term.
    const ListProgram lobe = program("lwEnvironmentPhong(vec3(0.0), b.xyz, b.xyz, a.xyz, n).lobe"),
                      cosine = program("lwEnvironmentDiffuse(vec3(0.0), b.xyz, a.xyz)");
    for (const auto& [technique, model] : {std::pair{LW_ENVIRONMENT_SUM, Reflectivity::spread}, {LW_ENVIRONMENT_SUM_PAPER, Reflectivity::paper}}) {
      for (const float n : {1.0f, 2.0f, 30.0f, 1e3f, 1e5f}) {
        const std::vector<float> pixels = run(lobe, mirrors, std::vector<Vec3>(mirrors.size(), direction), n, uint32_t(technique));
        for (size_t i = 0; i < mirrors.size(); ++i) {
          const float expected = averageCosinePower(model, cell, mirrors[i], n);
          EXPECT_NEAR(pixels[i * 4], expected, 2e-3f * expected + 1e-6f) << radius << " " << n << " " << i << " " << technique;
        }
      }
      const std::vector<float> pixels = run(cosine, mirrors, std::vector<Vec3>(mirrors.size(), direction), 1, uint32_t(technique));
      for (size_t i = 0; i < mirrors.size(); ++i)
        EXPECT_NEAR(pixels[i * 4], averageCosine(model, cell, mirrors[i]), 1e-4f) << radius << " " << i << " " << technique;
    }
  }
}

TEST_P(GlEnvironment, HarmonicsAndTheBackgroundAreTheSky) {
  load(bakeOf([](const Vec3& d) { return Rgb(1 + 0.5f * d.x, 2 + d.y * d.z, 1.5f + d.y); }, 32));
  upload();
  const std::vector<Vec3> axes = directions(100);
  const auto harmonic = run(program("lwEnvironmentHarmonicIrradiance(a.xyz)"), axes, axes);
  const auto radiance = run(program("lwEnvironmentRadiance(a.xyz)"), axes, axes);
  for (size_t i = 0; i < axes.size(); ++i) {
    const Vec3 d = axes[i];
    // Bands are scaled by pi, 2 pi / 3 and pi / 4.
    EXPECT_NEAR(harmonic[i * 4], kPi * (1 + 0.5f * d.x * 2 / 3), 3e-3);
    EXPECT_NEAR(harmonic[i * 4 + 1], kPi * (2 + d.y * d.z / 4), 6e-3);
    EXPECT_NEAR(radiance[i * 4], 1 + 0.5f * d.x, 1.5e-2);
    EXPECT_NEAR(radiance[i * 4 + 2], 1.5f + d.y, 2.5e-2);
  }
}

TEST_P(GlEnvironment, AnOpenPlaneDoesNotShadowItself) {
  load(outdoors(64));
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.map_texels = 64;
  const float low[3] = {-5, -0.1f, -5}, high[3] = {5, 0.5f, 5};
  std::copy(low, low + 3, options.bounds_min_m);
  std::copy(high, high + 3, options.bounds_max_m);
  upload(options);
  Casters casters(GetParam());
  casters.addBox({-5, -0.1f, -5}, {5, 0, 5});
  uint32_t refreshed = 0;
  ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1000, Casters::callback, &casters, &refreshed), LW_OK);
  EXPECT_EQ(refreshed, lw_gl_environment_cells(gl_environment.get()));
  std::vector<Vec3> points;
  for (const Vec3& d : directions(200)) points.push_back({4.5f * d.x, 0, 4.5f * d.z});
  const Vec3 up(0, 1, 0);
  Rgb expected;
  ASSERT_EQ(lw_environment_irradiance(environment.get(), &up.x, nullptr, &expected.x), LW_OK);
  const auto pixels = run(program("lwEnvironmentDiffuse(a.xyz, b.xyz, b.xyz)"), points, std::vector<Vec3>(points.size(), up));
  for (size_t i = 0; i < points.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixels[i * 4 + size_t(c)] / expected[c], 1, 0.004) << i;
}

TEST_P(GlEnvironment, ClosedRoomsAreDark) {
  load(outdoors(64));
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  for (int k = 0; k < 3; ++k) options.bounds_min_m[k] = -2, options.bounds_max_m[k] = 2;
  upload(options);
  Casters casters(GetParam());
  casters.addBox({-2, -2, -2}, {2, 2, 2});
  ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1000, Casters::callback, &casters, nullptr), LW_OK);
  const std::vector<Vec3> normals = directions(100);
  std::vector<Vec3> points;
  for (const Vec3& n : directions(100)) points.push_back(n * 1.5f);
  for (const char* expression : {"lwEnvironmentDiffuse(a.xyz, b.xyz, b.xyz)", "lwEnvironmentPhong(a.xyz, b.xyz, b.xyz, b.xyz, 40.0).lobe",
                                 "lwEnvironmentRough(a.xyz, b.xyz, b.xyz, b.xyz, 0.3).lobe"})
    for (const uint32_t technique : {LW_ENVIRONMENT_SHARE, LW_ENVIRONMENT_SUM, LW_ENVIRONMENT_SUM_PAPER})
      for (const float value : run(program(expression), points, normals, 0, technique))
        EXPECT_TRUE(value == 0 || value == 1) << expression << " " << technique;  // alpha is 1
}

/// A wall that hides x > 0 from the origin: the light of the rest, as the CPU has it from the visibility of the cells' centres.
TEST_P(GlEnvironment, ShadowedLightIsTheCpus) {
  const Environment& sky = outdoors(128);
  load(sky);
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.map_texels = 512;
  for (int k = 0; k < 3; ++k) options.bounds_min_m[k] = -1, options.bounds_max_m[k] = 1;
  upload(options);
  Casters casters(GetParam());
  casters.addBox({0.3f, -1, -1}, {0.4f, 1, 1});
  ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1000, Casters::callback, &casters, nullptr), LW_OK);
  std::vector<float> visibility;
  for (const Vec3& d : sky.cells.direction) {
    const Vec3 hit = d * (0.3f / std::max(d.x, 1e-6f));
    visibility.push_back(d.x > 0 && std::abs(hit.y) < 1 && std::abs(hit.z) < 1 ? 0.0f : 1.0f);
  }
  std::vector<Vec3> normals;
  for (const Vec3& n : directions(300))
    if (n.y > 0.1f) normals.push_back(n);
  // Cells below the surface are hidden by it.
  const auto seen = [&](const Vec3& normal) {
    std::vector<float> v = visibility;
    for (size_t i = 0; i < v.size(); ++i)
      if (sky.cells.direction[i].dot(normal) <= 0) v[i] = 0;
    return v;
  };
  const std::vector<Vec3> origin(normals.size(), Vec3(0));
  RelativeRms diffuse, glossy;
  const auto irradiance = run(program("lwEnvironmentDiffuse(a.xyz, b.xyz, b.xyz)"), origin, normals);
  const auto lobe = run(program("lwEnvironmentPhong(a.xyz, b.xyz, b.xyz, b.xyz, 30.0).lobe"), origin, normals);
  for (size_t i = 0; i < normals.size(); ++i) {
    Rgb expected;
    ASSERT_EQ(lw_environment_irradiance(environment.get(), &normals[i].x, seen(normals[i]).data(), &expected.x), LW_OK);
    diffuse.add(expected, rgbAt(irradiance, i));
    ASSERT_EQ(lw_environment_phong(environment.get(), &normals[i].x, 30, seen(normals[i]).data(), &expected.x), LW_OK);
    glossy.add(expected, rgbAt(lobe, i));
  }
  // Where the sun is hidden, the rest has the error that the filtering of the sky's picture has beside its other bright spots.
  EXPECT_LT(diffuse.value(), 0.003);
  EXPECT_LT(glossy.value(), 0.007);
}

/// The hardest that the picture's linear filter meets: the lobe of one bright point, anywhere between nodes.
TEST_P(GlEnvironment, LobesOfAPointAreWithinOnePercent) {
  const Vec3 point = Vec3(0.7f, 0.4f, 0.55f).normalized();
  load(bakeOf([&](const Vec3& d) { return d.dot(point) > 0.9992f ? Rgb(50, 50, 50) : Rgb(0.01f, 0.01f, 0.01f); }, 16));
  upload();
  const ListProgram lobe = program("lwEnvironmentLobe(a.xyz, n)");
  std::vector<Vec3> axes;
  for (const Vec3& d : directions(300)) axes.push_back((point + d * 0.25f).normalized());
  for (const float n : {3.0f, 30.0f, 200.0f}) {
    const std::vector<float> pixels = run(lobe, axes, axes, n);
    RelativeRms error;
    for (size_t i = 0; i < axes.size(); ++i) {
      Rgb expected;
      ASSERT_EQ(lw_environment_phong(environment.get(), &axes[i].x, n, nullptr, &expected.x), LW_OK);
      error.add(expected, rgbAt(pixels, i));
    }
    EXPECT_LT(error.value(), 0.009) << n;
  }
}

TEST_P(GlEnvironment, MapsAreDrawnByImportanceAndAllHaveTheirTurn) {
  load(outdoors(32));
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.map_texels = options.sun_map_texels = 16;
  upload(options);
  Casters casters(GetParam());
  const uint32_t count = lw_gl_environment_cells(gl_environment.get());
  uint32_t refreshed = 0;
  for (uint32_t frame = 0; frame < count; frame += 4)
    ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 4, Casters::callback, &casters, &refreshed), LW_OK);
  EXPECT_EQ(std::set<uint32_t>(casters.drawn.begin(), casters.drawn.end()).size(), count);
  EXPECT_EQ(casters.drawn[0], 0u);  // the sun
  casters.drawn.clear();
  const uint32_t frames = 1000;
  for (uint32_t frame = 0; frame < frames; ++frame)
    ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1, Casters::callback, &casters, nullptr), LW_OK);
  std::vector<uint32_t> times(count);
  for (const uint32_t cell : casters.drawn) ++times[cell];
  EXPECT_GT(*std::min_element(times.begin(), times.end()), 0u);
  EXPECT_EQ(std::max_element(times.begin(), times.end()) - times.begin(), 0);
  EXPECT_GT(times[0], frames / 4);  // two thirds of the light, but it takes turns
}

TEST_P(GlEnvironment, StateIsRestored) {
  load(bakeOf([](const Vec3&) { return Rgb(1, 1, 1); }, 8));
  const ListProgram light = program("lwEnvironmentIrradiance(a.xyz)");
  GLuint buffer = 0, framebuffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_UNIFORM_BUFFER, buffer);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glEnable(GL_SCISSOR_TEST);
  glScissor(1, 2, 3, 4);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_NEVER);
  glDepthMask(GL_FALSE);
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_NEVER, 0, 1);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1e6f, 1e6f);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT_AND_BACK);
  glViewport(5, 6, 7, 8);
  glActiveTexture(GL_TEXTURE5);
  const auto state = [] {
    std::vector<GLint> values;
    for (const GLenum name : {GL_UNIFORM_BUFFER_BINDING, GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_SCISSOR_BOX, GL_DEPTH_FUNC,
                              GL_DEPTH_WRITEMASK, GL_VIEWPORT, GL_ACTIVE_TEXTURE, GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING}) {
      GLint v[4] = {};
      glGetIntegerv(name, v);
      values.insert(values.end(), v, v + 4);
    }
    for (const GLenum name : {GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_CULL_FACE, GL_BLEND})
      values.push_back(glIsEnabled(name));
    return values;
  };
  const auto before = state();
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.bounds_min_m[0] = -2;
  upload(options);
  EXPECT_EQ(state(), before) << "lw_gl_environment_create";
  Casters casters(GetParam());
  casters.addBox({-1, -1, -1}, {1, 1, 1});
  ASSERT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1000, Casters::callback, &casters, nullptr), LW_OK);
  EXPECT_EQ(state(), before) << "lw_gl_environment_refresh";
  ASSERT_EQ(lw_gl_bind_environment(gl_environment.get(), light.name(), 2, 3, nullptr), LW_OK);
  const GLint generic[1] = {GLint(buffer)};
  GLint now = 0;
  glGetIntegerv(GL_UNIFORM_BUFFER_BINDING, &now);
  EXPECT_EQ(now, generic[0]) << "lw_gl_bind_environment";
  EXPECT_EQ(state(), before) << "lw_gl_bind_environment";
  for (const GLenum off : {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_CULL_FACE}) glDisable(off);
  // The casters were drawn in spite of it all: inside of the box it is dark.
  const std::vector<Vec3> axes = directions(20);
  const ListProgram inside = program("lwEnvironmentDiffuse(vec3(0.0), a.xyz, a.xyz)");
  for (const float v : run(inside, axes, axes)) EXPECT_TRUE(v == 0 || v == 1);
  const float low[3] = {-9, -9, -9}, high[3] = {9, 9, 9};
  ASSERT_EQ(lw_gl_environment_set_bounds(gl_environment.get(), low, high), LW_OK);
  for (const float v : run(inside, axes, axes)) EXPECT_GT(v, 0.9f);  // maps of other bounds say nothing
  glDeleteBuffers(1, &buffer);
  glDeleteFramebuffers(1, &framebuffer);
}

TEST_P(GlEnvironment, FewerCellsCarryTheLightOfAll) {
  load(outdoors(64));
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.cells = 16;
  upload(options);
  EXPECT_EQ(lw_gl_environment_cells(gl_environment.get()), 16u);
  const std::vector<Vec3> axes = directions(500);
  Rgb sum(0, 0, 0), expected(0, 0, 0);
  const auto pixels = run(program("lwEnvironmentDiffuse(vec3(0.0), a.xyz, a.xyz)"), axes, axes, 0, LW_ENVIRONMENT_SUM);
  for (size_t i = 0; i < axes.size(); ++i) {
    Rgb irradiance;
    ASSERT_EQ(lw_environment_irradiance(environment.get(), &axes[i].x, nullptr, &irradiance.x), LW_OK);
    expected += irradiance;
    sum += rgbAt(pixels, i);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / expected[c], 1, 0.03);
}

TEST_P(GlEnvironment, RefusesWhatMakesNoSense) {
  load(outdoors(300));
  lw_gl_environment* none = nullptr;
  lw_gl_environment_options options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.map_texels = 8;
  EXPECT_EQ(lw_gl_environment_create(gl.get(), environment.get(), &options, &none), LW_INVALID_ARGUMENT);
  options.map_texels = options.sun_map_texels = 2048;
  EXPECT_EQ(lw_gl_environment_create(gl.get(), environment.get(), &options, &none), LW_LIMIT_EXCEEDED);
  options = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  options.bounds_min_m[1] = NAN;
  EXPECT_EQ(lw_gl_environment_create(gl.get(), environment.get(), &options, &none), LW_INVALID_ARGUMENT);
  upload();
  const ListProgram small = program("lwEnvironmentIrradiance(a.xyz)"), other(GetParam(), "precision highp float;\n", "a.xyz");
  EXPECT_EQ(lw_gl_bind_environment(gl_environment.get(), small.name(), 0, 0, nullptr), LW_LIMIT_EXCEEDED) << message;
  EXPECT_EQ(lw_gl_bind_environment(gl_environment.get(), other.name(), 0, 0, nullptr), LW_NOT_FOUND);
  const ListProgram large(GetParam(), std::string("#define LW_ENVIRONMENT_CELLS 300\n") + lw_glsl_source(LW_GLSL_ENVIRONMENT),
                          "lwEnvironmentIrradiance(a.xyz)");
  EXPECT_EQ(lw_gl_bind_environment(gl_environment.get(), large.name(), 0, 0, nullptr), LW_OK) << message;
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  shading.filter_taps = 3;
  EXPECT_EQ(lw_gl_bind_environment(gl_environment.get(), large.name(), 0, 0, &shading), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_environment_refresh(gl_environment.get(), 1, nullptr, nullptr, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_environment_create(gl.get(), nullptr, &options, &none), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_environment_texture_bytes(nullptr), 0u);
}

}  // namespace
}  // namespace lightwell
