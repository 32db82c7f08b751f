// Each invariant of docs/format.md, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "format/encode/verify.h"
#include "tests/format/content.h"
#include "tests/format/listed.h"

namespace lightwell::format {
namespace {

struct Breach {
  const char* name;
  IssueId id;
  const char* place;
  std::function<void(Content&)> spoil;
  bool local_bases = false;
};

std::vector<Issue> issuesOf(const Content& content) {
  const std::vector<uint8_t> file = toWriter(content).bytes();
  return verify(memorySource(file.data(), file.size()));
}

const std::vector<Breach>& breaches() {
  static const std::vector<Breach> all = {
      {"MetaErrorNan", IssueId::header_value, "meta/header", [](Content& c) { c.meta.mutable_errors(0)->set_relrmse(NAN); }},
      {"MetaErrorNegative", IssueId::header_value, "meta/header", [](Content& c) { c.meta.mutable_errors(0)->set_texrel(-1); }},
      {"OmittedWithoutReason", IssueId::header_value, "meta/header", [](Content& c) { c.meta.mutable_omitted(0)->clear_reason(); }},
      {"OriginShort", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_origin()->RemoveLast(); }},
      {"OriginInfinite", IssueId::header_value, "scene/header", [](Content& c) { c.scene.set_origin(1, INFINITY); }},
      {"BoundsInsideOut", IssueId::header_value, "scene/header", [](Content& c) { c.scene.set_bounds_min(2, 5); }},
      {"LightWithoutType", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_lights(0)->clear_type(); }},
      {"LightNegative", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_lights(0)->set_intensity(0, -1); }},
      {"LightNotUnit", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_lights(0)->set_direction(1, -2); }},
      {"LightCones", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_lights(0)->set_inner_cone_angle(0.5f); }},
      {"LightRange", IssueId::header_value, "scene/header", [](Content& c) { c.scene.mutable_lights(0)->set_range(NAN); }},
      {"PositionNan", IssueId::not_finite, "geometry/position", [](Content& c) { c.position[4] = NAN; }},
      {"NormalReserved", IssueId::value_range, "geometry/normal", [](Content& c) { c.normal[3] = INT16_MIN; }},
      {"NormalCount", IssueId::chunk_shape, "geometry/normal", [](Content& c) { c.normal.resize(6); }},
      {"UvOutside", IssueId::value_range, "geometry/lightmap_uv", [](Content& c) { c.lightmap_uv[0] = 1.5f; }},
      {"IndexRange", IssueId::index_range, "geometry/index", [](Content& c) { c.index[5] = 4; }},
      {"FlagsReserved", IssueId::reserved_bits, "geometry/triangle_flags", [](Content& c) { c.triangle_flags[0] = 8; }},
      {"FlagsCount", IssueId::chunk_shape, "geometry/triangle_flags", [](Content& c) { c.triangle_flags.push_back(0); }},
      {"AlphaMissing", IssueId::chunk_missing, "geometry/triangle_alpha", [](Content& c) { c.left_out = {"geometry/triangle_alpha"}; }},
      {"AlphaTextureMissing", IssueId::chunk_missing, "geometry/alpha_texture_0",
       [](Content& c) { c.left_out = {"geometry/alpha_texture_0"}; }},
      {"AlphaIndex", IssueId::index_range, "geometry/triangle_alpha", [](Content& c) { c.triangle_alpha[1] = 1; }},
      {"AlphaMode", IssueId::value_range, "geometry/triangle_alpha", [](Content& c) { c.triangle_flags[1] = 5; }},
      {"AlphaFactor", IssueId::header_value, "geometry/alpha_material",
       [](Content& c) { c.alpha_material.mutable_materials(0)->set_factor(2); }},
      {"AlphaWrap", IssueId::header_value, "geometry/alpha_material",
       [](Content& c) { c.alpha_material.mutable_materials(0)->clear_wrap_v(); }},
      {"AlphaUv", IssueId::not_finite, "geometry/alpha_uv", [](Content& c) { c.alpha_uv[2] = INFINITY; }},
      {"AtlasSize", IssueId::header_value, "atlas/header", [](Content& c) { c.atlas.set_height(0); }},
      {"AtlasCovered", IssueId::header_value, "atlas/header", [](Content& c) { c.atlas.set_covered_texels(5); }},
      {"SourceMissing", IssueId::chunk_missing, "atlas/source", [](Content& c) { c.left_out = {"atlas/source"}; }},
      {"SourceRange", IssueId::index_range, "atlas/source", [](Content& c) { c.source[8] = 16; }},
      {"SourceChain", IssueId::order, "atlas/source", [](Content& c) { c.source[5] = 3; }},
      {"SourceUncovered", IssueId::index_range, "atlas/source", [](Content& c) { c.source[8] = 8; }},
      {"SourceNothing", IssueId::value_range, "atlas/source",
       [](Content& c) {
         c.source[3] = 0xffffffffu;
         std::fill_n(c.albedo.begin() + 9, 3, uint8_t(0));
       }},
      {"CoverageValue", IssueId::value_range, "atlas/coverage", [](Content& c) { c.coverage[15] = 2; }},
      {"AlbedoOfNothing", IssueId::value_range, "atlas/albedo", [](Content& c) { c.albedo[47] = 1; }},
      {"EmissionOfNothing", IssueId::value_range, "atlas/emission", [](Content& c) { c.emission[15] = 1; }},
      {"AtlasSectionMissing", IssueId::section_missing, "prm", [](Content& c) { c.left_out = {"atlas", "geometry"}; }},
      {"EntryNan", IssueId::not_finite, "prm/entry_position", [](Content& c) { c.entry_position[0] = NAN; }},
      {"EntryNormal", IssueId::value_range, "prm/entry_normal", [](Content& c) { c.entry_normal[0] = INT16_MIN; }},
      {"WeightNegative", IssueId::not_finite, "prm/entry_weight", [](Content& c) { c.entry_weight = {1.5f, -0.5f, 1}; }},
      {"WeightSum", IssueId::weight_sum, "prm/entry_weight", [](Content& c) { c.entry_weight[2] = 0.99f; }},
      {"ClusterOrder", IssueId::order, "prm/cluster_first_entry", [](Content& c) { c.cluster_first_entry[1] = 3; }},
      {"ClusterEnd", IssueId::order, "prm/cluster_first_entry", [](Content& c) { c.cluster_first_entry[2] = 2; }},
      {"EntryCount", IssueId::chunk_shape, "prm/entry_weight", [](Content& c) { c.entry_weight.push_back(1); }},
      {"TexelRange", IssueId::index_range, "prm/texel", [](Content& c) { c.texel[0] = 16; }},
      {"TexelTwice", IssueId::order, "prm/texel", [](Content& c) { c.texel[0] = 1; }},
      {"TexelUncovered", IssueId::cross_section, "prm/texel", [](Content& c) { c.texel[0] = 9; }},
      {"LayoutUnknown", IssueId::header_value, "prm/header", [](Content& c) { c.prm.clear_layout(); }},
      {"LayoutReserved", IssueId::header_value, "prm/header", [](Content& c) { c.prm.set_layout(v1::PrmLayout(2)); }},
      {"BasesWithoutClusters", IssueId::header_value, "prm/header",
       [](Content& c) {
         c.prm.set_entries(0), c.prm.set_clusters(0);
         c.entry_position.clear(), c.entry_normal.clear(), c.entry_weight.clear();
         c.cluster_first_entry = {0};
       },
       true},
      {"PaneMissing", IssueId::chunk_missing, "prm/pane", [](Content& c) { c.left_out = {"prm/pane"}; }},
      {"PaneInfinite", IssueId::not_finite, "prm/pane", [](Content& c) { c.pane_half.assign(18, 0x7c00); }},
      {"PaneNegative", IssueId::not_finite, "prm/pane", [](Content& c) { c.pane_half.assign(18, 0xbc00); }},
      {"Brightest", IssueId::header_value, "prm/header", [](Content& c) { c.prm.set_brightest(3); }},
      {"EmitterMissing", IssueId::chunk_missing, "prm/emitter_direct", [](Content& c) { c.left_out = {"prm/emitter_direct"}; }},
      {"SkyMissing", IssueId::chunk_missing, "prm/sky_direct", [](Content& c) { (c = skyPanesContent()).sky_direct.clear(); }},
      {"SkyScale", IssueId::header_value, "prm/header", [](Content& c) { (c = skyPanesContent()).prm.set_sky_scale(3); }},
      {"BlockOrder", IssueId::order, "prm/block_first_texel", [](Content& c) { c.block_first_texel[1] = 0; }, true},
      {"MaxRank", IssueId::header_value, "prm/header", [](Content& c) { c.prm.set_max_rank(256); }, true},
      {"BlockRank", IssueId::value_range, "prm/block_rank", [](Content& c) { c.block_rank[0] = 3; }, true},
      {"BasisCount", IssueId::chunk_shape, "prm/basis", [](Content& c) { c.basis.pop_back(); }, true},
      {"BasisReserved", IssueId::value_range, "prm/basis", [](Content& c) { c.basis[0] = INT8_MIN; }, true},
      {"LinkFalls", IssueId::order, "prm/block_first_link", [](Content& c) { c.block_first_link[1] = 5; }, true},
      {"LinkOrder", IssueId::order, "prm/link_wavelet", [](Content& c) { c.link_wavelet[1] = 0; }, true},
      {"LinkRange", IssueId::index_range, "prm/link_wavelet", [](Content& c) { c.link_wavelet[3] = 7; }, true},
      {"LinkCount", IssueId::order, "prm/block_first_link", [](Content& c) { c.link_wavelet.push_back(6); }, true},
      {"TreeAllInFirst", IssueId::value_range, "prm/tree_first_leaves", [](Content& c) { c.tree_first_leaves[0] = 3; }, true},
      {"TreeNoneInFirst", IssueId::value_range, "prm/tree_first_leaves", [](Content& c) { c.tree_first_leaves[1] = 0; }, true},
      {"TreeBeyondParent", IssueId::value_range, "prm/tree_first_leaves", [](Content& c) { c.tree_first_leaves[1] = 2; }, true},
      {"TreeCount", IssueId::chunk_shape, "prm/tree_first_leaves", [](Content& c) { c.tree_first_leaves.push_back(1); }, true},
      {"ShareZero", IssueId::value_range, "prm/tree_first_share", [](Content& c) { c.tree_first_share[1] = 0; }, true},
      {"ShareCount", IssueId::chunk_shape, "prm/tree_first_share", [](Content& c) { c.tree_first_share.pop_back(); }, true},
      {"UnitCount", IssueId::chunk_shape, "prm/wavelet_unit", [](Content& c) { c.wavelet_unit.push_back(160); }, true},
      {"RectangleInfinite", IssueId::not_finite, "prm/entry_rectangle", [](Content& c) { c.entry_rectangle[4] = 0x7c00; }, true},
      {"RectangleNan", IssueId::not_finite, "prm/entry_rectangle", [](Content& c) { c.entry_rectangle[11] = 0xfe01; }, true},
      {"RectangleCount", IssueId::chunk_shape, "prm/entry_rectangle", [](Content& c) { c.entry_rectangle.resize(9); }, true},
      {"RectangleMissing", IssueId::chunk_missing, "prm/entry_rectangle", [](Content& c) { c.left_out = {"prm/entry_rectangle"}; }, true},
      {"ScaleNan", IssueId::not_finite, "prm/coefficient_scale", [](Content& c) { c.coefficient_scale[0] = NAN; }, true},
      {"ScaleCount", IssueId::chunk_shape, "prm/coefficient_scale", [](Content& c) { c.coefficient_scale.pop_back(); }, true},
      {"ScaleNegative", IssueId::not_finite, "prm/coefficient_scale", [](Content& c) { c.coefficient_scale[2] = -1; }, true},
      {"CoefficientCount", IssueId::chunk_shape, "prm/coefficient", [](Content& c) { c.coefficient.push_back(0); }, true},
      {"BasesBrightest", IssueId::header_value, "prm/header", [](Content& c) { c.prm.set_brightest(1); }, true},
  };
  return all;
}

