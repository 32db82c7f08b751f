// Whatever state the game has set, the library's work is right and the state is the same afterwards.
#include "lightwell/lightwell_gl_vpl.h"
#include "tests/runtime/gl_fixture.h"
#include "tests/runtime/probes_fixture.h"

namespace lightwell::test {
namespace {

/// Every state that lightwell_gl.h says is touched, as text to compare.
std::string describeState(bool desktop) {
  std::string text;
  const auto line = [&](const char* name, int value) { text.append(name).append(" ").append(std::to_string(value)).append("\n"); };
  const auto integer = [&](const char* name, GLenum e, int count = 1) {
    GLint v[4] = {};
    glGetIntegerv(e, v);
    for (int i = 0; i < count; ++i) line(name, v[i]);
  };
  integer("program", GL_CURRENT_PROGRAM);
  integer("vertex array", GL_VERTEX_ARRAY_BINDING);
  integer("draw framebuffer", GL_DRAW_FRAMEBUFFER_BINDING);
  integer("read framebuffer", GL_READ_FRAMEBUFFER_BINDING);
  integer("viewport", GL_VIEWPORT, 4);
  integer("active texture", GL_ACTIVE_TEXTURE);
  integer("pack buffer", GL_PIXEL_PACK_BUFFER_BINDING);
  integer("unpack buffer", GL_PIXEL_UNPACK_BUFFER_BINDING);
  for (const GLenum e : {GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_IMAGE_HEIGHT,
                         GL_UNPACK_SKIP_IMAGES, GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    integer("pixel store", e);
  for (const GLenum e : {GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_RASTERIZER_DISCARD, GL_DEPTH_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL})
    line("enabled", glIsEnabled(e));
  for (const GLenum e : {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA,
                         GL_DEPTH_FUNC})
    integer("function", e);
  integer("scissor box", GL_SCISSOR_BOX, 4);
  GLboolean mask[4];
  glGetBooleanv(GL_COLOR_WRITEMASK, mask);
  for (const GLboolean m : mask) line("mask", m);
  glGetBooleanv(GL_DEPTH_WRITEMASK, mask);
  line("depth mask", mask[0]);
  if (desktop) {
    line("point size", glIsEnabled(GL_PROGRAM_POINT_SIZE));
    for (const GLenum e : {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST}) integer("pixel store", e);
    line("logic", glIsEnabled(GL_COLOR_LOGIC_OP));
    for (GLenum i = 0; i < 8; ++i) line("clip", glIsEnabled(GL_CLIP_DISTANCE0 + i));
    integer("polygon mode", GL_POLYGON_MODE);
    for (GLuint i = 0; i < 4; ++i) {
      glGetBooleani_v(GL_COLOR_WRITEMASK, i, mask);
      for (const GLboolean m : mask) line("mask i", m);
      line("blend i", glIsEnabledi(GL_BLEND, i));
    }
  }
  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (GLenum unit = 0; unit < 8; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    integer("2d", GL_TEXTURE_BINDING_2D);
    integer("array", GL_TEXTURE_BINDING_2D_ARRAY);
    integer("cube", GL_TEXTURE_BINDING_CUBE_MAP);
    integer("3d", GL_TEXTURE_BINDING_3D);
    integer("sampler", GL_SAMPLER_BINDING);
  }
  glActiveTexture(GLenum(active));
  return text;
}

class GlState : public GlFixture {
 protected:
  bool desktop() const { return GetParam() == Api::desktop33; }

  /// Each touched state away from its default and from what the library needs.
  void setOddState() {
    glGenTextures(4, textures);
    glGenSamplers(1, &sampler);
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    for (GLenum unit = 0; unit < 8; ++unit) {
      glActiveTexture(GL_TEXTURE0 + unit);
      glBindTexture(GL_TEXTURE_2D, textures[0]);
      glBindTexture(GL_TEXTURE_2D_ARRAY, textures[1]);
      glBindTexture(GL_TEXTURE_CUBE_MAP, textures[2]);
      glBindTexture(GL_TEXTURE_3D, textures[3]);
      glBindSampler(unit, sampler);
    }
    glActiveTexture(GL_TEXTURE6);
    glGenFramebuffers(2, framebuffers);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers[0]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[1]);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffers[0]);
    glBufferData(GL_PIXEL_PACK_BUFFER, 16, nullptr, GL_STATIC_DRAW);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[1]);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, 16, nullptr, GL_STATIC_DRAW);
    glViewport(3, 4, 5, 6);
    for (const GLenum e : {GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_RASTERIZER_DISCARD, GL_DEPTH_TEST, GL_STENCIL_TEST}) glEnable(e);
    glScissor(0, 0, 1, 1);
    glCullFace(GL_FRONT_AND_BACK);
    glBlendFuncSeparate(GL_ZERO, GL_ONE_MINUS_SRC_ALPHA, GL_SRC_ALPHA, GL_ZERO);
    glBlendEquationSeparate(GL_FUNC_SUBTRACT, GL_MAX);
    glDepthFunc(GL_NEVER);
    glDepthMask(GL_FALSE);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(3, 4);
    glStencilFunc(GL_NEVER, 0, 0xff);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
    int value = 2;
    for (const GLenum e : {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES,
                           GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
      glPixelStorei(e, value++);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    glPixelStorei(GL_PACK_ALIGNMENT, 2);
    if (desktop()) {
      for (const GLenum e : {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST}) glPixelStorei(e, 1);
      glEnable(GL_COLOR_LOGIC_OP);
      glLogicOp(GL_CLEAR);
      glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
      glPointSize(7);
      for (GLenum i = 0; i < 8; i += 2) glEnable(GL_CLIP_DISTANCE0 + i);
      glColorMaski(2, GL_FALSE, GL_FALSE, GL_TRUE, GL_FALSE);
      glDisablei(GL_BLEND, 1);
    }
    ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  }

  GLuint textures[4], framebuffers[2], buffers[2], sampler = 0, vertex_array = 0;
};
LW_INSTANTIATE_GL(GlState);

TEST_P(GlState, IsRestoredByEveryFunctionAndDoesNotDisturbTheWork) {
  setOddState();
  const std::string before = describeState(desktop());
  const auto same = [&](const char* function) { ASSERT_EQ(describeState(desktop()), before) << function; };
  for (const Layout layout : {Layout::panes_rgb9e5, Layout::local_bases}) {
    SyntheticOptions options;
    options.layout = layout;
    load(options);
    lw_gl* other = nullptr;
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = GlContext::load;
    ASSERT_EQ(lw_gl_create(&config, &other), LW_OK);
    same("lw_gl_create");
    lw_gl_destroy(other);
    same("lw_gl_destroy");
    GlPrm gl_prm = upload();
    same("lw_gl_prm_create");
    uint32_t visibility = 0;
    ASSERT_EQ(lw_gl_create_visibility(gl_prm.get(), &visibility), LW_OK);
    same("lw_gl_create_visibility");
    ASSERT_EQ(lw_gl_upload_visibility(gl_prm.get(), visibility, std::vector<float>(synthetic.entries(), 0.5f).data()), LW_OK);
    same("lw_gl_upload_visibility");
    lw_gl_light lights[2] = {glPointLight(0, 2, 0, 10), glPointLight(1, 0, 2, 30)};
    lights[1].shadow = LW_GL_SHADOW_VISIBILITY;
    lights[1].shadow_texture = visibility;
    ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), lights, 2), LW_OK);
    same("lw_gl_update_entries");
    const auto entries = readEntries(gl_prm.get());
    same("lw_gl_read_entries");
    lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
    evaluate.brightest = 10;
    ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &evaluate), LW_OK);
    same("lw_gl_evaluate");
    std::vector<float> expected_entries(entries.size()), half(entries.size());
    ASSERT_EQ(lw_prm_entry_irradiance(prm.get(), &lights[0].light, 1, nullptr, nullptr, expected_entries.data()), LW_OK);
    ASSERT_EQ(lw_prm_entry_irradiance(prm.get(), &lights[1].light, 1, nullptr, nullptr, half.data()), LW_OK);
    for (size_t i = 0; i < half.size(); ++i) expected_entries[i] += 0.5f * half[i];
    EXPECT_LT(relrmse(entries, expected_entries), layout == Layout::local_bases ? kRectangleError : 1e-5);
    std::vector<float> cluster(size_t(options.clusters) * 3);
    ASSERT_EQ(lw_prm_cluster_irradiance(prm.get(), expected_entries.data(), cluster.data()), LW_OK);
    const bool panes = layout == Layout::panes_rgb9e5;
    EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(cluster, LW_EMITTERS_INDIRECT, panes ? 10 : 0)), 1e-4);
    same("lw_gl_read_atlas");
    ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), cluster.data()), LW_OK);
    same("lw_gl_upload_cluster_irradiance");
    if (!panes) {
      ASSERT_EQ(lw_gl_update_coefficients(gl_prm.get()), LW_OK);
      same("lw_gl_update_coefficients");
    }
    lw_gl_destroy_visibility(gl_prm.get(), visibility);
    gl_prm.reset();
    same("lw_gl_prm_destroy");
  }
}

