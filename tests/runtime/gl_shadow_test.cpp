// Shadow maps against occluders whose shadow is known: a horizontal plate between the light and what lies below.
#include <array>

#include "tests/runtime/gl_fixture.h"

namespace lightwell::test {
namespace {

constexpr float kPlateHeight = 0.0f, kPlateHalf = 0.8f;  // |x|, |z| ≤ 0.8 at y = 0
using Matrix = std::array<float, 16>;                    // column-major

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) c[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
  return c;
}

/// World to eye: rows are the axes of the eye, which looks along −z.
Matrix view(const float* eye, std::array<float, 3> x, std::array<float, 3> y, std::array<float, 3> z) {
  Matrix m{x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, 0, 0, 0, 1};
  for (int k = 0; k < 3; ++k) m[12] -= x[k] * eye[k], m[13] -= y[k] * eye[k], m[14] -= z[k] * eye[k];
  return m;
}

/// glFrustum with a 90° opening.
Matrix perspective90(float near, float far) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0};
}
Matrix orthographic(float half, float near, float far) {
  return {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1};
}

class GlShadow : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    SyntheticOptions options;
    options.clusters = 400;
    load(options);
    const std::string version = GetParam() == Api::desktop33 ? "#version 330 core\n" : "#version 300 es\nprecision highp float;\n";
    program = glCreateProgram();
    addShader(GL_VERTEX_SHADER, version + R"(
      uniform mat4 u_matrix;
      uniform float u_reversed;
      void main() {
        vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 1.6 - 0.8;
        gl_Position = u_matrix * vec4(corner.x, 0.0, corner.y, 1.0);
        // Stored depth is z / w * 0.5 + 0.5; one minus it when reversed.
        if (u_reversed > 0.5) gl_Position.z = -gl_Position.z;
      })");
    addShader(GL_FRAGMENT_SHADER, version + "void main() {}");
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    ASSERT_TRUE(linked);
    glGenFramebuffers(1, &framebuffer);
    glGenVertexArrays(1, &vertex_array);
    glGenTextures(1, &texture);
  }
  void TearDown() override {
    glDeleteTextures(1, &texture);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteProgram(program);
    GlFixture::TearDown();
  }
  void addShader(GLenum type, const std::string& source) {
    const GLuint shader = glCreateShader(type);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  void drawPlate(GLenum face, const Matrix& matrix, bool reversed) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, face, texture, 0);
    const GLenum none = GL_NONE;
    glDrawBuffers(1, &none);
    glReadBuffer(GL_NONE);
    ASSERT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum(GL_FRAMEBUFFER_COMPLETE));
    glViewport(0, 0, kSize, kSize);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(reversed ? GL_GREATER : GL_LESS);
    glClearDepthf(reversed ? 0.0f : 1.0f);
    glClear(GL_DEPTH_BUFFER_BIT);
    glUseProgram(program);
    glUniformMatrix4fv(glGetUniformLocation(program, "u_matrix"), 1, GL_FALSE, matrix.data());
    glUniform1f(glGetUniformLocation(program, "u_reversed"), reversed);
    glBindVertexArray(vertex_array);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glBindVertexArray(0);
    glUseProgram(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDisable(GL_DEPTH_TEST);
  }
  void allocate(GLenum target, GLenum face) {
    glBindTexture(target, texture);
    glTexImage2D(face, 0, GL_DEPTH_COMPONENT32F, kSize, kSize, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    // Parameters of the texture itself must not matter.
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_COMPARE_MODE, GL_NONE);
  }

  /// 1 lit, 0 in the plate's shadow, −1 too near to its edge or to its plane to tell. p + to_light is where a point light is.
  static int truth(const float* p, const std::array<double, 3>& to_light, bool infinite) {
    const double t = (kPlateHeight - p[1]) / to_light[1];
    if (std::abs(p[1] - kPlateHeight) < 0.06) return -1;
    if (t < 0 || (!infinite && t > 1)) return 1;
    const double x = std::abs(p[0] + t * to_light[0]), z = std::abs(p[2] + t * to_light[2]);
    const double edge = std::max(x, z) - kPlateHalf;
    return std::abs(edge) < 0.04 ? -1 : edge < 0 ? 0 : 1;
  }

  void expectShadow(const lw_gl_light& light) {
    const GlPrm gl_prm = upload();
    ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_OK);
    const auto shadowed = readEntries(gl_prm.get());
    lw_gl_light plain = light;
    plain.shadow = LW_GL_SHADOW_NONE;
    ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), &plain, 1), LW_OK);
    const auto open = readEntries(gl_prm.get());
    int lit = 0, dark = 0;
    for (uint32_t e = 0; e < synthetic.entries(); ++e) {
      const float* p = &synthetic.entry_position[e * 3];
      const bool infinite = light.light.type == LW_LIGHT_DIRECTIONAL;
      std::array<double, 3> to_light;
      for (int k = 0; k < 3; ++k) to_light[k] = infinite ? -light.light.direction[k] : double(light.light.position_m[k]) - p[k];
      const int expected = truth(p, to_light, infinite);
      if (expected < 0 || open[e * 3] == 0) continue;
      ASSERT_NEAR(shadowed[e * 3], expected * open[e * 3], 1e-5f * open[e * 3])
          << "entry at " << p[0] << " " << p[1] << " " << p[2] << " should be " << (expected ? "lit" : "dark");
      ++(expected ? lit : dark);
    }
    EXPECT_GT(lit, 50);
    EXPECT_GT(dark, 20);
  }

  static constexpr GLsizei kSize = 512;
  GLuint program = 0, framebuffer = 0, vertex_array = 0, texture = 0;
};
LW_INSTANTIATE_GL(GlShadow);

