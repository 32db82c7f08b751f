#include "cli/stress/gltf_document.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "format/encode/atomic_file.h"

namespace lightwell::stress {
namespace {

using nlohmann::json;
constexpr int kFloat = 5126, kUnsignedInt = 5125;

/// The binary chunk with its views and accessors.
class Buffer {
 public:
  json views = json::array(), accessors = json::array();
  std::vector<uint8_t> bytes;

  template <class T>
  size_t add(const std::vector<T>& values, size_t width, int component_type) {
    static constexpr const char* kTypes[] = {"SCALAR", "SCALAR", "VEC2", "VEC3", "VEC4"};
    json accessor{{"bufferView", views.size()}, {"componentType", component_type}, {"count", values.size() / width}, {"type", kTypes[width]}};
    if (width == 3) {
      std::vector<T> low(values.begin(), values.begin() + 3), high = low;
      for (size_t i = 0; i < values.size(); ++i) low[i % 3] = std::min(low[i % 3], values[i]), high[i % 3] = std::max(high[i % 3], values[i]);
      accessor["min"] = low, accessor["max"] = high;
    }
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    accessors.push_back(accessor);
    const size_t offset = bytes.size();
    bytes.resize(offset + values.size() * sizeof(T));
    std::memcpy(bytes.data() + offset, values.data(), values.size() * sizeof(T));
    return accessors.size() - 1;
  }
};

json materialJson(const Look& look) {
  json material{{"pbrMetallicRoughness", {{"baseColorFactor", {look.albedo_rgb.x, look.albedo_rgb.y, look.albedo_rgb.z, 1.0}}, {"metallicFactor", 0}}},
                {"doubleSided", look.double_sided}};
  if (look.holes) material["alphaMode"] = "MASK";
  if (const double strength = maxComponent(look.emitted_radiance_rgb); strength > 0) {
    const Rgb& e = look.emitted_radiance_rgb;
    material["emissiveFactor"] = {double(e.x) / strength, double(e.y) / strength, double(e.z) / strength};
    material["extensions"] = {{"KHR_materials_emissive_strength", {{"emissiveStrength", strength}}}};
  }
  return material;
}

/// The shortest turn from −Z, the way lights of glTF shine, to `to`.
json rotationTo(const Vec3d& to) {
  const Vec3d from(0, 0, -1), direction = to.normalized();
  const double cosine = from.dot(direction);
  if (cosine < -0.999999) return {0, 1, 0, 0};
  const Vec3d axis = from.cross(direction);
  const double w = 1 + cosine, length = std::sqrt(axis.length2() + w * w);
  return {axis.x / length, axis.y / length, axis.z / length, w / length};
}

void appendWord(std::vector<uint8_t>& bytes, size_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(uint8_t(value >> (8 * i)));
}

}  // namespace

uint32_t GltfDocument::material(const Look& look) {
  looks_.push_back(look);
  surfaces_.emplace_back();
  return uint32_t(looks_.size()) - 1;
}

void GltfDocument::quad(const Vec3d& origin, const Vec3d& edge_s, const Vec3d& edge_t, uint32_t material) {
  grid(origin, edge_s, edge_t, 1, 1, material);
}

void GltfDocument::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t material) {
  Surface& surface = surfaces_[material];
  const auto first = uint32_t(surface.positions_m.size());
  surface.positions_m.insert(surface.positions_m.end(), {a, b, c});
  surface.uv.insert(surface.uv.end(), {{0, 0}, {1, 0}, {0, 1}});
  surface.triangles.push_back({first, first + 1, first + 2});
}

