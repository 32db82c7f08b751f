// Light maps from virtual lights on OpenGL: changes of sources, budgets, bad arguments. What is drawn is compared with what a new light map draws.
#include <gmock/gmock.h>

#include <array>

#include "tests/bake/gl_vpl_fixture.h"

namespace lightwell::bake {
namespace {

using testing::HasSubstr;

class GlVplChanges : public GlVplTest {
 protected:
  GlVplChanges() {
    options.shadow_map_side = 64;
    options.pieces = 1;
    scene::Scene scene = boxesInBox();
    scene.lights.push_back(test::pointLight({-1.4f, 2.2f, 1.2f}, 6));
    room = std::make_unique<LitRoom>(std::move(scene), 32, 30);
  }
  std::vector<lw_virtual_light> lightsOf(uint32_t source) const {
    std::vector<lw_virtual_light> chosen;
    for (const auto& light : room->lights)
      if (light.source == source) chosen.push_back(light);
    return chosen;
  }
  /// A new light map whose sources are scaled.
  std::vector<Vec3d> drawScaled(const std::array<float, 2>& scale) {
    const GlVpl vpl = create(*room, options);
    for (uint32_t s = 0; s < 2; ++s) setScale(vpl.get(), s, scale[s]);
    finish(vpl.get());
    return read(*room, vpl.get());
  }
  void setScale(lw_gl_vpl* vpl, uint32_t source, float scale) {
    const float rgb[3] = {scale, scale, scale};
    ASSERT_EQ(lw_gl_vpl_set_source_scale(vpl, source, rgb), LW_OK) << message;
  }

  lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
  std::unique_ptr<LitRoom> room;
};
INSTANTIATE_TEST_SUITE_P(Contexts, GlVplChanges, testing::Values(test::Api::desktop33, test::Api::embedded30), test::apiName);

TEST_P(GlVplChanges, AColourNeedsNoLightsWhereASourceHasItsLayer) {
  const GlVpl vpl = create(*room, options);
  finish(vpl.get());
  setScale(vpl.get(), 1, 3);
  lw_gl_vpl_progress progress{};
  ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 0, &progress), LW_OK);
  EXPECT_EQ(progress.lights_drawn, 0u);
  EXPECT_EQ(progress.lights_left, 0u);
  EXPECT_LT(relativeError(read(*room, vpl.get()), drawScaled({1, 3})), 1e-5);
}

TEST_P(GlVplChanges, AColourInASharedLayerIsDrawnAsADifferenceOfThatSourceAlone) {
  options.layers = 1;
  const GlVpl vpl = create(*room, options);
  finish(vpl.get());
  setScale(vpl.get(), 1, 3);
  EXPECT_EQ(finish(vpl.get()), lightsOf(1).size());
  EXPECT_LT(relativeError(read(*room, vpl.get()), drawScaled({1, 3})), 1e-5);
}

TEST_P(GlVplChanges, AMovedSourceHasItsNewLightsAlone) {
  for (const uint32_t layers : {16u, 1u}) {
    options.layers = layers;
    const GlVpl vpl = create(*room, options);
    finish(vpl.get());
    const auto lights = lightsOf(1), others = lightsOf(0);
    // It moves to where half of the other's lights are.
    ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 1, others.data(), uint32_t(others.size() / 2)), LW_OK) << message;
    EXPECT_EQ(finish(vpl.get()), others.size() / 2 + (layers == 1 ? lights.size() : 0));
    const auto moved = read(*room, vpl.get());
    const GlVpl fresh = create(*room, options);
    ASSERT_EQ(lw_gl_vpl_set_source_lights(fresh.get(), 1, others.data(), uint32_t(others.size() / 2)), LW_OK) << message;
    finish(fresh.get());
    EXPECT_LT(relativeError(moved, read(*room, fresh.get())), 1e-5) << layers;
    // It goes.
    ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 1, nullptr, 0), LW_OK);
    EXPECT_EQ(finish(vpl.get()), layers == 1 ? others.size() / 2 : 0);
    EXPECT_LT(relativeError(read(*room, vpl.get()), drawScaled({1, 0})), 1e-5) << layers;
  }
}

TEST_P(GlVplChanges, AHundredChangesAndBackLeaveNothing) {
  options.layers = 1;
  const auto fresh = drawScaled({1, 1});
  const GlVpl vpl = create(*room, options);
  finish(vpl.get());
  for (int i = 0; i < 100; ++i) {
    setScale(vpl.get(), uint32_t(i % 2), i % 5 == 0 ? 1000.0f : float(i % 7));
    finish(vpl.get());
  }
  for (uint32_t s = 0; s < 2; ++s) setScale(vpl.get(), s, 1);
  finish(vpl.get());
  EXPECT_LT(relativeError(read(*room, vpl.get()), fresh), 1e-3);
  ASSERT_EQ(lw_gl_vpl_redraw(vpl.get()), LW_OK);
  EXPECT_EQ(finish(vpl.get()), room->lights.size());
  EXPECT_LT(relativeError(read(*room, vpl.get()), fresh), 1e-7);
}

