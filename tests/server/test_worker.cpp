// lightwell_worker with faults: the scene's name says which. Other scenes are baked as ever.
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <vector>

#include "server/execution/worker.h"

namespace {

/// Touches memory until there is none.
void exhaustMemory() {
  std::vector<std::vector<char>> taken;
  try {
    while (true) taken.emplace_back(16 << 20, char(1));
  } catch (const std::bad_alloc&) {
    taken.clear();
    std::fputs("no memory left\n", stderr);
    std::abort();
  }
}

}  // namespace

int main() {
  return lightwell::server::runWorker([](const lightwell::v1::WorkerRequest& request) {
    const std::string& scene = request.spec().scene();
    if (scene == "crash.gltf") {
      std::fputs("about to crash on purpose\n", stderr);
      signal(SIGSEGV, SIG_DFL);  // not a sanitizer's
      raise(SIGSEGV);
    }
    if (scene == "exhaust.gltf") exhaustMemory();
    if (scene == "hang.gltf")
      while (true) pause();
    if (scene == "exit.gltf") _exit(0);
    if (scene == "slow.gltf") sleep(1);
  });
}
