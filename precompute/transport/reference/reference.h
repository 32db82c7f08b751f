// The truth that everything else is measured with: unbiased path-traced irradiance per texel.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::transport {

enum class Component { direct, indirect, total };

class SkyLight;

struct ReferenceOptions {
  uint32_t samples = 256;  // per texel
  uint64_t seed = 1;
  int threads = 0;
  uint32_t most_bounces = kNone;  // light that was reflected more often is left out
  const SkyLight* sky = nullptr;  // what rays that leave the scene meet; null: darkness
  const CancelFlag* cancel = nullptr;
  std::function<void(double fraction)> progress;  // may be empty; called from any thread
};

/// Irradiance per slot and its standard error (of the mean; per channel; infinite for a single sample), both in the order of Atlas::slots.
struct IrradianceMap {
  std::vector<Rgb> irradiance_rgb, standard_error_rgb;
};

/// Path tracing from points spread over each texel's surface: next-event estimation to punctual lights and to emissive triangles (chosen by
/// power, distance and orientation) and to the sky (by luminance), MIS with the balance heuristic against cosine sampling, Russian roulette by throughput, no clamping:
/// unbiased.
/// Of surfaces that coincide a ray meets one: emitters that lie on each other shine once, and never on themselves.
/// Throws UsageError without samples, Cancelled when options.cancel was set. `lights` in internal units.
/// Direct: straight from a light, an emitter or the sky. Indirect: after at least one reflection.
/// Irradiance is about the interpolated normal; light from below the geometric surface is not received.
IrradianceMap referenceIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer,
                                  const std::vector<scene::Light>& lights, Component component, const ReferenceOptions& options);

/// One contiguous range [first_slot, end_slot) of the same computation; the whole map is the concatenation of its ranges, bit for bit.
IrradianceMap referenceIrradianceRange(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer,
                                       const std::vector<scene::Light>& lights, Component component, const ReferenceOptions& options,
                                       size_t first_slot, size_t end_slot);

/// The same computation for the given slots only: one value each, in their order, equal to those of the whole map bit for bit.
IrradianceMap referenceIrradianceOf(std::span<const uint32_t> slots, const scene::Scene& scene, const atlas::Atlas& atlas,
                                    const trace::Tracer& tracer, const std::vector<scene::Light>& lights, Component component,
                                    const ReferenceOptions& options);

}  // namespace lightwell::transport