TEST_P(GlState, IsRestoredByTheFunctionsOfProbes) {
  LoadedProbes p(probesInRoom());
  lw_gl_radiosity* radiosity = nullptr;
  lw_gl_probes* gpu = nullptr;
  ASSERT_EQ(lw_gl_radiosity_create(gl, p.room.radiosity, nullptr, &radiosity), LW_OK) << message;
  setOddState();
  const std::string before = describeState(desktop());
  const auto same = [&](const char* function) { ASSERT_EQ(describeState(desktop()), before) << function; };
  ASSERT_EQ(lw_gl_probes_create(radiosity, p.probes, nullptr, &gpu), LW_OK) << message;
  same("lw_gl_probes_create");
  ASSERT_EQ(lw_gl_probes_evaluate(gpu, LW_RADIOSITY_EMITTERS), LW_OK) << message;
  same("lw_gl_probes_evaluate");
  std::vector<float> sh(size_t(p.info.probes) * 27);
  ASSERT_EQ(lw_gl_probes_read(gpu, sh.data()), LW_OK) << message;
  same("lw_gl_probes_read");
  EXPECT_NEAR(sh[0], p.evaluate(9, LW_RADIOSITY_EMITTERS)[0], 1e-3f * sh[0]);
  lw_gl_probes_destroy(gpu);
  same("lw_gl_probes_destroy");
  lw_gl_radiosity_destroy(radiosity);
}

