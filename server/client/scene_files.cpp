#include "server/client/scene_files.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "precompute/core/error.h"
#include "precompute/scene/gltf/files.h"
#include "server/store/sha256.h"

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

/// The JSON text of a .glb or .gltf; empty when there is none to be found.
std::string jsonText(const fs::path& scene) {
  std::ifstream in(scene, std::ios::binary);
  char header[20] = {};
  in.read(header, sizeof header);
  uint32_t words[5] = {};
  std::memcpy(words, header, sizeof header);
  constexpr uint32_t kGlb = 0x46546C67, kMostJson = 256u << 20;
  uint64_t size = 0;
  std::error_code error;
  if (in && words[0] == kGlb) {
    size = words[3];
  } else {
    in.clear();
    in.seekg(0);
    size = fs::file_size(scene, error);
  }
  std::string text(size_t(std::min<uint64_t>(size, kMostJson)), '\0');
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(size_t(in.gcount()));
  return text;
}

void hashFile(LocalFile& file) {
  std::ifstream in(file.path, std::ios::binary);
  Sha256 hash;
  std::vector<char> buffer(1 << 20);
  file.size = 0;
  while (in.read(buffer.data(), std::streamsize(buffer.size())), in.gcount() > 0) {
    hash.add(buffer.data(), size_t(in.gcount()));
    file.size += uint64_t(in.gcount());
  }
  if (!in.eof()) throw InputError(file.path.string(), "", "cannot be read");
  file.sha256 = hash.finish();
}

bool isInside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error), target = fs::canonical(file, error);
  return !error && std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first == root.end();
}

}  // namespace

std::vector<LocalFile> filesOfScene(const fs::path& scene) {
  std::vector<LocalFile> files{{scene.filename().string(), scene, 0, {}}};
  hashFile(files[0]);
  const fs::path folder = scene.has_parent_path() ? scene.parent_path() : fs::path(".");
  const auto document = nlohmann::json::parse(jsonText(scene), nullptr, false);
  if (!document.is_object()) return files;
  std::set<std::string> names{files[0].name};
  for (const char* array : {"buffers", "images"}) {
    const auto list = document.find(array);
    if (list == document.end() || !list->is_array()) continue;
    for (const auto& element : *list) {
      if (!element.is_object() || !element.contains("uri") || !element["uri"].is_string()) continue;
      const auto uri = element["uri"].get<std::string>();
      std::error_code error;
      std::string name = scene::gltf::relativeName(uri);
      if (name.empty()) continue;
      if (!fs::is_regular_file(folder / name, error)) name = fs::path(uri).lexically_normal().generic_string();  // written without encoding
      if (names.contains(name) || !fs::is_regular_file(folder / name, error) || !isInside(folder, folder / name)) continue;
      names.insert(name);
      files.push_back({name, folder / name, 0, {}});
      hashFile(files.back());
    }
  }
  return files;
}

LocalFile singleFile(const fs::path& path, const std::vector<LocalFile>& others) {
  LocalFile file{path.filename().string(), path, 0, {}};
  hashFile(file);
  for (int number = 2; std::any_of(others.begin(), others.end(), [&](const LocalFile& other) {
         return other.name == file.name && other.sha256 != file.sha256;
       }); ++number)
    file.name = path.stem().string() + "-" + std::to_string(number) + path.extension().string();
  return file;
}

}  // namespace lightwell::server
