#include "runtime/src/host.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace lightwell::runtime {

void* Host::allocate(size_t bytes) const { return allocator_.allocate ? allocator_.allocate(allocator_.user, bytes) : std::malloc(bytes); }

void Host::release(void* memory) const {
  if (!memory) return;
  if (allocator_.allocate) allocator_.release(allocator_.user, memory);
  else std::free(memory);
}

lw_result Host::fail(lw_result result, const char* format, ...) const {
  if (!message_) return result;
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  message_(message_user_, result, text);
  return result;
}

lw_result Host::fail(const format::Fault& fault) const {
  return fail(static_cast<lw_result>(fault.status), "%s (%s at byte %llu)", fault.what, format::statusName(fault.status),
              static_cast<unsigned long long>(fault.offset));
}

bool allFinite(const float* values, size_t count) {
  float sum = 0;  // 0 * x is 0 unless x is infinite or NaN: one comparison for all
  for (size_t i = 0; i < count; ++i) sum += 0.0f * values[i];
  return sum == 0.0f;
}

}  // namespace lightwell::runtime

const char* lw_result_name(lw_result result) {
  switch (result) {
#define LW_CASE(name) \
  case name: return #name
    LW_CASE(LW_OK);
    LW_CASE(LW_IO_ERROR);
    LW_CASE(LW_TRUNCATED);
    LW_CASE(LW_BAD_MAGIC);
    LW_CASE(LW_TOO_NEW);
    LW_CASE(LW_BAD_HEADER);
    LW_CASE(LW_BAD_CHECKSUM);
    LW_CASE(LW_BAD_DIRECTORY);
    LW_CASE(LW_BAD_CHUNK);
    LW_CASE(LW_BAD_SECTION);
    LW_CASE(LW_TRAILING_BYTES);
    LW_CASE(LW_LIMIT_EXCEEDED);
    LW_CASE(LW_OUT_OF_MEMORY);
    LW_CASE(LW_NOT_FOUND);
    LW_CASE(LW_INVALID_ARGUMENT);
    LW_CASE(LW_GL_UNSUPPORTED);
    LW_CASE(LW_GL_FAILED);
#undef LW_CASE
  }
  return "LW_UNKNOWN";
}

uint32_t lw_version(void) { return LW_VERSION; }
