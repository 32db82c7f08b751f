#include "precompute/transport/exposure.h"

#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kPoints = 16, kRaysPerPoint = 8;
constexpr uint64_t kExposureStream = 4ull << 40;

}  // namespace

std::vector<float> exposedShare(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, uint64_t seed,
                                int threads, const CancelFlag* cancel) {
  std::vector<float> share(sides.slot.size(), 1.0f);
  parallelFor(share.size(), 256, threads, cancel, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays;
    std::vector<trace::Hit> hits;
    const auto meetsBack = [&](const trace::Hit& hit) {
      return hit.triangle != kNone && !hit.front && !scene.materials[scene.mesh.triangle_material[hit.triangle]].double_sided;
    };
    for (uint32_t side = uint32_t(begin); side < end; ++side) {
      const Sampler sampler(seed, kExposureStream + side);
      // The rays of all points, one of each point first: where none of these meets a back face, nothing is hidden.
      const auto traceRays = [&](uint32_t first, uint32_t last) {
        rays.clear();
        for (uint32_t i = first; i < last; ++i)
          for (uint32_t p = 0; p < kPoints; ++p) {
            const auto point = sampleSide(scene.mesh, atlas, sides, side, sampler.get1D(p, 0), sampler.get2D(p, 1));
            Vec3 tangent, bitangent;
            orthonormalBasis(point.geometric_normal, tangent, bitangent);
            const Vec3 local = sampleCosineHemisphere(sampler.get2D(i * kPoints + p, 2));
            const Vec3 direction = (tangent * local.x + bitangent * local.y + point.geometric_normal * local.z).normalized();
            rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction,
                            .key = mixBits(combineKeys(kExposureStream + side, i * kPoints + p))});
          }
        hits.resize(rays.size());
        tracer.closest(rays, hits);
      };
      uint32_t backs[kPoints] = {};
      const auto countBacks = [&] {
        uint32_t all = 0;
        for (size_t i = 0; i < hits.size(); ++i) all += meetsBack(hits[i]), backs[i % kPoints] += meetsBack(hits[i]);
        return all;
      };
      traceRays(0, 1);
      if (countBacks() == 0) continue;
      traceRays(1, kRaysPerPoint);
      countBacks();
      uint32_t hidden = 0;
      for (const uint32_t back : backs) hidden += 2 * back > kRaysPerPoint;
      share[side] = 1.0f - float(hidden) / float(kPoints);
    }
  });
  return share;
}

}  // namespace lightwell::transport
