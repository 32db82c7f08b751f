// The GLSL that is exported, inside a program of the game.
#include "tests/format/lightmap_content.h"
#include "tests/runtime/gl_fixture.h"
#include "tests/runtime/gl_program.h"

namespace lightwell::test {
namespace {

class GlSnippets : public GlFixture {
 protected:
  /// A program that writes `expression` for each texel of a picture; `uv` runs over its texels' centres.
  GLuint makeProgram(const std::string& snippet, const std::string& expression) {
    return linkProgram(GetParam(), snippet + "uniform vec2 u_size, u_shift; uniform sampler2D u_atlas; out vec4 color;\n" +
                                       "void main() { vec2 uv = (gl_FragCoord.xy + u_shift) / u_size; color = vec4(" + expression + ", 1.0); }");
  }
  /// [height][width][4] of what the program writes; the textures are bound by `bind`.
  template <class Bind>
  std::vector<float> run(GLuint program, int width, int height, float shift, Bind bind) {
    GLuint texture = 0, framebuffer = 0, vertex_array = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glViewport(0, 0, width, height);
    glUseProgram(program);
    glUniform2f(glGetUniformLocation(program, "u_size"), float(width), float(height));
    glUniform2f(glGetUniformLocation(program, "u_shift"), shift, shift);
    bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<float> pixels(size_t(width) * height * 4);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, pixels.data());
    glUseProgram(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteTextures(1, &texture);
    glDeleteProgram(program);
    return pixels;
  }
  /// Of r, g and b alone.
  static double rgbError(const std::vector<float>& a, const std::vector<float>& b) {
    std::vector<float> x, y;
    for (size_t i = 0; i < a.size(); ++i)
      if (i % 4 != 3) x.push_back(a[i]), y.push_back(b[i]);
    return relrmse(x, y);
  }
};
LW_INSTANTIATE_GL(GlSnippets);

TEST_P(GlSnippets, LocalBasesAreReconstructedInTheGamesShader) {
  SyntheticOptions options;
  options.layout = Layout::local_bases;
  load(options);
  const GlPrm gl_prm = upload();
  const auto irradiance = randomIrradiance(options.clusters, 4);
  ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
  lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
  evaluate.emitters = 0;
  ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &evaluate), LW_OK);
  const auto atlas = readAtlas(gl_prm.get());
  const int width = int(options.width), height = int(options.height);
  for (const float shift : {0.0f, 0.25f}) {  // at the centres, and between them
    const GLuint program = makeProgram(lw_glsl_source(LW_GLSL_LOCAL_BASES), "lwLocalBasesIrradiance(uv)");
    const auto direct = run(program, width, height, shift, [&] { ASSERT_EQ(lw_gl_bind_local_bases(gl_prm.get(), program, 3), LW_OK); });
    const auto looked_up = run(makeProgram(lw_glsl_source(LW_GLSL_ATLAS), "lwAtlasIrradiance(u_atlas, uv)"), width, height, shift, [&] {
      glActiveTexture(GL_TEXTURE0);
      glBindTexture(GL_TEXTURE_2D, lw_gl_prm_atlas_texture(gl_prm.get()));
    });
    // Between centres the texture unit's weights are coarse.
    EXPECT_LT(rgbError(direct, looked_up), shift == 0 ? 1e-5 : 0.01);
    if (shift == 0) {
      EXPECT_LT(rgbError(direct, atlas), 1e-5);
    }
  }
  EXPECT_EQ(lw_gl_bind_local_bases(gl_prm.get(), 0, 0), LW_INVALID_ARGUMENT);
  const GLuint other = makeProgram(lw_glsl_source(LW_GLSL_ATLAS), "lwDiffuseRadiance(vec3(0.5), vec3(3.14159265))");
  EXPECT_EQ(lw_gl_bind_local_bases(gl_prm.get(), other, 0), LW_NOT_FOUND);
  EXPECT_NEAR(run(other, 1, 1, 0, [] {})[0], 0.5f, 1e-6f);
}

