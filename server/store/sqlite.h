// SQLite behind RAII: nothing but what the stores need.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace lightwell::server {

/// The database refused: disk full, I/O error, damage.
class StoreError : public std::runtime_error {
 public:
  StoreError(int code, const std::string& message) : std::runtime_error(message), code(code) {}
  bool diskFull() const;
  int code;  // SQLite's primary result code
};

class Database;

/// One prepared statement, bound by position from 1 in the order of bind() calls.
class Statement {
 public:
  Statement(Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int64_t value);
  Statement& bind(std::string_view text);
  Statement& bindBlob(std::string_view bytes);
  Statement& bindNull();
  /// True when there is a row. Throws StoreError.
  bool step();
  /// step() for statements without rows.
  void run() { step(); }

  int64_t integer(int column) const;
  std::string text(int column) const;  // blobs too; empty for NULL

 private:
  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

/// Not thread-safe: the owner serialises calls.
class Database {
 public:
  /// Opens or creates; WAL, every commit synced to the disk. Throws StoreError.
  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql);
  /// Rows that the last statement changed.
  int64_t changes() const;
  int64_t lastRowId() const;

 private:
  friend class Statement;
  [[noreturn]] void fail(int code) const;
  sqlite3* handle_ = nullptr;
};

/// Rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }
  ~Transaction();
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace lightwell::server
