#include "precompute/transport/lightmap/gather.h"

#include "precompute/transport/lightmap/direct_light.h"
#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kGatherStream = 8ull << 40;
constexpr uint32_t kSlotsBetweenChecks = 64;
constexpr float kNear = 2;  // texels' widths

/// The place under a hit, on the side that the ray came from.
DirectSampler::Receiver receiverAt(const scene::Mesh& mesh, const trace::Ray& ray, const trace::Hit& hit, const Sampler& sampler, uint32_t sample) {
  const auto& corner = mesh.triangles[hit.triangle];
  Vec3 normal = mesh.normals[corner[0]] * (1.0f - hit.u - hit.v) + mesh.normals[corner[1]] * hit.u + mesh.normals[corner[2]] * hit.v;
  if (!hit.front) normal = -normal;
  const float length = normal.length();
  return {ray.origin + ray.direction * hit.t, length > 0.0f ? normal / length : hit.geometric_normal, hit.geometric_normal, sampler, sample};
}

}  // namespace

GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const GatherSource& source,
                         const GatherOptions& options, uint32_t first, uint32_t end, const CancelFlag* cancel) {
  GatheredPair pair;
  std::vector<trace::Hit> hits;
  std::vector<DirectSampler::Receiver> near;
  std::vector<std::pair<uint32_t, Vec3>> near_side;  // and the ray's direction
  Vec3d sum(0.0), gradient(0.0);
  const auto gather = [&](uint32_t slot, uint32_t half, uint32_t rays) {
    const uint64_t stream = kGatherStream + 4ull * slot + 2 * options.round + half;
    const auto list = cosineRays(scene.mesh, atlas, sides, std::span(&slot, 1), rays, options.seed, stream);
    hits.resize(list.size());
    tracer.closest(list, hits);
    sum = Vec3d(0.0);
    near.clear(), near_side.clear();
    const auto add = [&](const Vec3& direction, const Rgb& radiosity_rgb) {
      sum += Vec3d(radiosity_rgb);
      if (options.tilt) gradient += Vec3d(options.tilt->gradient(atlas.slots[slot].normal, direction)) * double(luminance(radiosity_rgb));
    };
    for (size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hits[i].triangle, hits[i].u, hits[i].v), hits[i].front);
      if (side == kNone) continue;
      const uint32_t met = sides.slot[side];
      const auto look_up = source.direct ? LookUp(source.uneven[met]) : LookUp::of_texel;
      if (look_up == LookUp::at_point || (look_up == LookUp::by_distance && hits[i].t * hits[i].t < kNear * kNear * atlas.slots[met].area)) {
        near.push_back(receiverAt(scene.mesh, list[i], hits[i], Sampler(options.seed, combineKeys(stream, 1)), uint32_t(i)));
        near_side.emplace_back(side, list[i].direction);
      } else {
        add(list[i].direction, source.radiosity_rgb[side]);
      }
    }
    if (!near.empty()) {
      const auto irradiance_rgb = source.direct->irradiance(near);
      for (size_t i = 0; i < near.size(); ++i) {
        const auto& [side, direction] = near_side[i];
        const Rgb rest_rgb = source.radiosity_rgb[side] - source.direct_radiosity_rgb[side];
        add(direction, atlas.slots[sides.slot[side]].albedo_rgb * irradiance_rgb[i] + Rgb(std::max(0.0f, rest_rgb.x), std::max(0.0f, rest_rgb.y), std::max(0.0f, rest_rgb.z)));
      }
    }
    return Rgb(sum / double(rays));
  };
  for (uint32_t slot = first; slot < end; ++slot) {
    if (cancel && slot % kSlotsBetweenChecks == 0) cancel->check();
    const uint32_t rays = options.rays[slot - first];
    gradient = Vec3d(0.0);
    pair.a_rgb.push_back(gather(slot, 0, rays / 2));
    pair.b_rgb.push_back(gather(slot, 1, rays / 2));
    if (options.tilt) pair.gradient.push_back(Vec3(gradient / double(rays)));
  }
  return pair;
}

}  // namespace lightwell::transport
