// A container back as a scene to trace rays in: what visibility and direct light on the CPU need is all in the file.
#pragma once
#include "format/encode/reader.h"
#include "precompute/atlas/atlas.h"
#include "precompute/core/diagnostics.h"
#include "precompute/scene/scene.h"

namespace lightwell::bake {

struct ContainerScene {
  scene::Scene scene;   // geometry, alpha and the scene's own lights. Surfaces are black and emit nothing: that is in the other sections
  atlas::Atlas atlas;   // re-clipped from the stored coordinates, with the stored source map
};

/// Throws format::ContainerError when the container is damaged or has no geometry.
ContainerScene loadContainerScene(const format::Reader& reader, Diagnostics& diagnostics);

}  // namespace lightwell::bake
