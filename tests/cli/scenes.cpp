#include "tests/cli/scenes.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

namespace lightwell::test {
namespace {

using nlohmann::json;
using Corner = std::array<float, 3>;

std::string base64(const std::vector<uint8_t>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t word = uint32_t(bytes[i]) << 16;
    if (i + 1 < bytes.size()) word |= uint32_t(bytes[i + 1]) << 8;
    if (i + 2 < bytes.size()) word |= bytes[i + 2];
    for (int digit = 0; digit < 4; ++digit) text += i + size_t(digit) > bytes.size() ? '=' : kDigits[word >> (18 - 6 * digit) & 63];
  }
  return text;
}

template <class T>
void append(std::vector<uint8_t>& bytes, const std::vector<T>& values) {
  const auto* begin = reinterpret_cast<const uint8_t*>(values.data());
  bytes.insert(bytes.end(), begin, begin + values.size() * sizeof(T));
}

/// A cube of 0.4 m around the origin, its fronts outward, every side in 5 × 5 squares: positions, then indices.
std::vector<uint8_t> cube(size_t& corners, size_t& indices_count) {
  constexpr int kSquares = 5;
  const std::array<std::array<Corner, 3>, 6> sides{{{{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}}},
                                                    {{{-1, 1, -1}, {0, 0, 2}, {2, 0, 0}}},
                                                    {{{-1, -1, -1}, {0, 0, 2}, {0, 2, 0}}},
                                                    {{{1, -1, -1}, {0, 2, 0}, {0, 0, 2}}},
                                                    {{{-1, -1, -1}, {0, 2, 0}, {2, 0, 0}}},
                                                    {{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}}}}};
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  for (const auto& [corner, s, t] : sides)
    for (int a = 0; a < kSquares; ++a)
      for (int b = 0; b < kSquares; ++b) {
        const auto first = uint32_t(positions.size() / 3);
        for (const auto& [da, db] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
          for (int i = 0; i < 3; ++i)
            positions.push_back(0.2f * (corner[i] + float(a + da) / kSquares * s[i] + float(b + db) / kSquares * t[i]));
        for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
      }
  std::vector<uint8_t> bytes;
  append(bytes, positions);
  append(bytes, indices);
  corners = positions.size() / 3;
  indices_count = indices.size();
  return bytes;
}

json surfaceMaterial(const char* name, double albedo, double emission) {
  return {{"name", name},
          {"pbrMetallicRoughness", {{"baseColorFactor", {albedo, albedo, albedo, 1}}, {"metallicFactor", 0}}},
          {"emissiveFactor", {emission, emission, emission}}};
}

void addBoxes(json& gltf, json& roots, const RoomOptions& options) {
  size_t corners = 0, indices = 0;
  const std::vector<uint8_t> bytes = cube(corners, indices);
  const size_t buffer = gltf["buffers"].size(), view = gltf["bufferViews"].size(), accessor = gltf["accessors"].size();
  gltf["buffers"].push_back({{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
  gltf["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 0}, {"byteLength", 12 * corners}});
  gltf["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 12 * corners}, {"byteLength", 4 * indices}});
  gltf["accessors"].push_back({{"bufferView", view}, {"componentType", 5126}, {"count", corners}, {"type", "VEC3"},
                               {"min", {-0.2, -0.2, -0.2}}, {"max", {0.2, 0.2, 0.2}}});
  gltf["accessors"].push_back({{"bufferView", view + 1}, {"componentType", 5125}, {"count", indices}, {"type", "SCALAR"}});
  for (const bool first : {true, false}) {
    const char* name = first ? "first box" : "second box";
    gltf["materials"].push_back(surfaceMaterial(name, first ? options.box_albedo : 0.5, first ? 0.0 : options.box_emission));
    gltf["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", accessor}}}, {"indices", accessor + 1},
                                               {"material", gltf["materials"].size() - 1}}}}});
    roots.push_back(gltf["nodes"].size());
    gltf["nodes"].push_back({{"name", name}, {"mesh", gltf["meshes"].size() - 1},
                             {"translation", {first ? options.box_x : 0.5, -0.75, 0.25}}});
  }
}

