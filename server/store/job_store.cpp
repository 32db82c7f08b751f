#include "server/store/job_store.h"

#include <sys/random.h>

#include <chrono>

#include "server/failure.h"
#include "server/job/job_state.h"

namespace lightwell::server {
namespace {

constexpr const char* kSchema = R"(
CREATE TABLE IF NOT EXISTS jobs(
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  client TEXT NOT NULL,
  idempotency_key TEXT,
  request_key TEXT NOT NULL,
  state INTEGER NOT NULL,
  priority INTEGER NOT NULL,
  label TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  started_ms INTEGER NOT NULL DEFAULT 0,
  finished_ms INTEGER NOT NULL DEFAULT 0,
  attempts INTEGER NOT NULL DEFAULT 0,
  interruptions INTEGER NOT NULL DEFAULT 0,
  cancel_requested INTEGER NOT NULL DEFAULT 0,
  start_order INTEGER NOT NULL DEFAULT 0,
  spec BLOB NOT NULL,
  ending BLOB,
  UNIQUE(client, idempotency_key));
CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs(state, client);
CREATE INDEX IF NOT EXISTS jobs_by_client ON jobs(client, state, priority DESC, seq);
CREATE INDEX IF NOT EXISTS jobs_by_client_start ON jobs(client, start_order);
CREATE INDEX IF NOT EXISTS jobs_by_start ON jobs(start_order);
CREATE INDEX IF NOT EXISTS jobs_by_request ON jobs(request_key, state);
CREATE TABLE IF NOT EXISTS answers(
  request_key TEXT PRIMARY KEY,
  sha256 TEXT NOT NULL,
  preview_sha256 TEXT NOT NULL,
  ending BLOB NOT NULL);
CREATE INDEX IF NOT EXISTS answers_by_blob ON answers(sha256);
CREATE TABLE IF NOT EXISTS blobs(
  sha256 TEXT PRIMARY KEY,
  size INTEGER NOT NULL,
  client TEXT NOT NULL,
  last_used_ms INTEGER NOT NULL);
CREATE INDEX IF NOT EXISTS blobs_by_use ON blobs(last_used_ms);
CREATE INDEX IF NOT EXISTS blobs_by_client ON blobs(client);
CREATE TABLE IF NOT EXISTS needs(
  seq INTEGER NOT NULL REFERENCES jobs(seq) ON DELETE CASCADE,
  sha256 TEXT NOT NULL REFERENCES blobs(sha256),
  PRIMARY KEY(seq, sha256)) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS needs_by_blob ON needs(sha256);
)";

constexpr const char* kColumns =
    "SELECT id, client, state, created_ms, started_ms, finished_ms, attempts, spec, ending, seq, request_key, cancel_requested FROM jobs ";

std::string newJobId() {
  uint64_t bits = 0;
  if (getrandom(&bits, sizeof bits, 0) != sizeof bits) throw std::runtime_error("the system gives no random numbers");
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(bits));
  return text;
}

/// What of a job is written at its end: the same message, without what has columns of its own.
std::string packed(const Ending& ending) {
  v1::Job job;
  *job.mutable_progress() = ending.progress;
  for (const auto& warning : ending.warnings) *job.add_warnings() = warning;
  if (ending.state == v1::JOB_STATE_FAILED) *job.mutable_error() = ending.error;
  if (ending.state == v1::JOB_STATE_SUCCEEDED) *job.mutable_result() = ending.result;
  return job.SerializeAsString();
}

}  // namespace

int64_t nowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

JobStore::JobStore(const std::filesystem::path& file) : database_(file) { database_.execute(kSchema); }

v1::Job JobStore::read(const Statement& row) const {
  v1::Job job;
  job.ParseFromString(row.text(8));
  job.set_id(row.text(0));
  job.set_client(row.text(1));
  job.set_state(v1::JobState(row.integer(2)));
  job.set_created_ms(row.integer(3));
  job.set_started_ms(row.integer(4));
  job.set_finished_ms(row.integer(5));
  job.set_attempts(uint32_t(row.integer(6)));
  job.mutable_spec()->ParseFromString(row.text(7));
  return job;
}

size_t JobStore::recover() {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  Statement(database_, "DELETE FROM needs WHERE seq IN (SELECT seq FROM jobs WHERE state = ? AND cancel_requested = 1)")
      .bind(v1::JOB_STATE_RUNNING).run();
  Statement(database_, "UPDATE jobs SET state = ?, finished_ms = ? WHERE state = ? AND cancel_requested = 1")
      .bind(v1::JOB_STATE_CANCELLED).bind(nowMs()).bind(v1::JOB_STATE_RUNNING).run();
  Statement(database_, "UPDATE jobs SET state = ? WHERE state = ?").bind(v1::JOB_STATE_QUEUED).bind(v1::JOB_STATE_RUNNING).run();
  const auto count = size_t(database_.changes());
  transaction.commit();
  return count;
}

