// Writes small glTF files for the import tests.
#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/import.h"

namespace lightwell::scene {

using Json = nlohmann::json;

/// A glTF document under construction: JSON that tests edit freely, and one binary buffer.
class GltfBuilder {
 public:
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", Json::array()}}}}};
  std::vector<uint8_t> binary;

  /// Appends bytes as a buffer view and returns its index.
  size_t view(const void* data, size_t size, size_t stride = 0);
  template <typename T>
  size_t view(const std::vector<T>& data, size_t stride = 0) {
    return view(data.data(), data.size() * sizeof(T), stride);
  }
  /// Appends tightly packed elements as an accessor and returns its index.
  template <typename T>
  size_t accessor(const std::vector<T>& components, const char* type, size_t width, bool normalized = false) {
    return accessorOfView(view(components), components.size() / width, type, componentType(T{}), normalized);
  }
  size_t accessorOfView(size_t view, size_t count, const char* type, int component_type, bool normalized = false);

  /// Appends an element to a top-level array and returns its index.
  size_t add(const char* array, Json element);
  /// A mesh of one primitive, a node that shows it, both in the scene. Returns the node's index.
  size_t show(Json primitive);
  /// A unit right triangle (0,0,0), (1,0,0), (0,1,0) facing +z, without indices or normals.
  Json triangle();
  void useExtension(const char* name, bool required = false);

  std::filesystem::path writeGlb(const std::filesystem::path& file) const;
  /// JSON with the buffer as a file beside it.
  std::filesystem::path writeGltf(const std::filesystem::path& file, const std::string& buffer_uri, const std::string& buffer_file) const;

 private:
  static int componentType(int8_t) { return 5120; }
  static int componentType(uint8_t) { return 5121; }
  static int componentType(int16_t) { return 5122; }
  static int componentType(uint16_t) { return 5123; }
  static int componentType(uint32_t) { return 5125; }
  static int componentType(float) { return 5126; }
};

void writeBytes(const std::filesystem::path& file, const std::string& bytes);

/// A fixture with a folder of its own, removed afterwards.
class SceneTest : public testing::Test {
 protected:
  SceneTest();
  ~SceneTest() override;

  Scene load(const GltfBuilder& builder, LightUnits units = LightUnits::spec);
  Scene loadFile(const std::filesystem::path& file, LightUnits units = LightUnits::spec);
  /// The error of an import that has to fail, as "place: reason"; a failed test when it does not.
  std::string errorOf(const GltfBuilder& builder);
  std::string errorOfFile(const std::filesystem::path& file);
  /// Whether a warning has both texts in its place and message.
  bool warned(const std::string& place, const std::string& message) const;
  /// World position of a vertex, metres.
  static Vec3d worldPosition(const Scene& scene, uint32_t vertex);
  /// Unit normal of a triangle by its winding.
  static Vec3d faceNormal(const Scene& scene, uint32_t triangle);

  std::filesystem::path folder;
  Diagnostics diagnostics;
};

}  // namespace lightwell::scene
