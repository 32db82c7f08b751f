// The command line of the game.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "lightwell/lightwell.h"
#include "render/view.h"

namespace lightwell::game {

struct Options {
  std::filesystem::path container;
  std::optional<std::filesystem::path> camera, lights;  // CAM.json, LIGHTS.json
  bool headless = false;
  bool es = false;             // headless on OpenGL ES 3.0
  int frames = 0;              // 0: until the window closes
  int width = 1280, height = 720;
  std::string output_prefix = "frame";
  std::optional<render::LightPart> part;
};

/// Headless: a PNG per frame while the selected lamp goes once around. Prints the mean times. Returns the exit code.
int runHeadless(const Options& options, lw_container* container);
/// In a window.
int runWindowed(const Options& options, lw_container* container);

}  // namespace lightwell::game
