// Each invariant of the section points, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include "tests/format/breach.h"
#include "tests/format/points_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<PointsContent>;

const std::vector<Breach>& breaches() {
  using C = PointsContent;
  static const std::vector<Breach> all = {
      {"None", IssueId::header_value, "points/header", [](C& c) { c.header.set_points(0); }},
      {"TooMany", IssueId::header_value, "points/header", [](C& c) { c.header.set_points((1u << 22) + 1); }},
      {"WithoutArea", IssueId::header_value, "points/header", [](C& c) { c.header.set_area(0); }},
      {"StepMissing", IssueId::header_value, "points/header", [](C& c) { c.header.mutable_step()->RemoveLast(); }},
      {"StepNegative", IssueId::header_value, "points/header", [](C& c) { c.header.set_step(0, -1); }},
      {"Endless", IssueId::header_value, "points/header", [](C& c) { c.header.set_step(2, 1e38f); }},
      {"PositionMissing", IssueId::chunk_shape, "points/position", [](C& c) { c.position.resize(9); }},
      {"NormalReserved", IssueId::reserved_bits, "points/normal", [](C& c) { c.normal[3] = INT16_MIN; }},
      {"TexelOutside", IssueId::index_range, "points/texel", [](C& c) { c.texel[1] = 1u << 20; }},
      {"TexelThatShowsAnother", IssueId::index_range, "points/texel",
       [](C& c) {
         for (uint32_t t = 0; t < c.base.source.size(); ++t)
           if (c.base.source[t] != t) c.texel[1] = t;
       }},
  };
  return all;
}

TEST(VerifyPoints, FindsNothingWrong) { EXPECT_EQ(listed(issuesOf(pointsContent())), ""); }

class VerifyPointsBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyPointsBreach, IsNamed) { expectNamed(GetParam(), pointsContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyPointsBreach, testing::ValuesIn(breaches()), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::format
