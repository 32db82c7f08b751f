#include "precompute/atlas/validity.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "precompute/atlas/sources.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"

namespace lightwell::atlas {
namespace {

constexpr uint32_t kRays = 32;           // per slot; a power of two, for the net property of the points
constexpr uint32_t kFirstRays = 8;       // likewise; more only where one of these meets a back face
constexpr float kBuriedShare = 0.5f;     // of the rays that meet back faces
constexpr uint64_t kStream = 0xb0f1ed;   // keeps these rays independent of others with the same seed

trace::Ray rayFrom(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot, const Sampler& sampler, uint32_t sample, uint32_t key) {
  const SurfacePoint point = sampleSlot(mesh, atlas, slot, sampler.get1D(sample, 0), sampler.get2D(sample, 1));
  Vec3 tangent, bitangent;
  orthonormalBasis(point.geometric_normal, tangent, bitangent);
  const Vec3 local = sampleCosineHemisphere(sampler.get2D(sample, 2));
  trace::Ray ray;
  ray.direction = (tangent * local.x + bitangent * local.y + point.geometric_normal * local.z).normalized();
  ray.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, ray.direction);
  ray.key = key;
  return ray;
}

}  // namespace

std::vector<uint8_t> validSlots(const Atlas& atlas, const scene::Scene& scene, const trace::Tracer& tracer, uint64_t seed, size_t first,
                                size_t end) {
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<uint32_t> back(end - first, 0);
  const auto traceRays = [&](std::span<const size_t> slots, uint32_t from, uint32_t to) {
    rays.clear();
    for (const size_t i : slots) {
      const Sampler sampler(combineKeys(seed, kStream), atlas.slots[i].texel);
      for (uint32_t s = from; s < to; ++s) rays.push_back(rayFrom(scene.mesh, atlas, atlas.slots[i], sampler, s, mixBits(combineKeys(atlas.slots[i].texel, s))));
    }
    hits.resize(rays.size());
    tracer.closest(rays, hits);
    for (size_t k = 0; k < hits.size(); ++k) {
      const trace::Hit& hit = hits[k];
      const bool meets_back = hit.triangle != kNone && !hit.front && !scene.materials[scene.mesh.triangle_material[hit.triangle]].double_sided;
      back[slots[k / (to - from)] - first] += meets_back;
    }
  };
  // Where none of the first rays, which are spread evenly, meets a back face, half of all do not.
  std::vector<size_t> slots(end - first);
  std::iota(slots.begin(), slots.end(), first);
  traceRays(slots, 0, kFirstRays);
  std::erase_if(slots, [&](size_t i) { return back[i - first] == 0; });
  traceRays(slots, kFirstRays, kRays);
  std::vector<uint8_t> valid(end - first);
  for (size_t i = 0; i < valid.size(); ++i) valid[i] = float(back[i]) <= kBuriedShare * kRays;
  return valid;
}

ValidityReport fillInvalid(Atlas& atlas, std::span<const uint8_t> valid) {
  ValidityReport report;
  for (const uint8_t v : valid) report.buried += !v;
  report.unfilled = fillSources(atlas, {valid.begin(), valid.end()});
  return report;
}

ValidityReport fillInvalid(Atlas& atlas, const scene::Scene& scene, const trace::Tracer& tracer, uint64_t seed, int threads,
                           const CancelFlag* cancel) {
  std::vector<uint8_t> valid(atlas.slots.size());
  parallelFor(valid.size(), 64, threads, cancel, [&](size_t begin, size_t end) {
    const auto part = validSlots(atlas, scene, tracer, seed, begin, end);
    std::copy(part.begin(), part.end(), valid.begin() + ptrdiff_t(begin));
  });
  return fillInvalid(atlas, valid);
}

}  // namespace lightwell::atlas
