// Radiance maps from frame to frame on the CPU: equal to those of single frames, and written only where something changes.
#include "lightwell/lightwell_prm_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "tests/runtime/support.h"
#include "tests/runtime/synthetic_prm.h"

namespace lightwell::test {
namespace {

using State = std::unique_ptr<lw_prm_state, decltype(&lw_prm_state_release)>;

constexpr uint32_t kEverything = LW_EMITTERS_DIRECT | LW_EMITTERS_INDIRECT;

class PrmState : public testing::TestWithParam<Layout> {
 protected:
  PrmState() {
    SyntheticOptions shape;
    shape.layout = GetParam();
    shape.clusters = 200, shape.blocks = 20;
    synthetic = makeSyntheticPrm(shape);
    container = openMemory(synthetic.container);
    prm = loadPrm(container.get());
    state = makeState();
    light = randomIrradiance(shape.clusters, 1);
    atlas.assign(synthetic.source.size() * 4, -1.0f);
    options.tolerance = 0;
  }
  State makeState() const {
    lw_prm_state* made = nullptr;
    EXPECT_EQ(lw_prm_state_create(prm.get(), &made), LW_OK);
    return {made, lw_prm_state_release};
  }
  lw_prm_changes update() {
    lw_prm_changes changes{};
    EXPECT_EQ(lw_prm_state_update(state.get(), light.data(), &options, atlas.data(), &changes), LW_OK);
    return changes;
  }
  std::vector<float> evaluated() const {
    std::vector<float> result(atlas.size());
    std::vector<uint32_t> scratch(lw_prm_scratch_bytes(prm.get()) / 4 + 1);
    EXPECT_EQ(lw_prm_evaluate(prm.get(), light.data(), &options, scratch.data(), scratch.size() * 4, result.data()), LW_OK);
    return result;
  }
  void expectEvaluated() const {
    const auto expected = evaluated();
    EXPECT_LT(relrmse(atlas, expected), 1e-5);
    for (size_t i = 3; i < atlas.size(); i += 4) ASSERT_EQ(atlas[i], expected[i]);
  }
  SyntheticPrm synthetic;
  Container container;
  Prm prm{nullptr, lw_prm_release};
  State state{nullptr, lw_prm_state_release};
  std::vector<float> light, atlas;
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
};

TEST_P(PrmState, ShowsWhatSingleFramesShow) {
  for (const uint32_t fill : {1u, 0u}) {
    options.fill = fill;
    for (uint32_t frame = 0; frame < 150; ++frame) {  // past the sweep of rounding
      light[frame % light.size()] = frame % 3 ? 0.1f * float(frame) : 0.0f;
      update();
      if (frame % 10 == 0) expectEvaluated();
    }
  }
}

TEST_P(PrmState, FollowsItsOptions) {
  update();
  for (const uint32_t emitters : {0u, kEverything, 2u}) {
    options.emitters = emitters;
    EXPECT_EQ(update().rows, synthetic.options.height);
    expectEvaluated();
  }
  options.fill = 0;
  EXPECT_EQ(update().rows, synthetic.options.height);
  expectEvaluated();
}

TEST_P(PrmState, FillsAnotherAtlasAnew) {
  update();
  std::vector<float> other(atlas.size(), -1.0f);
  other.swap(atlas);
  EXPECT_EQ(update().texels, synthetic.source.size());
  expectEvaluated();
  std::fill(atlas.begin(), atlas.end(), 7.0f);
  lw_prm_state_forget(state.get());
  EXPECT_EQ(update().texels, synthetic.source.size());
  expectEvaluated();
}

TEST_P(PrmState, RejectsBadNumbersAndWritesNothing) {
  update();
  const auto before = atlas;
  for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const float good = std::exchange(light[7], bad);
    EXPECT_EQ(lw_prm_state_update(state.get(), light.data(), &options, atlas.data(), nullptr), LW_INVALID_ARGUMENT);
    light[7] = good;
  }
  options.fill = 2;
  EXPECT_EQ(lw_prm_state_update(state.get(), light.data(), &options, atlas.data(), nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(std::memcmp(atlas.data(), before.data(), atlas.size() * sizeof(float)), 0);
  EXPECT_EQ(lw_prm_state_update(nullptr, light.data(), &options, atlas.data(), nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_prm_state_update(state.get(), nullptr, &options, atlas.data(), nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_prm_state_update(state.get(), light.data(), &options, nullptr, nullptr), LW_INVALID_ARGUMENT);
  options.fill = 1;
  update();
  expectEvaluated();
}

TEST_P(PrmState, OutlivesTheHandleItWasMadeOf) {
  update();
  const auto expected = evaluated();
  prm.reset();
  container.reset();
  lw_prm_state_forget(state.get());
  update();
  EXPECT_LT(relrmse(atlas, expected), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Layouts, PrmState, testing::Values(Layout::panes_rgb9e5, Layout::panes_half, Layout::local_bases));

/// Local bases only: what has not changed stays as it is, down to the bytes that something else has written there.
class PrmStateOfBases : public PrmState {};

TEST_P(PrmStateOfBases, WritesNothingWhereTheLightStays) {
  update();
  const auto before = atlas;
  const lw_prm_changes changes = update();
  EXPECT_EQ(changes.texels, 0u);
  EXPECT_EQ(changes.rows, 0u);
  EXPECT_EQ(std::memcmp(atlas.data(), before.data(), atlas.size() * sizeof(float)), 0);
}

TEST_P(PrmStateOfBases, SaysWhichRowsHaveChanged) {
  for (const uint32_t fill : {1u, 0u}) {
    options.fill = fill;
    for (const float brighter : {0.05f, 1.0f, 0.0f}) {
      update();
      const auto before = atlas;
      light[3] += brighter;
      const lw_prm_changes changes = update();
      size_t differ = 0;
      for (size_t i = 0; i < synthetic.source.size(); ++i) {
        if (std::memcmp(&atlas[i * 4], &before[i * 4], 4 * sizeof(float)) == 0) continue;
        ++differ;
        ASSERT_GE(i / synthetic.options.width, changes.first_row);
        ASSERT_LT(i / synthetic.options.width, changes.first_row + changes.rows);
      }
      EXPECT_LE(differ, changes.texels);
      EXPECT_EQ(differ > 0, brighter > 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, PrmStateOfBases, testing::Values(Layout::local_bases));

TEST(PrmStateBlocks, AreLeftAloneWhereALightDoesNotReach) {
  SyntheticOptions shape;
  shape.layout = Layout::local_bases;
  shape.clusters = 2, shape.blocks = 200;  // with four wavelets between them, some blocks are linked to one cluster only
  const SyntheticPrm synthetic = makeSyntheticPrm(shape);
  const Container container = openMemory(synthetic.container);
  const Prm prm = loadPrm(container.get());
  lw_prm_state* made = nullptr;
  ASSERT_EQ(lw_prm_state_create(prm.get(), &made), LW_OK);
  const State state(made, lw_prm_state_release);
  std::vector<float> light(6, 0.0f), dark(synthetic.source.size() * 4), atlas(dark.size());
  ASSERT_EQ(lw_prm_state_update(state.get(), light.data(), nullptr, dark.data(), nullptr), LW_OK);
  atlas = dark;
  ASSERT_EQ(lw_prm_state_update(state.get(), light.data(), nullptr, atlas.data(), nullptr), LW_OK);
  lw_prm_changes first, second;
  light = {1, 1, 1, 0, 0, 0};
  ASSERT_EQ(lw_prm_state_update(state.get(), light.data(), nullptr, atlas.data(), &first), LW_OK);
  light = {1, 1, 1, 1, 1, 1};
  const auto before = atlas;
  ASSERT_EQ(lw_prm_state_update(state.get(), light.data(), nullptr, atlas.data(), &second), LW_OK);
  uint32_t shown = 0, differ = 0;
  for (size_t i = 0; i < atlas.size(); i += 4) {
    shown += atlas[i + 3] > 0;
    differ += std::memcmp(&atlas[i], &before[i], 3 * sizeof(float)) != 0;
  }
  EXPECT_GT(differ, 0u);
  EXPECT_GE(second.texels, differ);
  EXPECT_LT(second.texels, shown) << "what the second does not reach";
  EXPECT_GT(first.texels, 0u);
  EXPECT_LT(relrmse(atlas, synthetic.evaluate(light)), 1e-5);
}

TEST(PrmStateMemory, IsTheCallersAndAllOfItIsReleased) {
  for (const Layout layout : {Layout::panes_half, Layout::local_bases}) {
    SyntheticOptions shape;
    shape.layout = layout;
    const SyntheticPrm synthetic = makeSyntheticPrm(shape);
    for (size_t fails = 0; fails < 100; ++fails) {
      Host host;
      const lw_config config = host.config();
      {
        const Container container = openMemory(synthetic.container, &config);
        const Prm prm = loadPrm(container.get());
        host.fail_at = host.allocations + fails;
        lw_prm_state* state = nullptr;
        const lw_result result = lw_prm_state_create(prm.get(), &state);
        if (result == LW_OK) fails = 100;
        else EXPECT_EQ(result, LW_OUT_OF_MEMORY);
        lw_prm_state_release(state);
        host.fail_at = SIZE_MAX;
      }
      EXPECT_EQ(host.live, 0u);
    }
  }
  lw_prm_state_release(nullptr);
  lw_prm_state_forget(nullptr);
  EXPECT_EQ(lw_prm_state_create(nullptr, nullptr), LW_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace lightwell::test
