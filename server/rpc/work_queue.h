// A few threads for what may take a moment (a commit to the disk), so that gRPC's own threads never wait.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace lightwell::server {

class WorkQueue {
 public:
  explicit WorkQueue(unsigned threads);
  /// Runs what is queued, then ends.
  ~WorkQueue();
  void add(std::function<void()> work);

 private:
  void run();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> work_;
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lightwell::server