void GltfDocument::grid(const Vec3d& origin, const Vec3d& edge_s, const Vec3d& edge_t, uint32_t count_s, uint32_t count_t, uint32_t material) {
  Surface& surface = surfaces_[material];
  const auto first = uint32_t(surface.positions_m.size());
  for (uint32_t t = 0; t <= count_t; ++t)
    for (uint32_t s = 0; s <= count_s; ++s) {
      const double u = double(s) / count_s, v = double(t) / count_t;
      surface.positions_m.push_back(origin + edge_s * u + edge_t * v);
      surface.uv.emplace_back(float(u), float(v));
    }
  for (uint32_t t = 0; t < count_t; ++t)
    for (uint32_t s = 0; s < count_s; ++s) {
      const uint32_t low = first + t * (count_s + 1) + s, high = low + count_s + 1;
      surface.triangles.push_back({low, low + 1, high + 1});
      surface.triangles.push_back({low, high + 1, high});
    }
}

void GltfDocument::box(const Vec3d& low, const Vec3d& high, uint32_t material, bool fronts_inward) {
  const Vec3d x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  const auto wall = [&](const Vec3d& origin, const Vec3d& s, const Vec3d& t) { fronts_inward ? quad(origin, s, t, material) : quad(origin, t, s, material); };
  wall(low, z, x), wall(low + y, x, z);
  wall(low, y, z), wall(low + x, z, y);
  wall(low, x, y), wall(low + z, y, x);
}

void GltfDocument::layOut(double part) {
  size_t quads = 0;
  for (const Surface& surface : surfaces_) quads += surface.positions_m.size() / 4;
  const auto columns = size_t(std::ceil(std::sqrt(double(quads))));
  const double cell = part / double(columns), margin = cell / 16;
  size_t quad = 0;
  for (Surface& surface : surfaces_) {
    surface.lightmap_uv.clear();
    for (size_t v = 0; v < surface.positions_m.size(); ++v) {
      const size_t q = quad + v / 4;
      const Vec2& at = surface.uv[v];
      surface.lightmap_uv.emplace_back(float(double(q % columns) * cell + margin + double(at.x) * (cell - 2 * margin)),
                                       float(double(q / columns) * cell + margin + double(at.y) * (cell - 2 * margin)));
    }
    quad += surface.positions_m.size() / 4;
  }
}

size_t GltfDocument::triangleCount() const {
  size_t count = 0;
  for (const Surface& surface : surfaces_) count += surface.triangles.size();
  return count;
}

double GltfDocument::area_m2() const {
  double area = 0;
  for (const Surface& surface : surfaces_)
    for (const auto& [a, b, c] : surface.triangles)
      area += (surface.positions_m[b] - surface.positions_m[a]).cross(surface.positions_m[c] - surface.positions_m[a]).length() / 2;
  return area;
}

