#include "precompute/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace lightwell {

int hardwareThreads() { return std::max(1u, std::thread::hardware_concurrency()); }

void parallelFor(size_t count, size_t grain, int threads, const CancelFlag* cancel,
                 const std::function<void(size_t, size_t)>& body) {
  grain = std::max<size_t>(grain, 1);
  const size_t pieces = (count + grain - 1) / grain;
  const size_t workers = std::min<size_t>(pieces, threads > 0 ? threads : hardwareThreads());
  std::atomic<size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    try {
      for (;;) {
        const size_t piece = next.fetch_add(1);
        if (piece >= pieces || stop.load(std::memory_order_relaxed)) return;
        if (cancel) cancel->check();
        body(piece * grain, std::min(count, (piece + 1) * grain));
      }
    } catch (...) {
      std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
      stop = true;
    }
  };
  std::vector<std::thread> pool;
  for (size_t i = 1; i < workers; ++i) pool.emplace_back(work);
  work();
  for (auto& thread : pool) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace lightwell
