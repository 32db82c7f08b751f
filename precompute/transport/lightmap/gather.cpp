#include "precompute/transport/lightmap/gather.h"

#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kGatherStream = 8ull << 40;
constexpr uint32_t kSlotsBetweenChecks = 64;

}  // namespace

GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const Rgb> radiosity_rgb,
                         uint32_t rays, uint64_t seed, const TiltKernel* tilt, uint32_t first, uint32_t end, const CancelFlag* cancel) {
  GatheredPair pair;
  std::vector<trace::Hit> hits;
  Vec3d gradient;
  const auto gather = [&](uint32_t slot, uint32_t half) {
    const auto list = cosineRays(scene.mesh, atlas, sides, std::span(&slot, 1), rays / 2, seed, kGatherStream + 2ull * slot + half);
    hits.resize(list.size());
    tracer.closest(list, hits);
    Vec3d sum(0.0);
    for (size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hits[i].triangle, hits[i].u, hits[i].v), hits[i].front);
      if (side == kNone) continue;
      sum += Vec3d(radiosity_rgb[side]);
      if (tilt) gradient += Vec3d(tilt->gradient(atlas.slots[slot].normal, list[i].direction)) * double(luminance(radiosity_rgb[side]));
    }
    return Rgb(sum / double(rays / 2));
  };
  for (uint32_t slot = first; slot < end; ++slot) {
    if (cancel && slot % kSlotsBetweenChecks == 0) cancel->check();
    gradient = Vec3d(0.0);
    pair.a_rgb.push_back(gather(slot, 0));
    pair.b_rgb.push_back(gather(slot, 1));
    if (tilt) pair.gradient.push_back(Vec3(gradient / double(rays)));
  }
  return pair;
}

}  // namespace lightwell::transport
