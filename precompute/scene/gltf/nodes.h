// The node hierarchy flattened: which mesh and which light stands where.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/gltf/document.h"
#include "precompute/scene/gltf/portal_marks.h"

namespace lightwell::scene::gltf {

/// A mesh or a light in the world. A mesh under EXT_mesh_gpu_instancing has one placement per instance.
struct Placement {
  size_t node;
  size_t target;          // index into meshes or into the lights of KHR_lights_punctual
  std::string path;       // "nodes[4]"
  std::string instance;   // "#2" for instance 2 of EXT_mesh_gpu_instancing, else empty
  std::string name;       // of the node
  Matrix world;
  bool posed = false;     // the node itself shapes its mesh: by a skin or its own morph target weights
  size_t portal = kNoPortal;  // index into Placements::portals: of the node or the one above it that is one
  static constexpr size_t kNoPortal = ~size_t(0);
};

struct Placements {
  std::vector<Placement> meshes, lights;
  std::vector<std::optional<Matrix>> node_world;  // of every node; nothing for nodes outside the scene
  std::vector<PortalMark> portals;                // a portal's meshes are consecutive
};

/// Walks the default scene (the first one when none is named; every root node, with a warning, when there is no scene at all). A node
/// reached twice (a cycle, or two parents), a matrix that is not affine and too many instances are InputErrors. `portals`: ImportOptions::portals.
Placements placeNodes(Document& document, std::span<const std::string> portals, Diagnostics& diagnostics);

/// The node's own transform: its matrix, or translation * rotation * scale.
Matrix localTransform(const JsonValue& node, Diagnostics& diagnostics);

}  // namespace lightwell::scene::gltf
