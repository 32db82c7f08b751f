// The Cornell box in metres, open to nothing: the sixth wall is there, behind the camera.
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeCornellBox(bool emissive_lamp) {
  SampleScene scene;
  scene.name = emissive_lamp ? "cornell_box_emissive" : "cornell_box";
  const uint32_t white = scene.addMaterial("white", {0.73f, 0.73f, 0.73f});
  const uint32_t red = scene.addMaterial("red", {0.63f, 0.065f, 0.05f});
  const uint32_t green = scene.addMaterial("green", {0.14f, 0.45f, 0.091f});

  const float half = 2.75f, height = 5.5f;
  Node& room = scene.nodes.emplace_back();
  room.name = "room";
  const auto corner = [&](float x, float y, float z) { return Vec3(x * half, y * height, z * half); };
  addQuad(room, white, corner(-1, 0, 1), corner(1, 0, 1), corner(1, 0, -1), corner(-1, 0, -1));
  addQuad(room, white, corner(-1, 1, -1), corner(1, 1, -1), corner(1, 1, 1), corner(-1, 1, 1));
  addQuad(room, white, corner(-1, 0, -1), corner(1, 0, -1), corner(1, 1, -1), corner(-1, 1, -1));
  addQuad(room, white, corner(1, 0, 1), corner(-1, 0, 1), corner(-1, 1, 1), corner(1, 1, 1));
  addQuad(room, red, corner(-1, 0, 1), corner(-1, 0, -1), corner(-1, 1, -1), corner(-1, 1, 1));
  addQuad(room, green, corner(1, 0, -1), corner(1, 0, 1), corner(1, 1, 1), corner(1, 1, -1));

  Node& tall = scene.nodes.emplace_back();
  tall.name = "tall_block";
  addBox(tall, white, {-0.93f, 1.65f, -0.9f}, {1.65f, 3.3f, 1.65f}, 0.29f, false);
  Node& low = scene.nodes.emplace_back();
  low.name = "short_block";
  addBox(low, white, {0.93f, 0.825f, 0.95f}, {1.65f, 1.65f, 1.65f}, -0.29f, false);

  if (emissive_lamp) {
    const uint32_t lamp = scene.addMaterial("lamp", {0.5f, 0.5f, 0.5f}, {17, 12, 5.5f});
    Node& panel = scene.nodes.emplace_back();
    panel.name = "lamp";
    addBox(panel, lamp, {0, height - 0.1f, 0}, {1.3f, 0.06f, 1.05f}, 0, true);
  } else {
    scene.lamps.push_back({.name = "lamp", .position_m = {0, 4.9f, 0}, .color_rgb = {1, 0.85f, 0.65f}, .intensity = 40});
  }
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 128, 2);
  return scene;
}

}  // namespace lightwell::samples
