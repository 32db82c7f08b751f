// The heavy immutable things that tasks share: derived once per process from the scene's bytes and the settings, the same everywhere.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/bake/scene_keys.h"
#include "precompute/bake/task_runner.h"
#include "precompute/plan/plan.h"
#include "precompute/scene/file_table.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/environment/sky_light.h"

namespace lightwell::bake {

/// Where the work comes from. `lights`, when given, replaces the scene's punctual lights. `environment` is a map of the sky (.hdr, .exr);
/// with one, `scene` may be empty: then only the sky is baked. With `files`, all paths are names in it.
struct SceneSource {
  std::filesystem::path scene;
  std::optional<std::filesystem::path> lights;
  std::optional<std::filesystem::path> environment;
  std::optional<scene::FileTable> files;
};

/// A map as a bake reads it; `name` is for messages. Throws InputError and UsageError.
transport::EnvironmentMap openPlacedMap(const std::filesystem::path& file, const std::string& name,
                                        const plan::EnvironmentPlacement& placement, Diagnostics& diagnostics);

/// Throws UsageError when there is neither a scene nor an environment map, or what is asked for needs the one that is missing.
void checkSource(const SceneSource& source, const plan::Settings& settings);

class BakeContext {
 public:
  /// Reads the environment map, imports the scene, lays out the atlas, builds the tracer and finds buried texels. `stage`, if set, is
  /// called with the name of each stage before it begins. What is worth keeping of that is run by `tasks`; null: here, and not kept.
  /// Throws InputError, UsageError or Cancelled. `diagnostics` receives the repairs in a deterministic order.
  BakeContext(const SceneSource& source, const plan::Settings& settings, int threads, Diagnostics& diagnostics, const CancelFlag& cancel,
              const std::function<void(const std::string&)>& stage = {}, TaskRunner* tasks = nullptr);

  const scene::Scene& scene() const { return scene_; }
  /// Empty (0 × 0) when the scene has no surfaces.
  const atlas::Atlas& atlas() const { return atlas_; }
  /// Null when the scene has no surfaces.
  const trace::Tracer* tracer() const { return tracer_.get(); }
  /// Null without an environment map.
  const transport::SkyGrid* skyGrid() const { return sky_grid_ ? &*sky_grid_ : nullptr; }
  /// Null without an environment map, or when it is black.
  const transport::SkyLight* skyLight() const { return sky_light_.get(); }
  /// File name of the environment map without its folder; empty without one.
  const std::string& environmentName() const { return environment_name_; }
  int threads() const { return threads_; }
  const plan::Settings& settings() const { return settings_; }
  const plan::SceneFacts& facts() const { return facts_; }

  /// What of the scene tasks depend on: each names in its parameters the least of them that holds all it reads.
  const SceneKeys& keys() const { return keys_; }
  /// Hash of the sky's light as it is placed; all zero without an environment map.
  const Key& skyKey() const { return sky_key_; }
  /// Wall-clock seconds of the stages.
  const std::vector<PhaseTime>& stageTimes() const { return stage_times_; }

 private:
  scene::Scene scene_;
  atlas::Atlas atlas_;
  std::unique_ptr<trace::Tracer> tracer_;
  plan::Settings settings_;
  plan::SceneFacts facts_;
  std::optional<transport::SkyGrid> sky_grid_;
  std::unique_ptr<transport::SkyLight> sky_light_;
  std::string environment_name_;
  int threads_;
  SceneKeys keys_;
  Key sky_key_;
  std::vector<PhaseTime> stage_times_;
};

}  // namespace lightwell::bake
