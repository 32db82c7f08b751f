// Reading a container without trusting it. No exceptions, no RTTI, no protobuf, no globals: this half is linked into the runtime.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "format/decode/layout.h"

namespace lightwell::format {

/// Values are part of the runtime's ABI (lw_result) and of `lightwell verify`'s messages; never reuse one.
enum class Status : int32_t {
  ok = 0,
  io_error = 10,            // the caller's reader failed
  truncated = 20,           // the file is shorter than its header says
  bad_magic = 21,
  too_new = 22,             // version_major is greater, or an unknown required section
  bad_header = 23,          // reserved bits, sizes or offsets that cannot be
  bad_checksum = 24,
  bad_directory = 25,       // the directory is not a valid message, or contradicts itself
  bad_chunk = 26,           // a chunk does not decode to the size that its shape gives, or overlaps another
  bad_section = 27,         // a known section lacks a chunk, or its values are out of range
  trailing_bytes = 28,      // bytes that belong to nothing
  limit_exceeded = 30,      // larger than the caller's limits allow
  out_of_memory = 31,
  not_found = 40,
  invalid_argument = 41,
};
const char* statusName(Status status);

/// Where and why: `chunk` is "section/name" or a part of the header; both point into static storage or the view.
struct Fault {
  Status status = Status::ok;
  uint64_t offset = 0;
  char what[96] = {};
  explicit operator bool() const { return status != Status::ok; }
};
}  // namespace lightwell::format
