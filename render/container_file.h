// A container opened from a file and closed at the end of a scope.
#pragma once
#include <cstdio>
#include <memory>
#include <string>

#include "render/error.h"

namespace lightwell::render {

struct CloseContainer {
  void operator()(lw_container* container) const { lw_close(container); }
};
using ContainerFile = std::unique_ptr<lw_container, CloseContainer>;

/// What the runtime has to say about a failure goes to stderr. Throws RenderError naming the file.
inline ContainerFile openContainer(const std::string& file) {
  lw_config config = LW_CONFIG_INIT;
  config.message = [](void*, lw_result result, const char* text) {
    if (result != LW_NOT_FOUND) std::fprintf(stderr, "%s: %s\n", lw_result_name(result), text);  // optional arrays are asked for
  };
  lw_container* container = nullptr;
  check(lw_open_file(file.c_str(), &config, &container), file.c_str());
  return ContainerFile(container);
}

}  // namespace lightwell::render
