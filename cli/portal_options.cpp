#include "cli/portal_options.h"

#include <charconv>

#include "precompute/core/error.h"

namespace lightwell::cli {
namespace {

bool matches(const std::string& pattern, const std::string& name) {
  return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

}  // namespace

void addPortalStates(CLI::App& command, std::vector<std::string>& words, const std::string& what) {
  command.add_option("--portal", words, what + ": 0 is shut, 1 wide open; may be repeated, and NAME may end in *. Without it all are shut")->type_name("NAME=OPEN")->allow_extra_args(false);
}

std::vector<PortalState> parsePortalStates(const std::vector<std::string>& words) {
  std::vector<PortalState> states;
  for (const std::string& word : words) {
    const size_t equals = word.rfind('=');
    float open = -1;
    if (equals != std::string::npos) {
      const char* end = word.data() + word.size();
      const auto [rest, error] = std::from_chars(word.data() + equals + 1, end, open);
      if (error != std::errc() || rest != end) open = -1;
    }
    if (equals == 0 || !(open >= 0 && open <= 1)) throw UsageError("--portal: \"" + word + "\" is not NAME=OPEN with OPEN from 0 to 1");
    states.emplace_back(word.substr(0, equals), open);
  }
  return states;
}

std::vector<float> portalsOpen(const std::vector<PortalState>& states, const std::vector<scene::Portal>& portals) {
  std::vector<float> open(portals.size(), 0.0f);
  for (const auto& [name, how_far] : states) {
    bool found = false;
    for (size_t i = 0; i < portals.size(); ++i)
      if (matches(name, portals[i].name)) open[i] = how_far, found = true;
    if (found) continue;
    std::string message = "--portal: there is no portal \"" + name + "\"";
    for (size_t i = 0; i < portals.size(); ++i) message += (i == 0 ? "; portals are " : ", ") + portals[i].name;
    throw UsageError(message + (portals.empty() ? "; there are none" : ""));
  }
  return open;
}

}  // namespace lightwell::cli
