// lightwell stress: what it prints, and how it ends.
#include "tests/cli/command_fixture.h"

namespace lightwell::test {
namespace {

using Stress = CommandTest;

TEST_F(Stress, PrintsATableAndKeepsToItsSchema) {
  const auto document = runJson({"stress", "--filter", "no-*", "--techniques", "lightmap,vpl", "--json"}, "stress");
  EXPECT_EQ(document["failed"], 0);
  ASSERT_EQ(document["rows"].size(), 4u) << "two cases, two techniques";
  for (const auto& row : document["rows"]) {
    EXPECT_TRUE(row["passed"].get<bool>());
    EXPECT_FALSE(row["checks"].empty());
  }
  const Finished finished = run({"stress", "--filter", "no-surfaces", "--techniques", "vpl"});
  EXPECT_NE(finished.err.find("pass  no-surfaces"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("1 of 1 passed"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.out, "");
}

TEST_F(Stress, ListsWhatItWouldRun) {
  const Finished all = run({"stress", "--list"}), fast = run({"stress", "--list", "--fast"}), sky = run({"stress", "--list", "--filter", "*box*"});
  EXPECT_NE(all.out.find("atlas-8192"), std::string::npos);
  EXPECT_EQ(fast.out.find("atlas-8192"), std::string::npos);
  EXPECT_EQ(std::count(sky.out.begin(), sky.out.end(), '\n'), 2) << sky.out;
}

TEST_F(Stress, RefusesWhatCannotBeMeant) {
  EXPECT_EQ(lightwell({"stress", "--filter", "nothing-of-the-kind"}).exit_code, 2);
  EXPECT_EQ(lightwell({"stress", "--techniques", "magic"}).exit_code, 2);
  EXPECT_EQ(lightwell({"stress", "--list", "--json"}).exit_code, 2);
}

}  // namespace
}  // namespace lightwell::test
