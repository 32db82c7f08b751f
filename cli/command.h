// What the subcommands share. Each file adds one subcommand to the parser; its callback does the work and reports failures by throwing.
#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cli/console.h"
#include "cli/interrupt.h"
#include "precompute/plan/settings.h"
#include "render/environment_light.h"

namespace lightwell::cli {

struct Session {
  Console& console;
  Interrupt& interrupt;
};

void addBake(CLI::App& app, Session& session);
void addInfo(CLI::App& app, Session& session);
void addVerify(CLI::App& app, Session& session);
void addEnvironmentQueries(CLI::App& app, Session& session);
void addEvaluate(CLI::App& app, Session& session);
void addReference(CLI::App& app, Session& session);
void addCompare(CLI::App& app, Session& session);
void addRender(CLI::App& app, Session& session);
void addReport(CLI::App& app, Session& session);
void addStress(CLI::App& app, Session& session);
void addSubmit(CLI::App& app, Session& session);
void addJobs(CLI::App& app, Session& session);
void addWatch(CLI::App& app, Session& session);
void addFetch(CLI::App& app, Session& session);
void addCancel(CLI::App& app, Session& session);

// ---- Options that several commands have

/// --lightmap-size, --light-units and --seed, into `settings`.
void addSceneSettings(CLI::App& command, plan::Settings& settings);
/// --threads, 0 meaning all.
void addThreads(CLI::App& command, int& threads);
/// --lights, replacing the scene's punctual lights.
void addLights(CLI::App& command, std::optional<std::filesystem::path>& lights);
/// --environment FILE and how it is placed: --environment-rotation, --environment-intensity, --environment-ground.
void addEnvironment(CLI::App& command, std::optional<std::filesystem::path>& file, plan::EnvironmentPlacement& placement);
/// How OpenGL shows the light of a sky: --environment-technique, -cells, -map-size, -sun-map-size.
void addEnvironmentLight(CLI::App& command, render::EnvironmentSettings& settings);
/// -o, required. Throws UsageError from checkWritable() below before any work is done.
void addOutput(CLI::App& command, std::filesystem::path& output, const std::string& what);

/// Throws UsageError when `file` cannot be created or replaced: a missing folder, no permission, a folder of that name.
void checkWritable(const std::filesystem::path& file);
/// Throws InputError when `file` is not a readable regular file.
void checkReadable(const std::filesystem::path& file);
/// Runs `write`, which creates `file`, safe from interruption; what it throws becomes a UsageError (disk full, no permission).
void writeOutput(Session& session, const std::filesystem::path& file, const std::function<void()>& write);

/// One JSON document on stdout.
void printJson(const nlohmann::json& document);

}  // namespace lightwell::cli