TEST_P(GlVplChanges, OldLightStaysUntilTheNewIsThere) {
  for (const uint32_t layers : {16u, 1u}) {
    options.layers = layers;
    const GlVpl vpl = create(*room, options);
    finish(vpl.get());
    const double before = meanOf(read(*room, vpl.get()));
    setScale(vpl.get(), 1, layers == 1 ? 0.5f : 1.0f);
    auto lights = lightsOf(1);
    for (auto& light : lights)
      for (float& flux : light.flux_rgb) flux *= layers == 1 ? 1.0f : 0.5f;
    if (layers == 16) {
      ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 1, lights.data(), uint32_t(lights.size())), LW_OK);
    }
    std::vector<double> means{before};
    for (lw_gl_vpl_progress progress{0, 1, 0}; progress.lights_left > 0;) {
      ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 0, &progress), LW_OK);
      EXPECT_EQ(progress.lights_drawn, 1u) << "a budget of 0 is one light";
      means.push_back(meanOf(read(*room, vpl.get())));
    }
    const double after = means.back();
    EXPECT_LT(after, 0.9 * before);
    for (const double mean : means) {
      EXPECT_GT(mean, after * 0.93) << layers;
      EXPECT_LT(mean, before * 1.07) << layers;
    }
  }
}

TEST_P(GlVplChanges, ALampThatNeverRestsIsShown) {
  const GlVpl vpl = create(*room, options);
  finish(vpl.get());
  auto lights = lightsOf(1);
  const double before = meanOf(read(*room, vpl.get()));
  for (auto& light : lights)
    for (float& flux : light.flux_rgb) flux *= 4;
  for (size_t frame = 0; frame < lights.size() + 2; ++frame) {
    ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 1, lights.data(), uint32_t(lights.size())), LW_OK);
    ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 0, nullptr), LW_OK);
  }
  EXPECT_GT(meanOf(read(*room, vpl.get())), 1.5 * before);
}

TEST_P(GlVplChanges, StepsKeepToTheirBudget) {
  const GlVpl vpl = create(*room, options);
  lw_gl_vpl_progress progress{};
  ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 0, &progress), LW_OK);
  uint32_t drawn = progress.lights_drawn, left = progress.lights_left;
  EXPECT_EQ(drawn, 1u);
  EXPECT_EQ(drawn + left, room->lights.size());
  const double light_ms = std::max(progress.ms, 0.1);
  int late = 0, steps = 0;
  while (progress.lights_left > 0) {
    ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 4 * light_ms, &progress), LW_OK);
    EXPECT_GT(progress.lights_drawn, 0u);
    EXPECT_EQ(progress.lights_left + progress.lights_drawn, left);
    left = progress.lights_left;
    late += progress.ms > 8 * light_ms + 20;  // a machine that does other things, too
    ++steps;
  }
  EXPECT_LE(late, 1 + steps / 4);
  ASSERT_EQ(lw_gl_vpl_step(vpl.get(), 1000, &progress), LW_OK);
  EXPECT_EQ(progress.lights_drawn, 0u) << "nothing is left";
}

TEST_P(GlVplChanges, ComponentsAddUpAndPiecesKeepTheLight) {
  const auto whole = draw(*room, options);
  options.component = LW_GL_VPL_INDIRECT;
  EXPECT_LT(relativeError(draw(*room, options), whole), 1e-6) << "lamps are no virtual lights: all is indirect";
  options.component = LW_GL_VPL_DIRECT;
  EXPECT_EQ(meanOf(draw(*room, options)), 0);
  options.component = LW_GL_VPL_DIRECT | LW_GL_VPL_INDIRECT;
  options.shadow_map_side = 0;
  const auto open = draw(*room, options);
  options.pieces = 5;
  EXPECT_LT(relativeError(draw(*room, options), open), 1e-3) << "form factors of parts add up";
}

TEST_P(GlVplChanges, RefusesWhatIsWrong) {
  lw_gl_vpl* none = nullptr;
  EXPECT_EQ(lw_gl_vpl_create(gl, nullptr, nullptr, nullptr, &none), LW_INVALID_ARGUMENT);
  const auto refuses = [&](auto change) {
    lw_gl_vpl_options wrong = LW_GL_VPL_OPTIONS_INIT;
    change(wrong);
    message.clear();
    EXPECT_EQ(lw_gl_vpl_create(gl, room->container, nullptr, &wrong, &none), LW_INVALID_ARGUMENT);
    EXPECT_THAT(message, HasSubstr("lw_gl_vpl_options"));
  };
  refuses([](auto& o) { o.size = 8; });
  refuses([](auto& o) { o.component = 0; });
  refuses([](auto& o) { o.layers = 33; });
  refuses([](auto& o) { o.shadow_map_side = 17; });
  refuses([](auto& o) { o.filter_samples = 0; });
  refuses([](auto& o) { o.pieces = NAN; });
  refuses([](auto& o) { o.epsilon = -1; });
  const GlVpl vpl = create(*room, options);
  EXPECT_EQ(lw_gl_vpl_step(vpl.get(), -1, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_vpl_step(vpl.get(), NAN, nullptr), LW_INVALID_ARGUMENT);
  const float negative[3] = {1, -1, 1}, one[3] = {1, 1, 1};
  EXPECT_EQ(lw_gl_vpl_set_source_scale(vpl.get(), 0, negative), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_vpl_set_source_scale(vpl.get(), 99, one), LW_NOT_FOUND);
  EXPECT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 99, nullptr, 0), LW_NOT_FOUND);
  auto lights = lightsOf(0);
  lights[1].flux_rgb[2] = NAN;
  EXPECT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 0, lights.data(), uint32_t(lights.size())), LW_INVALID_ARGUMENT);
  EXPECT_THAT(message, HasSubstr("virtual light 1"));
  EXPECT_EQ(finish(vpl.get()), room->lights.size()) << "what was refused has changed nothing";
}

}  // namespace
}  // namespace lightwell::bake
