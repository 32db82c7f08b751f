#include "server/store/sqlite.h"

#include <sqlite3.h>

namespace lightwell::server {

bool StoreError::diskFull() const { return code == SQLITE_FULL; }

Statement::Statement(Database& database, std::string_view sql) : database_(database) {
  const int code = sqlite3_prepare_v2(database.handle_, sql.data(), int(sql.size()), &statement_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}
Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(int64_t value) {
  sqlite3_bind_int64(statement_, ++bound_, value);
  return *this;
}
Statement& Statement::bind(std::string_view text) {
  sqlite3_bind_text(statement_, ++bound_, text.data(), int(text.size()), SQLITE_TRANSIENT);
  return *this;
}
Statement& Statement::bindBlob(std::string_view bytes) {
  sqlite3_bind_blob(statement_, ++bound_, bytes.data() ? bytes.data() : "", int(bytes.size()), SQLITE_TRANSIENT);
  return *this;
}
Statement& Statement::bindNull() {
  sqlite3_bind_null(statement_, ++bound_);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail(code);
  return false;
}

int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }
std::string Statement::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  return bytes ? std::string(static_cast<const char*>(bytes), size_t(sqlite3_column_bytes(statement_, column))) : std::string();
}

Database::Database(const std::filesystem::path& file) {
  const int code = sqlite3_open_v2(file.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  try {
    if (code != SQLITE_OK) fail(code);
    sqlite3_busy_timeout(handle_, 5000);
    // FULL: a commit is on the disk when it returns, also through a power failure.
    execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}
Database::~Database() { sqlite3_close(handle_); }

void Database::execute(const char* sql) {
  const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}
int64_t Database::changes() const { return sqlite3_changes64(handle_); }
int64_t Database::lastRowId() const { return sqlite3_last_insert_rowid(handle_); }
void Database::fail(int code) const {
  throw StoreError(code & 0xff, std::string("the job store: ") + (handle_ ? sqlite3_errmsg(handle_) : sqlite3_errstr(code)));
}

Transaction::~Transaction() {
  if (open_) try {
      database_.execute("ROLLBACK");
    } catch (const StoreError&) {  // the statement that failed has rolled back already
    }
}
void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace lightwell::server
