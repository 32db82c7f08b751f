// Ctrl-C and SIGTERM: the work stops cleanly within a second, and leaves no temporary file.
#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>

#include "precompute/core/diagnostics.h"

namespace lightwell::cli {

/// Make one, first thing in main: it blocks both signals for all threads to come and waits for them in a thread of its own. On a signal
/// the flag is set, which polling code answers. Code that cannot poll (a library building something large) is not waited for: after a
/// grace period the process ends with 130, but never while an OutputGuard lives.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  const CancelFlag& flag() const { return flag_; }

  /// Held while a file is being written that must appear whole or not at all. Throws Cancelled instead of beginning after a signal.
  class OutputGuard {
   public:
    explicit OutputGuard(Interrupt& interrupt);

   private:
    std::lock_guard<std::mutex> lock_;
  };

 private:
  void wait();
  CancelFlag flag_;
  std::mutex output_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace lightwell::cli
