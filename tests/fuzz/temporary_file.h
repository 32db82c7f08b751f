// A file of this process, rewritten for every input, for importers that read from disk.
#pragma once
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/fuzz/require.h"

namespace lightwell::fuzz {

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name) {
    std::string folder = (std::filesystem::temp_directory_path() / "lightwell-fuzz-XXXXXX").string();
    require(mkdtemp(folder.data()), "a temporary folder");
    path_ = std::filesystem::path(folder) / name;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove_all(path_.parent_path(), ignored);
  }
  /// Its path, with these bytes in it.
  const std::filesystem::path& write(const void* data, size_t size) {
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    require(file && std::fwrite(data, 1, size, file) == size, "a temporary file");
    std::fclose(file);
    return path_;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace lightwell::fuzz
