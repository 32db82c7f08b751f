// Finds materials that would reflect all light, for which no bounce series ends.
#pragma once
#include "precompute/core/diagnostics.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {

/// Warns about every material whose albedo (factor × brightest texel × brightest vertex colour) reaches above the 0.999 at which
/// surfaceColor keeps it.
void reportHighAlbedo(const Scene& scene, Diagnostics& diagnostics);

}  // namespace lightwell::scene
