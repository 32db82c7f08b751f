// lightwell bake: a scene becomes a container.
#include <sys/resource.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "format/encode/atomic_file.h"
#include "format/encode/reader.h"
#include "precompute/bake/limits.h"

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
  bake::SceneSource source;
  fs::path output;
  std::string techniques = "auto", quality = "production";
  std::string prm_layout = "local-bases", prm_estimator = "gather";
  plan::Settings settings;
  std::optional<double> time_limit_s, target_error;
  std::optional<uint64_t> size_limit_bytes;
  std::optional<fs::path> cache;
  int threads = 0;
  bool json = false;
};

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

uint64_t peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return uint64_t(usage.ru_maxrss) * 1024;
}

uint64_t raysOf(const bake::BakeContext& context) {
  if (!context.tracer()) return 0;
  const auto counts = context.tracer()->counts();
  return counts.closest + counts.occlusion;
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

/// What the bake tells about itself besides bake::Outcome.
struct Report {
  double seconds = 0;
  uint64_t rays = 0;
  std::vector<bake::SectionSize> sections;
  std::vector<bake::PhaseTime> phases;
  std::vector<v1::MeasuredError> errors;
  std::vector<Warning> warnings;
};

json jsonOf(const bake::Outcome& outcome, const Report& report, const Options& options) {
  json document{{"output", options.output.string()},
                {"seconds", report.seconds},
                {"rays", report.rays},
                {"bytes", outcome.container->size()},
                {"tasks_run", outcome.tasks_run},
                {"tasks_reused", outcome.tasks_reused},
                {"peak_memory_bytes", peakMemoryBytes()},
                {"settings", json::parse(plan::canonicalJson(outcome.settings))},
                {"time_limited", outcome.time_limited},
                {"error", nullptr}};
  for (const char* key : {"sections", "omitted", "phases", "warnings"}) document[key] = json::array();
  if (!report.errors.empty()) document["error"] = json::array();
  for (const auto& e : report.errors)
    document["error"].push_back(
        {{"section", e.section()}, {"relrmse", e.relrmse()}, {"texrel", e.texrel()}, {"bias", e.bias()}, {"against", e.against()}});
  for (const auto& s : report.sections)
    document["sections"].push_back({{"type", s.type}, {"stored_bytes", s.stored_bytes}, {"raw_bytes", s.raw_bytes}});
  for (const auto& o : outcome.omitted) document["omitted"].push_back({{"type", o.type}, {"reason", o.reason}});
  for (const auto& p : report.phases) document["phases"].push_back({{"name", p.name}, {"seconds", p.seconds}});
  for (const auto& w : report.warnings) document["warnings"].push_back({{"place", w.place}, {"message", w.message}});
  return document;
}

void summarise(Console& console, const bake::Outcome& outcome, const Report& report, const Options& options) {
  std::string line =
      options.output.string() + ": " + formatBytes(double(outcome.container->size())) + " in " + formatDuration(report.seconds);
  if (report.rays) line += ", " + formatCount(double(report.rays)) + " rays";
  if (outcome.tasks_reused) line += ", " + std::to_string(outcome.tasks_reused) + " results reused";
  if (outcome.time_limited) line += ", cut to quality " + std::string(plan::name(outcome.settings.quality)) + " by the time limit";
  console.line(line);
  for (const auto& s : report.sections)
    console.line("  " + s.type + std::string(s.type.size() < 10 ? 10 - s.type.size() : 0, ' ') + formatBytes(double(s.stored_bytes)) +
                 " (" + formatBytes(double(s.raw_bytes)) + " decoded)");
  for (const auto& e : report.errors) {
    char text[128];
    std::snprintf(text, sizeof text, ": relrmse %.2g %%, texrel %.2g %%, bias %+.2g %% (", 100 * e.relrmse(), 100 * e.texrel(),
                  100 * e.bias());
    console.line("  error of " + e.section() + text + e.against() + ")");
  }
  for (const auto& o : outcome.omitted) console.line("  without " + o.type + ": " + o.reason);
}

/// Reads the options that need more than CLI11's checks, and refuses what cannot work before any work is done.
void prepare(Options& options) {
  options.settings.techniques = plan::parseTechniques(options.techniques);
  options.settings.quality = *plan::qualityNamed(options.quality);
  options.settings.prm_layout = *plan::prmLayoutNamed(options.prm_layout);
  options.settings.prm_estimator = *plan::prmEstimatorNamed(options.prm_estimator);
  plan::checkTechniques(options.settings);
  plan::checkPrm(options.settings);
  checkWritable(options.output);
  checkReadable(options.source.scene);
  if (options.source.lights) checkReadable(*options.source.lights);
}

std::unique_ptr<bake::ResultStore> openStore(const Options& options, Diagnostics& diagnostics) {
  if (options.cache) return std::make_unique<bake::DirectoryStore>(*options.cache, diagnostics);
  // Several attempts share what does not differ between them.
  if (options.size_limit_bytes || options.target_error) return std::make_unique<bake::MemoryStore>();
  return std::make_unique<bake::NullStore>();
}

void run(Session& session, Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  prepare(options);
  Console& console = session.console;
  const CancelFlag& cancel = session.interrupt.flag();
  Diagnostics diagnostics, run_diagnostics;  // of the scene; of this run alone, which no container mentions
  const auto store = openStore(options, run_diagnostics);
  bake::Limits limits{.deadline = {}, .target_error = options.target_error, .size_limit_bytes = options.size_limit_bytes};
  if (options.time_limit_s)
    limits.deadline =
        begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(*options.time_limit_s));

  const bake::BakeContext context(options.source, options.settings, options.threads, diagnostics, cancel,
                                  [&](const std::string& stage) { console.progress(stage, stage + " …"); });
  const std::vector<Warning> scene_warnings = diagnostics.warnings();
  for (const auto& warning : scene_warnings) console.warning(warning);
  bake::ThreadExecutor executor(options.threads);
  const auto progress = [&](const bake::Progress& p) { console.progress(p.phase, progressLine(p, raysOf(context))); };
  const bake::Outcome outcome =
      bake::bakeWithin(context, limits, scene_warnings, run_diagnostics, executor, *store, {.cancel = &cancel, .progress = progress},
                       [&](const std::string& text) { console.line(text); });
  writeOutput(session, options.output, [&] { format::writeFileAtomically(options.output, *outcome.container); });

  Report report;
  report.phases = context.stageTimes();
  report.phases.insert(report.phases.end(), outcome.phases.begin(), outcome.phases.end());
  const format::Reader reader(*outcome.container);
  report.sections = bake::sectionSizes(reader);
  const auto meta = reader.meta();
  report.errors.assign(meta.errors().begin(), meta.errors().end());
  report.rays = raysOf(context);
  report.seconds = secondsSince(begin);
  report.warnings = scene_warnings;
  for (const auto& warning : run_diagnostics.warnings()) {
    console.warning(warning);
    report.warnings.push_back(warning);
  }
  summarise(console, outcome, report, options);
  if (options.json) printJson(jsonOf(outcome, report, options));
}

}  // namespace

