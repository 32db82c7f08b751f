// What must hold for every input. A breach ends the process, as a sanitizer does: that is how a fuzzer learns of it.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace lightwell::fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace lightwell::fuzz
