// What has to be sent so that a server can bake a scene: the scene's file and every file it names.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lightwell::server {

struct LocalFile {
  std::string name;            // as JobSpec.files has it
  std::filesystem::path path;
  uint64_t size = 0;
  std::string sha256;
};

/// The scene first. Files that it names but that are not there, or lie outside its folder, are left out: the bake then says so, with the
/// place in the scene. Throws InputError for a file that cannot be read.
std::vector<LocalFile> filesOfScene(const std::filesystem::path& scene);

/// One file under a name that none of `others` has.
LocalFile singleFile(const std::filesystem::path& file, const std::vector<LocalFile>& others);

}  // namespace lightwell::server
