// Any bytes as a container: the format's reader and verify.
#include <cstddef>
#include <cstdint>

#include "format/encode/verify.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell::format;
  verify(memorySource(data, size), {.decoded_bytes = 1 << 24});
  return 0;
}