void addShutter(json& gltf, json& roots, const RoomOptions& options) {
  std::vector<uint8_t> bytes;
  append(bytes, std::vector<float>{0.5f, -1, -1, 0.5f, -1, 1, 0.5f, 1, 1, 0.5f, 1, -1});
  append(bytes, std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
  const size_t buffer = gltf["buffers"].size(), view = gltf["bufferViews"].size(), accessor = gltf["accessors"].size();
  gltf["buffers"].push_back({{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
  gltf["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 0}, {"byteLength", 48}});
  gltf["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 48}, {"byteLength", 24}});
  gltf["accessors"].push_back({{"bufferView", view}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"min", {0.5, -1, -1}}, {"max", {0.5, 1, 1}}});
  gltf["accessors"].push_back({{"bufferView", view + 1}, {"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}});
  gltf["materials"].push_back(surfaceMaterial("sheet", 0.5, 0));
  gltf["materials"].back()["doubleSided"] = true;
  gltf["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", accessor}}}, {"indices", accessor + 1}, {"material", gltf["materials"].size() - 1}}}}});
  roots.push_back(gltf["nodes"].size());
  gltf["nodes"].push_back({{"name", "shutter"}, {"mesh", gltf["meshes"].size() - 1}});
  if (options.shutter_marked) gltf["nodes"].back()["extras"]["lightwell"]["portal"] = {{"strips", 4}};
}

}  // namespace

std::string roomGltf(const RoomOptions& options) {
  json gltf{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"nodes", json::array()}};
  json roots = json::array();
  if (options.surfaces) {
    // Each wall: a corner and two edges whose cross product points into the room.
    const std::array<std::array<Corner, 3>, 6> walls{{{{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}}},
                                                      {{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}}},
                                                      {{{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}}},
                                                      {{{1, -1, -1}, {0, 0, 2}, {0, 2, 0}}},
                                                      {{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}},
                                                      {{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}}}}};
    std::vector<float> positions, uvs;
    std::vector<uint32_t> indices;
    for (uint32_t w = 0; w < 6; ++w) {
      if (w == 1 && options.open) continue;
      const auto first = uint32_t(positions.size() / 3);
      const auto& [corner, s, t] = walls[w];
      for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        for (int i = 0; i < 3; ++i) positions.push_back(corner[i] + float(a) * s[i] + float(b) * t[i]);
        uvs.push_back((float(w % 3) + 0.125f + 0.75f * float(a)) / 3);
        uvs.push_back((float(w / 3) + 0.125f + 0.75f * float(b)) / 3);
      }
      for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
    }
    std::vector<uint8_t> bytes;
    append(bytes, positions);
    append(bytes, uvs);
    append(bytes, indices);
    gltf["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    const size_t corners = positions.size() / 3;
    gltf["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 12 * corners}},
                           {{"buffer", 0}, {"byteOffset", 12 * corners}, {"byteLength", 8 * corners}},
                           {{"buffer", 0}, {"byteOffset", 20 * corners}, {"byteLength", 4 * indices.size()}}};
    gltf["accessors"] = {
        {{"bufferView", 0}, {"componentType", 5126}, {"count", corners}, {"type", "VEC3"}, {"min", {-1, -1, -1}}, {"max", {1, 1, 1}}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", corners}, {"type", "VEC2"}},
        {{"bufferView", 2}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}}};
    gltf["materials"] = json::array({surfaceMaterial("wall", options.albedo, options.emission)});
    gltf["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_1", 1}}}, {"indices", 2}, {"material", 0}}}}}};
    roots.push_back(gltf["nodes"].size());
    gltf["nodes"].push_back({{"name", "room"}, {"mesh", 0}});
    if (options.boxes) addBoxes(gltf, roots, options);
    if (options.shutter) addShutter(gltf, roots, options);
  }
  if (options.lamp_candela > 0) {
    gltf["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", options.lamp_candela}}};
    roots.push_back(gltf["nodes"].size());
    gltf["nodes"].push_back({{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  }
  gltf["scenes"] = {{{"nodes", roots}}};
  if (roots.empty()) gltf["scenes"] = {json::object()}, gltf.erase("nodes");
  return gltf.dump();
}

}  // namespace lightwell::test