TEST(Verify, SoundContentHasNoIssues) {
  EXPECT_EQ(listed(issuesOf(panesContent())), "");
  EXPECT_EQ(listed(issuesOf(localBasesContent())), "");
}

/// A tree of one leaf has no nodes; and it may be as deep as there are clusters.
TEST(Verify, TreesOfAnyShapeAreSound) {
  Content one = localBasesContent();
  one.prm.set_clusters(1);
  one.entry_weight = {0.25f, 0.25f, 0.25f, 0.25f};
  one.cluster_first_entry = {0, 4};
  one.tree_first_leaves.clear(), one.tree_first_share.clear();
  one.wavelet_unit = {160};
  one.link_wavelet.assign(4, 0);
  EXPECT_EQ(listed(issuesOf(one)), "");
  for (const bool first : {false, true}) {
    constexpr uint32_t kClusters = 1000;
    Content deep = localBasesContent();
    deep.prm.set_entries(kClusters), deep.prm.set_clusters(kClusters);
    deep.entry_position.assign(kClusters * 3, 0), deep.entry_normal.assign(kClusters * 2, 0), deep.entry_weight.assign(kClusters, 1);
    deep.entry_rectangle.assign(kClusters * 3, 0);
    deep.cluster_first_entry.resize(kClusters + 1), deep.tree_first_leaves.resize(kClusters - 1);
    for (uint32_t c = 0; c <= kClusters; ++c) deep.cluster_first_entry[c] = c;
    for (uint32_t n = 0; n + 1 < kClusters; ++n) deep.tree_first_leaves[n] = first ? kClusters - 1 - n : 1;
    deep.tree_first_share.assign(kClusters - 1, 1), deep.wavelet_unit.assign(3 * kClusters - 2, 160);
    EXPECT_EQ(listed(issuesOf(deep)), "") << first;
  }
}

