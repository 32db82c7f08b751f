// A room that a sky lights through one window. Walls have a thickness; outside there is ground that reflects.
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeWindowRoom() {
  SampleScene scene;
  scene.name = "window_room";
  const uint32_t plaster = scene.addMaterial("plaster", {0.78f, 0.76f, 0.72f});
  const uint32_t red = scene.addMaterial("red_wall", {0.55f, 0.16f, 0.1f});
  const uint32_t wood = scene.addMaterial("wood", {0.42f, 0.26f, 0.14f});
  const uint32_t grass = scene.addMaterial("grass", {0.16f, 0.25f, 0.08f});
  const auto box = [&](const char* name, uint32_t material, const Vec3& low, const Vec3& high) {
    Node& node = scene.nodes.emplace_back();
    node.name = name;
    addBox(node, material, (low + high) * 0.5f, high - low, 0, true);
  };
  // Inside: x from -2.5 to 2.5, z from -2 to 2, 2.75 high. The window, 2 m wide and 1.25 high, is in the wall toward +x.
  const float thickness = 0.25f;
  box("floor", wood, {-2.5f - thickness, -thickness, -2 - thickness}, {2.5f + thickness, 0, 2 + thickness});
  box("ceiling", plaster, {-2.5f - thickness, 2.75f, -2 - thickness}, {2.5f + thickness, 3, 2 + thickness});
  box("back", plaster, {-2.5f - thickness, 0, -2 - thickness}, {2.5f + thickness, 2.75f, -2});
  box("front", plaster, {-2.5f - thickness, 0, 2}, {2.5f + thickness, 2.75f, 2 + thickness});
  box("left", red, {-2.5f - thickness, 0, -2}, {-2.5f, 2.75f, 2});
  box("below_window", plaster, {2.5f, 0, -2}, {2.5f + thickness, 0.9f, 2});
  box("above_window", plaster, {2.5f, 2.15f, -2}, {2.5f + thickness, 2.75f, 2});
  box("beside_window_1", plaster, {2.5f, 0.9f, -2}, {2.5f + thickness, 2.15f, -1});
  box("beside_window_2", plaster, {2.5f, 0.9f, 1}, {2.5f + thickness, 2.15f, 2});
  box("mullion", wood, {2.5f + 0.09f, 0.9f, -0.03f}, {2.5f + 0.15f, 2.15f, 0.03f});
  box("table_top", wood, {-0.6f, 0.7f, -0.5f}, {0.8f, 0.75f, 0.4f});
  for (const float x : {-0.55f, 0.7f})
    for (const float z : {-0.45f, 0.3f}) box("table_leg", wood, {x, 0, z}, {x + 0.05f, 0.7f, z + 0.05f});
  Node& ball = scene.nodes.emplace_back();
  ball.name = "ball";
  addSphere(ball, plaster, {0.1f, 0.95f, -0.05f}, 0.2f, 24, 12);
  Node& ground = scene.nodes.emplace_back();
  ground.name = "ground";
  addQuad(ground, grass, {-8, -thickness, 8}, {8, -thickness, 8}, {8, -thickness, -8}, {-8, -thickness, -8});
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 256, 2);
  return scene;
}

}  // namespace lightwell::samples
