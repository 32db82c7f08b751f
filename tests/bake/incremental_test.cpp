// After a change only the tasks whose inputs changed run again, and the container is that of a bake from nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "precompute/bake/run.h"
#include "tests/cli/scenes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::bake {
namespace {

using testing::UnorderedElementsAre;

class Incremental : public testing::Test {
 protected:
  struct Result {
    Bytes container;
    std::vector<std::string> phases;  // of the tasks that ran
    size_t run = 0, reused = 0;
  };
  Result bake(const test::RoomOptions& room, const plan::Settings& settings, ResultStore& store, int threads = 2) const {
    const std::filesystem::path file = folder_.path() / "room.gltf";
    std::ofstream(file) << test::roomGltf(room);
    Diagnostics diagnostics;
    const CancelFlag never;
    const Baked baked = runBake({.source = {.scene = file}, .settings = settings, .threads = threads}, store, diagnostics, never, {});
    Result result{*baked.outcome.container, {}, baked.outcome.tasks_run, baked.outcome.tasks_reused};
    for (const auto& phase : baked.outcome.phases) result.phases.push_back(phase.name);
    return result;
  }
  /// Bakes what the members say with what the first bake left, and compares with a bake from nothing.
  Result again() {
    Result result = bake(room_, settings_, store_);
    NullStore nothing;
    const Result clean = bake(room_, settings_, nothing, 1);
    EXPECT_TRUE(result.container == clean.container) << "the bytes are those of a clean bake";
    EXPECT_EQ(clean.reused, 0u);
    EXPECT_LT(result.run, clean.run);
    return result;
  }
  void SetUp() override {
    room_ = {.lamp_candela = 10, .boxes = true, .box_emission = 2};
    settings_.lightmap_size = 48;
    settings_.quality = plan::Quality::draft;
    settings_.prm_clusters = 256;
    first_ = bake(room_, settings_, store_);
  }
  test::TemporaryFolder folder_;
  test::RoomOptions room_;
  plan::Settings settings_;
  MemoryStore store_;
  Result first_;
};

TEST_F(Incremental, TheSameAgainRunsNothing) {
  EXPECT_EQ(first_.reused, 0u);
  const Result second = bake(room_, settings_, store_);
  EXPECT_EQ(second.run, 0u);
  EXPECT_TRUE(second.container == first_.container);
}

TEST_F(Incremental, ALampChangesTheContainerAlone) {
  room_.lamp_candela = 20;
  const Result result = again();
  EXPECT_EQ(result.run, 1u);
  EXPECT_THAT(result.phases, UnorderedElementsAre("container"));
}

TEST_F(Incremental, AColourChangesWhatReflects) {
  room_.box_albedo = 0.25;
  const Result result = again();
  EXPECT_THAT(result.phases, UnorderedElementsAre("bounces", "solve", "fit", "container"));
  EXPECT_GE(result.reused, 6u) << "charts, validity, entries, training lights, emitters";
}

TEST_F(Incremental, AnEmissionChangesWhatIsLitByIt) {
  room_.box_emission = 3;
  const Result result = again();
  EXPECT_THAT(result.phases, UnorderedElementsAre("emitters", "solve", "fit", "container"));
  EXPECT_GE(result.reused, 6u);
}

TEST_F(Incremental, AMovedObjectKeepsTheChartsOfTheOthers) {
  room_.box_x = -0.4;
  const Result result = again();
  EXPECT_EQ(result.reused, 1u) << "light goes everywhere, the second box's charts stay";
}

TEST_F(Incremental, ClustersOfTheMapsChangeNoReferenceAndNoEmitter) {
  settings_.prm_clusters = 128;
  const Result result = again();
  EXPECT_THAT(result.phases, UnorderedElementsAre("bounces", "training", "solve", "fit", "container"));
  EXPECT_GE(result.reused, 4u) << "charts, validity, emitters";
}

TEST_F(Incremental, ReferencesOfTheErrorSeeColoursAlone) {
  settings_.quality = plan::Quality::preview;
  bake(room_, settings_, store_);
  room_.box_emission = 3;
  EXPECT_THAT(bake(room_, settings_, store_).phases, UnorderedElementsAre("emitters", "solve", "fit", "container"));
  room_.box_albedo = 0.25;
  EXPECT_THAT(bake(room_, settings_, store_).phases, UnorderedElementsAre("bounces", "solve", "fit", "measure", "container"));
}

TEST_F(Incremental, FormFactorsDoNotKnowOfColours) {
  settings_.techniques = {plan::Technique::radiosity};
  bake(room_, settings_, store_);
  room_.box_albedo = 0.25;
  room_.box_emission = 3;
  EXPECT_THAT(again().phases, UnorderedElementsAre("form factors", "links", "container")) << "patches, hits and training lights stay";
}

TEST_F(Incremental, APortalChangesRadiosityAlone) {
  room_.shutter = true;
  room_.shutter_marked = false;
  settings_.techniques = {plan::Technique::prm, plan::Technique::radiosity};
  bake(room_, settings_, store_);
  settings_.portals = {"shutter"};
  EXPECT_THAT(again().phases, UnorderedElementsAre("hits", "patch light", "form factors", "links", "container")) << "the maps have doors as they are in the file";
  room_.shutter_marked = true;  // with other strips
  EXPECT_THAT(again().phases, UnorderedElementsAre("hits", "patch light", "form factors", "links", "container"));
}

TEST_F(Incremental, FinerBasesAreFittedToTheSameTransport) {
  settings_.refinement = -1;
  const Result result = again();
  EXPECT_THAT(result.phases, UnorderedElementsAre("fit", "container"));
}

}  // namespace
}  // namespace lightwell::bake
