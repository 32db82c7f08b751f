// Runs the table, and tells what it found.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/stress/cases.h"

namespace lightwell::stress {

/// One case under one technique.
struct Row {
  std::string name, holds;
  plan::Technique technique{};
  std::vector<Check> checks;
  std::string failure;  // what was thrown, if something was; else empty
  double seconds = 0;
  uint64_t rays = 0;

  bool passed() const;
  /// The first check that failed; the last one that a case made itself when none did.
  const Check* telling() const;
};

struct Selection {
  std::string filter = "*";                 // of names
  std::vector<plan::Technique> techniques;  // empty: all
  bool slow = true;                         // slow cases, too
  bool gl = true;                           // also on OpenGL; else cases that need it are left out, too
};
/// Whether a case is in it.
bool selects(const Selection& selection, const Case& one);

/// `begin` and `done`, if set, are told of each row. Throws Cancelled, and UsageError when no folder for temporary files can be made; all else is a row that failed.
std::vector<Row> runCases(const std::vector<Case>& cases, const Selection& selection, int threads, const CancelFlag& cancel,
                          const std::function<void(const Case&, plan::Technique)>& begin = {}, const std::function<void(const Row&)>& done = {});

/// schemas/stress.schema.json.
nlohmann::json tableJson(const std::vector<Row>& rows);

}  // namespace lightwell::stress
