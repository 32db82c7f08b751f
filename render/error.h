// How drawing can end without a picture.
#pragma once
#include <stdexcept>
#include <string>

#include "lightwell/lightwell.h"

namespace lightwell::render {

/// The container or OpenGL refused: what the runtime said, and its result (LW_GL_… when OpenGL is the reason).
class RenderError : public std::runtime_error {
 public:
  RenderError(lw_result result, const std::string& what)
      : std::runtime_error(what + " (" + lw_result_name(result) + ")"), result(result) {}
  /// Whether the file is to blame (unreadable, damaged, too new), rather than this machine's OpenGL or this program.
  bool containerFault() const { return result >= LW_IO_ERROR && result <= LW_LIMIT_EXCEEDED; }
  lw_result result;
};

/// A camera or lights file was rejected: which file, which key, why.
class FileError : public std::runtime_error {
 public:
  FileError(const std::string& file, const std::string& place, const std::string& reason)
      : std::runtime_error(file + (place.empty() ? "" : ": " + place) + ": " + reason), file(file), place(place), reason(reason) {}
  std::string file, place, reason;
};

/// Throws RenderError when `result` is a failure of the call named `what`.
inline void check(lw_result result, const char* what) {
  if (result != LW_OK) throw RenderError(result, what);
}

}  // namespace lightwell::render
