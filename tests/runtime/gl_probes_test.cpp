// Probes on OpenGL against the CPU: what they receive, and what the exported GLSL makes of it between them.
#include <cmath>
#include <random>

#include "tests/runtime/gl_test.h"
#include "tests/runtime/gl_program.h"
#include "tests/runtime/probes_fixture.h"

namespace lightwell::test {
namespace {

class GlProbes : public GlTest {
 protected:
  void TearDown() override {
    lw_gl_probes_destroy(gpu);
    lw_gl_radiosity_destroy(radiosity);
    GlTest::TearDown();
  }
  /// Lit from one corner, with all bounces on both.
  void upload(LoadedProbes& p, uint32_t coefficients) {
    std::vector<float> direct(size_t(p.room.info.patches) * 3, 0.0f);
    for (size_t i = 0; i < 24; ++i) direct[i] = 3.0f + float(i);
    ASSERT_EQ(lw_radiosity_set_direct(p.room.state, direct.data()), LW_OK);
    p.room.solve();
    lw_gl_probes_destroy(gpu);
    lw_gl_radiosity_destroy(radiosity);
    gpu = nullptr;
    ASSERT_EQ(lw_gl_radiosity_create(gl, p.room.radiosity, nullptr, &radiosity), LW_OK) << message;
    lw_gl_probes_options options = LW_GL_PROBES_OPTIONS_INIT;
    options.coefficients = coefficients;
    ASSERT_EQ(lw_gl_probes_create(radiosity, p.probes, &options, &gpu), LW_OK) << message;
    ASSERT_EQ(lw_gl_radiosity_upload(radiosity, p.room.state, LW_GL_RADIOSITY_DIRECT), LW_OK) << message;
    ASSERT_EQ(lw_gl_radiosity_solve(radiosity, 1e-6, 200, nullptr), LW_OK) << message;
  }
  std::vector<float> read(const LoadedProbes& p) {
    std::vector<float> sh(size_t(p.info.probes) * 27);
    EXPECT_EQ(lw_gl_probes_read(gpu, sh.data()), LW_OK) << message;
    return sh;
  }

