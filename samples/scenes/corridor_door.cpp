// Two rooms on one corridor. The door between the warm room and the corridor is shut; it is a node of its own, a portal that slides into the wall.
#include "samples/scenes/cell_building.h"
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeCorridorDoor() {
  SampleScene scene;
  scene.name = "corridor_door";
  const uint32_t plaster = scene.addMaterial("plaster", {0.72f, 0.71f, 0.68f});
  const uint32_t ochre = scene.addMaterial("ochre_wall", {0.74f, 0.47f, 0.2f});
  const uint32_t blue = scene.addMaterial("blue_wall", {0.2f, 0.35f, 0.6f});
  const uint32_t boards = scene.addMaterial("boards", {0.36f, 0.22f, 0.12f});
  const uint32_t slate = scene.addMaterial("slate", {0.22f, 0.23f, 0.25f});
  const uint32_t door_paint = scene.addMaterial("door_paint", {0.55f, 0.08f, 0.06f});

  // Two rooms (4 m × 4 m) west and east of a corridor 1.6 m wide and 8 m long; walls are 0.2 m thick.
  const float room_west = -5, corridor_west = -0.8f, corridor_east = 0.8f, room_east = 5, wall = 0.2f;
  const float door_from = -1.5f, door_to = -0.5f, arch_from = 1.0f, arch_to = 2.4f, lintel = 2.1f;
  CellGrid grid(gridLines({room_west, corridor_west - wall, corridor_west, corridor_east, corridor_east + wall, room_east}),
                gridLines({-4, -3, door_from, door_to, 1, arch_from, arch_to, 3, 4}));
  const auto space = [](float height, uint32_t floor, uint32_t ceiling, uint32_t walls) {
    return [=](Cell& c) {
      c.ceiling_m = height;
      c.floor_material = floor;
      c.ceiling_material = ceiling;
      c.wall_material = c.riser_material = c.lintel_material = walls;
    };
  };
  grid.edit(corridor_west, corridor_east, -4, 4, space(2.6f, slate, plaster, plaster));
  grid.edit(room_west, corridor_west - wall, -3, 1, space(2.8f, boards, plaster, ochre));
  grid.edit(corridor_east + wall, room_east, -1.5f, 3, space(2.8f, boards, plaster, blue));
  grid.edit(corridor_west - wall, corridor_west, door_from, door_to, space(lintel, boards, plaster, plaster));
  grid.edit(corridor_east, corridor_east + wall, arch_from, arch_to, space(2.3f, slate, plaster, plaster));
  Node& building = scene.nodes.emplace_back();
  building.name = "building";
  grid.build(building);

  // The leaf stands in the middle of the wall, let into its frame by 1 cm all around.
  Node& door = scene.nodes.emplace_back();
  door.name = "door";
  door.portal = true;
  door.translation_m = {corridor_west - wall / 2, 0, (door_from + door_to) / 2};
  const float seam = 0.01f;
  addBox(door, door_paint, {0, lintel / 2, 0}, {0.05f, lintel + 2 * seam, door_to - door_from + 2 * seam}, 0, true);

  Node& table = scene.nodes.emplace_back();
  table.name = "table";
  addBox(table, boards, {3.2f, 0.72f, 0.4f}, {1.5f, 0.06f, 0.8f}, 0, true);
  for (const float x : {2.55f, 3.85f})
    for (const float z : {0.1f, 0.7f}) addBox(table, boards, {x, 0.345f, z}, {0.07f, 0.69f, 0.07f}, 0, false);
  Node& chest = scene.nodes.emplace_back();
  chest.name = "chest";
  addOpenBox(chest, blue, {-4.6f, 0, -2.7f}, {-3.4f, 0.6f, -2.0f});

  scene.lamps.push_back({.name = "ceiling_lamp", .position_m = {-3, 2.2f, -1}, .color_rgb = {1, 0.82f, 0.6f}, .intensity = 60});
  scene.lamps.push_back({.name = "desk_spot", .type = LampType::spot, .position_m = {3.2f, 2.4f, 0.4f}, .direction = {0, -1, 0},
                         .color_rgb = {0.8f, 0.9f, 1}, .intensity = 80, .inner_cone_angle = 0.3f, .outer_cone_angle = 0.6f});
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 256, 2);
  return scene;
}

}  // namespace lightwell::samples
