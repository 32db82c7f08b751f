// The plots of a report.
#pragma once
#include <string>
#include <vector>

#include "cli/report/result.h"

namespace lightwell::report {

struct Plot {
  std::string file;      // in the report's folder
  std::string chapter;   // of the page: "bake", "size", "frame", "load", "live", "sky"
  std::string caption;   // plain text
  std::string svg;
};

/// Only those that have something to show.
std::vector<Plot> plotsOf(const Report& report);

/// The error as plots show it: what is too small to be told from none stands at the references' resolution.
double shownError(const Report& report, const Evaluated& evaluated);

}  // namespace lightwell::report
