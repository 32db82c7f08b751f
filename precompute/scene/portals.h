// Portals of a scene whose mesh is complete: where they open first and last.
#pragma once
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/gltf/nodes.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {

/// Adds a portal for each mark. `first_triangle[i]` and `end_triangle[i]`: what its nodes show, consecutive; marks without surfaces are left out with a warning.
/// Without a direction it opens along the widest horizontal extent of its surface (the principal axis), from the low to the high end of the world axis that is nearest.
void addPortals(Scene& scene, const std::vector<gltf::PortalMark>& marks, const std::vector<uint32_t>& first_triangle, const std::vector<uint32_t>& end_triangle,
                Diagnostics& diagnostics);

}  // namespace lightwell::scene
