#include "precompute/bake/container_scene.h"

#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"

namespace lightwell::bake {
namespace {

[[noreturn]] void reject(const format::Reader& reader, const std::string& chunk, const std::string& reason) {
  throw format::ContainerError(reader.file(), format::makeFault(format::Status::bad_section, 0, "%s: %s", chunk.c_str(), reason.c_str()));
}

template <class Field>
Vec3 vectorOf(const format::Reader& reader, const Field& field, const char* what) {
  if (field.size() != 3) reject(reader, "scene/header", std::string(what) + " does not have three components");
  return Vec3(float(field[0]), float(field[1]), float(field[2]));
}

/// The power of two by which the importer would have scaled a scene of this extent: positions come back bit for bit.
double metresPerUnit(const std::vector<float>& position_m) {
  Box3 bounds;
  for (size_t i = 0; i + 2 < position_m.size(); i += 3) bounds.extendBy(Vec3(position_m[i], position_m[i + 1], position_m[i + 2]));
  if (bounds.isEmpty()) return 1;
  const Vec3 size = bounds.size();
  const double extent = std::max({size.x, size.y, size.z});
  return extent > 0 && std::isfinite(extent) ? std::exp2(std::floor(std::log2(extent)) - 3) : 1;
}

scene::Light lightOf(const format::Reader& reader, const v1::Light& in, double metres_per_unit) {
  scene::Light light;
  light.type = in.type() == v1::LIGHT_TYPE_DIRECTIONAL ? scene::LightType::directional
               : in.type() == v1::LIGHT_TYPE_SPOT      ? scene::LightType::spot
                                                       : scene::LightType::point;
  light.name = in.name();
  light.position = Vec3(Vec3d(vectorOf(reader, in.position(), "a light's position")) / metres_per_unit);
  light.direction = vectorOf(reader, in.direction(), "a light's direction");
  light.intensity = vectorOf(reader, in.intensity(), "a light's intensity");
  if (light.type != scene::LightType::directional) light.intensity = Vec3(Vec3d(light.intensity) / (metres_per_unit * metres_per_unit));
  if (light.type == scene::LightType::spot) {
    light.inner_cone_angle = in.inner_cone_angle();
    light.outer_cone_angle = in.outer_cone_angle();
  }
  light.range = float(in.range() / metres_per_unit);
  return light;
}

scene::Texture::Wrap wrapOf(v1::WrapMode mode) {
  return mode == v1::WRAP_MODE_CLAMP    ? scene::Texture::Wrap::clamp
         : mode == v1::WRAP_MODE_MIRROR ? scene::Texture::Wrap::mirror
                                        : scene::Texture::Wrap::repeat;
}

/// Materials: one opaque and one for each alpha material, each single- and double-sided (index 2 * (1 + alpha) + double_sided).
void readMaterials(const format::Reader& reader, scene::Scene& scene) {
  const auto flags = reader.read<uint8_t>("geometry", "triangle_flags");
  v1::AlphaMaterials alphas;
  std::vector<uint16_t> triangle_alpha;
  if (reader.has("geometry", "alpha_material")) {
    alphas = reader.readMessage<v1::AlphaMaterials>("geometry", "alpha_material");
    triangle_alpha = reader.read<uint16_t>("geometry", "triangle_alpha");
    const auto uv = reader.read<float>("geometry", "alpha_uv");
    if (uv.size() != scene.mesh.positions.size() * 2) reject(reader, "geometry/alpha_uv", "not one for each vertex");
    for (size_t i = 0; i < uv.size(); i += 2) scene.mesh.base_uv.emplace_back(uv[i], uv[i + 1]);
  }
  const size_t triangles = scene.mesh.triangles.size();
  if (flags.size() != triangles || (!triangle_alpha.empty() && triangle_alpha.size() != triangles))
    reject(reader, "geometry", "triangle arrays differ in length");
  scene.materials.resize(2);
  for (const auto& in : alphas.materials()) {
    scene::Material material;
    material.alpha_mode = in.mode() == v1::ALPHA_MODE_MASK ? scene::AlphaMode::mask : scene::AlphaMode::blend;
    material.alpha_cutoff = in.cutoff();
    material.alpha = in.factor();
    if (in.has_texture()) {
      const std::string name = "alpha_texture_" + std::to_string(in.texture());
      const auto& info = reader.chunk("geometry", name);
      const auto values = reader.read<uint8_t>("geometry", name);
      if (info.rank != 2 || values.empty() || info.shape[0] > INT32_MAX || info.shape[1] > INT32_MAX)
        reject(reader, "geometry/" + name, "not a picture");
      scene::Texture texture;
      texture.height = int(info.shape[0]);
      texture.width = int(info.shape[1]);
      texture.wrap_u = wrapOf(in.wrap_u());
      texture.wrap_v = wrapOf(in.wrap_v());
      texture.rgba.resize(values.size() * 4, 0);
      for (size_t p = 0; p < values.size(); ++p) texture.rgba[4 * p + 3] = values[p];
      material.base_color_texture = uint32_t(scene.textures.size());
      scene.textures.push_back(std::move(texture));
    }
    scene.materials.insert(scene.materials.end(), 2, material);
  }
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    scene.materials[i].base_color = Rgb(0.0f);
    scene.materials[i].double_sided = i % 2 == 1;
  }
  for (size_t t = 0; t < triangles; ++t) {
    const uint32_t alpha = triangle_alpha.empty() || triangle_alpha[t] == 0xffff ? 0 : 1u + triangle_alpha[t];
    if (alpha > uint32_t(alphas.materials_size())) reject(reader, "geometry/triangle_alpha", "index out of range");
    scene.mesh.triangle_material.push_back(2 * alpha + (flags[t] & 1));
  }
}

void readMesh(const format::Reader& reader, scene::Scene& scene) {
  const auto position_m = reader.read<float>("geometry", "position");
  const auto normal = reader.read<int16_t>("geometry", "normal");
  const auto uv = reader.read<float>("geometry", "lightmap_uv");
  const auto index = reader.read<uint32_t>("geometry", "index");
  const size_t vertices = position_m.size() / 3;
  if (position_m.size() % 3 || normal.size() != vertices * 2 || uv.size() != vertices * 2 || index.size() % 3)
    reject(reader, "geometry", "vertex arrays differ in length");
  scene.metres_per_unit = metresPerUnit(position_m);
  scene::Mesh& mesh = scene.mesh;
  for (size_t v = 0; v < vertices; ++v) {
    const Vec3 position = Vec3(Vec3d(position_m[3 * v], position_m[3 * v + 1], position_m[3 * v + 2]) / scene.metres_per_unit);
    const auto n = format::unpackOct({normal[2 * v], normal[2 * v + 1]});
    if (!isFinite(position) || !std::isfinite(uv[2 * v]) || !std::isfinite(uv[2 * v + 1]))
      reject(reader, "geometry", "a number is not finite");
    scene.bounds.extendBy(position);
    mesh.positions.push_back(position);
    mesh.normals.emplace_back(n.x, n.y, n.z);
    mesh.lightmap_uv.emplace_back(uv[2 * v], uv[2 * v + 1]);
  }
  for (size_t i = 0; i < index.size(); i += 3) {
    if (std::max({index[i], index[i + 1], index[i + 2]}) >= vertices) reject(reader, "geometry/index", "index out of range");
    mesh.triangles.push_back({index[i], index[i + 1], index[i + 2]});
  }
  mesh.triangle_object.assign(mesh.triangles.size(), 0);
  scene.objects.push_back({.gltf_path = "geometry",
                           .name = "geometry",
                           .first_triangle = 0,
                           .triangle_count = uint32_t(mesh.triangles.size()),
                           .first_vertex = 0,
                           .vertex_count = uint32_t(vertices),
                           .has_lightmap_uv = true});
}

}  // namespace

