// What people see on stderr: progress, warnings, results. Colour and in-place updates only on a terminal.
#pragma once
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "precompute/core/diagnostics.h"

namespace lightwell::cli {

/// Thread-safe.
class Console {
 public:
  /// Looks at stderr, TERM and NO_COLOR (https://no-color.org).
  Console();

  /// The present state, one line without a newline. On a terminal it replaces the last one; elsewhere a line is printed when its
  /// `stage` is new, and every five seconds.
  void progress(std::string_view stage, std::string_view text);
  void line(std::string_view text);
  void warning(const Warning& warning);
  void error(std::string_view text);

 private:
  void clear();  // of the progress line
  std::string painted(std::string_view text, const char* code) const;
  std::mutex mutex_;
  bool terminal_, colour_;
  bool progress_shown_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point last_print_;
};

/// "1:04" or "12 s"; "1:02:03" from an hour on.
std::string formatDuration(double seconds);
/// "1.2 MB", "640 B": decimal units.
std::string formatBytes(double bytes);
/// "1.2 M", "640": decimal prefixes.
std::string formatCount(double count);

}  // namespace lightwell::cli
