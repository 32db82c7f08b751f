// lightwell stress: stiff and extreme scenes, what they must give, and what they gave.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/stress/evaluators.h"
#include "cli/stress/run.h"

namespace lightwell::cli {
namespace {

struct Options {
  stress::Selection selection;
  std::string techniques = "auto", evaluator = "auto";
  bool fast = false, list = false, json = false, verbose = false;
  int threads = 0;
};

std::string padded(const std::string& text, size_t width) {
  size_t shown = 0;  // characters, not bytes
  for (const char c : text) shown += (c & 0xc0) != 0x80;
  return text + std::string(shown < width ? width - shown : 1, ' ');
}

void list(const Options& options) {
  for (const stress::Case& one : stress::allCases()) {
    if (!stress::selects(options.selection, one)) continue;
    std::string techniques;
    for (const auto technique : one.techniques) {
      if (!techniques.empty()) techniques += ',';
      techniques += plan::name(technique);
    }
    std::printf("%s%s%s%s\n", padded(one.name, 22).c_str(), padded(techniques, 30).c_str(), one.slow ? "(slow) " : "", one.holds.c_str());
  }
}

/// Whether to evaluate on OpenGL, too.
bool withGl(Session& session, const std::string& evaluator) {
  if (evaluator == "cpu") return false;
  const std::optional<std::string> reason = stress::reasonWithoutGl();
  if (!reason) return true;
  if (evaluator == "gl") throw UsageError("--evaluator gl: " + *reason);
  session.console.line("without OpenGL: " + *reason);
  return false;
}

/// One line of the table.
std::string lineOf(const stress::Row& row) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.1f s", row.seconds);
  const stress::Check* check = row.telling();
  std::string line = padded(row.passed() ? "pass" : "FAIL", 6) + padded(row.name, 22) + padded(std::string(plan::name(row.technique)), 12) + padded(seconds, 8);
  if (!row.failure.empty()) return line + row.failure;
  if (check) line += check->what + ": expected " + check->expected + ", got " + check->got;
  return line;
}

void run(Session& session, Options& options) {
  options.selection.slow = !options.fast;
  options.selection.techniques = plan::parseTechniques(options.techniques);
  const std::vector<stress::Case> cases = stress::allCases();
  if (std::none_of(cases.begin(), cases.end(), [&](const stress::Case& one) { return stress::selects(options.selection, one); }))
    throw UsageError("--filter " + options.selection.filter + ": no case has such a name; --list names them");
  if (options.list) return list(options);
  options.selection.gl = withGl(session, options.evaluator);
  const auto begin = [&](const stress::Case& one, plan::Technique technique) {
    session.console.progress(one.name, one.name + ", " + std::string(plan::name(technique)) + " …");
  };
  const auto done = [&](const stress::Row& row) {
    session.console.line(lineOf(row));
    if (options.verbose)
      for (const stress::Check& check : row.checks)
        session.console.line("        " + padded(check.passed ? "" : "FAIL", 6) + check.what + ": expected " + check.expected + ", got " + check.got);
  };
  const auto rows = stress::runCases(cases, options.selection, options.threads, session.interrupt.flag(), begin, done);
  const auto failed = size_t(std::count_if(rows.begin(), rows.end(), [](const stress::Row& row) { return !row.passed(); }));
  session.console.line(std::to_string(rows.size() - failed) + " of " + std::to_string(rows.size()) + " passed");
  if (options.json) printJson(stress::tableJson(rows));
  if (failed) throw std::runtime_error(std::to_string(failed) + " of " + std::to_string(rows.size()) + " rows of the stress table failed");
}

}  // namespace

void addStress(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("stress", "Bake and evaluate stiff and extreme scenes, and compare with what is exact or expected");
  command->add_option("--filter", options->selection.filter, "Only cases with such a name; * stands for anything, ? for one character")->type_name("GLOB")->capture_default_str();
  command->add_option("--techniques", options->techniques, "auto: each technique to which a case applies; or a list such as prm,lightmap")->type_name("LIST")->capture_default_str();
  command->add_option("--evaluator", options->evaluator, "cpu; gl: that and OpenGL, which must agree; auto: OpenGL where there is any")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "cpu", "gl"}))
      ->capture_default_str();
  command->add_flag("--fast", options->fast, "Leave out cases that take many seconds or gigabytes");
  CLI::Option* list = command->add_flag("--list", options->list, "Name the cases and what each holds, and run none");
  command->add_flag("--verbose", options->verbose, "Show every check, not only the telling one of each case");
  command->add_flag("--json", options->json, "Print all checks on stdout (schemas/stress.schema.json)")->excludes(list);
  addThreads(*command, options->threads);
  command->footer(R"(Scenes are made for the purpose, baked as drafts into a folder for temporary files, and evaluated by the runtime on the CPU and on OpenGL without a window.
Ends with 0 when every case passed and with 1 when one did not: that is an error of lightwell.

Examples:
  lightwell stress --fast
  lightwell stress --filter 'scale-*' --techniques lightmap --verbose)");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
