// Rooms in a row with a door between each two, for tests of portals.
#pragma once
#include "tests/support/scenes.h"

namespace lightwell::test {

struct DoorOptions {
  int doors = 1;
  bool leaves = true;
  uint32_t strips = 8;
  float thickness = 0.1f;  // of the leaves; 0: a double-sided quad
};

inline constexpr float kRoomLength = 3.5f, kWallThickness = 0.5f, kDoorWidth = 1.2f, kDoorHeight = 2.2f;

/// The room that a point is in, from −x to +x; doors belong to neither: −1.
inline int roomOf(const Vec3& p) {
  const float at = p.x / (kRoomLength + kWallThickness);
  const int room = int(std::floor(at));
  return p.x - float(room) * (kRoomLength + kWallThickness) <= kRoomLength ? room : -1;
}

/// Rooms of 3.5 × 3 × 4 along +x from x = 0, y from 0, z from −2 to 2. Portal i is the leaf between rooms i and i + 1, shut in the middle of a wall 0.5 thick, whose floor runs through under
/// it; it opens along +z.
inline scene::Scene roomsInARow(const DoorOptions& options = {}) {
  SceneBuilder builder;
  const uint32_t wall = builder.material(diffuse(0.6f)), paint = builder.material(diffuse(0.4f));
  scene::Material two_sided = diffuse(0.4f);
  two_sided.double_sided = true;
  const uint32_t sheet = builder.material(two_sided);
  const float height = 3, half = 2, door = kDoorWidth / 2, pitch = kRoomLength + kWallThickness;
  const float length = pitch * float(options.doors) + kRoomLength;
  uint32_t quads = 0;
  const auto quad = [&](const Vec3& origin, const Vec3& s, const Vec3& t, uint32_t material) {
    builder.quad(origin, s, t, material);
    ++quads;
  };
  const auto y = [](float v) { return Vec3(0, v, 0); };
  const auto x = [](float v) { return Vec3(v, 0, 0); };
  const auto z = [](float v) { return Vec3(0, 0, v); };
  quad({0, 0, -half}, y(height), z(2 * half), wall);
  quad({length, 0, -half}, z(2 * half), y(height), wall);
  for (int room = 0; room <= options.doors; ++room) {
    const float west = pitch * float(room);
    quad({west, 0, -half}, z(2 * half), x(kRoomLength), wall);
    quad({west, height, -half}, x(kRoomLength), z(2 * half), wall);
    quad({west, 0, -half}, x(kRoomLength), y(height), wall);
    quad({west, 0, half}, y(height), x(kRoomLength), wall);
  }
  std::vector<scene::Portal> portals;
  for (int i = 0; i < options.doors; ++i) {
    const float west = pitch * float(i) + kRoomLength, middle = west + kWallThickness / 2;
    for (const bool front : {true, false}) {
      const float at = front ? west : west + kWallThickness;
      const auto face = [&](float z0, float z1, float y0, float y1) {
        if (front) quad({at, y0, z0}, z(z1 - z0), y(y1 - y0), wall);
        else quad({at, y0, z0}, y(y1 - y0), z(z1 - z0), wall);
      };
      face(-half, -door, 0, height);
      face(door, half, 0, height);
      face(-door, door, kDoorHeight, height);
    }
    quad({west, 0, -door}, z(kDoorWidth), x(kWallThickness), wall);
    quad({west, 0, -door}, x(kWallThickness), y(kDoorHeight), wall);
    quad({west, 0, door}, y(kDoorHeight), x(kWallThickness), wall);
    quad({west, kDoorHeight, -door}, x(kWallThickness), z(kDoorWidth), wall);
    if (!options.leaves) continue;
    const uint32_t first = quads * 2;
    if (options.thickness > 0) {
      const float seam = 0.01f;  // let into the frame
      const Vec3 low(middle - options.thickness / 2, -seam, -door - seam), dx = x(options.thickness), dy = y(kDoorHeight + 2 * seam), dz = z(kDoorWidth + 2 * seam);
      quad(low, dz, dy, paint);
      quad(low + dx, dy, dz, paint);
      quad(low, dy, dx, paint);
      quad(low + dz, dx, dy, paint);
      quad(low + dy, dz, dx, paint);
      quad(low, dx, dz, paint);
    } else {
      quad({middle, 0, -door}, z(kDoorWidth), y(kDoorHeight), sheet);
    }
    scene::Portal portal{.name = "door " + std::to_string(i), .gltf_path = "nodes[0]", .first_triangle = first, .triangle_count = quads * 2 - first, .strips = options.strips};
    const float extent = options.thickness > 0 ? kDoorWidth + 0.02f : kDoorWidth;
    portal.axis = Vec3(0, 0, 1 / extent);
    portal.offset = 0.5f;
    portals.push_back(portal);
  }
  scene::Scene scene = builder.take();
  scene.portals = portals;
  return scene;
}

}  // namespace lightwell::test