TEST_P(GlSnippets, GradientsOfALightMapTiltTheNormalAsOnTheCpu) {
  const Container container = openMemory(format::toWriter(format::directionalContent()).bytes());
  lw_lightmap* map = nullptr;
  ASSERT_EQ(lw_lightmap_load(container.get(), &map), LW_OK);
  lw_gl_lightmap* gl_map = nullptr;
  ASSERT_EQ(lw_gl_lightmap_create(gl, map, nullptr, &gl_map), LW_OK);
  lw_lightmap_info info;
  ASSERT_EQ(lw_lightmap_get_info(map, &info), LW_OK);
  // Direct light alone, so that both sum up in the same way.
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  shading.light = LW_LIGHTMAP_DIRECT;
  lw_gl_lightmap_options options = LW_GL_LIGHTMAP_OPTIONS_INIT;
  options.shading = &shading;
  lw_gl_lightmap* direct = nullptr;
  ASSERT_EQ(lw_gl_lightmap_create(gl, map, &options, &direct), LW_OK);
  ASSERT_NE(lw_gl_lightmap_gradient_texture(direct), 0u);
  EXPECT_EQ(lw_gl_lightmap_texture_bytes(direct), uint64_t(info.width) * info.height * (8 + 4));
  const float up[3] = {0, 1, 0}, tilted[3] = {0.6f, 0.8f, 0};
  const std::string source = std::string(lw_glsl_source(LW_GLSL_ATLAS)) + lw_glsl_source(LW_GLSL_LIGHTMAP) + "uniform sampler2D u_gradients;\n";
  for (const float* normal : {up, tilted}) {
    const GLuint program = makeProgram(source, std::string("lwLightmapIrradiance(u_atlas, u_gradients, uv, vec3(0, 1, 0), ") +
                                                   (normal == up ? "vec3(0, 1, 0))" : "vec3(0.6, 0.8, 0))"));
    const auto pixels = run(program, int(info.width), int(info.height), 0, [&] {
      glUniform1i(glGetUniformLocation(program, "u_gradients"), 1);
      glActiveTexture(GL_TEXTURE1);
      glBindTexture(GL_TEXTURE_2D, lw_gl_lightmap_gradient_texture(direct));
      glActiveTexture(GL_TEXTURE0);
      glBindTexture(GL_TEXTURE_2D, lw_gl_lightmap_texture(direct));
    });
    for (uint32_t y = 0; y < info.height; ++y)
      for (uint32_t x = 0; x < info.width; ++x) {
        float rgb[3];
        ASSERT_EQ(lw_lightmap_irradiance(map, &shading, x, y, up, normal, rgb), LW_OK);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixels[(size_t(y) * info.width + x) * 4 + c], rgb[c], 2e-3 * (1 + rgb[c])) << x << ' ' << y;
      }
  }
  lw_gl_lightmap_destroy(direct);
  lw_gl_lightmap_destroy(gl_map);
  lw_lightmap_release(map);
}

TEST_P(GlSnippets, LightsShineInTheGamesShaderAsOnTheCpu) {
  lw_light light = glPointLight(0, 2, 0, 8).light;
  light.type = LW_LIGHT_SPOT;
  light.inner_cone_angle_rad = 0.5f;
  light.outer_cone_angle_rad = 1.0f;
  float packed[16];
  ASSERT_EQ(lw_gl_pack_light(&light, packed), LW_OK);
  const GLuint program =
      makeProgram(std::string(lw_glsl_source(LW_GLSL_LIGHT)) + "uniform vec4 u_light[4];\n",
                  "lwLightIrradiance(LwLight(u_light[0], u_light[1], u_light[2], u_light[3]), vec3(1, 0, 0), vec3(0, 1, 0))");
  const auto pixel = run(program, 1, 1, 0, [&] { glUniform4fv(glGetUniformLocation(program, "u_light"), 4, packed); });
  const double cosine = 2 / std::sqrt(5.0), edge = (cosine - std::cos(1.0)) / (std::cos(0.5) - std::cos(1.0));
  const double expected = 8.0 / 5 * cosine * std::min(edge, 1.0) * std::min(edge, 1.0);
  EXPECT_NEAR(pixel[0], expected, 1e-4);
  light.intensity_rgb[0] = -1;
  EXPECT_EQ(lw_gl_pack_light(&light, packed), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_glsl_source(lw_glsl(77)), nullptr);
}

}  // namespace
}  // namespace lightwell::test
