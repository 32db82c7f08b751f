#include "precompute/bake/context.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "precompute/atlas/validity.h"
#include "precompute/bake/atlas_tasks.h"
#include "precompute/plan/probe_scene.h"
#include "precompute/scene/import.h"

namespace lightwell::bake {
namespace {

constexpr int kSkyGridWidth = 2048;  // columns of the sky's working resolution at most

Key hashSky(const transport::SkyGrid& grid) {
  KeyHasher hasher;
  hasher.add(grid.width).add(grid.height).addArray(grid.frame.data(), grid.frame.size());
  hasher.addArray(grid.flux_rgb.data(), grid.flux_rgb.size());
  return hasher.finish();
}

transport::EnvironmentMap openMap(const SceneSource& source, const plan::EnvironmentPlacement& placement, Diagnostics& diagnostics) {
  std::filesystem::path file = *source.environment;
  if (source.files) {
    const auto found = source.files->find(file.generic_string());
    if (found == source.files->end()) throw InputError(file.string(), "", "no such file");
    file = found->second;
  }
  return openPlacedMap(file, source.environment->filename().string(), placement, diagnostics);
}

void addFacts(const atlas::Atlas& atlas, plan::SceneFacts& facts) {
  facts.has_surfaces = !atlas.slots.empty();
  for (const auto& slot : atlas.slots) {
    facts.has_emitters |= maxComponent(slot.emitted_radiance_rgb) > 0;
    facts.has_reflection |= maxComponent(slot.albedo_rgb) > 0;
  }
}

}  // namespace

void checkSource(const SceneSource& source, const plan::Settings& settings) {
  const auto& wanted = settings.techniques;
  if (!source.environment && std::find(wanted.begin(), wanted.end(), plan::Technique::environment) != wanted.end())
    throw UsageError("--techniques environment: there is no sky without --environment FILE");
  if (!source.scene.empty()) return;
  if (!source.environment) throw UsageError("there is nothing to bake: neither a scene nor an environment map");
  if (source.lights) throw UsageError("--lights: there is no scene whose lights they could replace");
}

transport::EnvironmentMap openPlacedMap(const std::filesystem::path& file, const std::string& name,
                                        const plan::EnvironmentPlacement& placement, Diagnostics& diagnostics) {
  transport::MapPlacement in_world;
  in_world.world_from_map = transport::rotationAboutY(double(placement.rotation_deg) * std::numbers::pi / 180);
  in_world.intensity = placement.intensity;
  if (const auto& ground = placement.ground_radiance_rgb) in_world.ground_radiance_rgb = Rgb((*ground)[0], (*ground)[1], (*ground)[2]);
  return transport::EnvironmentMap(transport::openRowSource(file, diagnostics), name, in_world);
}

BakeContext::BakeContext(const SceneSource& source, const plan::Settings& settings, int threads, Diagnostics& diagnostics,
                         const CancelFlag& cancel, const std::function<void(const std::string&)>& stage, TaskRunner* tasks)
    : settings_(settings), threads_(threads) {
  ThreadExecutor own_executor(threads);
  NullStore own_store;
  TaskRunner own_tasks(own_executor, own_store, {.cancel = &cancel});
  TaskRunner& runner = tasks ? *tasks : own_tasks;
  checkSource(source, settings);
  const auto timed = [&](const char* name, const auto& body) {
    cancel.check();
    if (stage) stage(name);
    const auto begin = std::chrono::steady_clock::now();
    body();
    stage_times_.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  };
  facts_.has_scene = !source.scene.empty();
  if (source.environment)
    timed("environment", [&] {
      transport::EnvironmentMap map = openMap(source, settings.environment, diagnostics);
      sky_grid_ = transport::makeSkyGrid(map, kSkyGridWidth, diagnostics, &cancel);
      sky_light_ = std::make_unique<transport::SkyLight>(*sky_grid_);
      if (sky_light_->isBlack()) sky_light_.reset();
      environment_name_ = source.environment->filename().string();
      sky_key_ = hashSky(*sky_grid_);
      facts_.has_environment = true;
      facts_.has_sky_light = sky_light_ != nullptr;
    });
  if (!facts_.has_scene) return;
  timed("import", [&] {
    const scene::FileTable* files = source.files ? &*source.files : nullptr;
    scene_ = scene::importGltf(source.scene, {.light_units = settings.light_units, .files = files, .portals = settings.portals}, diagnostics);
    if (source.lights) scene::replaceLights(scene_, *source.lights, diagnostics, files);
    keys_ = sceneKeys(scene_, settings);
  });
  if (scene_.mesh.triangles.empty()) {
    diagnostics.warn("", "the scene has no surfaces: there is nothing to bake");
    return;
  }
  timed("atlas", [&] {
    const atlas::AtlasOptions options{.size = settings.lightmap_size, .charts = chartTasks(runner)};
    atlas_ = atlas::buildAtlas(scene_, options, diagnostics, threads);
  });
  timed("acceleration", [&] { tracer_ = std::make_unique<trace::Tracer>(scene_, threads); });
  timed("validity", [&] {
    const auto report = atlas::fillInvalid(atlas_, validSlotTasks(runner, keys_, atlas_, scene_, *tracer_, settings.seed));
    if (report.buried)
      diagnostics.warn("", std::to_string(report.buried) + " of " + std::to_string(atlas_.slots.size()) +
                               " texels lie inside or behind other surfaces; they show the light of their nearest valid neighbour" +
                               (report.unfilled ? " (" + std::to_string(report.unfilled) + " have none)" : ""));
  });
  addFacts(atlas_, facts_);
  if (facts_.has_sky_light) {
    const plan::SkyProbe probe = plan::probeSky(scene_, atlas_, *tracer_, settings.seed);
    facts_.sees_sky = probe.seesSky();
    facts_.probing_rays = probe.rays;
  }
  facts_.has_portals = !scene_.portals.empty();
  facts_.has_lamps = !scene_.lights.empty();
}

}  // namespace lightwell::bake