void addBake(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bake", "Precompute the light transport of a scene into a container");
  command->add_option("scene", options->source.scene, "glTF 2.0 scene, .glb or .gltf")->required()->type_name("SCENE");
  addOutput(*command, options->output, "Container to write; an existing one is replaced only when the bake is done");
  command
      ->add_option("--techniques", options->techniques, "What to bake: auto (what the scene can use), or a comma-separated list; now: prm")
      ->type_name("LIST")
      ->capture_default_str();
  addSceneSettings(*command, options->settings);
  command->add_option("--quality", options->quality, "draft (seconds), preview, or production")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::qualityNames()))
      ->capture_default_str();
  command
      ->add_option("--time-limit", options->time_limit_s,
                   "Seconds: keep the best quality, up to --quality, that is done in time; a draft always is")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1e7));
  command->add_option("--target-error", options->target_error, "Refine until the measured relrmse is at most this: 0.05 is 5 %")
      ->type_name("E")
      ->check(CLI::Range(1e-4, 10.0));
  command->add_option("--size-limit", options->size_limit_bytes, "Coarsen until the container has at most so many bytes")
      ->type_name("BYTES")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 50));
  addLights(*command, options->source.lights);
  command->add_option("--prm-layout", options->prm_layout, "Form of the section prm: local-bases, or the paper's panes, one per cluster")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::prmLayoutNames()))
      ->capture_default_str();
  command->add_option("--prm-estimator", options->prm_estimator,
                      "How panes are estimated: gather (at the texels) or walks (the paper's, from the entry points)")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::prmEstimatorNames()))
      ->capture_default_str();
  command
      ->add_option("--prm-entries", options->settings.prm_entries,
                   "Entry points in all clusters together, about; without it the quality decides")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostPrmEntries));
  command->add_option("--prm-clusters", options->settings.prm_clusters, "Clusters of entry points, about; without it the quality decides")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostPrmClusters));
  command
      ->add_option("--cache", options->cache, "Folder that keeps results of tasks for later bakes; may be shared and deleted at any time")
      ->type_name("DIR");
  addThreads(*command, options->threads);
  command->add_flag("--json", options->json, "Print a report on stdout (schemas/bake.schema.json)");
  command->footer(kFooter);
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
