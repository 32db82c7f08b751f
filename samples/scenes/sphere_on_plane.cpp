// A sphere on a plane: what shadowed light of a sky is measured with.
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {

SampleScene makeSphereOnPlane() {
  SampleScene scene;
  scene.name = "sphere_on_plane";
  const uint32_t plaster = scene.addMaterial("plaster", {0.5f, 0.5f, 0.5f});
  Node& plane = scene.nodes.emplace_back();
  plane.name = "plane";
  addQuad(plane, plaster, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2});
  Node& sphere = scene.nodes.emplace_back();
  sphere.name = "sphere";
  addSphere(sphere, plaster, {0, 0.5f, 0}, 0.5f, 48, 24);
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 128, 2);
  return scene;
}

}  // namespace lightwell::samples
