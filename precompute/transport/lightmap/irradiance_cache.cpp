#include "precompute/transport/lightmap/irradiance_cache.h"

#include <algorithm>

#include "precompute/transport/fixed_point.h"
#include "precompute/transport/radiosity/texel_weights.h"
#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kCacheStream = 7ull << 40;
constexpr double kTolerance = 1e-4;
constexpr uint32_t kMostSweeps = 500;

}  // namespace

CacheRows cacheRows(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches, uint32_t rays,
                    uint64_t seed, uint32_t begin, uint32_t end) {
  CacheRows rows;
  std::vector<trace::Hit> hits;
  std::vector<uint32_t> met;
  for (uint32_t patch = begin; patch < end; ++patch) {
    const auto list = cosineRays(scene.mesh, atlas, sides, patches.sidesOf(patch), rays, seed, kCacheStream + patch);
    hits.resize(list.size());
    tracer.closest(list, hits);
    met.clear();
    for (const auto& hit : hits) {
      if (hit.triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hit.triangle, hit.u, hit.v), hit.front);
      if (side != kNone && patches.patch_of_side[side] != kNone) met.push_back(patches.patch_of_side[side]);
    }
    std::sort(met.begin(), met.end());
    for (const uint32_t other : met) {
      if (rows.patch.size() == rows.first.back() || rows.patch.back() != other) {
        rows.patch.push_back(other);
        rows.count.push_back(0);
      }
      ++rows.count.back();
    }
    rows.first.push_back(uint32_t(rows.patch.size()));
  }
  return rows;
}

std::vector<Rgb> sideRadiosity(const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                               std::span<const CacheRows> rows, uint32_t rays, std::span<const float> exposed, std::span<const Rgb> direct_rgb,
                               const CancelFlag* cancel) {
  const uint32_t count = patches.count();
  // Of the exposed surface, where rays from elsewhere end. Rays that start at hidden points meet nothing that counts.
  std::vector<Rgb> patch_direct_rgb(count, Rgb(0.0f)), patch_irradiance_rgb(count, Rgb(0.0f));
  const auto exposedDirect = [&](uint32_t side) { return exposed[side] > 0 ? direct_rgb[side] / exposed[side] : Rgb(0.0f); };
  for (uint32_t patch = 0; patch < count; ++patch) {
    double area = 0;
    Vec3d sum(0.0);
    for (const uint32_t side : patches.sidesOf(patch)) {
      const double weight = std::max(1e-30, double(atlas.slots[sides.slot[side]].area) * exposed[side]);
      sum += Vec3d(exposedDirect(side)) * weight;
      area += weight;
    }
    patch_direct_rgb[patch] = Rgb(sum / area);
  }
  for (int c = 0; c < 3; ++c) {
    const auto sweep = [&](const Eigen::VectorXd& irradiance) {
      if (cancel) cancel->check();
      Eigen::VectorXd radiosity(count), next(count);
      for (uint32_t patch = 0; patch < count; ++patch)
        radiosity[patch] = patches.albedo_rgb[patch][c] * (double(patch_direct_rgb[patch][c]) + irradiance[patch]);
      uint32_t patch = 0;
      for (const CacheRows& part : rows)
        for (size_t row = 0; row + 1 < part.first.size(); ++row, ++patch) {
          double sum = 0;
          for (uint32_t i = part.first[row]; i < part.first[row + 1]; ++i) sum += part.count[i] * radiosity[part.patch[i]];
          next[patch] = sum / (double(rays) * patches.exposed_share[patch]);
        }
      return next;
    };
    const FixedPoint solution = solveFixedPoint(count, sweep, kTolerance, kMostSweeps);
    for (uint32_t patch = 0; patch < count; ++patch) patch_irradiance_rgb[patch][c] = std::max(0.0f, float(solution.x[patch]));
  }
  std::vector<Rgb> radiosity_rgb(sides.slot.size(), Rgb(0.0f));
  for (uint32_t side = sides.front_count; side < sides.slot.size(); ++side)
    if (const uint32_t patch = patches.patch_of_side[side]; patch != kNone)
      radiosity_rgb[side] = atlas.slots[sides.slot[side]].albedo_rgb * (exposedDirect(side) + patch_irradiance_rgb[patch]);
  const TexelWeights weights = makeTexelWeights(atlas, tracer, sides, patches, makePatchTree(patches), 1, cancel);
  for (size_t i = 0; i < weights.slot.size(); ++i) {
    Rgb irradiance_rgb(0.0f);
    for (size_t k = 0; k < 4; ++k)
      if (weights.patch[i][k] != kNone) irradiance_rgb += patch_irradiance_rgb[weights.patch[i][k]] * weights.weight[i][k];
    const uint32_t slot = weights.slot[i];
    radiosity_rgb[slot] = atlas.slots[slot].albedo_rgb * (exposedDirect(slot) + irradiance_rgb);
  }
  return radiosity_rgb;
}

}  // namespace lightwell::transport
