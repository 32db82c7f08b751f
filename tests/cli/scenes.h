// Small glTF scenes as text, with their data inside.
#pragma once
#include <string>

namespace lightwell::test {

struct RoomOptions {
  double albedo = 0.5;
  double emission = 0;         // radiance of every wall
  double lamp_candela = 0;     // a point light in the middle; 0: none
  bool surfaces = true;
  bool open = false;           // without its ceiling
  bool boxes = false;          // two cubes of 0.4 m and 300 triangles each on the floor, without light-map coordinates
  bool shutter = false;        // a double-sided sheet across the room at x = 0.5, a node of its own
  bool shutter_marked = true;  // as a portal, by its extras
  double box_x = -0.5;         // where the first one stands
  double box_albedo = 0.5;     // of the first one
  double box_emission = 0;     // radiance of the second one
};

/// A closed cube of 2 m around the origin, its fronts inward, with light-map coordinates (one chart per wall).
/// In an atlas of 24 texels, or a multiple, charts end at texel borders: every covered texel has the same area.
std::string roomGltf(const RoomOptions& options);

}  // namespace lightwell::test
