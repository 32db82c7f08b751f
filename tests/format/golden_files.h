// The golden containers of tests/golden: `valid/NAME.lwc` decode and verify; `invalid/STATUS.DEFECT.lwc` are refused with that status.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace lightwell::format {

struct GoldenFile {
  std::string path;  // relative to tests/golden
  std::vector<uint8_t> bytes;
};
std::vector<GoldenFile> goldenFiles();

}  // namespace lightwell::format
