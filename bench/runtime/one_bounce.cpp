#include "bench/runtime/one_bounce.h"

#include "format/decode/pixel.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"

namespace lightwell::bench {

OneBounce::OneBounce(const format::Reader& reader, const bake::ContainerScene& container, const trace::Tracer& tracer) : container_(container), tracer_(tracer) {
  const auto srgb = reader.read<uint8_t>("atlas", "albedo");
  albedo_.resize(srgb.size() / 3);
  for (size_t i = 0; i < srgb.size(); ++i) albedo_[i / 3][int(i % 3)] = format::decodeSrgb(srgb[i]);
}

std::vector<Rgb> OneBounce::irradiance(std::span<const uint32_t> slots, const scene::Light& light, uint32_t samples, uint64_t seed, int threads) const {
  const scene::Scene& scene = container_.scene;
  const atlas::Atlas& atlas = container_.atlas;
  std::vector<Rgb> result(slots.size());
  parallelFor(slots.size(), 16, threads, nullptr, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays(samples), shadows;
    std::vector<trace::Hit> hits(samples);
    std::vector<Rgb> carried;
    std::vector<float> passed;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t slot = slots[i];
      const Sampler sampler(seed, slot);
      for (uint32_t s = 0; s < samples; ++s) {
        const atlas::SurfacePoint at = atlas::sampleSlot(scene.mesh, atlas, atlas.slots[slot], sampler.get1D(s, 0), sampler.get2D(s, 1));
        Vec3 tangent, bitangent;
        orthonormalBasis(at.normal, tangent, bitangent);
        const Vec3 local = sampleCosineHemisphere(sampler.get2D(s, 2));
        rays[s] = {};
        rays[s].direction = (tangent * local.x + bitangent * local.y + at.normal * local.z).normalized();
        rays[s].origin = trace::Tracer::offsetOrigin(at.position, at.geometric_normal, rays[s].direction);
        rays[s].key = mixBits(combineKeys(seed, uint64_t(slot) * samples + s));
        if (rays[s].direction.dot(at.geometric_normal) <= 0) rays[s].t_max = 0;  // from below the surface
      }
      tracer_.closest(rays, hits);
      shadows.clear(), carried.clear();
      for (uint32_t s = 0; s < samples; ++s) {
        const trace::Hit& hit = hits[s];
        if (hit.triangle == kNone || (!hit.front && !scene.materials[scene.mesh.triangle_material[hit.triangle]].double_sided)) continue;
        const atlas::SurfacePoint at = atlas::surfacePoint(scene.mesh, hit.triangle, hit.u, hit.v);
        Vec3 to_light;
        float distance = 0;
        const Rgb direct = scene::lightIrradiance(light, at.position, hit.geometric_normal, to_light, distance);
        if (!(maxComponent(direct) > 0)) continue;
        const uint32_t own = atlas.slotAt(scene.mesh, hit.triangle, hit.u, hit.v);
        trace::Ray ray;
        ray.origin = trace::Tracer::offsetOrigin(at.position, hit.geometric_normal, to_light);
        ray.direction = to_light;
        ray.t_max = distance;
        shadows.push_back(ray);
        carried.push_back(direct * albedo_[atlas.slots[own].texel]);
      }
      passed.resize(shadows.size());
      tracer_.transmittance(shadows, passed);
      Vec3d sum(0.0);
      for (size_t k = 0; k < passed.size(); ++k) sum += Vec3d(carried[k]) * double(passed[k]);
      result[i] = Rgb(sum / double(samples));
    }
  });
  return result;
}

}  // namespace lightwell::bench
