// Each invariant of the section radiosity, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>

#include "format/decode/headers.h"
#include "tests/format/breach.h"
#include "tests/format/radiosity_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<RadiosityContent>;

/// All of portalsContent, which has every chunk.
const std::vector<Breach>& breaches() {
  using C = RadiosityContent;
  constexpr uint32_t kNone = 0xffffffffu;
  constexpr const char* kHeader = "radiosity/header";
  static const std::vector<Breach> all = {
      {"NoPatches", IssueId::header_value, kHeader, [](C& c) { c.header.set_patches(0); }},
      {"NoTexels", IssueId::header_value, kHeader, [](C& c) { c.header.set_texels(0); }},
      {"TooManyNodes", IssueId::header_value, kHeader, [](C& c) { c.header.set_patches(15u << 20); }},
      {"NoMaterials", IssueId::header_value, kHeader, [](C& c) { c.header.clear_materials(); }},
      {"PortalWithoutStrips", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->set_strips(0); }},
      {"PortalElsewhere", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->set_first_gate(1); }},
      {"TooManyGates", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->set_strips(40000); }},
      {"LeafWithoutAxis", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->clear_axis(); }},
      {"LeafAxisZero", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->set_axis(0, 0); }},
      {"LeafOffsetNan", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_portals(0)->set_offset(NAN); }},
      {"LeafOutside", IssueId::cross_section, kHeader, [](C& c) { c.header.mutable_portals(0)->set_first_triangle(100); }},
      {"AreaZero", IssueId::value_range, "radiosity/patch_area", [](C& c) { c.patch_area[2] = 0; }},
      {"AreaNan", IssueId::value_range, "radiosity/patch_area", [](C& c) { c.patch_area[2] = NAN; }},
      {"PositionInfinite", IssueId::not_finite, "radiosity/patch_position", [](C& c) { c.patch_position[5] = INFINITY; }},
      {"NormalReserved", IssueId::value_range, "radiosity/patch_normal", [](C& c) { c.patch_normal[3] = INT16_MIN; }},
      {"MaterialOutside", IssueId::index_range, "radiosity/patch_material", [](C& c) { c.patch_material[4] = 2; }},
      {"AlbedoOne", IssueId::value_range, "radiosity/patch_albedo", [](C& c) { c.patch_albedo[7] = 1; }},
      {"AlbedoCount", IssueId::chunk_shape, "radiosity/patch_albedo", [](C& c) { c.patch_albedo.resize(24); }},
      {"EmissionMissing", IssueId::chunk_missing, "radiosity/patch_emission", [](C& c) { c.left_out = {"patch_emission"}; }},
      {"LinksFall", IssueId::order, "radiosity/link_first", [](C& c) { c.link_first[1] = 5; }},
      {"LinksShort", IssueId::order, "radiosity/link_first", [](C& c) { c.link_first.back() -= 1; }},
      {"NodeOutside", IssueId::index_range, "radiosity/link_node", [](C& c) { c.link_node[1] = 11; }},
      {"NodesFall", IssueId::order, "radiosity/link_node", [](C& c) { c.link_gates[1] = 0, c.link_node[1] = 7; }},
      {"NodeTwice", IssueId::order, "radiosity/link_node", [](C& c) { c.link_gates[1] = 0, c.link_node[1] = 8; }},
      {"SetsFall", IssueId::order, "radiosity/link_node", [](C& c) { c.link_gates[1] = 2, c.link_gates[2] = 1; }},
      {"SetOutside", IssueId::index_range, "radiosity/link_gates", [](C& c) { c.link_gates[1] = 4; }},
      {"ScaleNan", IssueId::not_finite, "radiosity/row_scale", [](C& c) { c.row_scale[1] = NAN; }},
      {"ScaleNegative", IssueId::not_finite, "radiosity/row_scale", [](C& c) { c.row_scale[1] = -1; }},
      {"RowGains", IssueId::weight_sum, "radiosity/row_scale", [](C& c) { c.row_scale[1] *= 1.01f; }},
      {"RowGainsWhenClosed", IssueId::weight_sum, "radiosity/row_scale", [](C& c) { c.link_code[2] = 0x40; }},
      {"SetZeroNotEmpty", IssueId::value_range, "radiosity/gate_set_first", [](C& c) { c.gate_set_first = {0, 1, 1, 2, 4}; }},
      {"SetsShort", IssueId::order, "radiosity/gate_set_first", [](C& c) { c.gate_set_first.back() = 3; }},
      {"GateOutside", IssueId::index_range, "radiosity/gate_set", [](C& c) { c.gate_set[1] = 5; }},
      {"GatesFall", IssueId::order, "radiosity/gate_set", [](C& c) { std::swap(c.gate_set[2], c.gate_set[3]); }},
      {"TexelOutside", IssueId::index_range, "radiosity/texel", [](C& c) { c.texel[2] = 16; }},
      {"TexelTwice", IssueId::order, "radiosity/texel", [](C& c) { c.texel[1] = 0; }},
      {"TexelUncovered", IssueId::cross_section, "radiosity/texel", [](C& c) { c.texel[2] = 5; }},
      {"TexelWithoutPatch", IssueId::index_range, "radiosity/texel_patch", [](C& c) { c.texel_patch[8] = kNone; }},
      {"TexelPatchOutside", IssueId::index_range, "radiosity/texel_patch", [](C& c) { c.texel_patch[1] = 9; }},
      {"TexelWeights", IssueId::weight_sum, "radiosity/texel_weight", [](C& c) { c.texel_weight[0] = 201; }},
      {"WeightOfNothing", IssueId::value_range, "radiosity/texel_weight", [](C& c) { c.texel_weight[0] = 100, c.texel_weight[3] = 100; }},
      {"ExposedMissing", IssueId::chunk_missing, "radiosity/texel_exposed", [](C& c) { c.left_out = {"texel_exposed"}; }},
      {"BackOutside", IssueId::index_range, "radiosity/texel_back_patch", [](C& c) { c.texel_back_patch[1] = 9; }},
      {"WithoutGeometry", IssueId::section_missing, "radiosity", [](C& c) { c.base.left_out.insert("geometry"); }},
  };
  return all;
}

TEST(VerifyRadiosity, SoundContentHasNoIssues) {
  EXPECT_EQ(listed(issuesOf(radiosityContent())), "");
  EXPECT_EQ(listed(issuesOf(portalsContent())), "");
}

class RadiosityInvariant : public testing::TestWithParam<size_t> {};

TEST_P(RadiosityInvariant, IsHeld) { expectNamed(breaches()[GetParam()], portalsContent()); }

INSTANTIATE_TEST_SUITE_P(Breach, RadiosityInvariant, testing::Range(size_t(0), breaches().size()),
                         [](const auto& info) { return std::string(breaches()[info.param].name); });

TEST(Headers, Radiosity) {
  const std::string bytes = portalsContent().header.SerializeAsString();
  RadiosityHeader header;
  std::string_view names[1];
  RadiosityPortal portals[1];
  ASSERT_TRUE(parseRadiosityHeader(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), header, names, 1, portals, 1));
  EXPECT_EQ(header.patches, 9u);
  EXPECT_EQ(header.texels, 3u);
  EXPECT_TRUE(header.has_emission && header.has_backs);
  EXPECT_EQ(header.material_count, 2u);
  EXPECT_EQ(names[0], "paint");
  ASSERT_EQ(header.portal_count, 1u);
  EXPECT_EQ(portals[0].name, "door");
  EXPECT_EQ(portals[0].strips, 2u);
}

}  // namespace
}  // namespace lightwell::format
