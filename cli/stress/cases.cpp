#include "cli/stress/cases.h"

#include <fnmatch.h>

namespace lightwell::stress {

std::vector<Case> allCases() {
  std::vector<Case> all;
  for (const auto& group : {placeCases(), reflectionCases(), lightCases(), geometryCases(), skyCases(), dynamicCases(), sizeCases()}) all.insert(all.end(), group.begin(), group.end());
  return all;
}

bool matches(const std::string& pattern, const std::string& name) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; }

}  // namespace lightwell::stress
