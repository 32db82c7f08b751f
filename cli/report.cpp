// lightwell report: error against run time of every technique on one scene, as a page.
#include "cli/report/run.h"

#include <memory>

#include "cli/command.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;

void checkFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) throw UsageError("cannot write to " + folder.string() + ": it exists and is not a folder");
  fs::create_directories(folder, error);
  if (error) throw UsageError("cannot make the folder " + folder.string() + ": " + error.message());
  checkWritable(folder / "report.html");
}

void run(Session& session, report::Request& request) {
  report::LaboratoryOptions& options = request.laboratory;
  checkReadable(options.source.scene);
  if (options.source.lights) checkReadable(*options.source.lights);
  if (options.source.environment) checkReadable(*options.source.environment);
  for (const fs::path& container : request.against) checkReadable(container);
  checkFolder(options.folder);
  const report::Report made = report::runReport(session, request);
  session.console.line((options.folder / "report.html").string() + ": " + std::to_string(made.measured) + " bakes measured, " + std::to_string(made.reused) + " taken from earlier runs, " +
                       std::to_string(made.skipped.size()) + " left out, in " + formatDuration(made.seconds));
}

}  // namespace

void addReport(CLI::App& app, Session& session) {
  const auto request = std::make_shared<report::Request>();
  CLI::App* command = app.add_subcommand("report", "Error against run time of every technique on a scene: a page with plots, pictures and tables");
  command->add_option("scene", request->laboratory.source.scene, "glTF 2.0 scene, .glb or .gltf")->required()->type_name("SCENE");
  command->add_option("-o,--output", request->laboratory.folder, "Folder to write to; made if it is not there")->required()->type_name("DIR");
  command->add_option("--budget", request->budget_s, "Seconds that all may take, about; what does not fit is left out and named")->type_name("S")->check(CLI::Range(0.1, 1e6))->capture_default_str();
  command->add_option("--against", request->against, "Also measure this container of the scene; may be repeated")->type_name("OUT.lwc")->allow_extra_args(false);
  command->add_option("--reference-samples", request->reference_samples, "Paths for each texel in each of the two references; without it what a fifth of the budget allows")
      ->type_name("N")
      ->check(CLI::Range(2u, 1u << 20));
  command->add_flag("--fresh", request->fresh, "Measure everything again, also what an earlier run has left in DIR");
  addSceneSettings(*command, request->laboratory.settings);
  addLights(*command, request->laboratory.source.lights);
  addEnvironment(*command, request->laboratory.source.environment, request->laboratory.settings.environment);
  addThreads(*command, request->laboratory.threads);
  command->footer(R"(Writes report.html, .csv and .json, plots (.svg), pictures/, and what they were made from: maps/ (EXR) and containers/.
An interrupted report goes on where it stopped, and a larger budget adds to what is there.

Examples:
  lightwell report room.glb -o report
  lightwell report level.glb -o report --lightmap-size 512 --budget 1200 --against shipped.lwc)");
  command->callback([&session, request] { run(session, *request); });
}

}  // namespace lightwell::cli
