// Each invariant of the section vpl, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>


#include "tests/format/breach.h"
#include "tests/format/vpl_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<VplContent>;

const std::vector<Breach>& breaches() {
  using C = VplContent;
  static const std::vector<Breach> all = {
      {"NoSources", IssueId::header_value, "vpl/header", [](C& c) { c.header.clear_sources(); }},
      {"SourcesOfAnotherScene", IssueId::cross_section, "vpl/header", [](C& c) { c.header.set_sources(c.header.sources() + 2); }},
      {"TypeUnknown", IssueId::value_range, "vpl/type", [](C& c) { c.type[0] = 5; }},
      {"SourceOutside", IssueId::index_range, "vpl/source", [](C& c) { c.source[3] = c.header.sources(); }},
      {"SourcesMixed", IssueId::order, "vpl/source", [](C& c) { c.bounce[1] = 3; }},
      {"NormalNotUnit", IssueId::value_range, "vpl/normal", [](C& c) { c.normal[1] = 1.5f; }},
      {"FluxNegative", IssueId::value_range, "vpl/flux", [](C& c) { c.flux[2] = -1; }},
      {"PointWithRadius", IssueId::value_range, "vpl/radius", [](C& c) { c.radius[0] = 1; }},
      {"DiskWithout", IssueId::value_range, "vpl/radius", [](C& c) { c.radius[1] = 0; }},
      {"VerticesOfADisk", IssueId::value_range, "vpl/first_vertex", [](C& c) { c.first_vertex = {0, 0, 4, 4, 4}; }},
      {"VerticesUnclaimed", IssueId::order, "vpl/first_vertex", [](C& c) { c.first_vertex[4] = 3; }},
      {"PolygonTurnedOver", IssueId::value_range, "vpl/vertex", [](C& c) { c.normal[10] = 1; }},
      {"PolygonNotPlane", IssueId::value_range, "vpl/vertex", [](C& c) { c.vertex[4] = 2.1f; }},
      {"PolygonNotConvex", IssueId::value_range, "vpl/vertex", [](C& c) { c.vertex[6] = 0.2f, c.vertex[8] = 0.2f; }},
      {"PositionMissing", IssueId::chunk_shape, "vpl/position", [](C& c) { c.position.resize(9); }},
  };
  return all;
}

TEST(VerifyVpl, FindsNothingWrong) {
  EXPECT_EQ(listed(issuesOf(vplContent())), "");
  VplContent points = vplContent();
  points.type[3] = 1;
  points.header.set_vertices(0), points.radius[3] = 0;
  points.first_vertex[4] = 0;
  points.vertex.clear();
  EXPECT_EQ(listed(issuesOf(points)), "");
}

class VerifyVplBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyVplBreach, IsNamed) { expectNamed(GetParam(), vplContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyVplBreach, testing::ValuesIn(breaches()), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::format
