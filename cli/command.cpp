#include "cli/command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

namespace lightwell::cli {
namespace fs = std::filesystem;

void addSceneSettings(CLI::App& command, plan::Settings& settings) {
  command.add_option("--lightmap-size", settings.lightmap_size, "Texels along each side of the atlas")
      ->type_name("N")
      ->check(CLI::Range(1, plan::kMostLightmapSize))
      ->capture_default_str();
  command.add_option("--light-units", "What light intensities mean: spec (candela, lux), unitless or raw (Blender's other exports)")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::lightUnitsNames()))
      ->default_str("spec")
      ->each([&settings](const std::string& name) { settings.light_units = *plan::lightUnitsNamed(name); });
  command.add_option("--seed", settings.seed, "Seed of all random numbers; another one gives independent noise")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void addThreads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads to use; 0 means all of the machine. The result does not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

void addLights(CLI::App& command, std::optional<fs::path>& lights) {
  command.add_option("--lights", lights, "Lights to use instead of the scene's own punctual lights; emitting surfaces stay")
      ->type_name("LIGHTS.json");
}

void addEnvironment(CLI::App& command, std::optional<fs::path>& file, plan::EnvironmentPlacement& placement) {
  command.add_option("--environment", file, "Map of the sky, Radiance (.hdr) or OpenEXR, latitude-longitude")->type_name("FILE");
  command.add_option("--environment-rotation", placement.rotation_deg, "Degrees by which the map is turned about +Y, from +Z towards +X")
      ->type_name("DEG")
      ->check(CLI::Range(-360.0, 360.0))
      ->capture_default_str();
  command.add_option("--environment-intensity", placement.intensity, "Factor on the map's radiance")
      ->type_name("X")
      ->check(CLI::Range(0.0f, plan::kMostEnvironmentIntensity))
      ->capture_default_str();
  command
      .add_option("--environment-ground", placement.ground_radiance_rgb,
                  "Radiance R G B that replaces the map below the horizon, before the factor")
      ->type_name("R G B")
      ->check(CLI::Range(0.0f, plan::kMostRadiance));
}

void addEnvironmentLight(CLI::App& command, render::EnvironmentSettings& settings) {
  const std::map<std::string, uint32_t> techniques{{"share", LW_ENVIRONMENT_SHARE},
                                                   {"sum", LW_ENVIRONMENT_SUM},
                                                   {"paper", LW_ENVIRONMENT_SUM_PAPER},
                                                   {"unshadowed", LW_ENVIRONMENT_UNSHADOWED}};
  command
      .add_option("--environment-technique", settings.technique,
                   "Light of a sky: its exact light less the share of the hidden cells (share), the sum of the visible cells (sum, or paper with "
                   "the paper's reflectivity), or unshadowed; without it share")
      ->transform(CLI::CheckedTransformer(techniques))
      ->type_name("NAME");
  command
      .add_option("--environment-cells", settings.cells,
                   "Use only so many cells of the sky, the brightest, which then stand for all; 0: all")
      ->check(CLI::Range(0u, 4096u))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--environment-map-size", settings.map_texels, "Texels along a side of each cell's depth map")
      ->check(CLI::Range(16u, 2048u))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--environment-sun-map-size", settings.sun_map_texels, "Texels along a side of a sun's depth map")
      ->check(CLI::Range(16u, 4096u))
      ->type_name("N")
      ->capture_default_str();
}

void addOutput(CLI::App& command, fs::path& output, const std::string& what) {
  command.add_option("-o,--output", output, what)->required()->type_name("FILE");
}

void checkWritable(const fs::path& file) {
  const auto refuse = [&](const std::string& reason) { throw UsageError("cannot write " + file.string() + ": " + reason); };
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  if (file.filename().empty()) refuse("it names a folder");
  if (!fs::is_directory(folder, error)) refuse("there is no folder " + folder.string());
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) refuse("it exists and is not a regular file");
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse(std::strerror(errno));
}

void checkReadable(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(file.string(), "", "no such file");
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "", "not a regular file");
  if (access(file.c_str(), R_OK) != 0) throw InputError(file.string(), "", std::strerror(errno));
}

void writeOutput(Session& session, const fs::path& file, const std::function<void()>& write) {
  const Interrupt::OutputGuard guard(session.interrupt);
  try {
    write();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw UsageError(reason.find(file.string()) != std::string::npos ? reason : "cannot write " + file.string() + ": " + reason);
  }
}

void printJson(const nlohmann::json& document) {
  const std::string text = document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

}  // namespace lightwell::cli
