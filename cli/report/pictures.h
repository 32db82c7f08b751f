// Pictures of a report: reference, result, signed error at one scale, and the worst texel.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/report/result.h"
#include "cli/report/truth.h"

namespace lightwell::report {

struct Picture {
  std::string title;                       // of the result
  std::string reference, result, error;    // PNGs in the report's folder: the unfolded atlas, one exposure for all
  std::string near_reference, near_result, near_error;  // around the worst texel, zoomed
  int worst_x = -1, worst_y = -1;          // its column and row in the atlas
  double worst = 0;                        // its error over rms(r)
};

/// Of the best evaluation of each series. Writes pictures/ in `folder`. Maps that cannot be read are left out.
std::vector<Picture> makePictures(const std::filesystem::path& folder, const Report& report, const Truth& truth);

/// The file as a data URI. Throws std::runtime_error naming the file.
std::string dataUri(const std::filesystem::path& png);
/// RFC 4648.
std::string base64(const std::string& bytes);

}  // namespace lightwell::report
