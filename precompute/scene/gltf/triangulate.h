// Triangle lists, strips and fans to triangles.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lightwell::scene::gltf {

/// The modes of a glTF primitive that are surfaces, by their numbers.
enum class TopologyMode { triangles = 4, triangle_strip = 5, triangle_fan = 6 };

/// The triangles of glTF 2.0, section 3.7.2.1; all wound alike. Incomplete ones at the end are left out.
std::vector<std::array<uint32_t, 3>> triangulate(std::span<const uint32_t> indices, TopologyMode mode);

}  // namespace lightwell::scene::gltf