void JobStore::refer(int64_t seq, const std::string& sha256) {
  Statement(database_, "INSERT OR IGNORE INTO needs VALUES(?, ?)").bind(seq).bind(sha256).run();
  Statement(database_, "UPDATE blobs SET last_used_ms = ? WHERE sha256 = ?").bind(nowMs()).bind(sha256).run();
}

JobStore::Submitted JobStore::submit(const Submission& s) {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (!s.idempotency_key.empty()) {
    Statement known(database_, std::string(kColumns) + "WHERE client = ? AND idempotency_key = ?");
    if (known.bind(s.client).bind(s.idempotency_key).step()) return {read(known), false};
  }
  for (const auto& file : s.spec.files()) {
    Statement blob(database_, "SELECT size FROM blobs WHERE sha256 = ?");
    if (!blob.bind(file.sha256()).step())
      throw Failure(FailureId::missing_file, "\"" + file.name() + "\" (" + file.sha256() + ") has not been uploaded");
    if (uint64_t(blob.integer(0)) != file.size())
      throw Failure(FailureId::invalid_request, "\"" + file.name() + "\" has " + std::to_string(blob.integer(0)) + " bytes, not " +
                                                    std::to_string(file.size()));
  }
  Statement unfinished(database_, "SELECT count(*) FROM jobs WHERE client = ? AND state IN (1, 2)");
  unfinished.bind(s.client).step();
  if (unfinished.integer(0) >= int64_t(s.max_unfinished_jobs))
    throw Failure(FailureId::too_many_jobs, "you have " + std::to_string(unfinished.integer(0)) + " unfinished jobs; the limit is " +
                                                std::to_string(s.max_unfinished_jobs));
  const std::string id = newJobId();
  Statement insert(database_,
                   "INSERT INTO jobs(id, client, idempotency_key, request_key, state, priority, label, created_ms, spec) "
                   "VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(id).bind(s.client);
  s.idempotency_key.empty() ? insert.bindNull() : insert.bind(s.idempotency_key);
  insert.bind(s.request_key).bind(v1::JOB_STATE_QUEUED).bind(s.spec.priority()).bind(s.spec.label()).bind(nowMs())
      .bindBlob(s.spec.SerializeAsString()).run();
  const int64_t seq = database_.lastRowId();

  Statement answer(database_, "SELECT ending, sha256, preview_sha256 FROM answers WHERE request_key = ?");
  if (answer.bind(s.request_key).step()) {
    for (int column = 1; column <= 2; ++column)
      if (const std::string blob = answer.text(column); !blob.empty()) refer(seq, blob);
    Statement(database_, "UPDATE jobs SET state = ?, finished_ms = ?, ending = ? WHERE seq = ?")
        .bind(v1::JOB_STATE_SUCCEEDED).bind(nowMs()).bindBlob(answer.text(0)).bind(seq).run();
  } else {
    for (const auto& file : s.spec.files()) refer(seq, file.sha256());
  }
  Statement row(database_, std::string(kColumns) + "WHERE seq = ?");
  row.bind(seq).step();
  Submitted submitted{read(row), true};
  transaction.commit();
  return submitted;
}

std::optional<v1::Job> JobStore::get(const std::string& id, const std::string& client) {
  std::lock_guard lock(mutex_);
  Statement row(database_, std::string(kColumns) + "WHERE id = ? AND (client = ? OR ? = '')");
  if (!row.bind(id).bind(client).bind(client).step()) return std::nullopt;
  return read(row);
}

JobStore::Page JobStore::list(const std::string& client, const std::vector<v1::JobState>& states, const std::string& label, int64_t before,
                              uint32_t count) {
  std::string wanted;
  for (const auto state : states) wanted += (wanted.empty() ? "" : ", ") + std::to_string(int(state));
  std::string sql = std::string(kColumns) + "WHERE (client = ?1 OR ?1 = '') AND (label = ?2 OR ?2 = '') AND (seq < ?3 OR ?3 = 0)";
  if (!states.empty()) sql += " AND state IN (" + wanted + ")";
  std::lock_guard lock(mutex_);
  Statement rows(database_, sql + " ORDER BY seq DESC LIMIT ?4");
  rows.bind(client).bind(label).bind(before).bind(int64_t(count) + 1);
  Page page;
  int64_t last = 0;
  while (rows.step()) {
    if (page.jobs.size() == count) {
      page.next = last;
      break;
    }
    page.jobs.push_back(read(rows));
    last = rows.integer(9);
  }
  return page;
}

std::map<v1::JobState, int64_t> JobStore::counts() {
  std::lock_guard lock(mutex_);
  std::map<v1::JobState, int64_t> counts;
  Statement rows(database_, "SELECT state, count(*) FROM jobs GROUP BY state");
  while (rows.step()) counts[v1::JobState(rows.integer(0))] = rows.integer(1);
  return counts;
}

std::optional<v1::Job> JobStore::next() {
  std::lock_guard lock(mutex_);
  // Of each client only the first in its own order can be the next, so that clients are compared rather than all their jobs.
  Statement row(database_, std::string(kColumns) + R"(AS job
    WHERE seq IN (
      SELECT (SELECT q.seq FROM jobs q
              WHERE q.client = c.client AND q.state = 1
                AND NOT EXISTS (SELECT 1 FROM jobs r WHERE r.request_key = q.request_key AND r.state = 2)
              ORDER BY q.priority DESC, q.seq LIMIT 1)
      FROM (SELECT DISTINCT client FROM jobs WHERE state = 1) c)
    ORDER BY priority DESC,
             (SELECT count(*) FROM jobs r WHERE r.client = job.client AND r.state = 2),
             (SELECT max(start_order) FROM jobs s WHERE s.client = job.client),
             seq
    LIMIT 1)");
  if (!row.step()) return std::nullopt;
  return read(row);
}

bool JobStore::start(const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement(database_,
            "UPDATE jobs SET state = ?, started_ms = ?, attempts = attempts + 1, start_order = (SELECT max(start_order) + 1 FROM jobs) "
            "WHERE id = ? AND state = ?")
      .bind(v1::JOB_STATE_RUNNING).bind(nowMs()).bind(id).bind(v1::JOB_STATE_QUEUED).run();
  return database_.changes() == 1;
}

bool JobStore::answerFromCache(const std::string& id) {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  Statement row(database_, "SELECT seq, a.ending, a.sha256, a.preview_sha256 FROM jobs JOIN answers a USING(request_key) WHERE id = ? AND state = ?");
  if (!row.bind(id).bind(v1::JOB_STATE_QUEUED).step()) return false;
  const int64_t seq = row.integer(0);
  Statement(database_, "DELETE FROM needs WHERE seq = ?").bind(seq).run();
  for (int column = 2; column <= 3; ++column)
    if (const std::string blob = row.text(column); !blob.empty()) refer(seq, blob);
  Statement(database_, "UPDATE jobs SET state = ?, finished_ms = ?, ending = ? WHERE seq = ?")
      .bind(v1::JOB_STATE_SUCCEEDED).bind(nowMs()).bindBlob(row.text(1)).bind(seq).run();
  transaction.commit();
  return true;
}

bool JobStore::finish(const std::string& id, const Ending& ending) {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  Statement row(database_, "SELECT seq, state, request_key FROM jobs WHERE id = ?");
  if (!row.bind(id).step() || !isTransition(v1::JobState(row.integer(1)), ending.state)) return false;
  const int64_t seq = row.integer(0);
  if (ending.state == v1::JOB_STATE_QUEUED) {
    Statement(database_, "UPDATE jobs SET state = ?, interruptions = interruptions + 1 WHERE seq = ?").bind(ending.state).bind(seq).run();
  } else {
    Statement(database_, "UPDATE jobs SET state = ?, finished_ms = ?, ending = ? WHERE seq = ?")
        .bind(ending.state).bind(nowMs()).bindBlob(packed(ending)).bind(seq).run();
    Statement(database_, "DELETE FROM needs WHERE seq = ?").bind(seq).run();
  }
  if (ending.state == v1::JOB_STATE_SUCCEEDED) {
    refer(seq, ending.result.sha256());
    if (!ending.result.preview_sha256().empty()) refer(seq, ending.result.preview_sha256());
    if (ending.reusable) {
      Ending answer = ending;
      answer.result.set_from_cache(true);
      answer.progress = {};
      Statement(database_, "INSERT OR REPLACE INTO answers VALUES(?, ?, ?, ?)")
          .bind(row.text(2)).bind(ending.result.sha256()).bind(ending.result.preview_sha256()).bindBlob(packed(answer)).run();
    }
  }
  transaction.commit();
  return true;
}

bool JobStore::cancelQueued(const std::string& id) {
  std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  Statement(database_, "UPDATE jobs SET state = ?, finished_ms = ? WHERE id = ? AND state = ?")
      .bind(v1::JOB_STATE_CANCELLED).bind(nowMs()).bind(id).bind(v1::JOB_STATE_QUEUED).run();
  const bool cancelled = database_.changes() == 1;
  if (cancelled) Statement(database_, "DELETE FROM needs WHERE seq = (SELECT seq FROM jobs WHERE id = ?)").bind(id).run();
  transaction.commit();
  return cancelled;
}

void JobStore::requestCancel(const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement(database_, "UPDATE jobs SET cancel_requested = 1 WHERE id = ?").bind(id).run();
}

uint32_t JobStore::interruptions(const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement row(database_, "SELECT interruptions FROM jobs WHERE id = ?");
  return row.bind(id).step() ? uint32_t(row.integer(0)) : 0;
}

bool JobStore::remove(const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement(database_, "DELETE FROM jobs WHERE id = ? AND state NOT IN (1, 2)").bind(id).run();
  return database_.changes() == 1;
}

size_t JobStore::removeFinishedBefore(int64_t time_ms) {
  std::lock_guard lock(mutex_);
  Statement(database_, "DELETE FROM jobs WHERE state NOT IN (1, 2) AND finished_ms < ?").bind(time_ms).run();
  return size_t(database_.changes());
}

}  // namespace lightwell::server
