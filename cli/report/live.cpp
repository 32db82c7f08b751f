#include "cli/report/live.h"

#include <chrono>

#include "cli/dynamic_evaluator.h"
#include "cli/environment_evaluator.h"
#include "cli/irradiance_image.h"
#include "cli/report/frame_cost.h"
#include "cli/slot_values.h"
#include "format/encode/atomic_file.h"
#include "precompute/bake/bake.h"
#include "precompute/bake/container_scene.h"
#include "precompute/transport/compare.h"

namespace lightwell::report {
namespace {

using Clock = std::chrono::steady_clock;
using transport::Component;

constexpr uint64_t kSeeds[] = {1003, 1004};
constexpr uint32_t kPoints = 16384, kFewLights = 16;  // of the section points; baked virtual lights, which are not looked at
constexpr uint32_t kCellSamples = 16;                 // points of each texel

/// A container made for the purpose, open.
struct Opened {
  Opened(const LiveBench& bench, plan::Settings settings, const std::string& name) : file(bench.options.folder / "containers" / name) {
    const auto begin = Clock::now();
    bake::ThreadExecutor executor(bench.options.threads);
    bake::NullStore store;
    bake::TaskRunner tasks(executor, store, {.cancel = &bench.cancel});
    const bake::BakeGraph graph = bake::makeBakeGraph(bench.context, {.settings = std::move(settings), .warnings = {}, .test_lights = 0}, tasks);
    format::writeFileAtomically(file, *tasks.run(graph.graph, std::array{graph.container}, Clock::time_point::max()).goals[0]);
    seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    runtime.emplace(file);
    Diagnostics diagnostics;
    scene = bake::loadContainerScene(format::Reader(file), diagnostics);
  }
  ImageRgba image(const std::vector<Rgb>& slot_rgb) const { return cli::imageOfSlots(scene.scene.mesh, scene.atlas, scene.atlas.width, slot_rgb); }

  fs::path file;
  double seconds = 0;
  std::optional<cli::RuntimeContainer> runtime;
  bake::ContainerScene scene;
};

/// What lamps or the sky give alone: emitters' light, which the reference always has, is taken off.
Truth trace(const LiveBench& bench, Component component, bool of_sky) {
  const auto map = [&](uint64_t seed) {
    const auto light = [&](bool on) {
      transport::ReferenceOptions options{.samples = bench.samples, .seed = seed, .threads = bench.options.threads, .sky = on && of_sky ? bench.context.skyLight() : nullptr, .cancel = &bench.cancel};
      if (!of_sky) options.most_bounces = 1;
      return transport::referenceIrradiance(bench.context.scene(), bench.context.atlas(), *bench.context.tracer(), on && !of_sky ? bench.context.scene().lights : std::vector<scene::Light>{}, component, options)
          .irradiance_rgb;
    };
    std::vector<Rgb> rgb = light(true);
    if (bench.context.facts().has_emitters) {
      const std::vector<Rgb> without = light(false);
      for (size_t i = 0; i < rgb.size(); ++i) rgb[i] -= without[i];
    }
    return cli::imageOfSlots(bench.context.scene().mesh, bench.context.atlas(), bench.options.settings.lightmap_size, rgb);
  };
  return {map(kSeeds[0]), map(kSeeds[1])};
}

}  // namespace

std::vector<LampAnswer> measureLamps(const LiveBench& bench) {
  const Truth truth = trace(bench, Component::indirect, false);
  plan::Settings settings = bench.options.settings;
  settings.techniques = {plan::Technique::vpl};
  settings.quality = plan::Quality::draft, settings.points = kPoints, settings.virtual_lights = kFewLights;
  const Opened opened(bench, settings, "live_lamps.lwc");
  std::vector<LampAnswer> answers;
  const auto add = [&](bool incremental, uint32_t lights, uint32_t shadow_side) {
    bench.cancel.check();
    const auto rgba = cli::evaluateDynamicOnGl({.container = *opened.runtime, .scene = opened.scene.scene, .incremental = incremental, .lights = lights, .shadow_side = shadow_side});
    const auto error = transport::compareMaps(truth.first, opened.image(cli::valuesOfSlots(opened.scene.atlas, rgba)), &truth.second);
    answers.push_back({incremental, lights, shadow_side, error.relrmse, dynamicFrameMs(*opened.runtime, incremental, lights, shadow_side)});
  };
  for (const bool incremental : {false, true}) {
    for (const uint32_t lights : kLampCounts) add(incremental, lights, kLampShadowSide);
    for (const uint32_t side : kLampShadowSides) add(incremental, kLampLights, side);
  }
  return answers;
}

std::vector<SkyAnswer> measureShadowedSky(const LiveBench& bench) {
  const Truth truth = trace(bench, Component::direct, true);
  std::vector<SkyAnswer> answers;
  for (const uint32_t cells : kShadowedCells) {
    plan::Settings settings = bench.options.settings;
    settings.techniques = {plan::Technique::environment};
    settings.environment_samples = cells;
    const Opened opened(bench, settings, "live_sky_" + std::to_string(cells) + ".lwc");
    const trace::Tracer tracer(opened.scene.scene, bench.options.threads);
    const cli::EnvironmentEvaluation evaluation{.container = *opened.runtime, .scene = opened.scene, .tracer = tracer, .samples = kCellSamples, .threads = bench.options.threads, .cancel = &bench.cancel};
    const auto add = [&](const char* model, const std::vector<Rgb>& slot_rgb) {
      answers.push_back({model, 1, cells, opened.seconds, transport::compareMaps(truth.first, opened.image(slot_rgb), &truth.second).relrmse});
    };
    add("shadowed, rays", cli::evaluateEnvironmentOnCpu(evaluation));
    if (bench.options.gl) add("shadowed, OpenGL", cli::evaluateEnvironmentOnGl(evaluation));
    bench.cancel.check();
  }
  return answers;
}

}  // namespace lightwell::report
