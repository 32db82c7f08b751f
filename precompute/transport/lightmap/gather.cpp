#include "precompute/transport/lightmap/gather.h"

#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kGatherStream = 8ull << 40;
constexpr uint32_t kSlotsBetweenChecks = 64;

}  // namespace

GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const Rgb> radiosity_rgb,
                         uint32_t rays, uint64_t seed, uint32_t first, uint32_t end, const CancelFlag* cancel) {
  GatheredPair pair;
  std::vector<trace::Hit> hits;
  const auto gather = [&](uint32_t slot, uint32_t half) {
    const auto list = cosineRays(scene.mesh, atlas, sides, std::span(&slot, 1), rays / 2, seed, kGatherStream + 2ull * slot + half);
    hits.resize(list.size());
    tracer.closest(list, hits);
    Vec3d sum(0.0);
    for (const auto& hit : hits) {
      if (hit.triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hit.triangle, hit.u, hit.v), hit.front);
      if (side != kNone) sum += Vec3d(radiosity_rgb[side]);
    }
    return Rgb(sum / double(rays / 2));
  };
  for (uint32_t slot = first; slot < end; ++slot) {
    if (cancel && slot % kSlotsBetweenChecks == 0) cancel->check();
    pair.a_rgb.push_back(gather(slot, 0));
    pair.b_rgb.push_back(gather(slot, 1));
  }
  return pair;
}

}  // namespace lightwell::transport
