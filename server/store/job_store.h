// Jobs and what is known about blobs, on disk: SQLite in WAL mode, every change synced before the call returns.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lightwell/v1/service.pb.h"
#include "server/store/sqlite.h"

namespace lightwell::server {

/// Milliseconds since 1970, UTC.
int64_t nowMs();

struct Submission {
  std::string client;
  v1::JobSpec spec;
  std::string idempotency_key;      // empty: none
  std::string request_key;          // equal keys: equal containers
  uint32_t max_unfinished_jobs = 0; // of the client
};

/// A job as it ends, or as its attempt does.
struct Ending {
  v1::JobState state = v1::JOB_STATE_FAILED;  // queued: it shall run again
  v1::JobProgress progress;
  std::vector<v1::JobWarning> warnings;
  v1::JobError error;                         // failed
  v1::JobResult result;                       // succeeded
  bool reusable = true;                       // succeeded: later requests of this key get this result
};

/// Thread-safe. Throws StoreError when the database fails.
class JobStore {
 public:
  explicit JobStore(const std::filesystem::path& file);

  /// Once, before anything else: what was running when the last process ended is queued again (or cancelled, if that was asked
  /// for). Returns how many.
  size_t recover();

  struct Submitted {
    v1::Job job;
    bool created;  // false: the idempotency key was known
  };
  /// Durable on return. A request that was answered before succeeds at once. Throws Failure: missing_file, too_many_jobs.
  Submitted submit(const Submission& submission);

  /// None when there is no such job of that client (an empty client sees all).
  std::optional<v1::Job> get(const std::string& id, const std::string& client = {});
  struct Page {
    std::vector<v1::Job> jobs;
    int64_t next = 0;  // continue before this; 0: the end
  };
  /// Newest first.
  Page list(const std::string& client, const std::vector<v1::JobState>& states, const std::string& label, int64_t before, uint32_t count);
  std::map<v1::JobState, int64_t> counts();

  /// The queued job whose turn it is: higher priority first; then the client with the fewest running jobs, then the one whose last start
  /// is longest ago; then the oldest. Jobs whose request is running already wait for its answer.
  std::optional<v1::Job> next();
  /// queued → running; false when it is not queued any more.
  bool start(const std::string& id);
  /// If the job's request has an answer by now: queued → succeeded, and true.
  bool answerFromCache(const std::string& id);
  /// To a final state, or running → queued. False when the job is not in a state that leads there.
  bool finish(const std::string& id, const Ending& ending);
  /// queued → cancelled; false when it is not queued.
  bool cancelQueued(const std::string& id);
  /// Notes that a running job shall be cancelled, also after a restart.
  void requestCancel(const std::string& id);
  /// How often something outside ended this job's worker.
  uint32_t interruptions(const std::string& id);
  /// Deletes a finished job. False when it is unknown or unfinished.
  bool remove(const std::string& id);
  /// Deletes jobs that finished before that time; returns how many.
  size_t removeFinishedBefore(int64_t time_ms);

  // ---- blobs

  void addBlob(const std::string& sha256, uint64_t size, const std::string& client);
  /// Whether it is known; counts as a use.
  bool touchBlob(const std::string& sha256);
  uint64_t blobBytes();
  uint64_t blobBytesOf(const std::string& client);
  struct Unreferenced {
    std::string sha256;
    uint64_t size;
  };
  /// Blobs that no unfinished job needs and no finished one has as its result, not used since `before_ms`; the longest unused first.
  std::vector<Unreferenced> unreferenced(int64_t before_ms);
  /// Forgets it, and answers that need it. False when it has been referenced or used since `before_ms` in the meantime.
  bool forgetBlob(const std::string& sha256, int64_t before_ms);
  std::vector<std::string> allBlobs();

 private:
  v1::Job read(const Statement& row) const;
  void refer(int64_t seq, const std::string& sha256);
  std::mutex mutex_;
  Database database_;
};

}  // namespace lightwell::server
