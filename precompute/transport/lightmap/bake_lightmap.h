// The stages of a light map of static lights, as pure functions from bytes to bytes.
//
//   first light(sides) ─▶ direct light(sides) ─┐
//   rows(patches) ─────────────────────────────┴▶ radiosity ─▶ gather(slots) ─▶ refine ─▶ gather(slots) ─▶ assemble
//
// Light of lamps and plain emitters is sampled, with more samples where shadows have their edges. Indirect light is gathered from every texel, first with few rays into a coarse
// solution of all bounces, then into what that has given: each gathering is an exact step. All of it is shared between texels as far as it is smooth.
#pragma once
#include <memory>

#include "precompute/core/bytes.h"
#include "precompute/transport/lightmap/direct_light.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

struct LightmapSettings {
  DirectOptions direct;
  PatchOptions patches{.coarsest = 4, .most = 8000};
  uint32_t cache_rays = 256;   // per patch
  uint32_t first_gather_rays = 32;  // per texel, even
  uint32_t gather_rays = 128;  // per texel, even; up to 16 times as many where it is bright
  bool directional = false;    // how light changes with the normal is wanted too
  uint64_t seed = 1;
};

/// Irradiance per slot of the atlas: means over its whole surface.
struct Lightmap {
  std::vector<Rgb> direct_rgb, indirect_rgb;
  std::vector<Vec3> direct_gradient, indirect_gradient;  // tilt.h; empty unless directional
};

/// The patches that the coarse solution lives on, and which parts of the surface are exposed.
Bytes makeLightmapPatchBytes(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const LightmapSettings& settings, int threads,
                             const CancelFlag* cancel);

class LightmapBaker {
 public:
  /// Everything given must outlive the baker; `lights` in internal units, `sky` may be null. `patches` is makeLightmapPatchBytes of the same arguments; throws
  /// std::runtime_error when it cannot be.
  LightmapBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const std::vector<scene::Light>& lights, const SkyLight* sky,
                const LightmapSettings& settings, ByteView patches);
  ~LightmapBaker();

  uint32_t sideCount() const;
  uint32_t patchCount() const;
  uint32_t slotCount() const;

  /// A few samples of the light of lamps and plain emitters on each of the sides [first, end).
  Bytes firstLight(uint32_t first, uint32_t end, const CancelFlag& cancel) const;
  /// Direct light on these sides, as exact as settings want. `first_light` of all sides, in range order.
  Bytes directLight(uint32_t first, uint32_t end, std::span<const ByteView> first_light, const CancelFlag& cancel) const;
  /// What the rays of patches [first, end) meet.
  Bytes rows(uint32_t first, uint32_t end) const;
  /// Radiosity of all sides. Inputs in range order.
  Bytes radiosity(std::span<const ByteView> direct, std::span<const ByteView> rows, const CancelFlag& cancel) const;
  /// Indirect light on the slots [first, end), from `radiosity`, with few rays.
  Bytes firstGather(uint32_t first, uint32_t end, ByteView radiosity, const CancelFlag& cancel) const;
  /// Radiosity of all sides, of fronts with the indirect light of firstGather, and how many rays each slot gets.
  Bytes refine(std::span<const ByteView> direct, ByteView radiosity, std::span<const ByteView> first_gathered, int threads, const CancelFlag& cancel) const;
  /// Indirect light on the slots [first, end), from `refine`.
  Bytes gather(uint32_t first, uint32_t end, ByteView refined, const CancelFlag& cancel) const;
  /// Path-traced light at the texels number [first, end) of those to measure at, several times, independently; they are chosen by what `refine` knows.
  Bytes references(uint32_t first, uint32_t end, ByteView refined, const CancelFlag& cancel) const;
  uint32_t referenceCount() const;
  /// The error of all light together. `references` of all of them, in range order; a few texels are traced again.
  PooledError measure(const Lightmap& map, ByteView refined, std::span<const ByteView> references, const CancelFlag& cancel) const;
  /// Inputs in range order. This and the stages before throw std::runtime_error for inputs that no stage wrote.
  Lightmap assemble(std::span<const ByteView> direct, std::span<const ByteView> gathered, int threads, const CancelFlag& cancel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell::transport
