// Work that must be over by a moment, through the flag that long loops poll anyway.
#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "precompute/core/diagnostics.h"

namespace lightwell::report {

/// Sets its flag when `outer` is set or `end` has passed, within 50 ms.
class TimeBox {
 public:
  using Clock = std::chrono::steady_clock;
  TimeBox(const CancelFlag& outer, Clock::time_point end) : outer_(outer), end_(end), thread_([this] { watch(); }) {}
  ~TimeBox() {
    {
      std::lock_guard lock(mutex_);
      done_ = true;
    }
    ended_.notify_all();
    thread_.join();
  }
  TimeBox(const TimeBox&) = delete;
  TimeBox& operator=(const TimeBox&) = delete;

  const CancelFlag& flag() const { return flag_; }

 private:
  void watch() {
    std::unique_lock lock(mutex_);
    while (!done_ && !flag_.cancelled()) {
      ended_.wait_for(lock, std::chrono::milliseconds(50));
      if (outer_.cancelled() || Clock::now() >= end_) flag_.cancel();
    }
  }

  const CancelFlag& outer_;
  const Clock::time_point end_;
  CancelFlag flag_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace lightwell::report
