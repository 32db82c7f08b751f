#include "precompute/bake/context.h"

#include <algorithm>
#include <chrono>

#include "precompute/scene/import.h"

namespace lightwell::bake {
namespace {

constexpr int kSkyGridWidth = 2048;  // columns of the sky's working resolution at most

template <class T>
void addVector(KeyHasher& hasher, const std::vector<T>& values) {
  static_assert(std::is_standard_layout_v<T>);
  hasher.addArray(values.data(), values.size());
}

Key hashSurfaces(const scene::Scene& scene, const plan::Settings& settings) {
  const scene::Mesh& mesh = scene.mesh;
  KeyHasher hasher;
  hasher.add(settings.lightmap_size).add(settings.seed).add(scene.metres_per_unit);
  addVector(hasher, mesh.positions);
  addVector(hasher, mesh.normals);
  addVector(hasher, mesh.base_uv);
  addVector(hasher, mesh.emissive_uv);
  addVector(hasher, mesh.lightmap_uv);
  addVector(hasher, mesh.colors);
  addVector(hasher, mesh.triangles);
  addVector(hasher, mesh.triangle_material);
  addVector(hasher, mesh.triangle_object);
  for (const auto& m : scene.materials)
    hasher.addArray(&m.base_color, 1).add(m.alpha).add(m.base_color_texture).addArray(&m.emissive, 1).add(m.emissive_texture)
        .add(m.alpha_mode).add(m.alpha_cutoff).add(m.double_sided).add(m.unlit);
  for (const auto& t : scene.textures) {
    hasher.add(t.width).add(t.height).add(t.wrap_u).add(t.wrap_v);
    addVector(hasher, t.rgba);
  }
  return hasher.finish();
}

Key hashLights(const scene::Scene& scene) {
  KeyHasher hasher;
  hasher.add(scene.origin_m.x).add(scene.origin_m.y).add(scene.origin_m.z).add(scene.metres_per_unit);
  for (const auto& light : scene.lights)
    hasher.add(light.type).add(light.name).addArray(&light.position, 1).addArray(&light.direction, 1).addArray(&light.intensity, 1)
        .add(light.inner_cone_angle).add(light.outer_cone_angle).add(light.range);
  return hasher.finish();
}

Key hashSky(const transport::SkyGrid& grid) {
  KeyHasher hasher;
  hasher.add(grid.width).add(grid.height).addArray(grid.frame.data(), grid.frame.size());
  addVector(hasher, grid.flux_rgb);
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
                         const CancelFlag& cancel, const std::function<void(const std::string&)>& stage)
    : settings_(settings), threads_(threads) {
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
    scene_ = scene::importGltf(source.scene, {.light_units = settings.light_units, .files = files}, diagnostics);
    if (source.lights) scene::replaceLights(scene_, *source.lights, diagnostics, files);
    surface_key_ = hashSurfaces(scene_, settings);
    light_key_ = hashLights(scene_);
  });
  if (scene_.mesh.triangles.empty()) {
    diagnostics.warn("", "the scene has no surfaces: there is nothing to bake");
    return;
  }
  timed("atlas", [&] { atlas_ = atlas::buildAtlas(scene_, {.size = settings.lightmap_size}, diagnostics); });
  timed("acceleration", [&] { tracer_ = std::make_unique<trace::Tracer>(scene_, threads); });
  timed("validity", [&] {
    const auto report = atlas::fillInvalid(atlas_, scene_, *tracer_, settings.seed, threads, &cancel);
    if (report.buried)
      diagnostics.warn("", std::to_string(report.buried) + " of " + std::to_string(atlas_.slots.size()) +
                               " texels lie inside or behind other surfaces; they show the light of their nearest valid neighbour" +
                               (report.unfilled ? " (" + std::to_string(report.unfilled) + " have none)" : ""));
  });
  addFacts(atlas_, facts_);
}

}  // namespace lightwell::bake
