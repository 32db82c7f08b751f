// Handles that close themselves, and what the tests expect of the message callback.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell::test {

/// Closes a container that was opened in memory, before the bytes it reads in place go.
struct CloseBeforeBytes {
  std::vector<uint8_t> bytes;
  void operator()(lw_container* container) const { lw_close(container); }
};
using Container = std::unique_ptr<lw_container, CloseBeforeBytes>;
using Prm = std::unique_ptr<lw_prm, decltype(&lw_prm_release)>;

/// Counts the caller's memory and keeps the last message.
struct Host {
  size_t allocations = 0, live = 0, fail_at = SIZE_MAX;
  std::string message;
  lw_result result = LW_OK;

  lw_config config() {
    lw_config c = LW_CONFIG_INIT;
    c.allocate = [](void* user, size_t bytes) -> void* {
      auto& host = *static_cast<Host*>(user);
      if (host.allocations++ >= host.fail_at) return nullptr;
      ++host.live;
      return std::malloc(bytes);
    };
    c.release = [](void* user, void* memory) {
      --static_cast<Host*>(user)->live;
      std::free(memory);
    };
    c.message = [](void* user, lw_result r, const char* text) {
      static_cast<Host*>(user)->message = text;
      static_cast<Host*>(user)->result = r;
    };
    c.allocator_user = c.message_user = this;
    return c;
  }
};

inline Container openMemory(std::vector<uint8_t> bytes, const lw_config* config = nullptr) {
  lw_container* container = nullptr;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), config, &container), LW_OK);
  return {container, {std::move(bytes)}};
}
inline Prm loadPrm(const lw_container* container) {
  lw_prm* prm = nullptr;
  EXPECT_EQ(lw_prm_load(container, &prm), LW_OK);
  return {prm, lw_prm_release};
}

}  // namespace lightwell::test