TEST_P(GlState, IsRestoredByTheFunctionsOfVirtualLights) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, 0.5, 1);
  const LoadedRoom room(options);
  setOddState();
  const std::string before = describeState(desktop());
  const auto same = [&](const char* function) { ASSERT_EQ(describeState(desktop()), before) << function; };
  lw_gl_vpl_options full = LW_GL_VPL_OPTIONS_INIT;
  full.atlas_format = LW_GL_ATLAS_RGBA32F;
  full.shadow_map_side = 32, full.layers = 1;
  lw_gl_vpl* vpl = nullptr;
  ASSERT_EQ(lw_gl_vpl_create(gl, room.container.get(), nullptr, &full, &vpl), LW_OK) << message;
  same("lw_gl_vpl_create");
  lw_virtual_light light{};
  light.type = LW_VIRTUAL_POINT;
  light.position_m[0] = light.position_m[1] = light.position_m[2] = 0.5f;
  light.normal[1] = 1;
  light.flux_rgb[0] = light.flux_rgb[1] = light.flux_rgb[2] = 3;
  ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl, 0, &light, 1), LW_OK) << message;
  same("lw_gl_vpl_set_source_lights");
  lw_gl_vpl_progress progress{};
  ASSERT_EQ(lw_gl_vpl_step(vpl, 5, &progress), LW_OK) << message;
  same("lw_gl_vpl_step");
  EXPECT_EQ(progress.lights_drawn, 1u);
  std::vector<float> atlas(size_t(room.info.width) * room.info.height * 4);
  ASSERT_EQ(lw_gl_vpl_read(vpl, atlas.data()), LW_OK);
  same("lw_gl_vpl_read");
  double most = 0;
  for (size_t i = 0; i < atlas.size(); i += 4) most = std::max(most, double(atlas[i]));
  EXPECT_GT(most, 1) << "the ceiling right above the light";
  ASSERT_EQ(lw_gl_vpl_redraw(vpl), LW_OK);
  lw_gl_vpl_destroy(vpl);
  same("lw_gl_vpl_destroy");
}