TEST_P(GlShadow, SpotLightWithADepthMap) {
  lw_gl_light light = glPointLight(0.2f, 1.2f, -0.1f, 10);
  light.light.type = LW_LIGHT_SPOT;
  light.light.outer_cone_angle_rad = 0.75f;
  const Matrix matrix = multiply(perspective90(0.1f, 10.0f), view(light.light.position_m, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}));
  allocate(GL_TEXTURE_2D, GL_TEXTURE_2D);
  drawPlate(GL_TEXTURE_2D, matrix, false);
  light.shadow = LW_GL_SHADOW_2D;
  light.shadow_texture = texture;
  std::copy(matrix.begin(), matrix.end(), light.shadow_matrix);
  expectShadow(light);
}

TEST_P(GlShadow, DirectionalLightWithADepthMapPlainAndReversed) {
  for (const bool reversed : {false, true}) {
    lw_gl_light light = glPointLight(0, 0, 0, 10);
    light.light.type = LW_LIGHT_DIRECTIONAL;
    const float s = std::sqrt(0.5f);
    light.light.direction[0] = s, light.light.direction[1] = -s, light.light.direction[2] = 0;
    const float eye[3] = {-4, 4, 0};
    const Matrix matrix = multiply(orthographic(4, 0.5f, 12), view(eye, {0, 0, 1}, {s, s, 0}, {-s, s, 0}));
    allocate(GL_TEXTURE_2D, GL_TEXTURE_2D);
    drawPlate(GL_TEXTURE_2D, matrix, reversed);
    light.shadow = LW_GL_SHADOW_2D;
    light.shadow_texture = texture;
    light.reversed_depth = reversed;
    Matrix lookup = matrix;
    if (reversed)  // depth 1 − (z * 0.5 + 0.5) as the matrix's own z, the zero-to-one way
      for (int column = 0; column < 4; ++column) lookup[column * 4 + 2] = 0.5f * (matrix[column * 4 + 3] - matrix[column * 4 + 2]);
    std::copy(lookup.begin(), lookup.end(), light.shadow_matrix);
    expectShadow(light);
  }
}

TEST_P(GlShadow, PointLightWithACubeMapPlainAndReversed) {
  constexpr std::array<std::array<float, 3>, 3> kAxes[6] = {  // right, up, backward of GL's faces +x −x +y −y +z −z
      {{{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}}}, {{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}}, {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}},
      {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}},   {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}, {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}};
  for (const bool reversed : {false, true}) {
    lw_gl_light light = glPointLight(0.3f, 0.7f, -0.2f, 10);
    light.near_m = 0.05f;
    light.far_m = 8;
    light.reversed_depth = reversed;
    for (GLenum face = 0; face < 6; ++face) allocate(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_CUBE_MAP_POSITIVE_X + face);
    for (GLenum face = 0; face < 6; ++face)
      drawPlate(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face,
                multiply(perspective90(light.near_m, light.far_m),
                         view(light.light.position_m, kAxes[face][0], kAxes[face][1], kAxes[face][2])),
                reversed);
    light.shadow = LW_GL_SHADOW_CUBE;
    light.shadow_texture = texture;
    expectShadow(light);
  }
}

TEST_P(GlShadow, NormalOffsetMovesTheLookup) {
  // A plate just above every entry point would shadow it; an offset beyond the plate brings it out.
  lw_gl_light light = glPointLight(0, 3, 0, 10);
  light.light.type = LW_LIGHT_DIRECTIONAL;
  const float eye[3] = {0, 4, 0};
  const Matrix matrix = multiply(orthographic(4, 0.5f, 12), view(eye, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}));
  allocate(GL_TEXTURE_2D, GL_TEXTURE_2D);
  drawPlate(GL_TEXTURE_2D, matrix, false);
  light.shadow = LW_GL_SHADOW_2D;
  light.shadow_texture = texture;
  std::copy(matrix.begin(), matrix.end(), light.shadow_matrix);
  expectShadow(light);
  light.normal_offset_m = 10;  // normals that see the light point up: all come out on top
  const GlPrm gl_prm = upload();
  ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_OK);
  const auto moved = readEntries(gl_prm.get());
  for (uint32_t e = 0; e < synthetic.entries(); ++e)
    if (synthetic.entry_normal[e * 3 + 1] > 0.3f) {
      ASSERT_GT(moved[e * 3], 0.0f);
    }
}

}  // namespace
}  // namespace lightwell::test
