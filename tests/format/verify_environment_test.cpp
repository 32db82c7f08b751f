// Each invariant of the section environment, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>

#include "format/decode/headers.h"
#include "tests/format/breach.h"
#include "tests/format/environment_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<EnvironmentContent>;

const std::vector<Breach>& breaches() {
  using C = EnvironmentContent;
  constexpr const char* kHeader = "environment/header";
  static const std::vector<Breach> all = {
      {"NoCells", IssueId::header_value, kHeader, [](C& c) { c.header.set_cells(0); }},
      {"SunsMoreThanCells", IssueId::header_value, kHeader, [](C& c) { c.header.set_suns(4); }},
      {"FaceOdd", IssueId::header_value, kHeader, [](C& c) { c.header.set_face_cells(5); }},
      {"FaceLarge", IssueId::header_value, kHeader, [](C& c) { c.header.set_face_cells(258); }},
      {"ScaleNoPowerOfTwo", IssueId::header_value, kHeader, [](C& c) { c.header.set_node_scale(0.3f); }},
      {"FluxShort", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_sky_flux()->RemoveLast(); }},
      {"FluxNan", IssueId::header_value, kHeader, [](C& c) { c.header.set_sky_flux(1, NAN); }},
      {"HarmonicsShort", IssueId::header_value, kHeader, [](C& c) { c.header.mutable_radiance_sh()->RemoveLast(); }},
      {"HarmonicsOfAnotherSky", IssueId::header_value, kHeader, [](C& c) { c.header.set_radiance_sh(0, 9); }},
      {"HarmonicsBeyondTheFlux", IssueId::header_value, kHeader, [](C& c) { c.header.set_radiance_sh(8, 1000); }},
      {"RotationInfinite", IssueId::header_value, kHeader, [](C& c) { c.header.set_rotation_deg(INFINITY); }},
      {"IntensityNegative", IssueId::header_value, kHeader, [](C& c) { c.header.set_intensity(-1); }},
      {"GroundShort", IssueId::header_value, kHeader, [](C& c) { c.header.add_ground_radiance(1); }},
      {"DirectionNotUnit", IssueId::value_range, "environment/cell_direction", [](C& c) { c.direction[4] = 1.1f; }},
      {"DirectionCount", IssueId::chunk_shape, "environment/cell_direction", [](C& c) { c.direction.resize(6); }},
      {"FluxNegative", IssueId::not_finite, "environment/cell_flux", [](C& c) { c.flux[0] = -1; }},
      {"FluxSum", IssueId::value_range, "environment/cell_flux", [](C& c) { c.flux[3] *= 1.01f; }},
      {"SolidAngleNone", IssueId::value_range, "environment/cell_solid_angle", [](C& c) { c.solid_angle[0] = 0; }},
      {"SolidAngleSum", IssueId::value_range, "environment/cell_solid_angle", [](C& c) { c.solid_angle[1] -= 0.01f; }},
      {"Spread", IssueId::value_range, "environment/cell_spread", [](C& c) { c.spread[2] = 1.5f; }},
      {"CovarianceOfNothing", IssueId::value_range, "environment/cell_covariance", [](C& c) { c.covariance[4] = 0.5f; }},
      {"NodeInfinite", IssueId::not_finite, "environment/node", [](C& c) { c.node[7] = 0x7c00; }},
      {"NodeSum", IssueId::value_range, "environment/node",
       [](C& c) {
         for (size_t i = 0; i < c.node.size() / 2; i += 3) c.node[i] = 0;
       }},
      {"NodeMissing", IssueId::chunk_missing, "environment/node", [](C& c) { c.left_out = {"node"}; }},
  };
  return all;
}

TEST(VerifyEnvironment, SoundContentHasNoIssues) { EXPECT_EQ(listed(issuesOf(environmentContent())), ""); }

class EnvironmentInvariant : public testing::TestWithParam<size_t> {};

TEST_P(EnvironmentInvariant, IsHeld) { expectNamed(breaches()[GetParam()], environmentContent()); }

INSTANTIATE_TEST_SUITE_P(Breach, EnvironmentInvariant, testing::Range(size_t(0), breaches().size()),
                         [](const auto& info) { return std::string(breaches()[info.param].name); });

TEST(Headers, Environment) {
  const v1::EnvironmentHeader wanted = environmentContent().header;
  const std::string bytes = wanted.SerializeAsString();
  EnvironmentHeader header;
  ASSERT_TRUE(parseEnvironmentHeader(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), header));
  EXPECT_EQ(header.cells, 3u);
  EXPECT_EQ(header.suns, 1u);
  EXPECT_EQ(header.face_cells, 4u);
  EXPECT_EQ(header.node_scale, 0.25f);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(header.sky_flux_rgb[c], wanted.sky_flux(c));
  for (int i = 0; i < 27; ++i) EXPECT_EQ(header.radiance_sh_rgb[i], wanted.radiance_sh(i));
}

}  // namespace
}  // namespace lightwell::format
