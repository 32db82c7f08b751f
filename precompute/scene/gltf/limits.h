// What an input may claim at most. Generous for real scenes, small enough that no file exhausts the machine.
#pragma once
#include <cstdint>

namespace lightwell::scene::gltf {

inline constexpr uint64_t kMaxFileBytes = 4ull << 30;   // a .glb cannot be longer
inline constexpr uint64_t kMaxJsonBytes = 256ull << 20;
inline constexpr uint64_t kMaxVertices = 64ull << 20;   // of all instances together
inline constexpr uint64_t kMaxTriangles = 64ull << 20;  // likewise
inline constexpr uint64_t kMaxInstances = 1ull << 20;   // primitives of nodes, instances of EXT_mesh_gpu_instancing counted
inline constexpr uint64_t kMaxUnbackedElements = 4ull << 20;  // of an accessor without data of its own
inline constexpr uint64_t kMaxTexturePixels = 256ull << 20;  // of all textures together
inline constexpr int kMaxTextureSide = 16384;
inline constexpr double kMinExtentM = 1e-9, kMaxExtentM = 1e12;  // of the scene, metres
inline constexpr double kMaxCoordinateM = 1e15;

}  // namespace lightwell::scene::gltf
