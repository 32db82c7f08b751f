#include "cli/stress/workbench.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "cli/environment_evaluator.h"
#include "cli/lightmap_evaluator.h"
#include "cli/prm_evaluator.h"
#include "cli/radiosity_evaluator.h"
#include "cli/runtime_handles.h"
#include "cli/slot_values.h"
#include "cli/vpl_evaluator.h"
#include "format/encode/atomic_file.h"
#include "format/encode/verify.h"

namespace lightwell::stress {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using plan::Technique;
using transport::Component;

constexpr uint32_t kSamples = 16;  // points of each texel at which evaluators look

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// What the runtime makes of the technique's section, as `lightwell evaluate --evaluator cpu` asks it.
std::vector<Rgb> evaluate(const Job& job, const cli::RuntimeContainer& runtime, const bake::ContainerScene& scene, const trace::Tracer& tracer, int threads,
                          const CancelFlag& cancel) {
  const bool direct = job.component != Component::indirect, indirect = job.component != Component::direct;
  switch (job.technique) {
    case Technique::prm: {
      cli::PrmEvaluation evaluation{.container = runtime, .scene = scene.scene, .tracer = tracer, .lights = {}};
      if (indirect) evaluation.lights = scene.scene.lights, evaluation.emitters |= LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT;
      if (direct) evaluation.emitters |= LW_EMITTERS_DIRECT | LW_SKY_DIRECT;
      return cli::valuesOfSlots(scene.atlas, cli::evaluatePrmOnCpu(evaluation));
    }
    case Technique::radiosity: {
      const uint32_t light = (indirect ? LW_RADIOSITY_INDIRECT : 0) | (direct ? LW_RADIOSITY_EMITTERS : 0);
      return cli::valuesOfSlots(scene.atlas, cli::evaluateRadiosityOnCpu({.container = runtime, .scene = scene, .tracer = tracer, .light = light, .samples = kSamples,
                                                                     .portal_open = {}, .threads = threads, .cancel = &cancel}));
    }
    case Technique::lightmap: {
      const uint32_t light = (direct ? LW_LIGHTMAP_DIRECT : 0) | (indirect ? LW_LIGHTMAP_INDIRECT : 0);
      return cli::valuesOfSlots(scene.atlas, cli::evaluateLightmapOnCpu(runtime, light));
    }
    case Technique::vpl:
      return cli::evaluateVplOnCpu({.container = runtime, .scene = scene, .tracer = tracer, .component = job.component, .samples = kSamples, .threads = threads,
                                    .cancel = &cancel, .progress = [](double) {}})
          .irradiance_rgb;
    case Technique::environment:
      return cli::evaluateEnvironmentOnCpu({.container = runtime, .scene = scene, .tracer = tracer, .samples = kSamples, .threads = threads, .cancel = &cancel});
  }
  return {};
}

}  // namespace

Vec3d Lit::flux_rgb() const {
  Vec3d flux(0.0);
  for (size_t i = 0; i < irradiance_rgb.size(); ++i) flux += Vec3d(irradiance_rgb[i]) * double(scene.atlas.slots[i].area);
  return flux * (metres_per_unit * metres_per_unit);
}

double Lit::area_m2() const {
  double area = 0;
  for (const atlas::Slot& slot : scene.atlas.slots) area += double(slot.area);
  return area * metres_per_unit * metres_per_unit;
}

double Lit::meanLuminance(const std::function<bool(const atlas::Slot&)>& of) const {
  double sum = 0, area = 0;
  for (size_t i = 0; i < irradiance_rgb.size(); ++i) {
    const atlas::Slot& slot = scene.atlas.slots[i];
    if (of && !of(slot)) continue;
    sum += double(luminance(irradiance_rgb[i])) * double(slot.area), area += double(slot.area);
  }
  return area > 0 ? sum / area : 0;
}

double Lit::mostLuminance(const std::function<bool(const atlas::Slot&)>& of) const {
  double most = 0;
  for (size_t i = 0; i < irradiance_rgb.size(); ++i)
    if (!of || of(scene.atlas.slots[i])) most = std::max(most, double(luminance(irradiance_rgb[i])));
  return most;
}

Workbench::Workbench(int threads, const CancelFlag& cancel) : threads_(threads), cancel_(cancel) {
  std::string name = (fs::temp_directory_path() / "lightwell_stress_XXXXXX").string();
  if (!mkdtemp(name.data())) throw UsageError("no folder for temporary files can be made in " + fs::temp_directory_path().string());
  folder_ = name;
}

Workbench::~Workbench() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path Workbench::bake(const Job& job, Lit* lit) const {
  bake::Request request{.settings = job.settings, .threads = threads_};
  request.settings.techniques = {job.technique};
  if (job.scene) {
    request.source.scene = folder_ / "scene.glb";
    job.scene->write(request.source.scene);
  }
  if (job.sky) {
    request.source.environment = folder_ / "sky.exr";
    writeExr(*request.source.environment, *job.sky);
  }
  bake::NullStore store;
  Diagnostics diagnostics;
  const bake::Baked baked = bake::runBake(request, store, diagnostics, cancel_, {});
  const fs::path container = folder_ / "scene.lwc";
  format::writeFileAtomically(container, *baked.outcome.container);
  if (!lit) return container;
  lit->omitted = baked.outcome.omitted;
  lit->warnings = baked.report.warnings;
  lit->rays = baked.report.rays;
  lit->bytes = baked.outcome.container->size();
  for (const auto& issue : format::verify(container))
    if (!issue.note) lit->unsound.push_back(issue.place + ": " + issue.message);
  return container;
}

Lit Workbench::light(const Job& job) const {
  Lit lit;
  const auto begin = Clock::now();
  const fs::path file = bake(job, &lit);
  const format::Reader reader(file);
  lit.baked = reader.has(std::string(plan::name(job.technique)));
  if (reader.has("geometry")) {
    Diagnostics diagnostics;
    lit.scene = bake::loadContainerScene(reader, diagnostics);
    lit.metres_per_unit = lit.scene.scene.metres_per_unit;
    const trace::Tracer tracer(lit.scene.scene, threads_);
    const cli::RuntimeContainer runtime(file);
    if (lit.baked) lit.irradiance_rgb = evaluate(job, runtime, lit.scene, tracer, threads_, cancel_);
    const auto counts = tracer.counts();
    lit.rays += counts.closest + counts.occlusion;
  }
  lit.seconds = secondsSince(begin);
  return lit;
}

}  // namespace lightwell::stress
