// A courtyard open to the sky, with a colonnade on all four sides and a fountain. It has no TEXCOORD_1, so that a bake unwraps it.
#include "samples/scenes/cell_building.h"
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeColonnadeCourtyard() {
  SampleScene scene;
  scene.name = "colonnade_courtyard";
  const uint32_t limestone = scene.addMaterial("limestone", {0.72f, 0.66f, 0.54f});
  const uint32_t terracotta = scene.addMaterial("terracotta", {0.62f, 0.26f, 0.14f});
  const uint32_t ochre = scene.addMaterial("ochre_wall", {0.70f, 0.45f, 0.22f});
  const uint32_t grass = scene.addMaterial("grass", {0.11f, 0.26f, 0.06f});
  const uint32_t timber = scene.addMaterial("timber", {0.30f, 0.18f, 0.10f});
  const uint32_t basin_stone = scene.addMaterial("basin_stone", {0.55f, 0.57f, 0.60f});

  // From the middle outward: a lawn of 6.5 m, paving, the row of columns, a walk 2.2 m deep, the walls.
  const float lawn = 3.25f, row_inner = 5.75f, row_outer = 6.25f, walls = 8.5f, soffit = 3.4f, parapet = 4.4f, step = 0.15f, plinth = 0.3f;
  const int columns_per_side = 5;
  std::vector<float> lines{-walls, -row_outer, -row_inner, -lawn, lawn, row_inner, row_outer, walls};
  std::vector<float> axes;
  for (int k = 0; k < columns_per_side; ++k) axes.push_back(-6.0f + 12.0f * float(k) / float(columns_per_side - 1));
  for (const float axis : axes) {
    lines.push_back(axis - 0.25f);
    lines.push_back(axis + 0.25f);
  }
  CellGrid grid(gridLines(lines), gridLines(lines));
  grid.edit(-walls, walls, -walls, walls, [&](Cell& c) {
    c = {.floor_m = step, .ceiling_m = soffit + 0.25f, .floor_material = terracotta, .ceiling_material = timber, .wall_material = ochre,
         .riser_material = limestone, .lintel_material = limestone};
  });
  // The architrave on the columns is lower than the walk's timber ceiling.
  grid.edit(-row_outer, row_outer, -row_outer, row_outer, [&](Cell& c) {
    c.ceiling_m = soffit;
    c.floor_material = c.ceiling_material = limestone;
  });
  grid.edit(-row_inner, row_inner, -row_inner, row_inner, [&](Cell& c) {
    c = {.floor_m = 0, .ceiling_m = parapet, .floor_material = limestone, .wall_material = limestone, .open_sky = true};
  });
  grid.edit(-lawn, lawn, -lawn, lawn, [&](Cell& c) { c.floor_material = grass; });

  Node& building = scene.nodes.emplace_back();
  building.name = "courtyard";
  for (const float x : axes)
    for (const float z : axes) {
      if (std::abs(x) < 5.9f && std::abs(z) < 5.9f) continue;
      grid.edit(x - 0.25f, x + 0.25f, z - 0.25f, z + 0.25f, [&](Cell& c) {
        c.floor_m = plinth;
        c.makes_floor = c.makes_ceiling = false;
      });
      addColumn(building, limestone, limestone,
                {.plinth_top = {x, plinth, z}, .soffit_m = soffit, .half_width_m = 0.25f, .radius_m = 0.185f});
    }
  grid.build(building);
  stitch(building);

  // Walls and roof have a thickness, so that nothing depends on how exactly a viewer's shadow map ends at their edges.
  Node& outside = scene.nodes.emplace_back();
  outside.name = "outside";
  const float outer = walls + 0.35f, eaves = outer + 0.3f, roof_inner = row_inner + 0.25f, roof_bottom = soffit + 0.5f;
  const Vec3 corners[] = {{-outer, 0, outer}, {outer, 0, outer}, {outer, 0, -outer}, {-outer, 0, -outer}, {-outer, 0, outer}};
  const Vec3 up(0, roof_bottom, 0);
  for (int side = 0; side < 4; ++side)
    addQuad(outside, ochre, corners[side], corners[side + 1], corners[side + 1] + up, corners[side] + up);
  const float middle = (roof_inner + eaves) / 2, depth = eaves - roof_inner, roof_y = (roof_bottom + parapet) / 2;
  for (const float side : {-1.0f, 1.0f}) {
    addBox(outside, terracotta, {0, roof_y, side * middle}, {2 * eaves, parapet - roof_bottom, depth}, 0, true);
    addBox(outside, terracotta, {side * middle, roof_y, 0}, {depth, parapet - roof_bottom, 2 * (roof_inner - 0.01f)}, 0, true);
  }
  stitch(outside);

  Node& fountain = scene.nodes.emplace_back();
  fountain.name = "fountain";
  // The basin's outside, rim, inside and bottom meet at sharp edges; a stem carries a bowl.
  const ProfilePoint basin[] = {{1.35f, 0}, {1.35f, 0.5f}, {1.15f, 0.5f}, {1.15f, 0.2f}, {0.3f, 0.2f}};
  for (size_t edge = 0; edge + 1 < std::size(basin); ++edge)
    addLathe(fountain, basin_stone, {0, 0, 0}, std::span(basin).subspan(edge, 2), 16);
  const ProfilePoint stem[] = {{0.3f, 0.2f}, {0.16f, 0.4f}, {0.12f, 0.8f}, {0.2f, 1.1f}, {0.7f, 1.35f}};
  const ProfilePoint bowl[] = {{0.7f, 1.35f}, {0.62f, 1.35f}, {0.3f, 1.2f}, {0, 1.16f}};
  addLathe(fountain, limestone, {0, 0, 0}, stem, 16);
  addLathe(fountain, limestone, {0, 0, 0}, bowl, 16);
  stitch(fountain);

  scene.lamps.push_back({.name = "sun", .type = LampType::directional, .direction = {0.55f, -1.0f, -0.35f},
                         .color_rgb = {1, 0.93f, 0.82f}, .intensity = 1000});
  scene.lamps.push_back({.name = "walk_lantern", .position_m = {-7.3f, 2.4f, 0}, .color_rgb = {1, 0.7f, 0.4f}, .intensity = 150});
  return scene;
}

}  // namespace lightwell::samples
