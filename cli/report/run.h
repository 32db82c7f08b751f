// A whole report within a budget of time: what is measured, in which order, and what an earlier run has left.
#pragma once
#include "cli/command.h"
#include "cli/report/laboratory.h"

namespace lightwell::report {

struct Request {
  LaboratoryOptions laboratory;
  std::vector<fs::path> against;
  double budget_s = 480;
  std::optional<uint32_t> reference_samples;  // else what a fifth of the budget allows
  bool fresh = false;                         // measure everything again
};

/// Measures and writes everything to the folder: report.html, .csv, .json, plots, pictures, maps, containers. Progress goes to the session's console.
/// Throws InputError, UsageError, Cancelled; what was finished until then is kept.
Report runReport(cli::Session& session, const Request& request);

}  // namespace lightwell::report
