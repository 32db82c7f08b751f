// What a sample scene is before it becomes a .glb: charts of triangles in metres, materials, nodes and lamps.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::samples {

/// Triangles that share one parametrisation, in metres, with neither overlap nor fold. Front faces are counter-clockwise.
struct Chart {
  uint32_t material = 0;
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> metric_uv;    // metres: how the chart lies when spread out
  std::vector<Vec2> lightmap_uv;  // [0, 1]², written by layOutCharts
  std::vector<std::array<uint32_t, 3>> triangles;

  /// Appends a vertex and returns its index. Positions are rounded to 1/4096 m, so that points meant to coincide do, and
  /// normals to 1/16384, so that the files do not depend on the last bit of a math library's sine.
  uint32_t addVertex(const Vec3& position, const Vec3& normal, const Vec2& uv);
};

struct Node {
  std::string name;
  Vec3 translation_m{0, 0, 0};
  float rotation_y = 0;  // radians about the node's origin
  bool portal = false;   // a door, shut: marked by the node's extras
  std::vector<Chart> charts;
};

struct Material {
  std::string name;
  Rgb albedo_rgb;                      // linear
  Rgb emitted_radiance_rgb{0, 0, 0};
  float roughness = 1;                 // perceptual, as glTF has it
};

enum class LampType { point, spot, directional };
struct Lamp {
  std::string name;
  LampType type = LampType::point;
  Vec3 position_m{0, 0, 0};
  Vec3 direction{0, -1, 0};  // the way the light travels; need not be unit
  Rgb color_rgb{1, 1, 1};    // linear
  float intensity = 1;       // candela, or lux for a directional lamp
  float inner_cone_angle = 0, outer_cone_angle = kPi / 4;  // radians
};

struct SampleScene {
  std::string name;  // of the file, without extension
  std::vector<Material> materials;
  std::vector<Node> nodes;
  std::vector<Lamp> lamps;
  int lightmap_size = 0;  // texels the TEXCOORD_1 layout is made for; 0: the file has no TEXCOORD_1

  uint32_t addMaterial(const std::string& name, const Rgb& albedo_rgb, const Rgb& emitted_radiance_rgb = Rgb(0));
  size_t triangleCount() const;
};

SampleScene makeCornellBox(bool emissive_lamp);
SampleScene makeMarbleChamber();
SampleScene makeCorridorDoor();
SampleScene makeColonnadeCourtyard();
SampleScene makeSkySpheres();
SampleScene makeSphereOnPlane();
SampleScene makeWindowRoom();
/// All of them.
std::vector<SampleScene> makeAllScenes();

}  // namespace lightwell::samples
