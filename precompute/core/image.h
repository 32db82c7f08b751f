// Float images in and out: the EXR atlases of the outside contract, and PNGs for people.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell {

/// Linear RGBA, row 0 first. In an irradiance atlas A is 1 where a texel is covered by the surface and 0 elsewhere.
struct ImageRgba {
  int width = 0, height = 0;
  std::vector<std::array<float, 4>> pixels;
};

/// 32-bit float EXR with channels R, G, B, A; written to a temporary file and renamed. Throws std::runtime_error naming the file.
void writeExr(const std::filesystem::path& file, const ImageRgba& image);
/// Reads an EXR (half or float; luminance-only files give R = G = B; missing A reads as 1). Throws InputError.
ImageRgba readExr(const std::filesystem::path& file);

}  // namespace lightwell
