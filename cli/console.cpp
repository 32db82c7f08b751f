#include "cli/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace lightwell::cli {
namespace {

constexpr auto kPlainInterval = std::chrono::seconds(5);

void print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

size_t terminalColumns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string withPrefix(double value, const char* unit) {
  static constexpr const char* kPrefixes[] = {"", "k", "M", "G", "T"};
  int prefix = 0;
  while (value >= 999.5 && prefix < 4) value /= 1000, ++prefix;
  char text[48];
  std::snprintf(text, sizeof text, prefix && value < 99.95 ? "%.1f" : "%.0f", value);
  const std::string suffix = std::string(kPrefixes[prefix]) + unit;
  return suffix.empty() ? text : text + (" " + suffix);
}

}  // namespace

Console::Console() {
  const char* term = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) && term && std::strcmp(term, "dumb") != 0;
  const char* no_colour = std::getenv("NO_COLOR");
  colour_ = terminal_ && !(no_colour && *no_colour);
}

std::string Console::painted(std::string_view text, const char* code) const {
  return colour_ ? "\x1b[" + std::string(code) + "m" + std::string(text) + "\x1b[0m" : std::string(text);
}

void Console::clear() {
  if (std::exchange(progress_shown_, false)) print("\r\x1b[K");
}

void Console::progress(std::string_view stage, std::string_view text) {
  std::lock_guard lock(mutex_);
  if (terminal_) {
    print("\r\x1b[K" + std::string(text.substr(0, terminalColumns() - 1)));
    progress_shown_ = true;
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (stage == stage_ && now - last_print_ < kPlainInterval) return;
  stage_ = stage;
  last_print_ = now;
  print(std::string(text) + "\n");
}

void Console::line(std::string_view text) {
  std::lock_guard lock(mutex_);
  clear();
  print(std::string(text) + "\n");
}

void Console::warning(const Warning& warning) {
  line(painted("warning:", "33") + " " + (warning.place.empty() ? "" : warning.place + ": ") + warning.message);
}

void Console::error(std::string_view text) { line(painted("error:", "1;31") + " " + std::string(text)); }

std::string formatDuration(double seconds) {
  const long total = std::lround(seconds);
  char text[48];
  if (total < 60)
    std::snprintf(text, sizeof text, seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
  else if (total < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld", total / 60, total % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", total / 3600, total / 60 % 60, total % 60);
  return text;
}

std::string formatBytes(double bytes) { return withPrefix(bytes, "B"); }
std::string formatCount(double count) { return withPrefix(count, ""); }

}  // namespace lightwell::cli