  lw_gl_radiosity* radiosity = nullptr;
  lw_gl_probes* gpu = nullptr;
};

TEST_P(GlProbes, ReceiveWhatTheyDoOnTheCpu) {
  LoadedProbes p(probesInRoom()), sharp(probesInRoom([](uint32_t i) { return std::vector<ProbeLink>{{i, 0.02}, {37, 0.005}}; }));
  for (LoadedProbes* probes : {&p, &sharp})
    for (const uint32_t coefficients : {9u, 4u}) {
      upload(*probes, coefficients);
      for (const uint32_t light : {1u, 2u, 3u}) {
        ASSERT_EQ(lw_gl_probes_evaluate(gpu, light), LW_OK) << message;
        EXPECT_LT(relrmse(read(*probes), probes->evaluate(coefficients, light)), 2e-4) << coefficients << " " << light;
      }
    }
}

TEST_P(GlProbes, TheGamesShaderInterpolatesAsTheCpuDoes) {
  RoomWithProbes made = probesInRoom();
  // Walls here and there, moved probes, and points without a probe.
  format::ProbesContent& c = made.probes;
  std::mt19937 random(5);
  for (uint8_t& code : c.nearness) code = uint8_t(random() % 3 == 0 ? 0 : 60 + random() % 80);
  for (int8_t& steps : c.offset) steps = int8_t(int(random() % 200) - 100);
  LoadedProbes p(std::move(made));
  for (const uint32_t coefficients : {9u, 4u}) {
    upload(p, coefficients);
    ASSERT_EQ(lw_gl_probes_evaluate(gpu, 3), LW_OK);
    const auto sh = p.evaluate(coefficients);
    std::vector<float> positions, normals, expected;
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 500; ++i) {
      const float position[3] = {4 * unit(random) - 0.5f, 3 * unit(random) - 0.5f, 5 * unit(random) - 0.5f};
      float n[3] = {unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f}, around[9][3], e[3];
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (float& v : n) v /= length;
      ASSERT_EQ(lw_probes_sample(p.probes, sh.data(), position, around), LW_OK);
      ASSERT_EQ(lw_sh_irradiance(around, n, e), LW_OK);
      positions.insert(positions.end(), {position[0], position[1], position[2], 0});
      normals.insert(normals.end(), {n[0], n[1], n[2], 0});
      expected.insert(expected.end(), {e[0], e[1], e[2], 1});
    }
    const ListProgram program(GetParam(), lw_glsl_source(LW_GLSL_PROBES), "lwProbesIrradiance(a.xyz, b.xyz)");
    ASSERT_EQ(lw_gl_bind_probes(gpu, program.name(), 3), LW_OK) << message;
    const auto found = program.run(positions, normals, 0);
    double difference = 0, square = 0;
    for (size_t i = 0; i < found.size(); ++i)
      if (i % 4 != 3) difference += std::pow(double(found[i]) - double(expected[i]), 2), square += double(expected[i]) * double(expected[i]);
    EXPECT_LT(std::sqrt(difference / square), 2e-3) << coefficients;
  }
}

TEST_P(GlProbes, BlockersTakeTheSameLightAsOnTheCpu) {
  LoadedProbes p(probesInRoom());
  const std::vector<lw_blocker> blockers = {{{1, 0.5f, 1}, 0.5f, {0.9f, 0.5f, 0.1f}}, {{2, 1, 2.5f}, 0.8f, {0, 0, 0}}, {{0.3f, 0.2f, 3}, 0.6f, {1, 1, 1}}};
  ASSERT_EQ(lw_radiosity_set_blockers(p.room.state, blockers.data(), 3), LW_OK);
  upload(p, 9);
  EXPECT_GT(relrmse(p.evaluate(9), [&] {
              std::vector<float> sh(size_t(p.info.probes) * 27);
              EXPECT_EQ(lw_gl_probes_evaluate(gpu, 3), LW_OK);
              EXPECT_EQ(lw_gl_probes_read(gpu, sh.data()), LW_OK);
              return sh;
            }()), 0.01) << "nothing was uploaded yet";
  ASSERT_EQ(lw_gl_radiosity_upload(radiosity, p.room.state, LW_GL_RADIOSITY_BLOCKERS), LW_OK) << message;
  ASSERT_EQ(lw_gl_radiosity_solve(radiosity, 1e-6, 200, nullptr), LW_OK);
  ASSERT_EQ(lw_gl_probes_evaluate(gpu, 3), LW_OK);
  EXPECT_LT(relrmse(read(p), p.evaluate(9)), 2e-4);

  std::vector<float> positions, normals, expected;
  std::mt19937 random(7);
  std::normal_distribution<float> gauss;
  for (int i = 0; i < 2000; ++i) {
    const float position[3] = {1.5f + gauss(random), 1 + gauss(random), 2 + gauss(random)};
    float n[3] = {gauss(random), gauss(random), gauss(random)}, kept[3];
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (float& v : n) v /= length;
    ASSERT_EQ(lw_blockers_kept(blockers.data(), 3, position, n, kept), LW_OK);
    positions.insert(positions.end(), {position[0], position[1], position[2], 0});
    normals.insert(normals.end(), {n[0], n[1], n[2], 0});
    expected.insert(expected.end(), {kept[0], kept[1], kept[2], 1});
  }
  const ListProgram program(GetParam(), lw_glsl_source(LW_GLSL_BLOCKERS), "lwBlockersKept(a.xyz, b.xyz)");
  ASSERT_EQ(lw_gl_set_blockers(gl, program.name(), blockers.data(), 3), LW_OK) << message;
  EXPECT_LT(relrmse(program.run(positions, normals, 0), expected), 1e-3);
  const ListProgram other(GetParam(), "", "a.xyz");
  EXPECT_EQ(lw_gl_set_blockers(gl, other.name(), blockers.data(), 3), LW_NOT_FOUND);
}

TEST_P(GlProbes, FollowTheDoor) {
  const auto bytes = toWriter(format::probesContent()).bytes();
  const Container container = openMemory(bytes);
  lw_radiosity* room = nullptr;
  lw_radiosity_state* state = nullptr;
  lw_probes* probes = nullptr;
  ASSERT_EQ(lw_radiosity_load(container.get(), &room), LW_OK);
  ASSERT_EQ(lw_radiosity_state_create(room, &state), LW_OK);
  ASSERT_EQ(lw_probes_load(container.get(), room, &probes), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_create(gl, room, nullptr, &radiosity), LW_OK) << message;
  ASSERT_EQ(lw_gl_probes_create(radiosity, probes, nullptr, &gpu), LW_OK) << message;
  const std::vector<float> direct(27, 1.0f);
  ASSERT_EQ(lw_radiosity_set_direct(state, direct.data()), LW_OK);
  for (const float open : {0.0f, 0.5f, 1.0f}) {
    ASSERT_EQ(lw_radiosity_set_gate(state, 0, open), LW_OK);
    ASSERT_EQ(lw_gl_radiosity_upload(radiosity, state, LW_GL_RADIOSITY_DIRECT | LW_GL_RADIOSITY_PORTALS), LW_OK);
    ASSERT_EQ(lw_gl_probes_evaluate(gpu, 1), LW_OK) << message;
    std::vector<float> found(4 * 27), expected(4 * 27);
    ASSERT_EQ(lw_gl_probes_read(gpu, found.data()), LW_OK);
    lw_probes_evaluation evaluation = LW_PROBES_EVALUATION_INIT;
    evaluation.light = 1;
    ASSERT_EQ(lw_probes_evaluate(probes, state, &evaluation, expected.data()), LW_OK);
    EXPECT_LT(relrmse(found, expected), 1e-4) << open;
  }
  lw_probes_release(probes);
  lw_radiosity_state_destroy(state);
  lw_radiosity_release(room);
}

TEST_P(GlProbes, RefuseWhatCannotBe) {
  LoadedProbes p(probesInRoom());
  upload(p, 9);
  EXPECT_EQ(lw_gl_probes_evaluate(gpu, 0), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_probes_evaluate(gpu, 4), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_probes_evaluate(nullptr, 1), LW_INVALID_ARGUMENT);
  const ListProgram other(GetParam(), "", "a.xyz");
  EXPECT_EQ(lw_gl_bind_probes(gpu, other.name(), 3), LW_NOT_FOUND);
  lw_gl_probes_options options = LW_GL_PROBES_OPTIONS_INIT;
  options.coefficients = 5;
  lw_gl_probes* none = nullptr;
  EXPECT_EQ(lw_gl_probes_create(radiosity, p.probes, &options, &none), LW_INVALID_ARGUMENT);
  EXPECT_GT(lw_gl_probes_texture_bytes(gpu), 8u * p.info.links);
}

std::string apiName(const testing::TestParamInfo<Api>& info) { return info.param == Api::desktop33 ? "Core33" : "Es30"; }
INSTANTIATE_TEST_SUITE_P(Contexts, GlProbes, testing::Values(Api::desktop33, Api::embedded30), apiName);

}  // namespace
}  // namespace lightwell::test
