#include "precompute/bake/context.h"

#include <chrono>

#include "precompute/scene/import.h"

namespace lightwell::bake {
namespace {

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

plan::SceneFacts factsOf(const atlas::Atlas& atlas) {
  plan::SceneFacts facts{.has_surfaces = !atlas.slots.empty()};
  for (const auto& slot : atlas.slots) {
    facts.has_emitters |= maxComponent(slot.emitted_radiance_rgb) > 0;
    facts.has_reflection |= maxComponent(slot.albedo_rgb) > 0;
  }
  return facts;
}

}  // namespace

BakeContext::BakeContext(const SceneSource& source, const plan::Settings& settings, int threads, Diagnostics& diagnostics,
                         const CancelFlag& cancel, const std::function<void(const std::string&)>& stage)
    : settings_(settings) {
  const auto timed = [&](const char* name, const auto& body) {
    cancel.check();
    if (stage) stage(name);
    const auto begin = std::chrono::steady_clock::now();
    body();
    stage_times_.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  };
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
  facts_ = factsOf(atlas_);
}

}  // namespace lightwell::bake
