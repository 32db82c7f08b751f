// Direct irradiance at entry points, as a game computes it each frame; here with ray-traced shadows.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// The shadow ray of entry `i` towards a light in this direction (unit) and at this distance.
inline trace::Ray shadowRay(const PrmEntries& entries, uint32_t i, const Vec3& to_light, float distance) {
  return {.origin = trace::Tracer::offsetOrigin(entries.position[i], entries.normal[i], to_light), .direction = to_light, .t_max = distance * (1.0f - 1e-4f), .key = i};
}

/// Shadowed irradiance of one light, averaged over each cluster's entry points: one value per cluster. A light within a few lengths of an entry's rectangle
/// is averaged over it: its flux there is its intensity times the solid angle that the rectangle fills (rectangleGain), so that rectangles side by side receive what
/// the surface does, however close the light.
std::vector<Rgb> clusterIrradiance(const PrmEntries& entries, const trace::Tracer& tracer, const scene::Light& light);

/// What the mean over a rectangle is of the value at its middle, for the irradiance of a light at `to_light` from the middle (any unit of length):
/// (solid angle / area) / (cos / distance²). 1 from afar. `half_u`, `half_v`: half the sides.
float rectangleGain(const Vec3& to_light, const Vec3& normal, const Vec3& half_u, const Vec3& half_v);

}  // namespace lightwell::transport
