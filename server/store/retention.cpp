#include "server/store/retention.h"

#include <algorithm>
#include <set>
#include <system_error>
#include <vector>

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

/// Files below `folder`, unless they vanish under our hands.
template <class Visit>
void forEachFile(const fs::path& folder, const Visit& visit) {
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && at != end; at.increment(error)) {
    std::error_code gone;
    const uint64_t size = at->is_regular_file(gone) ? at->file_size(gone) : 0;
    if (!gone && size > 0) visit(*at, size);
  }
}

int64_t secondsAgoMs(double seconds) { return nowMs() - int64_t(seconds * 1000); }

}  // namespace

uint64_t folderBytes(const fs::path& folder) {
  uint64_t bytes = 0;
  forEachFile(folder, [&](const auto&, uint64_t size) { bytes += size; });
  return bytes;
}

Retention::Retention(fs::path task_folder, fs::path upload_folder, BlobStore& blobs, JobStore& jobs, const RetentionLimits& limits)
    : task_folder_(std::move(task_folder)), upload_folder_(std::move(upload_folder)), blobs_(blobs), jobs_(jobs), limits_(limits) {
  reconcile();
  task_bytes_ = folderBytes(task_folder_);
}

void Retention::reconcile() {
  const auto names = jobs_.allBlobs();
  const std::set<std::string> known(names.begin(), names.end());
  std::set<std::string> present;
  for (const auto& entry : blobs_.entries()) {
    if (!known.contains(entry.sha256)) blobs_.remove(entry.sha256);  // the last process ended between two steps
    present.insert(entry.sha256);
  }
  for (const auto& sha256 : known)
    if (!present.contains(sha256)) jobs_.forgetBlob(sha256, nowMs() + 1);
}

uint64_t Retention::storeBytes() {
  std::lock_guard lock(mutex_);
  return jobs_.blobBytes() + folderBytes(upload_folder_) + task_bytes_;
}

uint64_t Retention::removeTaskResults(uint64_t bytes) {
  struct File {
    fs::file_time_type used;
    fs::path path;
    uint64_t size;
  };
  std::vector<File> files;
  forEachFile(task_folder_, [&](const fs::directory_entry& entry, uint64_t size) {
    std::error_code gone;
    const auto used = entry.last_write_time(gone);
    if (!gone) files.push_back({used, entry.path(), size});
  });
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
  uint64_t removed = 0;
  for (const File& file : files) {
    if (removed >= bytes) break;
    std::error_code error;
    if (fs::remove(file.path, error)) removed += file.size;
  }
  return removed;
}

uint64_t Retention::removeBlobs(uint64_t bytes) {
  const int64_t before_ms = secondsAgoMs(limits_.upload_keep_s);
  uint64_t removed = 0;
  for (const auto& blob : jobs_.unreferenced(before_ms)) {
    if (removed >= bytes) break;
    if (!jobs_.forgetBlob(blob.sha256, before_ms)) continue;
    blobs_.remove(blob.sha256);
    removed += blob.size;
  }
  return removed;
}

bool Retention::makeRoom(uint64_t bytes) {
  std::lock_guard lock(mutex_);
  const auto excess = [&] {
    const uint64_t wanted = jobs_.blobBytes() + folderBytes(upload_folder_) + task_bytes_ + bytes;
    return wanted > limits_.max_store_bytes ? wanted - limits_.max_store_bytes : 0;
  };
  uint64_t over = excess();
  if (over == 0) return true;
  // Somewhat more than needed, so that a full store does not look for room at every call.
  const uint64_t extra = limits_.max_store_bytes / 20;
  task_bytes_ = folderBytes(task_folder_);
  if ((over = excess()) == 0) return true;
  const uint64_t removed = removeTaskResults(over + extra);
  task_bytes_ -= std::min(task_bytes_, removed);
  if ((over = excess()) == 0) return true;
  removeBlobs(over);
  return excess() == 0;
}

void Retention::sweep() {
  jobs_.removeFinishedBefore(secondsAgoMs(limits_.finished_keep_s));
  const uint64_t task_bytes = folderBytes(task_folder_);
  {
    std::lock_guard lock(mutex_);
    task_bytes_ = task_bytes;
  }
  makeRoom(0);
}

}  // namespace lightwell::server
