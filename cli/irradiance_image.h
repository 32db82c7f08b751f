// What the commands that write irradiance atlases share.
#pragma once
#include <mutex>
#include <span>

#include "cli/command.h"
#include "precompute/atlas/atlas.h"
#include "precompute/core/image.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::cli {

/// --component direct|indirect|total.
void addComponent(CLI::App& command, std::string& component);
transport::Component componentNamed(const std::string& name);

/// The EXR convention of the outside contract: size × size. Every texel that the surface touches has its own value; A = 1 where it stands for its texel
/// (atlas::standingSlots), else 0. `slot_rgb` has one value per slot. An atlas without slots gives an image without coverage.
ImageRgba imageOfSlots(const scene::Mesh& mesh, const atlas::Atlas& atlas, int size, std::span<const Rgb> slot_rgb);

/// Turns fractions reported from any thread into progress lines with the time left.
class ProgressMeter {
 public:
  ProgressMeter(Console& console, std::string stage);
  void update(double fraction);

 private:
  Console& console_;
  std::string stage_;
  std::chrono::steady_clock::time_point begin_, last_;
  std::mutex mutex_;
  double highest_ = 0;
};

}  // namespace lightwell::cli
