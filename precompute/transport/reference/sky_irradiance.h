// Irradiance straight from the sky: what the constant panes of a sky are made of.
#pragma once
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/environment/sky_light.h"

namespace lightwell::transport {

/// What all receivers share; outlives the calls. `sky` is not black.
struct SkyScene {
  const scene::Mesh& mesh;
  const atlas::Atlas& atlas;
  const trace::Tracer& tracer;
  const SkyLight& sky;
  uint32_t samples;  // of the sky and of the cosine lobe each, per receiver
  uint64_t seed;
};

/// Unbiased means over the front surface of the slots [first, end): light and cosine samples with the balance heuristic (Veach 1997,
/// section 9.2.2).
std::vector<Rgb> skyOnSlots(const SkyScene& scene, size_t first, size_t end);

/// The same at points on surfaces, about unit normals on the sides that receive.
std::vector<Rgb> skyAtPoints(const SkyScene& scene, std::span<const Vec3> position, std::span<const Vec3> normal, int threads,
                             const CancelFlag* cancel);

}  // namespace lightwell::transport
