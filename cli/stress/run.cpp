#include "cli/stress/run.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

namespace lightwell::stress {

bool Row::passed() const {
  return failure.empty() && !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.passed; });
}

const Check* Row::telling() const {
  for (const Check& check : checks)
    if (!check.passed) return &check;
  return checks.empty() ? nullptr : &checks.back();
}

bool selects(const Selection& selection, const Case& one) { return (selection.slow || !one.slow) && (selection.gl || !one.needs_gl) && matches(selection.filter, one.name); }

std::vector<Row> runCases(const std::vector<Case>& cases, const Selection& selection, int threads, const CancelFlag& cancel,
                          const std::function<void(const Case&, plan::Technique)>& begin, const std::function<void(const Row&)>& done) {
  const Workbench bench(threads, cancel, selection.gl);
  PlainCosts plain;
  std::vector<Row> rows;
  for (const Case& one : cases) {
    if (!selects(selection, one)) continue;
    for (const plan::Technique technique : one.techniques) {
      const auto& wanted = selection.techniques;
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), technique) == wanted.end()) continue;
      if (begin) begin(one, technique);
      const auto start = std::chrono::steady_clock::now();
      Trial trial(technique, bench, plain);
      Row row{.name = one.name, .holds = one.holds, .technique = technique};
      try {
        one.run(trial);
      } catch (const Cancelled&) {
        throw;
      } catch (const std::exception& error) {
        row.failure = error.what();
      }
      row.checks = trial.checks();
      row.rays = trial.rays();
      row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (done) done(row);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

nlohmann::json tableJson(const std::vector<Row>& rows) {
  using nlohmann::json;
  json table = json::array();
  size_t passed = 0;
  for (const Row& row : rows) {
    json checks = json::array();
    for (const Check& check : row.checks) checks.push_back({{"what", check.what}, {"expected", check.expected}, {"got", check.got}, {"passed", check.passed}});
    passed += row.passed();
    table.push_back({{"case", row.name},
                     {"technique", plan::name(row.technique)},
                     {"holds", row.holds},
                     {"passed", row.passed()},
                     {"failure", row.failure.empty() ? json(nullptr) : json(row.failure)},
                     {"checks", checks},
                     {"rays", row.rays},
                     {"seconds", row.seconds}});
  }
  return {{"passed", passed}, {"failed", rows.size() - passed}, {"rows", table}};
}

}  // namespace lightwell::stress
