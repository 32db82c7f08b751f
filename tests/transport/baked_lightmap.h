// Light maps of test scenes, stage by stage.
#pragma once
#include <vector>

#include "precompute/core/parallel.h"
#include "precompute/transport/lightmap/bake_lightmap.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/stages.h"

namespace lightwell::transport {

using Prepared = test::PreparedScene;

/// All stages, cut into ranges of `grain`, on `threads` threads; with `error` the measured one too.
inline Lightmap bake(const Prepared& p, const LightmapSettings& settings, uint32_t grain = 200, int threads = 2, PooledError* error = nullptr,
                     const SkyLight* sky = nullptr) {
  const CancelFlag cancel;
  const Bytes patches = makeLightmapPatchBytes(p.scene, p.atlas, *p.tracer, settings, threads, nullptr);
  const LightmapBaker baker(p.scene, p.atlas, *p.tracer, p.scene.lights, sky, settings, patches);
  const auto stage = [&](uint32_t count, auto function) { return test::inRanges(count, grain, threads, function); };
  using test::views;
  const auto first = stage(baker.sideCount(), [&](uint32_t a, uint32_t b) { return baker.firstLight(a, b, cancel); });
  const auto direct = stage(baker.sideCount(), [&](uint32_t a, uint32_t b) { return baker.directLight(a, b, views(first), cancel); });
  const auto rows = stage(baker.patchCount(), [&](uint32_t a, uint32_t b) { return baker.rows(a, b); });
  const Bytes radiosity = baker.radiosity(views(direct), views(rows), cancel);
  const auto first_gathered = stage(baker.slotCount(), [&](uint32_t a, uint32_t b) { return baker.firstGather(a, b, radiosity, cancel); });
  const Bytes refined = baker.refine(views(direct), radiosity, views(first_gathered), threads, cancel);
  const auto gathered = stage(baker.slotCount(), [&](uint32_t a, uint32_t b) { return baker.gather(a, b, refined, cancel); });
  Lightmap map = baker.assemble(views(direct), views(gathered), threads, cancel);
  if (error) {
    const auto references = stage(baker.referenceCount(), [&](uint32_t a, uint32_t b) { return baker.references(a, b, refined, cancel); });
    *error = baker.measure(map, refined, views(references), cancel);
  }
  return map;
}

inline scene::Scene roomWithBox(float albedo) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(albedo));
  builder.room({-2, 0, -2}, {2, 3, 2}, wall);
  // A box of 1 m, outside faces: it stands on the floor.
  const Vec3 low(-0.6f, 0, -0.4f), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.quad(low + y, z, x, wall).quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({1.2f, 2.4f, 0.9f}, 10.0f));
  return scene;
}

}  // namespace lightwell::transport
