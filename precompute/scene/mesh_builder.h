// Appends primitives, transformed into the internal frame, to the one mesh of a scene.
#pragma once
#include <cstddef>
#include <string>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/gltf/nodes.h"
#include "precompute/scene/gltf/primitive.h"
#include "precompute/scene/normalization.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {

class MeshBuilder {
 public:
  MeshBuilder(Scene& scene, const Frame& frame) : scene_(scene), frame_(frame) {}

  /// Adds one instance of a primitive as an object. Mirroring transforms have their winding undone, normals follow the inverse
  /// transpose, missing ones are the faces', degenerate triangles and vertices that no triangle uses are dropped.
  void add(const gltf::Primitive& primitive, const gltf::Matrix& world, uint32_t material, std::string path, std::string name);

  /// Reports what was repaired, counted over the whole scene.
  void report(Diagnostics& diagnostics) const;

 private:
  Scene& scene_;
  Frame frame_;
  size_t degenerate_ = 0, flipped_ = 0, replaced_ = 0;
  std::string first_degenerate_, first_flipped_, first_replaced_;
};

}  // namespace lightwell::scene
