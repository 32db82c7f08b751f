// From a document to what each texel receives, through all that a user goes through: import, bake, container, runtime.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/stress/gltf_document.h"
#include "precompute/bake/container_scene.h"
#include "precompute/bake/run.h"
#include "precompute/core/image.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::stress {

/// Lamps that nothing was baked for: virtual lights found in each frame, on OpenGL, in the container's geometry.
struct Dynamic {
  bool incremental = false;   // lights stay where they are as long as the lamp shines there
  uint32_t lights = 256;      // of each lamp
  uint32_t shadow_side = 32;  // texels of their shadow maps; 0: none
};

struct Job {
  const GltfDocument* scene = nullptr;  // null: only the sky
  const ImageRgba* sky = nullptr;       // latitude-longitude map, or none
  plan::Technique technique = plan::Technique::prm;
  transport::Component component = transport::Component::indirect;
  plan::Settings settings;              // `techniques` is overwritten by `technique`
  std::optional<Dynamic> dynamic;       // set: one reflection of the lamps is found by OpenGL alone, and of `technique` nothing is evaluated
  bool on_gl = true;                    // evaluate there, too, where there is any
};

/// What came of it.
struct Lit {
  bool baked = false;                 // the container has the technique's section, or (dynamic) surfaces
  bake::ContainerScene scene;         // without texels when the container has no surfaces
  double metres_per_unit = 1;
  std::vector<Rgb> irradiance_rgb;    // per slot; empty unless baked
  std::optional<std::vector<Rgb>> gl_irradiance_rgb;  // the same from OpenGL; unset where it was not asked
  std::vector<plan::Omitted> omitted;
  std::vector<Warning> warnings;
  std::vector<std::string> unsound;   // what `verify` found, notes left out
  uint64_t rays = 0;                  // of bake and evaluation
  double seconds = 0;                 // likewise, without OpenGL
  double gl_seconds = 0;              // of the evaluation on OpenGL
  uint64_t bytes = 0;                 // of the container

  /// W or lm on all texels: Σ E area, square metres.
  Vec3d flux_rgb() const;
  double area_m2() const;
  /// Over the area of the slots for which `of` holds.
  double meanLuminance(const std::function<bool(const atlas::Slot&)>& of = {}) const;
  double mostLuminance(const std::function<bool(const atlas::Slot&)>& of = {}) const;
};

/// A folder for the files of one run, removed afterwards.
class Workbench {
 public:
  /// `with_gl`: evaluate on OpenGL, too. `threads`: 0 for all of the machine.
  Workbench(int threads, const CancelFlag& cancel, bool with_gl);
  ~Workbench();
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  /// Throws what a bake and the runtime throw; InputError, UsageError for scenes and settings that are rejected.
  Lit light(const Job& job) const;
  /// The container alone, as a file that lives until the next bake. `lit`, if set, receives what the bake told.
  std::filesystem::path bake(const Job& job, Lit* lit = nullptr) const;

 private:
  int threads_;
  const CancelFlag& cancel_;
  bool with_gl_;
  std::filesystem::path folder_;
};

}  // namespace lightwell::stress