TEST_P(GlState, IsRestoredByTheFunctionsOfRadiosity) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, 0.5, 1);
  LoadedRoom room(options);
  setOddState();
  const std::string before = describeState(desktop());
  const auto same = [&](const char* function) { ASSERT_EQ(describeState(desktop()), before) << function; };
  lw_gl_radiosity* gpu = nullptr;
  lw_gl_radiosity_options full = LW_GL_RADIOSITY_OPTIONS_INIT;
  full.atlas_format = LW_GL_ATLAS_RGBA32F;
  ASSERT_EQ(lw_gl_radiosity_create(gl, room.radiosity, &full, &gpu), LW_OK) << message;
  same("lw_gl_radiosity_create");
  ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, LW_GL_RADIOSITY_MATERIALS | LW_GL_RADIOSITY_PORTALS | LW_GL_RADIOSITY_DIRECT), LW_OK);
  same("lw_gl_radiosity_upload");
  ASSERT_EQ(lw_gl_radiosity_step(gpu, 3), LW_OK);
  same("lw_gl_radiosity_step");
  ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-4, 100, nullptr), LW_OK);
  same("lw_gl_radiosity_solve");
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  shading.light = LW_RADIOSITY_INDIRECT;
  ASSERT_EQ(lw_gl_radiosity_shade(gpu, &shading), LW_OK);
  same("lw_gl_radiosity_shade");
  std::vector<float> rgb(size_t(room.info.patches) * 3), atlas(size_t(room.info.width) * room.info.height * 4);
  ASSERT_EQ(lw_gl_radiosity_read_irradiance(gpu, rgb.data()), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_read_atlas(gpu, atlas.data()), LW_OK);
  same("lw_gl_radiosity_read_atlas");
  for (const float e : rgb) EXPECT_NEAR(e, 2 * 3.14159265f, 1e-2f);
  EXPECT_NEAR(atlas[room.room.content.texel[0] * 4], 3.14159265f, 1e-2f);
  lw_gl_radiosity_injector* injector = nullptr;
  ASSERT_EQ(lw_gl_radiosity_injector_create(gpu, room.container.get(), room.radiosity, 64, &injector), LW_OK) << message;
  same("lw_gl_radiosity_injector_create");
  lw_light light = glPointLight(0.4f, 0.5f, 0.6f, 10).light;
  ASSERT_EQ(lw_gl_radiosity_inject(injector, &light, 1), LW_OK) << message;
  same("lw_gl_radiosity_inject");
  ASSERT_EQ(lw_gl_radiosity_read_direct(gpu, rgb.data()), LW_OK);
  same("lw_gl_radiosity_read_direct");
  double power = 0;
  for (uint32_t i = 0; i < room.info.patches; ++i) power += double(rgb[i * 3]) * double(room.room.content.patch_area[i]);
  EXPECT_NEAR(power / (4 * 3.14159265 * 10), 1, 1e-4);
  lw_gl_radiosity_injector_destroy(injector);
  same("lw_gl_radiosity_injector_destroy");
  lw_gl_radiosity_destroy(gpu);
  same("lw_gl_radiosity_destroy");
}

}  // namespace
}  // namespace lightwell::test
