// lightwell bake: a scene becomes a container.
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/bake_options.h"
#include "cli/command.h"
#include "format/encode/atomic_file.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFooter = R"(Examples:
  lightwell bake room.glb -o room.lwc
  lightwell bake level.gltf -o level.lwc --lightmap-size 512 --quality preview
  lightwell bake room.glb -o room.lwc --cache ~/.cache/lightwell    # a second bake reuses what has not changed
  lightwell bake room.glb -o room.lwc --json > report.json

The same scene, settings and version give the same bytes, for any number of threads.
Ctrl-C stops within a second; with --cache the next bake goes on from there.)";

struct Options {
  BakeOptions bake;
  fs::path output;
  std::optional<fs::path> cache;
  bool json = false;
};

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string progressLine(const bake::Progress& p, uint64_t rays) {
  char text[160];
  std::snprintf(text, sizeof text, "%3.0f %%  %s, %zu of %zu tasks", 100 * p.fraction, p.phase.c_str(), p.tasks_done, p.tasks_total);
  std::string line = text;
  if (p.tasks_reused) line += " (" + std::to_string(p.tasks_reused) + " reused)";
  if (rays) line += ", " + formatCount(double(rays)) + " rays";
  line += ", " + formatDuration(p.elapsed_s);
  if (p.eta_s >= 1) line += ", about " + formatDuration(p.eta_s) + " left";
  return line;
}

void summarise(Console& console, const bake::Baked& baked, const fs::path& output) {
  const auto& [outcome, report] = baked;
  std::string line =
      output.string() + ": " + formatBytes(double(outcome.container->size())) + " in " + formatDuration(report.seconds);
  if (report.rays) line += ", " + formatCount(double(report.rays)) + " rays";
  if (outcome.tasks_reused) line += ", " + std::to_string(outcome.tasks_reused) + " results reused";
  if (outcome.time_limited) line += ", cut to quality " + std::string(plan::name(outcome.settings.quality)) + " by the time limit";
  console.line(line);
  for (const auto& s : report.sections)
    console.line("  " + s.type + std::string(s.type.size() < 12 ? 12 - s.type.size() : 0, ' ') + formatBytes(double(s.stored_bytes)) +
                 " (" + formatBytes(double(s.raw_bytes)) + " decoded)");
  for (const auto& e : report.errors) {
    char text[192];
    std::snprintf(text, sizeof text, ": relrmse %.2g %% (%.2g to %.2g), texrel %.2g %% (%.2g to %.2g), bias %+.2g %%, maximum %.2g %% (", 100 * e.relrmse(), 100 * e.relrmse_low(),
                  100 * e.relrmse_high(), 100 * e.texrel(), 100 * e.texrel_low(), 100 * e.texrel_high(), 100 * e.bias(), 100 * e.maximum());
    console.line("  error of " + e.section() + text + e.against() + ")");
  }
  // Seconds by the rate of this bake: rays are most of what it does.
  const double seconds_per_ray = report.rays ? report.seconds / double(report.rays) : 0;
  for (const auto& o : outcome.omitted) {
    std::string saved = o.decoded_bytes ? " (saves " + formatBytes(double(o.decoded_bytes)) + " decoded" : "";
    if (o.rays) saved += (saved.empty() ? " (saves " : ", ") + ("about " + formatDuration(double(o.rays) * seconds_per_ray));
    console.line("  without " + o.type + ": " + o.reason + saved + (saved.empty() ? "" : ")"));
  }
}

std::unique_ptr<bake::ResultStore> openStore(const Options& options, Diagnostics& diagnostics) {
  if (options.cache) return std::make_unique<bake::DirectoryStore>(*options.cache, diagnostics);
  // Several attempts share what does not differ between them.
  const bake::Request& request = options.bake.request;
  if (request.size_limit_bytes || request.target_error || request.time_limit_s) return std::make_unique<bake::MemoryStore>();
  return std::make_unique<bake::NullStore>();
}

void run(Session& session, Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  checkWritable(options.output);
  resolve(options.bake);
  Console& console = session.console;
  chooseLightmapSize(session, options.bake);
  Diagnostics run_diagnostics;
  const auto store = openStore(options, run_diagnostics);
  bake::Listener listener;
  listener.stage = [&](const std::string& stage) { console.progress(stage, stage + " …"); };
  listener.warning = [&](const Warning& warning) { console.warning(warning); };
  listener.progress = [&](const bake::Progress& p, uint64_t rays) { console.progress(p.phase, progressLine(p, rays)); };
  listener.attempts.announce = [&](const std::string& text) { console.line(text); };
  bake::Baked baked = bake::runBake(options.bake.request, *store, run_diagnostics, session.interrupt.flag(), listener);
  writeOutput(session, options.output, [&] { format::writeFileAtomically(options.output, *baked.outcome.container); });
  baked.report.seconds = secondsSince(begin);
  for (const auto& warning : run_diagnostics.warnings()) console.warning(warning);
  summarise(console, baked, options.output);
  if (!options.json) return;
  json document = bake::reportJson(baked);
  document["output"] = options.output.string();
  printJson(document);
}

}  // namespace

void addBake(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bake", "Precompute the light transport of a scene into a container");
  addBakeOptions(*command, options->bake);
  addOutput(*command, options->output, "Container to write; an existing one is replaced only when the bake is done");
  command
      ->add_option("--cache", options->cache, "Folder that keeps results of tasks for later bakes; may be shared and deleted at any time")
      ->type_name("DIR");
  command->add_flag("--record-seconds", options->bake.request.record_seconds,
                    "Keep beside the measured errors how long each section took; the same scene and settings then no longer give the same bytes");
  command->add_flag("--json", options->json, "Print a report on stdout (schemas/bake.schema.json)");
  command->footer(kFooter);
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
