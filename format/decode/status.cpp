#include "format/decode/status.h"

#include <cstdarg>
#include <cstdio>

namespace lightwell::format {

const char* statusName(Status status) {
  switch (status) {
    case Status::ok: return "ok";
    case Status::io_error: return "io_error";
    case Status::truncated: return "truncated";
    case Status::bad_magic: return "bad_magic";
    case Status::too_new: return "too_new";
    case Status::bad_header: return "bad_header";
    case Status::bad_checksum: return "bad_checksum";
    case Status::bad_directory: return "bad_directory";
    case Status::bad_chunk: return "bad_chunk";
    case Status::bad_section: return "bad_section";
    case Status::trailing_bytes: return "trailing_bytes";
    case Status::limit_exceeded: return "limit_exceeded";
    case Status::out_of_memory: return "out_of_memory";
    case Status::not_found: return "not_found";
    case Status::invalid_argument: return "invalid_argument";
  }
  return "unknown";
}

Fault makeFault(Status status, uint64_t offset, const char* format, ...) {
  Fault fault;
  fault.status = status;
  fault.offset = offset;
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(fault.what, sizeof(fault.what), format, arguments);
  va_end(arguments);
  return fault;
}

}  // namespace lightwell::format
