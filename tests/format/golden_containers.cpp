// golden_containers compare|update FOLDER: the golden containers against what the code writes today. Exit 0 when equal (or updated).
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>

#include "format/encode/atomic_file.h"
#include "tests/format/golden_files.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  const std::string_view mode = argc == 3 ? argv[1] : "";
  if (mode != "compare" && mode != "update") {
    std::fprintf(stderr, "usage: golden_containers compare|update FOLDER\n");
    return 2;
  }
  const fs::path folder = argv[2];
  int differences = 0;
  std::set<fs::path> expected;
  for (const auto& golden : lightwell::format::goldenFiles()) {
    const fs::path path = folder / golden.path;
    expected.insert(path);
    std::ifstream stream(path, std::ios::binary);
    const std::vector<uint8_t> old{std::istreambuf_iterator<char>(stream), {}};
    if (stream.is_open() && old == golden.bytes) continue;
    ++differences;
    std::printf("%s: %zu bytes are now %zu\n", golden.path.c_str(), old.size(), golden.bytes.size());
    if (mode == "update") {
      fs::create_directories(path.parent_path());
      lightwell::format::writeFileAtomically(path, golden.bytes);
    }
  }
  for (const char* kind : {"valid", "invalid"})
    if (fs::is_directory(folder / kind))
      for (const auto& entry : fs::directory_iterator(folder / kind))
        if (!expected.contains(entry.path())) {
          ++differences;
          std::printf("%s: no longer written\n", entry.path().c_str());
          if (mode == "update") fs::remove(entry.path());
        }
  std::printf("%d of %zu golden files differ\n", differences, expected.size());
  return mode == "compare" && differences > 0 ? 1 : 0;
}
