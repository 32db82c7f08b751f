// The section prm: the runtime finds the light that the bake has, on the clusters and on the texels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "format/encode/verify.h"
#include "lightwell/lightwell.h"
#include "precompute/bake/sections.h"
#include "precompute/core/random.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/evaluate.h"

namespace lightwell::bake {
namespace {

constexpr uint32_t kSize = 8, kClusters = 40, kBlocks = 4, kRank = 3;
constexpr double kMetresPerUnit = 0.25;

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

void splitLeaves(Random& random, uint32_t leaves, transport::WaveletTree& tree) {
  if (leaves < 2) return;
  const uint32_t first = 1 + uint32_t(random() * float(leaves - 1));
  tree.first_leaves.push_back(first);
  tree.first_share.push_back(uint16_t(1 + random() * 65534));
  splitLeaves(random, first, tree);
  splitLeaves(random, leaves - first, tree);
}

/// Entries that face anywhere; coefficients of all sizes, that wrap where one channel is taken from another; what is even is positive.
transport::PrmResult randomPrm() {
  Random random;
  transport::PrmResult prm;
  prm.entries.cluster_first_entry = {0};
  for (uint32_t c = 0; c < kClusters; ++c) {
    const Vec3 normal = Vec3(random() - 0.5f, random() - 0.5f, random() - 0.5f).normalized();
    const Vec3 along = normal.cross(Vec3(random(), random(), random())).normalized();
    prm.entries.position.emplace_back(random(), random(), random());
    prm.entries.normal.push_back(normal);
    prm.entries.half_u.push_back(along * (0.01f + random()));
    prm.entries.half_v.push_back(normal.cross(along) * (0.01f + random()));
    prm.entries.weight.push_back(1);
    prm.entries.cluster_first_entry.push_back(c + 1);
  }
  transport::PrmLocalBases& b = prm.bases;
  splitLeaves(random, kClusters, b.tree);
  for (uint32_t w = 0; w < transport::waveletCount(kClusters); ++w) b.wavelet_unit.push_back(uint8_t(150 + random() * 20));
  b.block_first_texel = b.block_first_link = {0};
  const uint32_t texels = kSize * kSize / kBlocks;
  for (uint32_t block = 0; block < kBlocks; ++block) {
    for (uint32_t i = 0; i < texels; ++i) prm.texel.push_back(block * texels + i);
    for (uint32_t i = 0; i < texels * kRank; ++i) b.basis.push_back(int8_t(random() * 127.9f));
    b.block_rank.push_back(kRank);
    b.block_first_texel.push_back(uint32_t(prm.texel.size()));
    for (uint32_t i = 0; i < kRank * 3; ++i) b.scale.push_back(0.01f + random());
    for (uint32_t w = 0; w < transport::waveletCount(kClusters); ++w)
      for (float chance = 0.7f; random() < chance; chance = 0.1f) {
        const bool even = w < transport::differenceIndex(kClusters, 0);
        b.link_wavelet.push_back(w);
        for (uint32_t i = 0; i < kRank * 3; ++i) b.coefficient.push_back(int8_t(even ? 255 * random() - 100 : 20 * random() - 10));
      }
    b.block_first_link.push_back(uint32_t(b.link_wavelet.size()));
  }
  return prm;
}

double relrmse(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double difference2 = 0, sum2 = 0;
  for (size_t i = 0; i < b.size(); ++i) difference2 += double((a[i] - b[i]).length2()), sum2 += double(b[i].length2());
  return std::sqrt(difference2 / sum2);
}

/// Where nothing is reflected no block has a rank; that is a sound radiance map, too.
TEST(PrmSectionOfABlackScene, Loads) {
  transport::PrmResult prm = randomPrm();
  transport::PrmLocalBases& b = prm.bases;
  std::fill(b.block_rank.begin(), b.block_rank.end(), uint8_t(0));
  std::fill(b.block_first_link.begin(), b.block_first_link.end(), 0);
  b.basis.clear(), b.scale.clear(), b.link_wavelet.clear(), b.coefficient.clear();
  format::Writer writer;
  addSceneSection(writer, scene::Scene());
  addAtlasSection(writer, planeAtlas());
  addPrmSection(writer, prm, {}, kMetresPerUnit);
  const std::vector<uint8_t> container = writer.bytes();
  EXPECT_TRUE(format::isSound(format::verify(format::memorySource(container.data(), container.size()))));
  lw_container* opened = nullptr;
  lw_prm* loaded = nullptr;
  ASSERT_EQ(lw_open_memory(container.data(), container.size(), nullptr, &opened), LW_OK);
  EXPECT_EQ(lw_prm_load(opened, &loaded), LW_OK);
  lw_prm_release(loaded);
  lw_close(opened);
}

class PrmSection : public testing::Test {
 protected:
  PrmSection() {
    format::Writer writer;
    addSceneSection(writer, scene::Scene());
    addAtlasSection(writer, planeAtlas());
    addPrmSection(writer, prm, {}, kMetresPerUnit);
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
  EXPECT_LT(relrmse(own, expected), 1e-5);
  Rgb expected_sum(0.0f), own_sum(0.0f);
  for (size_t i = 0; i < own.size(); ++i) expected_sum += expected[i], own_sum += own[i];
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(own_sum[channel] / expected_sum[channel], 1, 1e-5);
  one_cluster[kClusters - 1] = Rgb(1.0f);
  EXPECT_LT(relrmse(evaluate(one_cluster, 0), transport::evaluatePrm(prm, one_cluster)), 1e-5);
}

/// How an entry's rectangle lies is stored as two sides and a turn: the runtime averages a near light over the same surface.
TEST_F(PrmSection, RectanglesLieAsInTheBake) {
  Random random;
  double turned = 0, worst = 0;
  std::vector<float> rgb(kClusters * 3);
  for (int l = 0; l < 50; ++l) {
    const Vec3 place(random() * 2 - 0.5f, random() * 2 - 0.5f, random() * 2 - 0.5f);
    lw_light light{};
    light.type = LW_LIGHT_POINT;
    for (int k = 0; k < 3; ++k) light.position_m[k] = float(place[k] * kMetresPerUnit), light.intensity_rgb[k] = 1;
    ASSERT_EQ(lw_prm_entry_irradiance(loaded, &light, 1, nullptr, nullptr, rgb.data()), LW_OK);
    for (uint32_t c = 0; c < kClusters; ++c) {
      const auto& entries = prm.entries;
      const Vec3 to_light = place - entries.position[c];
      const double distance_m = double(to_light.length()) * kMetresPerUnit;
      const double cosine = std::max(double(to_light.dot(entries.normal[c])) / double(to_light.length()), 0.0);
      if (cosine < 0.05) continue;  // there the rounding of normals decides
      const auto gain = [&](const Vec3& u, const Vec3& v) { return double(transport::rectangleGain(to_light, entries.normal[c], u, v)); };
      const double as_it_lies = gain(entries.half_u[c], entries.half_v[c]);
      const double at_the_middle = cosine / (distance_m * distance_m);
      EXPECT_NEAR(rgb[c * 3], as_it_lies * at_the_middle, 5e-3 * as_it_lies * at_the_middle) << c;
      worst = std::max(worst, std::abs(rgb[c * 3] / (as_it_lies * at_the_middle) - 1));
      const Vec3 u = (entries.half_u[c] + entries.half_v[c]).normalized() * entries.half_u[c].length();
      turned = std::max(turned, std::abs(gain(u, entries.normal[c].cross(u).normalized() * entries.half_v[c].length()) / as_it_lies - 1));
    }
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_GT(turned, 0.1) << "how they lie matters";
}

TEST_F(PrmSection, BuriedTexelsKeepTheirOwnLightAndShowAnothers) {
  const std::vector<Rgb> irradiance_rgb(kClusters, Rgb(1.0f));
  const auto expected = transport::evaluatePrm(prm, irradiance_rgb);
  const auto own = evaluate(irradiance_rgb, 0), shown = evaluate(irradiance_rgb, 1);
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x) {
      const uint32_t texel = y * kSize + x, source = y * kSize + std::max(x, 2u);
      EXPECT_NEAR(own[texel].y, expected[texel].y, 1e-4 * expected[texel].y);
      EXPECT_EQ(shown[texel], own[source]);
    }
}

}  // namespace
}  // namespace lightwell::bake
