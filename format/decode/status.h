// How reading a container can fail.
#pragma once
#include <cstdint>

namespace lightwell::format {

/// Values are part of the runtime's ABI (lw_result) and of `lightwell verify`'s messages; never reuse one.
enum class Status : int32_t {
  ok = 0,
  io_error = 10,            // the caller's reader failed
  truncated = 20,           // the file is shorter than its header says
  bad_magic = 21,
  too_new = 22,             // version_major is greater, an unknown required section, or a codec or element type of a later version
  bad_header = 23,          // reserved bits, sizes or offsets that cannot be
  bad_checksum = 24,
  bad_directory = 25,       // the directory is not a valid message, or contradicts itself
  bad_chunk = 26,           // a chunk does not decode to the size that its shape gives, or overlaps another
  bad_section = 27,         // a known section lacks a chunk, or its values are out of range
  trailing_bytes = 28,      // bytes that belong to nothing: after the end, in a gap, or padding that is not zero
  limit_exceeded = 30,      // larger than the caller's limits allow
  out_of_memory = 31,
  not_found = 40,
  invalid_argument = 41,
};
/// "bad_chunk" and so on; "unknown" for other values. Static storage.
const char* statusName(Status status);

/// The outcome of a call: why it failed and at which byte of the file. `what` names the chunk as "section/name" or the part of the header.
struct Fault {
  Status status = Status::ok;
  uint64_t offset = 0;
  char what[160] = {};
  /// True when something failed.
  explicit operator bool() const { return status != Status::ok; }
};

/// A Fault with a printf-formatted message, cut at the size of Fault::what.
[[gnu::format(printf, 3, 4)]] Fault makeFault(Status status, uint64_t offset, const char* format, ...);

}  // namespace lightwell::format
