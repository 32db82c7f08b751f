// What verify found, in words for a failed expectation.
#pragma once
#include <string>
#include <vector>

#include "format/encode/verify.h"

namespace lightwell::format {

inline std::string listed(const std::vector<Issue>& issues) {
  std::string text;
  for (const Issue& issue : issues) text += std::to_string(int(issue.id)) + " " + issue.place + ": " + issue.message + "\n";
  return text;
}

}  // namespace lightwell::format