namespace {

void readPortals(const format::Reader& reader, scene::Scene& scene) {
  if (!reader.has("radiosity", "header")) return;
  const v1::RadiosityHeader header = reader.radiosity();
  uint32_t end = 0;
  for (const v1::RadiosityPortal& in : header.portals()) {
    scene::Portal portal{.name = in.name(), .gltf_path = "radiosity/header", .first_triangle = in.first_triangle(), .triangle_count = in.triangles(), .strips = in.strips()};
    if (in.triangles() > 0) {
      if (in.first_triangle() < end || uint64_t(in.first_triangle()) + in.triangles() > scene.mesh.triangles.size())
        reject(reader, "radiosity/header", "triangles of a portal are another's or not there");
      end = in.first_triangle() + in.triangles();
      portal.axis = Vec3(Vec3d(vectorOf(reader, in.axis(), "a portal's axis")) * scene.metres_per_unit);
      portal.offset = in.offset();
      if (!isFinite(portal.axis) || !std::isfinite(portal.offset)) reject(reader, "radiosity/header", "a portal's axis is not finite");
    }
    scene.portals.push_back(std::move(portal));
  }
}

}  // namespace

ContainerScene loadContainerScene(const format::Reader& reader, Diagnostics& diagnostics) {
  ContainerScene result;
  scene::Scene& scene = result.scene;
  scene.file = reader.file();
  readMesh(reader, scene);
  readMaterials(reader, scene);
  readPortals(reader, scene);
  const v1::SceneHeader header = reader.scene();
  if (header.origin_size() != 3) reject(reader, "scene/header", "the origin does not have three components");
  scene.origin_m = Vec3d(header.origin(0), header.origin(1), header.origin(2));
  for (const auto& light : header.lights()) scene.lights.push_back(lightOf(reader, light, scene.metres_per_unit));

  const v1::AtlasHeader atlas_header = reader.atlas();
  if (atlas_header.width() != atlas_header.height() || atlas_header.width() < 1 || atlas_header.width() > 8192)
    reject(reader, "atlas/header", "the atlas is not a square of 1 to 8192 texels");
  result.atlas = atlas::buildAtlas(scene, {.size = int(atlas_header.width())}, diagnostics);
  const auto coverage = reader.read<uint8_t>("atlas", "coverage");
  const auto source = reader.read<uint32_t>("atlas", "source");
  if (coverage.size() != result.atlas.texel_slot.size() || source.size() != coverage.size())
    reject(reader, "atlas", "the maps do not have the atlas's size");
  for (size_t texel = 0; texel < coverage.size(); ++texel) {
    if ((coverage[texel] != 0) != (result.atlas.texel_slot[texel] != kNone))
      reject(reader, "atlas/coverage", "the stored coverage is not that of the geometry");
    if (source[texel] != kNone && (source[texel] >= coverage.size() || !coverage[source[texel]]))
      reject(reader, "atlas/source", "a texel shows one that is not covered");
  }
  result.atlas.source = source;
  return result;
}

}  // namespace lightwell::bake
