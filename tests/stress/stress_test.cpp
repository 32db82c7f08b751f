// The table of `lightwell stress`, and that a row which is not as it should be is one that fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cli/stress/evaluators.h"
#include "cli/stress/run.h"

namespace lightwell::stress {

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

namespace {

using plan::Technique;

std::vector<Row> rowsOf(const std::vector<Case>& cases, const std::string& filter) {
  const CancelFlag cancel;
  return runCases(cases, {.filter = filter, .gl = !reasonWithoutGl()}, 2, cancel);
}

std::string told(const Row& row) {
  std::string text = row.name + ", " + std::string(plan::name(row.technique)) + ": " + row.failure;
  for (const Check& check : row.checks)
    if (!check.passed) text += "\n  " + check.what + ": expected " + check.expected + ", got " + check.got;
  return text;
}

class StressCase : public testing::TestWithParam<Case> {};

TEST_P(StressCase, Holds) {
  if (const auto reason = reasonWithoutGl()) {
    if (GetParam().needs_gl) GTEST_SKIP() << *reason;
    std::printf("without OpenGL: %s\n", reason->c_str());
  }
  for (const Row& row : rowsOf({GetParam()}, "*")) EXPECT_TRUE(row.passed()) << told(row);
}

std::vector<Case> casesThatAre(bool slow) {
  std::vector<Case> cases = allCases();
  std::erase_if(cases, [&](const Case& one) { return one.slow != slow; });
  return cases;
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Fast, StressCase, testing::ValuesIn(casesThatAre(false)), nameOf);
INSTANTIATE_TEST_SUITE_P(Slow, StressCase, testing::ValuesIn(casesThatAre(true)), nameOf);

TEST(StressTable, NamesAreUniqueAndSaidInWords) {
  std::set<std::string> names;
  for (const Case& one : allCases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_FALSE(one.holds.empty()) << one.name;
    EXPECT_FALSE(one.techniques.empty()) << one.name;
  }
}

TEST(StressTable, FiltersByName) {
  const std::vector<Case> cases = allCases();
  const auto count = [&](const std::string& filter) {
    return std::count_if(cases.begin(), cases.end(), [&](const Case& one) { return selects({.filter = filter}, one); });
  };
  EXPECT_EQ(count("*"), std::ptrdiff_t(cases.size()));
  EXPECT_EQ(count("scale-1e?"), 2);
  EXPECT_EQ(count("nothing-of-the-kind"), 0);
}

TEST(StressTable, ARowFailsWhenACheckDoesOrSomethingIsThrownOrNothingIsChecked) {
  const std::vector<Technique> one = {Technique::prm};
  const auto rows = rowsOf({{"holds", "", one, [](Trial& trial) { trial.expectNear("one", 1.001, 1, 0.01); }},
                            {"differs", "", one, [](Trial& trial) { trial.expectNear("one", 1.02, 1, 0.01); }},
                            {"is no number", "", one, [](Trial& trial) { trial.expectNear("one", std::nan(""), 1, 0.01); }},
                            {"is more", "", one, [](Trial& trial) { trial.expectAtMost("one", std::nan(""), 1); }},
                            {"throws", "", one, [](Trial&) { throw std::runtime_error("out of luck"); }},
                            {"checks nothing", "", one, [](Trial&) {}}},
                           "*");
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_TRUE(rows[0].passed());
  for (size_t i = 1; i < rows.size(); ++i) EXPECT_FALSE(rows[i].passed()) << rows[i].name;
  EXPECT_EQ(rows[4].failure, "out of luck");
}

TEST(StressTable, AMapThatIsNotTheSameIsSeen) {
  const std::vector<Technique> lightmap = {Technique::lightmap};
  const auto rows = rowsOf({{"brighter", "", lightmap,
                             [](Trial& trial) {
                               const Lit lit = trial.light(plainRoom({}, 10), {.component = transport::Component::total});
                               const Lit more = trial.light(plainRoom({}, 11), {.component = transport::Component::total});
                               trial.expectSame("the room", more, lit, 1.1, 0.01);
                               trial.expectSame("the room", more, lit, 1, 0.01);
                             }}},
                           "*");
  ASSERT_EQ(rows.size(), 1u);
  const auto& checks = rows[0].checks;
  ASSERT_GE(checks.size(), 2u);
  EXPECT_TRUE(checks[checks.size() - 2].passed);
  EXPECT_FALSE(checks.back().passed);
}

}  // namespace
}  // namespace lightwell::stress
