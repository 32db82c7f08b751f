// The part of JobStore that knows blobs: who uploaded them, when they were used, who needs them.
#include "server/store/job_store.h"

namespace lightwell::server {

void JobStore::addBlob(const std::string& sha256, uint64_t size, const std::string& client) {
  std::lock_guard lock(mutex_);
  Statement(database_,
            "INSERT INTO blobs VALUES(?1, ?2, ?3, ?4) ON CONFLICT(sha256) DO UPDATE SET last_used_ms = excluded.last_used_ms")
      .bind(sha256).bind(int64_t(size)).bind(client).bind(nowMs()).run();
}

bool JobStore::touchBlob(const std::string& sha256) {
  std::lock_guard lock(mutex_);
  Statement(database_, "UPDATE blobs SET last_used_ms = ? WHERE sha256 = ?").bind(nowMs()).bind(sha256).run();
  return database_.changes() == 1;
}

uint64_t JobStore::blobBytes() {
  std::lock_guard lock(mutex_);
  Statement row(database_, "SELECT total(size) FROM blobs");
  row.step();
  return uint64_t(row.integer(0));
}

uint64_t JobStore::blobBytesOf(const std::string& client) {
  std::lock_guard lock(mutex_);
  Statement row(database_, "SELECT total(size) FROM blobs WHERE client = ?");
  row.bind(client).step();
  return uint64_t(row.integer(0));
}

std::vector<JobStore::Unreferenced> JobStore::unreferenced(int64_t before_ms) {
  std::lock_guard lock(mutex_);
  Statement rows(database_,
                 "SELECT sha256, size FROM blobs WHERE last_used_ms < ? AND NOT EXISTS (SELECT 1 FROM needs WHERE needs.sha256 = "
                 "blobs.sha256) ORDER BY last_used_ms");
  rows.bind(before_ms);
  std::vector<Unreferenced> found;
  while (rows.step()) found.push_back({rows.text(0), uint64_t(rows.integer(1))});
  return found;
}

bool JobStore::forgetBlob(const std::string& sha256, int64_t before_ms) {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  Statement(database_,
            "DELETE FROM blobs WHERE sha256 = ? AND last_used_ms < ? AND NOT EXISTS (SELECT 1 FROM needs WHERE needs.sha256 = "
            "blobs.sha256)")
      .bind(sha256).bind(before_ms).run();
  const bool forgotten = database_.changes() == 1;
  if (forgotten) Statement(database_, "DELETE FROM answers WHERE sha256 = ?1 OR preview_sha256 = ?1").bind(sha256).run();
  transaction.commit();
  return forgotten;
}

std::vector<std::string> JobStore::allBlobs() {
  std::lock_guard lock(mutex_);
  Statement rows(database_, "SELECT sha256 FROM blobs");
  std::vector<std::string> names;
  while (rows.step()) names.push_back(rows.text(0));
  return names;
}

}  // namespace lightwell::server
