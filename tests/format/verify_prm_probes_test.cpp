// Each invariant of the section prm_probes, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/format/breach.h"
#include "tests/format/prm_probes_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<PrmProbesContent>;

const std::vector<Breach>& breaches() {
  using C = PrmProbesContent;
  static const std::vector<Breach> all = {
      {"None", IssueId::header_value, "prm_probes/header", [](C& c) { c.header.set_probes(0); }},
      {"RankTooHigh", IssueId::header_value, "prm_probes/header", [](C& c) { c.header.set_max_rank(13); }},
      {"OverPanes", IssueId::cross_section, "prm_probes/header", [](C& c) { c.base = panesContent(); }},
      {"Nowhere", IssueId::not_finite, "prm_probes/position", [](C& c) { c.position[4] = INFINITY; }},
      {"PositionMissing", IssueId::chunk_shape, "prm_probes/position", [](C& c) { c.position.resize(3); }},
      {"RankAboveTheHeaders", IssueId::value_range, "prm_probes/block_rank", [](C& c) { c.block_rank[0] = 3; }},
      {"BasisTooShort", IssueId::chunk_shape, "prm_probes/basis", [](C& c) { c.basis.pop_back(); }},
      {"BasisReserved", IssueId::value_range, "prm_probes/basis", [](C& c) { c.basis[5] = INT8_MIN; }},
      {"ScaleNegative", IssueId::not_finite, "prm_probes/coefficient_scale", [](C& c) { c.coefficient_scale[8] = -1; }},
      {"LinksFall", IssueId::order, "prm_probes/link_wavelet", [](C& c) { c.link_wavelet[2] = 1; }},
      {"LinkToNoWavelet", IssueId::index_range, "prm_probes/link_wavelet", [](C& c) { c.link_wavelet[4] = 7; }},
      {"CoefficientMissing", IssueId::chunk_shape, "prm_probes/coefficient", [](C& c) { c.coefficient.pop_back(); }},
      {"EmitterNotFinite", IssueId::not_finite, "prm_probes/emitter", [](C& c) { c.emitter[53] = 0x7c00; }},
  };
  return all;
}

TEST(VerifyPrmProbes, FindsNothingWrong) { EXPECT_EQ(listed(issuesOf(prmProbesContent())), ""); }

class VerifyPrmProbesBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyPrmProbesBreach, IsNamed) { expectNamed(GetParam(), prmProbesContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyPrmProbesBreach, testing::ValuesIn(breaches()), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::format
