#include "tests/scene/gltf_builder.h"

#include <unistd.h>

#include <fstream>

#include "precompute/core/error.h"

namespace lightwell::scene {

size_t GltfBuilder::view(const void* data, size_t size, size_t stride) {
  while (binary.size() % 8 != 0) binary.push_back(0);
  Json element = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
  if (stride != 0) element["byteStride"] = stride;
  const auto* bytes = static_cast<const uint8_t*>(data);
  binary.insert(binary.end(), bytes, bytes + size);
  return add("bufferViews", element);
}

size_t GltfBuilder::accessorOfView(size_t view, size_t count, const char* type, int component_type, bool normalized) {
  Json element = {{"bufferView", view}, {"count", count}, {"type", type}, {"componentType", component_type}};
  if (normalized) element["normalized"] = true;
  return add("accessors", element);
}

size_t GltfBuilder::add(const char* array, Json element) {
  json[array].push_back(std::move(element));
  return json[array].size() - 1;
}

size_t GltfBuilder::show(Json primitive) {
  const size_t mesh = add("meshes", {{"primitives", {std::move(primitive)}}});
  const size_t node = add("nodes", {{"mesh", mesh}});
  json["scenes"][0]["nodes"].push_back(node);
  return node;
}

Json GltfBuilder::triangle() {
  return {{"attributes", {{"POSITION", accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}};
}

void GltfBuilder::useExtension(const char* name, bool required) {
  json["extensionsUsed"].push_back(name);
  if (required) json["extensionsRequired"].push_back(name);
}

std::filesystem::path GltfBuilder::writeGlb(const std::filesystem::path& file) const {
  Json document = json;
  if (!binary.empty() && !document.contains("buffers")) document["buffers"] = {{{"byteLength", binary.size()}}};
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string chunk(binary.begin(), binary.end());
  chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
  const auto u32 = [](size_t value) {
    const auto narrow = uint32_t(value);
    return std::string(reinterpret_cast<const char*>(&narrow), 4);
  };
  writeBytes(file, "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + chunk.size()) + u32(text.size()) + "JSON" + text + u32(chunk.size()) +
                       std::string("BIN\0", 4) + chunk);
  return file;
}

std::filesystem::path GltfBuilder::writeGltf(const std::filesystem::path& file, const std::string& buffer_uri,
                                             const std::string& buffer_file) const {
  Json document = json;
  document["buffers"] = {{{"byteLength", binary.size()}, {"uri", buffer_uri}}};
  writeBytes(file, document.dump());
  if (!buffer_file.empty()) writeBytes(file.parent_path() / buffer_file, std::string(binary.begin(), binary.end()));
  return file;
}

void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

SceneTest::SceneTest() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  folder = std::filesystem::temp_directory_path() /
           ("lightwell_scene_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" + test->name());
  std::filesystem::create_directories(folder);
}

SceneTest::~SceneTest() { std::filesystem::remove_all(folder); }

Scene SceneTest::load(const GltfBuilder& builder, LightUnits units) { return loadFile(builder.writeGlb(folder / "scene.glb"), units); }

Scene SceneTest::loadFile(const std::filesystem::path& file, LightUnits units) { return importGltf(file, {units}, diagnostics); }

std::string SceneTest::errorOf(const GltfBuilder& builder) { return errorOfFile(builder.writeGlb(folder / "scene.glb")); }

std::string SceneTest::errorOfFile(const std::filesystem::path& file) {
  try {
    importGltf(file, {}, diagnostics);
  } catch (const InputError& e) {
    EXPECT_EQ(e.file, file.string());
    return e.place + ": " + e.reason;
  }
  ADD_FAILURE() << "the import should have failed";
  return "";
}

bool SceneTest::warned(const std::string& place, const std::string& message) const {
  for (const Warning& warning : diagnostics.warnings())
    if (warning.place.find(place) != std::string::npos && warning.message.find(message) != std::string::npos) return true;
  return false;
}

Vec3d SceneTest::worldPosition(const Scene& scene, uint32_t vertex) {
  return scene.origin_m + Vec3d(scene.mesh.positions[vertex]) * scene.metres_per_unit;
}

Vec3d SceneTest::faceNormal(const Scene& scene, uint32_t triangle) {
  const auto& t = scene.mesh.triangles[triangle];
  const Vec3d a(scene.mesh.positions[t[0]]), b(scene.mesh.positions[t[1]]), c(scene.mesh.positions[t[2]]);
  return (b - a).cross(c - a).normalized();
}

}  // namespace lightwell::scene
