// One scene on the bench: path-traced references, bakes, and what the runtime makes of them.
#pragma once
#include <filesystem>
#include <memory>

#include "cli/report/ladder.h"
#include "cli/report/result.h"
#include "cli/report/truth.h"
#include "precompute/bake/context.h"

namespace lightwell::report {

namespace fs = std::filesystem;

struct LaboratoryOptions {
  bake::SceneSource source;
  fs::path folder;                 // of the report; exists
  plan::Settings settings;         // what all bakes share
  int threads = 0;
  bool gl = true;                  // measure on OpenGL, too
};

/// Files go to the folder: maps/, containers/, and lights.json where the scene has no light of its own.
class Laboratory {
 public:
  /// Imports the scene and fills in what `report` tells of it. Throws InputError, UsageError or Cancelled.
  Laboratory(const LaboratoryOptions& options, Report& report, Diagnostics& diagnostics, const CancelFlag& cancel, const std::function<void(const std::string&)>& stage);

  const bake::BakeContext& context() const { return *context_; }
  /// Content hash of the scene, its lights and sky, and what all bakes share.
  const std::string& key() const { return key_; }
  std::string keyOf(const Rung& rung) const;

  /// Paths a texel for which both references take about `seconds`: a power of two, 16 to 4,096.
  uint32_t samplesWithin(double seconds, const CancelFlag& cancel) const;
  Reference traceReferences(uint32_t samples, const CancelFlag& cancel, const std::function<void(double)>& progress);
  /// References that an earlier run has left. Throws InputError when they are not there or of another size.
  void readReferences(const Reference& reference);
  const Truth& truth() const { return truth_; }

  /// Throws UsageError when the section does not come about, and the reason.
  Baked measure(const Rung& rung, const CancelFlag& cancel);
  /// Container of a user, for each technique in it. Throws UsageError when it is not of this scene and light map.
  std::vector<Baked> measureGiven(const fs::path& container, const CancelFlag& cancel);

 private:
  struct Opened;
  void evaluate(Opened& opened, const Rung& rung, Baked& baked, const CancelFlag& cancel);
  Evaluated compared(const Opened& opened, const std::vector<Rgb>& slot_rgb, const std::string& name) const;
  std::string sceneOptions() const;

  LaboratoryOptions options_;
  std::unique_ptr<bake::BakeContext> context_;
  std::vector<Warning> warnings_;
  double stage_seconds_ = 0;
  std::string key_;
  Truth truth_;
};

}  // namespace lightwell::report
