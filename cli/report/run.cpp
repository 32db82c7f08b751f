#include "cli/report/run.h"

#include <algorithm>
#include <cmath>

#include "cli/report/ledger.h"
#include "cli/report/live.h"
#include "cli/report/page.h"
#include "cli/report/plots.h"
#include "cli/report/rays.h"
#include "cli/report/sky.h"
#include "cli/report/time_box.h"
#include "format/encode/atomic_file.h"
#include "format/encode/reader.h"
#include "precompute/core/parallel.h"
#include "render/egl_context.h"
#include "render/error.h"

namespace lightwell::report {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kReferenceShare = 0.2, kLargestShare = 0.5;  // of the budget, and of what is left of it
constexpr double kPage_s = 3;                                 // for plots and pictures
constexpr double kLiveShare = 0.1;                             // of the budget, for what is not of a bake
constexpr uint32_t kMostLiveSamples = 64;                     // of references that hold one reflection, or straight light alone

bool openGlWorks() {
  try {
    const render::EglContext context;
    return true;
  } catch (const render::RenderError&) {
    return false;
  }
}

std::string secondsText(double seconds) { return cli::formatDuration(std::max(seconds, 0.0)); }

class Run {
 public:
  Run(cli::Session& session, const Request& request) : session_(session), request_(request) {}

  Report make() {
    fs::create_directories(request_.laboratory.folder);
    Diagnostics diagnostics;
    LaboratoryOptions options = request_.laboratory;
    options.gl = options.gl && openGlWorks();
    report_.has_gl = options.gl;
    report_.budget_s = request_.budget_s;
    report_.threads = options.threads > 0 ? options.threads : hardwareThreads();
    if (!options.gl) report_.skipped.push_back({"OpenGL", "this machine has none"});
    laboratory_.emplace(options, report_, diagnostics, cancel(), [&](const std::string& stage) { session_.console.progress(stage, stage + " …"); });
    for (const auto& warning : diagnostics.warnings()) session_.console.warning(warning);
    for (const fs::path& container : request_.against) format::Reader(container).meta();  // a damaged one is told before any work
    Ledger ledger(options.folder, laboratory_->key(), request_.fresh);
    traceReferences(ledger);
    measureGiven();
    climb(ledger);
    if (options.source.environment) {
      measureOnce(ledger, "sky", ledger.sky, [&](const CancelFlag& cancel) { return measureSky(options.source, options.settings, options.threads, cancel); });
      measureOnce(ledger, "shadowed sky", ledger.shadowed_sky, [&](const CancelFlag& cancel) { return measureShadowedSky(liveBench(options, cancel)); });
    }
    if (options.gl && !laboratory_->context().scene().lights.empty())
      measureOnce(ledger, "lamps without a bake", ledger.live_lamps, [&](const CancelFlag& cancel) { return measureLamps(liveBench(options, cancel)); });
    report_.sky = ledger.sky, report_.live_lamps = ledger.live_lamps;
    report_.sky.insert(report_.sky.end(), ledger.shadowed_sky.begin(), ledger.shadowed_sky.end());
    if (!ledger.rays && secondsLeft() > 0) ledger.rays = measureRays(laboratory_->context()), ledger.save();
    report_.rays = ledger.rays;
    report_.seconds = elapsed();
    return report_;
  }

 private:
  const CancelFlag& cancel() const { return session_.interrupt.flag(); }
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  double secondsLeft() const { return request_.budget_s - kPage_s - elapsed(); }

  void traceReferences(Ledger& ledger) {
    const bool usable = ledger.reference && (!request_.reference_samples || *request_.reference_samples == ledger.reference->samples);
    if (usable) {
      laboratory_->readReferences(*ledger.reference);
    } else {
      ledger = Ledger(request_.laboratory.folder, laboratory_->key(), true);  // figures are those of other references
      const uint32_t samples = request_.reference_samples ? *request_.reference_samples : laboratory_->samplesWithin(kReferenceShare * request_.budget_s, cancel());
      ledger.reference = laboratory_->traceReferences(samples, cancel(), [&](double fraction) { progress("references", std::to_string(int(100 * fraction)) + " % of two path-traced references"); });
      ledger.save();
    }
    report_.reference = *ledger.reference;
  }

  void progress(const std::string& stage, const std::string& text) {
    session_.console.progress(stage, text + ", " + secondsText(elapsed()) + (expected_left_ > 0 ? ", about " + secondsText(std::min(expected_left_, secondsLeft() + kPage_s)) + " left" : "") +
                                         " of at most " + secondsText(request_.budget_s));
  }

