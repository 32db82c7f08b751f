#include "precompute/scene/gltf/triangulate.h"

namespace lightwell::scene::gltf {

std::vector<std::array<uint32_t, 3>> triangulate(std::span<const uint32_t> indices, TopologyMode mode) {
  std::vector<std::array<uint32_t, 3>> triangles;
  if (mode == TopologyMode::triangles) {
    triangles.reserve(indices.size() / 3);
    for (size_t i = 0; i + 2 < indices.size(); i += 3) triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else if (mode == TopologyMode::triangle_strip) {
    for (size_t i = 0; i + 2 < indices.size(); ++i)
      triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
  } else {
    for (size_t i = 0; i + 2 < indices.size(); ++i) triangles.push_back({indices[i + 1], indices[i + 2], indices[0]});
  }
  return triangles;
}

}  // namespace lightwell::scene::gltf
