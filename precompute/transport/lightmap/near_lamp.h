// A lamp so near to a texel that points of the texel may all miss the spot it lights.
#pragma once
#include "precompute/atlas/atlas.h"
#include "precompute/transport/reference/punctual.h"

namespace lightwell::transport {

struct NearLamp {
  uint32_t light = kNone;          // index into the lights; kNone: no lamp is near
  Vec3d irradiance_rgb{0, 0, 0};   // mean over the texel, as if nothing were in the way: exact about the geometric normals
  bool spot = false;               // what it lights is smaller than the texel: one value for all of it has to do
};

/// The nearest to the texel of those point lights without a range that are always looked at (PunctualLights), if it is within three times the texel's radius. Its light on a triangle is its
/// intensity times the solid angle under which it sees that (Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle", 1983). `back`: of the back of the surface.
NearLamp nearLamp(const scene::Mesh& mesh, const atlas::Atlas& atlas, const PunctualLights& lamps, const atlas::Slot& slot, bool back);

}  // namespace lightwell::transport
