// What of a scene a computation reads, as hashes: change a colour, and only what looks at colours is another computation.
#pragma once
#include "precompute/bake/key.h"
#include "precompute/plan/settings.h"
#include "precompute/scene/scene.h"

namespace lightwell::bake {

/// Each of the first three holds all that the layout of the atlas and the tracer depend on.
struct SceneKeys {
  Key geometry;    // surfaces as rays meet them: places, normals, sides, cut-outs, light-map coordinates; and what shapes the atlas
  Key reflection;  // geometry and what it reflects: colours, with their textures
  Key emission;    // geometry and what it emits
  Key surfaces;    // everything about surfaces
  Key lights;      // punctual lights and the scene's place in the world
  Key portals;     // which surfaces are portals, and how they open; all zero without portals
};

/// Of a scene as it was imported, before buildAtlas.
SceneKeys sceneKeys(const scene::Scene& scene, const plan::Settings& settings);

/// What the charts of objects depend on: the triangles' corners, wherever they are in the mesh.
Key chartKey(const scene::Scene& scene, std::span<const size_t> objects);

}  // namespace lightwell::bake
