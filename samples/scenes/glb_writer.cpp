#include "samples/scenes/glb_writer.h"

#include <bit>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace lightwell::samples {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;

/// Six decimals: more than any quantity here needs, and free of float-to-double tails.
double tidy(float value) { return std::round(double(value) * 1e6) / 1e6; }
template <class V>
Json tidy3(const V& v) {
  return {tidy(v.x), tidy(v.y), tidy(v.z)};
}

/// The binary chunk with its views and accessors.
class Buffer {
 public:
  Json views = Json::array(), accessors = Json::array();
  std::vector<uint8_t> bytes;

  size_t addFloats(const std::vector<float>& values, int components, bool with_bounds) {
    Json accessor = beginAccessor(values.size() / size_t(components), components == 2 ? "VEC2" : "VEC3", kFloat, kArrayBuffer);
    if (with_bounds) {
      std::vector<double> low(values.begin(), values.begin() + components), high = low;
      for (size_t i = 0; i < values.size(); ++i) {
        const size_t c = i % size_t(components);
        low[c] = std::min(low[c], double(values[i]));
        high[c] = std::max(high[c], double(values[i]));
      }
      accessor["min"] = low;
      accessor["max"] = high;
    }
    for (float value : values) append(std::bit_cast<uint32_t>(value), 4);
    return endAccessor(std::move(accessor));
  }
  size_t addIndices(const std::vector<uint32_t>& indices, size_t vertex_count) {
    const bool wide = vertex_count > 65535;
    Json accessor = beginAccessor(indices.size(), "SCALAR", wide ? kUnsignedInt : kUnsignedShort, kElementArrayBuffer);
    for (uint32_t index : indices) append(index, wide ? 4 : 2);
    return endAccessor(std::move(accessor));
  }

 private:
  Json beginAccessor(size_t count, const char* type, int component, int target) {
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", 0}, {"target", target}});
    return {{"bufferView", views.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}};
  }
  size_t endAccessor(Json accessor) {
    views.back()["byteLength"] = bytes.size() - views.back()["byteOffset"].get<size_t>();
    while (bytes.size() % 4) bytes.push_back(0);
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
  }
  void append(uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(uint8_t(value >> (8 * i)));
  }
};

/// All charts of one material in one node, merged.
Json encodePrimitive(const Node& node, uint32_t material, bool with_lightmap, Buffer& buffer) {
  std::vector<float> positions, normals, metric_uv, lightmap_uv;
  std::vector<uint32_t> indices;
  for (const Chart& chart : node.charts) {
    if (chart.material != material) continue;
    const uint32_t base = uint32_t(positions.size() / 3);
    for (size_t i = 0; i < chart.positions.size(); ++i) {
      for (int c = 0; c < 3; ++c) positions.push_back(chart.positions[i][c]);
      const Vec3 normal = chart.normals[i].normalized();
      for (int c = 0; c < 3; ++c) normals.push_back(normal[c]);
      for (int c = 0; c < 2; ++c) metric_uv.push_back(chart.metric_uv[i][c]);
      if (with_lightmap)
        for (int c = 0; c < 2; ++c) lightmap_uv.push_back(chart.lightmap_uv[i][c]);
    }
    for (const auto& triangle : chart.triangles)
      for (uint32_t index : triangle) indices.push_back(base + index);
  }
  Json attributes;
  attributes["POSITION"] = buffer.addFloats(positions, 3, true);
  attributes["NORMAL"] = buffer.addFloats(normals, 3, false);
  attributes["TEXCOORD_0"] = buffer.addFloats(metric_uv, 2, false);
  if (with_lightmap) attributes["TEXCOORD_1"] = buffer.addFloats(lightmap_uv, 2, false);
  const size_t index_accessor = buffer.addIndices(indices, positions.size() / 3);
  return {{"attributes", attributes}, {"indices", index_accessor}, {"material", material}};
}

Json encodeMaterial(const Material& material) {
  Json json{{"name", material.name},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {tidy(material.albedo_rgb.x), tidy(material.albedo_rgb.y), tidy(material.albedo_rgb.z), 1.0}},
              {"metallicFactor", 0.0}, {"roughnessFactor", tidy(material.roughness)}}}};
  const float strength = maxComponent(material.emitted_radiance_rgb);
  if (strength > 0) {
    json["emissiveFactor"] = tidy3(material.emitted_radiance_rgb / strength);
    json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = tidy(strength);
  }
  return json;
}

/// The rotation that turns −z, along which glTF lights shine, into `direction`.
Json rotationTo(const Vec3& direction) {
  const Vec3 to = direction.normalized();
  const Vec3 axis = Vec3(0, 0, -1).cross(to);
  const float w = 1 - to.z;
  if (w < 1e-6f) return {0.0, 1.0, 0.0, 0.0};
  const float scale = 1 / std::sqrt(axis.length2() + w * w);
  return {tidy(axis.x * scale), tidy(axis.y * scale), tidy(axis.z * scale), tidy(w * scale)};
}

