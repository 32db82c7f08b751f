// Each invariant of the section probes, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/format/breach.h"
#include "tests/format/probes_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<ProbesContent>;

const std::vector<Breach>& breaches() {
  using C = ProbesContent;
  constexpr const char* kHeader = "probes/header";
  static const std::vector<Breach> all = {
      {"NoProbes", IssueId::header_value, kHeader, [](C& c) { c.header.clear_lattice_probes(), c.header.clear_points(); }},
      {"TooManyProbes", IssueId::header_value, kHeader, [](C& c) { c.header.set_points(1u << 30); }},
      {"TwoDimensions", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_lattice_count()->RemoveLast(); }},
      {"NoLattice", IssueId::header_value, kHeader, [](C& c) { c.header.clear_lattice_count(), c.header.clear_lattice_first(); }},
      {"NoSpacing", IssueId::header_value, kHeader, [](C& c) { c.header.clear_lattice_spacing(); }},
      {"SpacingNan", IssueId::header_value, kHeader, [](C& c) { c.header.set_lattice_spacing(NAN); }},
      {"Nowhere", IssueId::header_value, kHeader, [](C& c) { c.header.set_lattice_first(1, INFINITY); }},
      {"FlatLattice", IssueId::header_value, kHeader, [](C& c) { c.header.set_lattice_count(1, 0); }},
      {"HugeLattice", IssueId::header_value, kHeader, [](C& c) { c.header.set_lattice_count(1, 1u << 31); }},
      {"PointBeyond", IssueId::index_range, "probes/lattice_point", [](C& c) { c.lattice_point[2] = 8; }},
      {"PointTwice", IssueId::order, "probes/lattice_point", [](C& c) { c.lattice_point[1] = 0; }},
      {"OffsetReserved", IssueId::value_range, "probes/offset", [](C& c) { c.offset[4] = -128; }},
      {"NearnessShort", IssueId::chunk_shape, "probes/nearness", [](C& c) { c.nearness.resize(289 * 2); }},
      {"PositionNan", IssueId::not_finite, "probes/point_position", [](C& c) { c.point_position[1] = NAN; }},
      {"LinksFall", IssueId::order, "probes/link_first", [](C& c) { c.link_first[1] = 5; }},
      {"NodeOutside", IssueId::index_range, "probes/link_node", [](C& c) { c.link_node[1] = 11; }},
      {"NodesFall", IssueId::order, "probes/link_node", [](C& c) { c.link_node[0] = 9, c.link_node[1] = 3; }},
      {"SetsFall", IssueId::order, "probes/link_node", [](C& c) { c.link_gates[6] = 1, c.link_gates[7] = 0; }},
      {"SetOutside", IssueId::index_range, "probes/link_gates", [](C& c) { c.link_gates[7] = 2; }},
      {"SetZeroNotEmpty", IssueId::value_range, "probes/gate_set_first", [](C& c) { c.gate_set_first = {0, 1, 1}; }},
      {"GateOutside", IssueId::index_range, "probes/gate_set", [](C& c) { c.gate_set[0] = 4; }},
      {"ScaleNan", IssueId::not_finite, "probes/scale", [](C& c) { c.scale[1] = NAN; }},
      {"MoreThanTheSphere", IssueId::weight_sum, "probes/scale", [](C& c) { c.scale[1] *= 1.01f; }},
      {"CodeMissing", IssueId::chunk_missing, "probes/link_code", [](C& c) { c.left_out = {"link_code"}; }},
  };
  return all;
}

TEST(VerifyProbes, FindsNothingWrong) {
  EXPECT_EQ(listed(issuesOf(probesContent())), "");
  ProbesContent ungated = probesContent();
  ungated.link_gates.clear();
  EXPECT_EQ(listed(issuesOf(ungated)), "");
}

class VerifyProbesBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyProbesBreach, IsNamed) { expectNamed(GetParam(), probesContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyProbesBreach, testing::ValuesIn(breaches()), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::format