  /// Costs of what was measured here, in seconds for each unit of expected cost.
  double secondsOf(const Rung& rung) const {
    double seconds = 0, cost = 0;
    for (const auto& [series, of_series] : spent_)
      if (series == rung.series) return of_series.first / of_series.second * rung.cost;
    for (const auto& [series, of_series] : spent_) seconds += of_series.first, cost += of_series.second;
    return cost > 0 ? seconds / cost * rung.cost : 0;
  }

  void climb(Ledger& ledger) {
    const std::vector<Rung> rungs = ladderOf(request_.laboratory.settings, laboratory_->context().facts(), report_.skipped);
    for (size_t i = 0; i < rungs.size(); ++i) {
      const Rung& rung = rungs[i];
      const std::string name = std::string(seriesNamed(rung.series).title) + ", " + rung.setting;
      if (const Baked* finished = ledger.find(laboratory_->keyOf(rung))) {
        report_.bakes.push_back(*finished), ++report_.reused;
        continue;
      }
      const double expected = secondsOf(rung), left = secondsLeft() - kLiveShare * request_.budget_s;
      if (left <= 0 || expected > left) {
        report_.skipped.push_back({name, left <= 0 ? "the budget was used up" : "expected to take " + secondsText(expected) + ", with " + secondsText(left) + " of the budget left"});
        continue;
      }
      expected_left_ = 0;
      for (size_t k = i; k < rungs.size(); ++k) expected_left_ += ledger.find(laboratory_->keyOf(rungs[k])) ? 0 : secondsOf(rungs[k]);
      progress(name, std::to_string(i + 1) + " of " + std::to_string(rungs.size()) + ": " + name);
      const auto begin = Clock::now();
      const auto allowance = std::chrono::duration<double>(kLargestShare * left);
      TimeBox box(cancel(), begin + std::chrono::duration_cast<Clock::duration>(allowance));
      try {
        const Baked baked = laboratory_->measure(rung, box.flag());
        report_.bakes.push_back(baked), ++report_.measured;
        ledger.add(baked);
        ledger.save();
      } catch (const Cancelled&) {
        cancel().check();
        report_.skipped.push_back({name, "not done within " + secondsText(allowance.count()) + ", its share of the budget"});
      } catch (const UsageError& error) {
        report_.skipped.push_back({name, error.what()});
      } catch (const std::bad_alloc&) {
        report_.skipped.push_back({name, "this machine has too little memory for it"});
      }
      auto& [seconds, cost] = spent_[rung.series];
      seconds += std::chrono::duration<double>(Clock::now() - begin).count(), cost += rung.cost;
    }
    expected_left_ = 0;
  }

  void measureGiven() {
    for (const fs::path& container : request_.against) {
      progress(container.string(), container.filename().string());
      for (const Baked& baked : laboratory_->measureGiven(container, cancel())) report_.bakes.push_back(baked), ++report_.measured;
    }
  }

  LiveBench liveBench(const LaboratoryOptions& options, const CancelFlag& cancel) const { return {laboratory_->context(), options, std::min(report_.reference.samples, kMostLiveSamples), cancel}; }

  /// What is not of a bake: unless an earlier run has done it, with what is left of the budget.
  template <class Answers, class Measure>
  void measureOnce(Ledger& ledger, const std::string& name, Answers& answers, const Measure& measure) {
    if (!answers.empty()) return;
    progress(name, name);
    TimeBox box(cancel(), begin_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(request_.budget_s - kPage_s)));
    try {
      box.flag().check();
      answers = measure(box.flag());
      ledger.save();
    } catch (const Cancelled&) {
      cancel().check();
      report_.skipped.push_back({name, "the budget was used up"});
    }
  }

  cli::Session& session_;
  const Request& request_;
  const Clock::time_point begin_ = Clock::now();
  Report report_;
  std::optional<Laboratory> laboratory_;
  std::map<std::string, std::pair<double, double>> spent_;  // by series: seconds, expected cost
  double expected_left_ = 0;

 public:
  const Truth& truth() const { return laboratory_->truth(); }
};

void writeText(const fs::path& file, const std::string& text) { format::writeFileAtomically(file, std::vector<uint8_t>(text.begin(), text.end())); }

}  // namespace

Report runReport(cli::Session& session, const Request& request) {
  Run run(session, request);
  Report report = run.make();
  session.console.progress("page", "page …");
  const fs::path& folder = request.laboratory.folder;
  const std::vector<Plot> plots = plotsOf(report);
  const std::vector<Picture> pictures = makePictures(folder, report, run.truth());
  for (const Plot& plot : plots) writeText(folder / plot.file, plot.svg);
  writeText(folder / "report.csv", csvOf(report));
  writeText(folder / "report.json", nlohmann::json(report).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  writeText(folder / "report.html", pageOf(folder, report, plots, pictures));
  return report;
}

}  // namespace lightwell::report
