#include "cli/stress/workbench.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "cli/stress/evaluators.h"
#include "format/encode/atomic_file.h"
#include "format/encode/verify.h"

namespace lightwell::stress {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

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

Workbench::Workbench(int threads, const CancelFlag& cancel, bool with_gl) : threads_(threads), cancel_(cancel), with_gl_(with_gl) {
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
  lit.baked = job.dynamic ? reader.has("geometry") : reader.has(std::string(plan::name(job.technique)));
  if (!reader.has("geometry")) {
    lit.seconds = secondsSince(begin);
    return lit;
  }
  Diagnostics diagnostics;
  lit.scene = bake::loadContainerScene(reader, diagnostics);
  lit.metres_per_unit = lit.scene.scene.metres_per_unit;
  const trace::Tracer tracer(lit.scene.scene, threads_);
  const cli::RuntimeContainer runtime(file);
  const Open open{.job = job, .runtime = runtime, .scene = lit.scene, .tracer = tracer, .threads = threads_, .cancel = cancel_};
  if (lit.baked) lit.irradiance_rgb = job.dynamic ? evaluateDynamically(open, *job.dynamic) : evaluateOnCpu(open);
  const auto counts = tracer.counts();
  lit.rays += counts.closest + counts.occlusion;
  lit.seconds = secondsSince(begin);
  if (with_gl_ && job.on_gl && lit.baked && !job.dynamic) {
    const auto gl_begin = Clock::now();
    lit.gl_irradiance_rgb = evaluateOnGl(open);
    lit.gl_seconds = secondsSince(gl_begin);
  }
  return lit;
}

}  // namespace lightwell::stress
