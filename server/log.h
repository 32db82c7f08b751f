// Structured logs on stderr: an event, and fields. Text for people, or a JSON object a line.
#pragma once
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace spdlog {
class logger;
}

namespace lightwell::server {

enum class LogLevel { debug, info, warning, error };

/// Thread-safe.
class Log {
 public:
  /// `level`: debug, info, warning or error.
  Log(std::string_view level, bool as_json);
  using Field = std::pair<const char*, std::string>;
  /// "job ended", {{"job", …}, {"state", …}}.
  void operator()(LogLevel level, std::string_view event, std::initializer_list<Field> fields = {}) const;

 private:
  std::shared_ptr<spdlog::logger> logger_;
  bool as_json_;
};

}  // namespace lightwell::server
