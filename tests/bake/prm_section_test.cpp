// The section prm: quantisation that keeps energy, element types as small as the light maps allow, and the values that the runtime finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "format/encode/verify.h"
#include "lightwell/lightwell.h"
#include "precompute/bake/quantise.h"
#include "precompute/bake/quantised_bases.h"
#include "precompute/bake/sections.h"
#include "precompute/core/random.h"
#include "precompute/transport/prm/evaluate.h"

namespace lightwell::bake {
namespace {

constexpr uint32_t kSize = 8, kClusters = 40, kBlocks = 4, kRank = 3;

struct Random {
  uint64_t state = 1;
  float operator()() {
    state = combineKeys(state, 1);
    return float(state >> 40) * 0x1p-24f;
  }
};

/// A plane of kSize² covered texels; the first two of each row are buried and show the third.
atlas::Atlas planeAtlas() {
  atlas::Atlas atlas;
  atlas.width = atlas.height = kSize;
  atlas.chart_count = 1;
  for (uint32_t texel = 0; texel < kSize * kSize; ++texel) {
    atlas.slots.push_back({.texel = texel});
    atlas.texel_slot.push_back(texel);
    atlas.source.push_back(std::max(texel, texel / kSize * kSize + 2));
  }
  return atlas;
}

/// Entry points over the plane y = 0; transport that differs between clusters by three orders of magnitude.
transport::PrmResult randomPrm() {
  Random random;
  transport::PrmResult prm;
  prm.entries.cluster_first_entry = {0};
  for (uint32_t c = 0; c < kClusters; ++c) {
    prm.entries.position.emplace_back(random(), 0.0f, random());
    prm.entries.normal.emplace_back(0.0f, 1.0f, 0.0f);
    prm.entries.weight.push_back(1);
    prm.entries.cluster_first_entry.push_back(c + 1);
  }
  transport::PrmLocalBases& b = prm.bases;
  b.block_first_texel = b.block_first_link = {0};
  const uint32_t texels = kSize * kSize / kBlocks;
  for (uint32_t block = 0; block < kBlocks; ++block) {
    for (uint32_t i = 0; i < texels; ++i) prm.texel.push_back(block * texels + i);
    for (uint32_t i = 0; i < texels * kRank; ++i) b.basis.push_back(std::round(random() * 127) / 127);
    b.block_rank.push_back(kRank);
    b.block_first_texel.push_back(uint32_t(prm.texel.size()));
    for (uint32_t c = 0; c < kClusters; ++c) {
      b.link_cluster.push_back(c);
      for (uint32_t i = 0; i < kRank * 3; ++i) b.coefficient.push_back(std::pow(10.0f, -3 * random()));
    }
    b.block_first_link.push_back(uint32_t(b.link_cluster.size()));
  }
  return prm;
}

double relrmse(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double difference2 = 0, sum2 = 0;
  for (size_t i = 0; i < b.size(); ++i) difference2 += double((a[i] - b[i]).length2()), sum2 += double(b[i].length2());
  return std::sqrt(difference2 / sum2);
}

TEST(Quantise, EveryRunKeepsItsSumWithinAStep) {
  Random random;
  std::vector<float> values(3000, 0.0f);  // one channel of three, mostly far smaller than a step
  for (size_t i = 0; i < values.size(); i += 3) values[i] = i % 7 == 0 ? 0.0f : std::pow(random(), 12.0f);
  std::vector<uint8_t> integers(values.size(), 77);
  const float step = quantiseKeepingSum(values.data(), 1000, 3, integers.data());
  double wanted = 0, kept = 0;
  for (size_t i = 0; i < values.size(); i += 3) {
    wanted += values[i], kept += double(integers[i]) * step;
    ASSERT_LE(std::abs(wanted - kept), 0.51 * step) << i;
    ASSERT_LE(std::abs(values[i] - integers[i] * step), 1.01 * step) << i;
    if (values[i] == 0) { ASSERT_EQ(integers[i], 0); }
    ASSERT_EQ(integers[i + 1], 77) << "another channel's";
  }
  EXPECT_GT(wanted, 20 * double(step)) << "there is something to lose";
  for (float& v : values) v = -v;
  std::vector<int8_t> negative(values.size());
  EXPECT_GT(quantiseKeepingSum(values.data(), 1000, 3, negative.data()), step);
  EXPECT_EQ(*std::min_element(negative.begin(), negative.end()), -127) << "-128 is as far from zero as nothing positive";
  const std::vector<float> dark(4, 0.0f);
  EXPECT_EQ(quantiseKeepingSum(dark.data(), 4, 1, negative.data()), 1.0f);
}

TEST(QuantisedBases, AreAsWideAsTheLightMapsNeed) {
  transport::PrmResult prm = randomPrm();
  for (float& c : prm.bases.coefficient) c = 1 + 0.1f * c;
  QuantisedBases quantised = quantiseBases(prm);
  EXPECT_EQ(quantised.coefficient_i8.size(), prm.bases.coefficient.size());
  EXPECT_TRUE(quantised.coefficient_i16.empty());
  // Great numbers that no light ever meets leave few steps to those that matter.
  prm.entries.weight[0] = 0;
  for (uint32_t block = 0; block < kBlocks; ++block)
    for (uint32_t i = 0; i < kRank * 3; ++i) prm.bases.coefficient[block * kClusters * kRank * 3 + i] = 300;
  quantised = quantiseBases(prm);
  EXPECT_EQ(quantised.coefficient_i16.size(), prm.bases.coefficient.size());
  EXPECT_TRUE(quantised.coefficient_i8.empty());
}

TEST(QuantisedBases, UseNoMoreOfSixteenBitsThanTheLightMapsNeed) {
  transport::PrmResult prm = randomPrm();
  QuantisedBases quantised = quantiseBases(prm);
  for (float steepness = 1; quantised.coefficient_i16.empty() && steepness < 8; ++steepness) {
    for (float& c : prm.bases.coefficient) c *= std::sqrt(c);
    quantised = quantiseBases(prm);
  }
  ASSERT_FALSE(quantised.coefficient_i16.empty());
  const int most = *std::max_element(quantised.coefficient_i16.begin(), quantised.coefficient_i16.end());
  EXPECT_GE(most, 3 * 127);
  EXPECT_LT(most, 32767);
}

class PrmSection : public testing::Test {
 protected:
  PrmSection() {
    format::Writer writer;
    addSceneSection(writer, scene::Scene());
    addAtlasSection(writer, planeAtlas());
    addPrmSection(writer, prm, {}, 1.0);
    container = writer.bytes();
    lw_container* opened = nullptr;
    EXPECT_EQ(lw_open_memory(container.data(), container.size(), nullptr, &opened), LW_OK);
    EXPECT_EQ(lw_prm_load(opened, &loaded), LW_OK);
    lw_close(opened);
  }
  ~PrmSection() override { lw_prm_release(loaded); }
  std::vector<Rgb> evaluate(const std::vector<Rgb>& irradiance_rgb, uint32_t fill) {
    lw_prm_options options = LW_PRM_OPTIONS_INIT;
    options.fill = fill;
    std::vector<float> scratch(lw_prm_scratch_bytes(loaded) / sizeof(float)), rgba(kSize * kSize * 4);
    EXPECT_EQ(lw_prm_evaluate(loaded, &irradiance_rgb[0].x, &options, scratch.data(), scratch.size() * sizeof(float), rgba.data()), LW_OK);
    std::vector<Rgb> rgb;
    for (size_t i = 0; i < rgba.size(); i += 4) rgb.emplace_back(rgba[i], rgba[i + 1], rgba[i + 2]);
    return rgb;
  }
  const transport::PrmResult prm = randomPrm();
  std::vector<uint8_t> container;
  lw_prm* loaded = nullptr;
};

TEST_F(PrmSection, IsSound) {
  for (const auto& issue : format::verify(format::memorySource(container.data(), container.size())))
    ADD_FAILURE() << issue.place << ": " << issue.message;
}

TEST_F(PrmSection, GivesTheBakesLight) {
  Random random;
  std::vector<Rgb> irradiance_rgb, one_cluster(kClusters, Rgb(0.0f));
  for (uint32_t c = 0; c < kClusters; ++c) irradiance_rgb.emplace_back(random(), random(), random());
  const auto expected = transport::evaluatePrm(prm, irradiance_rgb), own = evaluate(irradiance_rgb, 0);
  EXPECT_LT(relrmse(own, expected), kMostCoefficientChange);
  Rgb expected_sum(0.0f), own_sum(0.0f);
  for (size_t i = 0; i < own.size(); ++i) expected_sum += expected[i], own_sum += own[i];
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(own_sum[channel] / expected_sum[channel], 1, 5e-4);
  one_cluster[kClusters - 1] = Rgb(1.0f);
  EXPECT_LT(relrmse(evaluate(one_cluster, 0), transport::evaluatePrm(prm, one_cluster)), 0.01);
}

TEST_F(PrmSection, BuriedTexelsKeepTheirOwnLightAndShowAnothers) {
  const std::vector<Rgb> irradiance_rgb(kClusters, Rgb(1.0f));
  const auto expected = transport::evaluatePrm(prm, irradiance_rgb);
  const auto own = evaluate(irradiance_rgb, 0), shown = evaluate(irradiance_rgb, 1);
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x) {
      const uint32_t texel = y * kSize + x, source = y * kSize + std::max(x, 2u);
      EXPECT_NEAR(own[texel].y, expected[texel].y, 0.01 * expected[texel].y);
      EXPECT_EQ(shown[texel], own[source]);
    }
}

}  // namespace
}  // namespace lightwell::bake