class Invariant : public testing::TestWithParam<size_t> {};

TEST_P(Invariant, IsHeld) {
  const Breach& breach = breaches()[GetParam()];
  Content content = breach.local_bases ? localBasesContent() : panesContent();
  breach.spoil(content);
  const std::vector<Issue> issues = issuesOf(content);
  ASSERT_EQ(issues.size(), 1u) << listed(issues);
  EXPECT_EQ(issues[0].id, breach.id) << listed(issues);
  EXPECT_EQ(issues[0].place, breach.place);
  EXPECT_EQ(issues[0].status, Status::bad_section);
  EXPECT_FALSE(issues[0].message.empty());
  EXPECT_FALSE(isSound(issues));
}

INSTANTIATE_TEST_SUITE_P(Breach, Invariant, testing::Range(size_t(0), breaches().size()),
                         [](const auto& info) { return std::string(breaches()[info.param].name); });

TEST(Verify, UnknownThingsAreNotes) {
  Writer writer = toWriter(panesContent());
  writer.add("prm", "later", std::vector<uint8_t>{1, 2, 3});
  writer.addSection("caustics", 1, false);
  writer.add("caustics", "position", std::vector<float>{1, 2, 3});
  const std::vector<uint8_t> file = writer.bytes();
  const std::vector<Issue> issues = verify(memorySource(file.data(), file.size()));
  EXPECT_TRUE(isSound(issues));
  ASSERT_EQ(issues.size(), 2u);
  EXPECT_EQ(issues[0].id, IssueId::section_unknown);
  EXPECT_EQ(issues[1].id, IssueId::chunk_unknown);
  EXPECT_EQ(issues[1].place, "prm/later");
}

TEST(Verify, NotAMessage) {
  Writer writer;
  writer.addSection("scene");
  writer.add("scene", "header", std::vector<uint8_t>{0x0a, 0x7f}, {2}, ElementType::bytes);
  const std::vector<uint8_t> file = writer.bytes();
  const std::vector<Issue> issues = verify(memorySource(file.data(), file.size()));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].id, IssueId::message_invalid);
}

TEST(Verify, WrongElementType) {
  Writer writer;
  writer.addSection("scene");
  writer.add("scene", "header", std::vector<uint8_t>{0x0a, 0x00});
  const std::vector<uint8_t> file = writer.bytes();
  const std::vector<Issue> issues = verify(memorySource(file.data(), file.size()));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].id, IssueId::chunk_element);
}

}  // namespace
}  // namespace lightwell::format
