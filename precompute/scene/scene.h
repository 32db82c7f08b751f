// The imported scene: all surfaces flattened into one indexed triangle mesh, with materials, textures and punctual lights.
//
// Units: inside precompute, lengths are internal units. world_m = origin_m + internal * metres_per_unit. The importer re-centres and scales
// by a power of two so that the largest extent lies in [8, 16): ray epsilons are then relative for 1e-4 m and 1e6 m scenes alike.
// Light intensities are kept in candela and divided by metres_per_unit² when imported (intensity_internal), so that
// E = I_internal / d_internal². Radiance and irradiance have the same value in both units.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::scene {

/// An 8-bit RGBA picture. RGB is sRGB-encoded (base colour, emission), A linear. Row 0 is v = 0 (glTF: the top row).
struct Texture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;  // width * height * 4
  enum class Wrap : uint8_t { repeat, clamp, mirror };
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

enum class AlphaMode : uint8_t { opaque, mask, blend };

struct Material {
  std::string name, gltf_path;
  Rgb base_color{1, 1, 1};  // linear factor
  float alpha = 1;
  uint32_t base_color_texture = kNone;  // index into Scene::textures
  Rgb emissive{0, 0, 0};    // radiance factor, emissive strength included
  uint32_t emissive_texture = kNone;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;  // KHR_materials_unlit: shown as is by a viewer; emits nothing and reflects as its base colour in the bake
};

/// All arrays are per vertex and of equal length, except `triangles` and the two per-triangle ones. Normals are unit and finite.
struct Mesh {
  std::vector<Vec3> positions;    // internal units
  std::vector<Vec3> normals;      // unit shading normals, on the front (counter-clockwise) side
  std::vector<Vec2> base_uv;      // base-colour texture coordinates, KHR_texture_transform applied; empty when no material is textured
  std::vector<Vec2> emissive_uv;  // likewise for the emissive texture; empty when unused
  std::vector<Vec2> lightmap_uv;  // TEXCOORD_1 as read; (NaN, NaN) on vertices whose primitive has none. Empty when none has
  std::vector<std::array<float, 4>> colors;  // linear COLOR_0; empty when no primitive has colours
  std::vector<std::array<uint32_t, 3>> triangles;  // counter-clockwise from the front, mirrored transforms already undone
  std::vector<uint32_t> triangle_material;  // index into Scene::materials
  std::vector<uint32_t> triangle_object;    // index into Scene::objects
};

/// One primitive of one node instance. Its triangles are consecutive. Vertices are never shared between objects.
struct Object {
  std::string gltf_path;  // "nodes[4]/meshes[3].primitives[0]", with "#i" for instance i of EXT_mesh_gpu_instancing
  std::string name;       // of the node
  uint32_t first_triangle = 0, triangle_count = 0;
  uint32_t first_vertex = 0, vertex_count = 0;
  bool has_lightmap_uv = false;
};

enum class LightType : uint8_t { point, spot, directional };

struct Light {
  LightType type = LightType::point;
  std::string name;
  Vec3 position{0, 0, 0};     // internal units
  Vec3 direction{0, -1, 0};   // unit, the way the light travels
  Rgb intensity{0, 0, 0};     // colour × intensity: candela per metres_per_unit² for point and spot, lux for directional
  float inner_cone_angle = 0, outer_cone_angle = kPi / 4;  // radians, 0 ≤ inner < outer ≤ π/2
  float range = 0;            // internal units; 0: infinite
};

/// A door leaf or a shutter: surfaces that a game opens and closes, in the scene as they stand when it is shut. It opens by sliding into the wall, so to speak:
/// open by τ, what is left of it is where s ≥ τ. It is cut into strips of equal width in s, so that partly open lets some of them through.
struct Portal {
  std::string name, gltf_path;  // of its node
  uint32_t first_triangle = 0, triangle_count = 0;
  Vec3 axis{0, 0, 0};           // s(p) = axis · p + offset, p in internal units: 0 where it opens first, 1 where it opens last
  float offset = 0;
  uint32_t strips = 8;          // 1 to kMostPortalStrips

  float place(const Vec3& p) const { return axis.dot(p) + offset; }
  uint32_t strip(const Vec3& p) const {
    const float at = place(p) * float(strips);
    return at > 0 ? at < float(strips) ? uint32_t(at) : strips - 1 : 0;
  }
  bool holds(uint32_t triangle) const { return triangle - first_triangle < triangle_count; }
};
inline constexpr uint32_t kMostPortalStrips = 256;

struct Scene {
  std::string file;
  Vec3d origin_m{0, 0, 0};
  double metres_per_unit = 1;
  Box3 bounds;  // of the surfaces, internal units; empty when there are none
  Mesh mesh;
  std::vector<Object> objects;
  std::vector<Material> materials;  // at least one when there are triangles
  std::vector<Texture> textures;
  std::vector<Light> lights;
  std::vector<Portal> portals;  // in the order of their triangles, which they do not share
};

/// Irradiance that `light` gives, unoccluded, at `position` (internal units) with unit normal `normal`; zero from behind.
/// KHR_lights_punctual: inverse square, smooth spot edge, range window. `to_light` receives the unit direction toward the
/// light and `distance` the length of the shadow ray (internal units; infinity for a directional light).
Rgb lightIrradiance(const Light& light, const Vec3& position, const Vec3& normal, Vec3& to_light, float& distance);

/// Bilinear texture lookup with the texture's wrap modes: linear RGB (sRGB decoded) and linear alpha.
std::array<float, 4> sampleTexture(const Texture& texture, const Vec2& uv);

/// Surface colour at barycentrics (1 − u − v, u, v) of a triangle: albedo (base colour × texture × vertex colour, ≤ 0.999 per
/// channel), emitted radiance, and alpha as the material's alpha mode wants it (1 for opaque; 0 or 1 for mask).
struct SurfaceColor {
  Rgb albedo_rgb, emitted_radiance_rgb;
  float alpha;
};
SurfaceColor surfaceColor(const Scene& scene, uint32_t triangle, float u, float v);
/// Only the alpha of surfaceColor.
float surfaceAlpha(const Scene& scene, uint32_t triangle, float u, float v);

}  // namespace lightwell::scene
