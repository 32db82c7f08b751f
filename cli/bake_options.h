// What bake and submit both take: everything about the result, nothing about where it goes.
#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "cli/command.h"
#include "precompute/bake/run.h"

namespace lightwell::cli {

struct BakeOptions {
  bake::Request request;
  std::string techniques = "auto", quality = "production";
  std::string probe_spacing = "0";
  std::optional<std::filesystem::path> probes;
  std::string moving_lights = "anywhere";
  bool no_geometry = false;
  bool lightmap_size_by_error = false;
  std::string virtual_light = "auto";
  std::string prm_layout = "local-bases", prm_estimator = "gather";
};

/// The scene and all settings and limits of a bake, --threads included.
void addBakeOptions(CLI::App& command, BakeOptions& options);

/// Completes `request` from the parsed words, and refuses what cannot work before any work is done: UsageError for settings that this
/// version cannot bake, InputError for files that cannot be read.
void resolve(BakeOptions& options);

/// With --lightmap-size-by-error: chooses the light map's size from the scene and --target-error, and tells it. After resolve().
void chooseLightmapSize(Session& session, BakeOptions& options);

}  // namespace lightwell::cli
