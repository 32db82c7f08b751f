// lightwell verify: every checksum and every invariant of a container.
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "format/encode/reader.h"
#include "format/encode/verify.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

struct Options {
  fs::path container;
  bool json = false;
};

void run(Session& session, const Options& options) {
  checkReadable(options.container);
  const std::vector<format::Issue> issues = format::verify(options.container);
  const bool sound = format::isSound(issues);
  if (options.json) {
    json document{{"file", options.container.string()}, {"sound", sound}, {"issues", json::array()}};
    for (const auto& issue : issues)
      document["issues"].push_back({{"id", int(issue.id)},
                                    {"status", format::statusName(issue.status)},
                                    {"note", issue.note},
                                    {"offset", issue.offset},
                                    {"place", issue.place},
                                    {"message", issue.message}});
    printJson(document);
  }
  for (const auto& issue : issues)
    session.console.line((issue.note ? "note " : "issue ") + std::to_string(int(issue.id)) + " at byte " + std::to_string(issue.offset) +
                         ", " + issue.place + ": " + issue.message);
  if (sound) {
    session.console.line(options.container.string() + ": sound");
    return;
  }
  const auto first = std::find_if(issues.begin(), issues.end(), [](const auto& issue) { return !issue.note; });
  throw format::ContainerError(options.container.string(),
                               format::makeFault(first->status, first->offset, "%s: %s", first->place.c_str(), first->message.c_str()));
}

}  // namespace

void addVerify(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("verify", "Check every checksum and every invariant of a container");
  command->add_option("container", options->container, "Container to check")->required()->type_name("OUT.lwc");
  command->add_flag("--json", options->json, "Print the issues on stdout (schemas/verify.schema.json)");
  command->footer("Ends with 0 when the container is sound and with 4 when it is not.\n\nExample:\n  lightwell verify room.lwc");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