Json encodeLamp(const Lamp& lamp) {
  static constexpr const char* kTypes[] = {"point", "spot", "directional"};
  Json json{{"name", lamp.name}, {"type", kTypes[int(lamp.type)]}, {"color", tidy3(lamp.color_rgb)}, {"intensity", tidy(lamp.intensity)}};
  if (lamp.type == LampType::spot)
    json["spot"] = {{"innerConeAngle", tidy(lamp.inner_cone_angle)}, {"outerConeAngle", tidy(lamp.outer_cone_angle)}};
  return json;
}

void appendChunk(std::vector<uint8_t>& glb, const char* type, const uint8_t* data, size_t size, uint8_t filler) {
  const uint32_t padded = uint32_t((size + 3) / 4 * 4);
  for (int i = 0; i < 4; ++i) glb.push_back(uint8_t(padded >> (8 * i)));
  glb.insert(glb.end(), type, type + 4);
  glb.insert(glb.end(), data, data + size);
  glb.insert(glb.end(), padded - size, filler);
}

}  // namespace

std::vector<uint8_t> encodeGlb(const SampleScene& scene) {
  Buffer buffer;
  Json gltf;
  gltf["asset"] = {{"version", "2.0"}, {"generator", "lightwell_make_samples"}};
  gltf["scene"] = 0;
  gltf["scenes"] = Json::array({{{"name", scene.name}, {"nodes", Json::array()}}});
  if (scene.lightmap_size > 0) gltf["scenes"][0]["extras"]["lightmapSize"] = scene.lightmap_size;
  Json extensions = Json::array(), nodes = Json::array(), meshes = Json::array();
  for (const Node& node : scene.nodes) {
    Json primitives = Json::array();
    for (uint32_t material = 0; material < scene.materials.size(); ++material) {
      const bool used = std::any_of(node.charts.begin(), node.charts.end(), [&](const Chart& chart) { return chart.material == material; });
      if (used) primitives.push_back(encodePrimitive(node, material, scene.lightmap_size > 0, buffer));
    }
    Json json{{"name", node.name}, {"mesh", meshes.size()}};
    if (node.translation_m != Vec3(0)) json["translation"] = tidy3(node.translation_m);
    if (node.rotation_y != 0) json["rotation"] = {0.0, tidy(std::sin(node.rotation_y / 2)), 0.0, tidy(std::cos(node.rotation_y / 2))};
    if (node.portal) json["extras"]["lightwell"]["portal"] = true;
    nodes.push_back(std::move(json));
    meshes.push_back({{"name", node.name}, {"primitives", std::move(primitives)}});
  }
  Json lamps = Json::array();
  for (const Lamp& lamp : scene.lamps) {
    Json json{{"name", lamp.name}};
    if (lamp.type != LampType::directional) json["translation"] = tidy3(lamp.position_m);
    if (lamp.type != LampType::point) json["rotation"] = rotationTo(lamp.direction);
    json["extensions"]["KHR_lights_punctual"]["light"] = lamps.size();
    nodes.push_back(std::move(json));
    lamps.push_back(encodeLamp(lamp));
  }
  for (size_t i = 0; i < nodes.size(); ++i) gltf["scenes"][0]["nodes"].push_back(i);
  gltf["nodes"] = std::move(nodes);
  gltf["meshes"] = std::move(meshes);
  for (const Material& material : scene.materials) gltf["materials"].push_back(encodeMaterial(material));
  if (!lamps.empty()) {
    extensions.push_back("KHR_lights_punctual");
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lamps);
  }
  const auto emits = [](const Material& material) { return maxComponent(material.emitted_radiance_rgb) > 0; };
  if (std::any_of(scene.materials.begin(), scene.materials.end(), emits))
    extensions.push_back("KHR_materials_emissive_strength");
  if (!extensions.empty()) gltf["extensionsUsed"] = std::move(extensions);
  gltf["bufferViews"] = std::move(buffer.views);
  gltf["accessors"] = std::move(buffer.accessors);
  gltf["buffers"] = Json::array({{{"byteLength", buffer.bytes.size()}}});

  const std::string json = gltf.dump();
  std::vector<uint8_t> chunks;
  appendChunk(chunks, "JSON", reinterpret_cast<const uint8_t*>(json.data()), json.size(), ' ');
  appendChunk(chunks, "BIN\0", buffer.bytes.data(), buffer.bytes.size(), 0);
  std::vector<uint8_t> glb{'g', 'l', 'T', 'F', 2, 0, 0, 0};
  const uint32_t total = uint32_t(12 + chunks.size());
  for (int i = 0; i < 4; ++i) glb.push_back(uint8_t(total >> (8 * i)));
  glb.insert(glb.end(), chunks.begin(), chunks.end());
  return glb;
}

void writeFile(const std::filesystem::path& file, const std::vector<uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace lightwell::samples
