#include "precompute/transport/radiosity/sealed_rooms.h"

#include <algorithm>
#include <numeric>

#include "precompute/transport/sphere_rays.h"

namespace lightwell::transport {
namespace {

constexpr double kMostArea = 0.01;   // of a sealed room, as a share of the scene's
constexpr uint32_t kLampRays = 256;  // by which the room of a lamp is found
constexpr uint64_t kLampStream = 9ull << 40;

/// Sets of patches, joined link by link.
class Rooms {
 public:
  explicit Rooms(uint32_t patches) : parent_(patches) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t of(uint32_t patch) {
    while (parent_[patch] != patch) patch = parent_[patch] = parent_[parent_[patch]];
    return patch;
  }
  void join(uint32_t a, uint32_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace

uint32_t emptySealedRooms(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                          const PatchTree& tree, uint64_t seed, LinkValues& links) {
  const uint32_t count = patches.count();
  const bool emits = std::any_of(patches.emitted_radiance_rgb.begin(), patches.emitted_radiance_rgb.end(), [](const Rgb& e) { return maxComponent(e) > 0; });
  if (scene.lights.empty() && !emits) return 0;
  Rooms rooms(count);
  for (uint32_t row = 0; row < count; ++row)
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l)
      for (uint32_t patch = tree.first_patch[links.node[l]]; patch < tree.end_patch[links.node[l]]; ++patch) rooms.join(row, patch);

  std::vector<double> area(count, 0.0);
  std::vector<char> lit(count, 0);
  double total = 0;
  for (uint32_t patch = 0; patch < count; ++patch) {
    area[rooms.of(patch)] += patches.area[patch];
    total += patches.area[patch];
    if (maxComponent(patches.emitted_radiance_rgb[patch]) > 0) lit[rooms.of(patch)] = 1;
  }
  // A directional light is outside of everything that is sealed.
  std::vector<trace::Hit> hits(kLampRays);
  for (uint32_t i = 0; i < scene.lights.size(); ++i) {
    if (scene.lights[i].type == scene::LightType::directional) continue;
    tracer.closest(sphereRays(scene.lights[i].position, kLampRays, seed, kLampStream + i), hits);
    for (const auto& hit : hits) {
      if (hit.triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hit.triangle, hit.u, hit.v), hit.front);
      if (side != kNone && patches.patch_of_side[side] != kNone) lit[rooms.of(patches.patch_of_side[side])] = 1;
    }
  }

  LinkValues kept;
  kept.sets = std::move(links.sets);
  uint32_t emptied = 0;
  for (uint32_t row = 0; row < count; ++row) {
    const uint32_t begin = links.first[row], end = links.first[row + 1], room = rooms.of(row);
    if (lit[room] || area[room] >= kMostArea * total) {
      kept.node.insert(kept.node.end(), links.node.begin() + begin, links.node.begin() + end);
      kept.value.insert(kept.value.end(), links.value.begin() + begin, links.value.begin() + end);
      if (!links.set.empty()) kept.set.insert(kept.set.end(), links.set.begin() + begin, links.set.begin() + end);
    } else {
      emptied += end > begin;
    }
    kept.first.push_back(uint32_t(kept.node.size()));
  }
  links = std::move(kept);
  return emptied;
}

}  // namespace lightwell::transport
