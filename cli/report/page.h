// The page of a report: in words, in plots, in pictures, in tables. One file without anything from outside.
#pragma once
#include <filesystem>

#include "cli/report/pictures.h"
#include "cli/report/plots.h"

namespace lightwell::report {

/// HTML. Pictures are read from `folder`.
std::string pageOf(const std::filesystem::path& folder, const Report& report, const std::vector<Plot>& plots, const std::vector<Picture>& pictures);

/// What a series is recommended with: the cheapest bake whose error is at most 1.3 times the smallest of the series. Null without one.
const Baked* recommended(const Report& report, std::string_view series);

}  // namespace lightwell::report
