// What a computation tells about itself while it runs: repairs it made, and whether it should stop.
#pragma once
#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "precompute/core/error.h"

namespace lightwell {

/// A repair of the input, or something implausible in it. `place` is a glTF path or a file; may be empty.
struct Warning {
  std::string place, message;
};

/// Collects warnings from any thread, in the order of arrival. Owned by whoever starts the work.
class Diagnostics {
 public:
  void warn(std::string place, std::string message) {
    std::lock_guard lock(mutex_);
    warnings_.push_back({std::move(place), std::move(message)});
  }
  std::vector<Warning> warnings() const {
    std::lock_guard lock(mutex_);
    return warnings_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Warning> warnings_;
};

/// Set from a signal handler or another thread; polled by long loops at least every few milliseconds.
class CancelFlag {
 public:
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  void check() const {
    if (cancelled()) throw Cancelled();
  }

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace lightwell
