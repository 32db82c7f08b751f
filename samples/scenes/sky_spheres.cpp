// Spheres of several shininess on a plane, for light from a sky.
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeSkySpheres() {
  SampleScene scene;
  scene.name = "sky_spheres";
  const uint32_t ground = scene.addMaterial("ground", {0.5f, 0.48f, 0.45f});
  Node& plane = scene.nodes.emplace_back();
  plane.name = "plane";
  addQuad(plane, ground, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4});
  // Perceptual roughness of the Phong shininesses 10, 100, 1,000 and 10,000: (2 / (n + 2))^(1/4).
  const struct {
    const char* name;
    Rgb albedo_rgb;
    float roughness;
  } spheres[] = {{"matte", {0.6f, 0.55f, 0.5f}, 1.0f},
                 {"shininess_10", {0.35f, 0.12f, 0.08f}, 0.639f},
                 {"shininess_100", {0.1f, 0.2f, 0.35f}, 0.374f},
                 {"shininess_1000", {0.1f, 0.25f, 0.12f}, 0.211f},
                 {"shininess_10000", {0.05f, 0.05f, 0.06f}, 0.119f}};
  float x = -2.4f;
  for (const auto& sphere : spheres) {
    const uint32_t material = scene.addMaterial(sphere.name, sphere.albedo_rgb);
    scene.materials[material].roughness = sphere.roughness;
    Node& node = scene.nodes.emplace_back();
    node.name = sphere.name;
    addSphere(node, material, {x, 0.5f, 0}, 0.5f, 32, 16);
    x += 1.2f;
  }
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 256, 2);
  return scene;
}

}  // namespace lightwell::samples