void GltfDocument::write(const std::filesystem::path& glb) const {
  Buffer buffer;
  const double side = placement_.mirrored ? -1 : 1, scale = placement_.scale;
  const auto placed = [&](const Vec3d& p) { return Vec3d(p.x * side, p.y, p.z) * scale + placement_.translation_m; };
  json nodes = json::array(), scene_nodes = json::array(), primitives = json::array(), materials = json::array(), lights = json::array();
  for (size_t m = 0; m < looks_.size(); ++m) {
    materials.push_back(materialJson(looks_[m]));
    const Surface& surface = surfaces_[m];
    if (surface.triangles.empty()) continue;
    std::vector<float> positions, uv, lightmap_uv, colors;
    for (size_t v = 0; v < surface.positions_m.size(); ++v) {
      const Vec3d p = placement_.by_nodes ? surface.positions_m[v] : placed(surface.positions_m[v]);
      positions.insert(positions.end(), {float(p.x), float(p.y), float(p.z)});
      uv.insert(uv.end(), {surface.uv[v].x * float(std::max(looks_[m].holes, 1u)) / 2, surface.uv[v].y});
      if (!surface.lightmap_uv.empty()) lightmap_uv.insert(lightmap_uv.end(), {surface.lightmap_uv[v].x, surface.lightmap_uv[v].y});
    }
    std::vector<uint32_t> indices;
    for (auto [a, b, c] : surface.triangles) {
      if (placement_.mirrored && !placement_.by_nodes) std::swap(b, c);
      indices.insert(indices.end(), {a, b, c});
    }
    json attributes{{"POSITION", buffer.add(positions, 3, kFloat)}};
    if (looks_[m].holes) attributes["TEXCOORD_0"] = buffer.add(uv, 2, kFloat);
    if (!lightmap_uv.empty()) attributes["TEXCOORD_1"] = buffer.add(lightmap_uv, 2, kFloat);
    primitives.push_back({{"attributes", attributes}, {"indices", buffer.add(indices, 1, kUnsignedInt)}, {"material", m}});
  }
  const auto addInstance = [&](const Placement& at) {
    json node{{"mesh", 0}};
    if (at.by_nodes) {
      node["translation"] = {at.translation_m.x, at.translation_m.y, at.translation_m.z};
      node["scale"] = {at.scale * (at.mirrored ? -1 : 1), at.scale, at.scale};
    }
    nodes.push_back(node);
  };
  if (!primitives.empty()) {
    addInstance(placement_);
    for (const Placement& at : instances_) addInstance(at);
  }
  for (const Lamp& lamp : lamps_) {
    const Vec3d p = placed(lamp.position_m);
    json node{{"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}};
    if (lamp.directional) node["rotation"] = rotationTo(Vec3d(lamp.direction.x * side, lamp.direction.y, lamp.direction.z));
    else node["translation"] = {p.x, p.y, p.z};
    nodes.push_back(node);
    lights.push_back({{"type", lamp.directional ? "directional" : "point"}, {"intensity", lamp.directional ? lamp.intensity : lamp.intensity * scale * scale}});
  }
  for (size_t i = 0; i < nodes.size(); ++i) scene_nodes.push_back(i);
  json document{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"extensionsUsed", {"KHR_lights_punctual", "KHR_materials_emissive_strength"}}};
  document["scenes"] = json::array({json::object()});
  if (!nodes.empty()) document["scenes"][0]["nodes"] = scene_nodes, document["nodes"] = nodes;
  if (!primitives.empty()) document["meshes"] = {{{"primitives", primitives}}};
  if (!materials.empty()) document["materials"] = materials;
  if (!lights.empty()) document["extensions"] = {{"KHR_lights_punctual", {{"lights", lights}}}};
  const bool with_holes = std::any_of(looks_.begin(), looks_.end(), [](const Look& look) { return look.holes > 0; });
  if (with_holes) {
    // Two texels, one opaque and one not: a PNG of 2 × 1.
    static constexpr const char* kStripes =
        "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAADElEQVR4nGP4DwEMACLmBvoI+gInAAAAAElFTkSuQmCC";
    document["images"] = {{{"uri", kStripes}}};
    document["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9728}}};
    document["textures"] = {{{"source", 0}, {"sampler", 0}}};
    for (size_t m = 0; m < looks_.size(); ++m)
      if (looks_[m].holes) document["materials"][m]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  }
  if (!buffer.bytes.empty()) {
    document["buffers"] = {{{"byteLength", buffer.bytes.size()}}};
    document["bufferViews"] = buffer.views, document["accessors"] = buffer.accessors;
  }
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  while (buffer.bytes.size() % 4) buffer.bytes.push_back(0);
  std::vector<uint8_t> file{'g', 'l', 'T', 'F'};
  appendWord(file, 2), appendWord(file, 12 + 8 + text.size() + (buffer.bytes.empty() ? 0 : 8 + buffer.bytes.size()));
  appendWord(file, text.size()), file.insert(file.end(), {'J', 'S', 'O', 'N'}), file.insert(file.end(), text.begin(), text.end());
  if (!buffer.bytes.empty()) {
    appendWord(file, buffer.bytes.size()), file.insert(file.end(), {'B', 'I', 'N', 0});
    file.insert(file.end(), buffer.bytes.begin(), buffer.bytes.end());
  }
  format::writeFileAtomically(glb, file);
}

}  // namespace lightwell::stress
