#include "precompute/plan/texel_density.h"

#include "precompute/atlas/validity.h"
#include "precompute/core/error.h"
#include "precompute/plan/probe_scene.h"

namespace lightwell::plan {

ChosenSize chooseLightmapSize(const scene::Scene& scene, double target, uint64_t seed, int threads, const CancelFlag* cancel) {
  if (scene.mesh.triangles.empty()) return {kLeastChosenSize, 0};
  const trace::Tracer tracer(scene, threads);  // unwrapping moves nothing
  for (int size = kLeastChosenSize;; size *= 2) {
    if (cancel) cancel->check();
    scene::Scene unwrapped = scene;
    Diagnostics told_by_the_bake;
    atlas::Atlas atlas;
    try {
      atlas = atlas::buildAtlas(unwrapped, {.size = size}, told_by_the_bake, threads);
    } catch (const InputError&) {
      if (size >= kMostChosenSize) throw;
      continue;  // too small for the charts
    }
    atlas::fillInvalid(atlas, unwrapped, tracer, seed, threads, cancel);
    const double variation = probeVariation(unwrapped, atlas, tracer, seed);
    if (variation <= target || size >= kMostChosenSize) return {size, variation};
  }
}

}  // namespace lightwell::plan
