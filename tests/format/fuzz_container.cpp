// libFuzzer: any bytes as a container, as they are and with the checksums of header and directory put right.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/decode/checksum.h"
#include "format/decode/endian.h"
#include "format/decode/layout.h"
#include "format/encode/verify.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell::format;
  const Limits limits{.decoded_bytes = 1 << 24};
  verify(memorySource(data, size), limits);
  if (size < kHeaderBytes) return 0;
  std::vector<uint8_t> file(data, data + size);
  const uint64_t directory_bytes = loadLittle<uint64_t>(&file[32]);
  storeLittle(&file[16], uint64_t(size));
  if (directory_bytes <= size - kHeaderBytes) storeLittle(&file[40], checksum(file.data() + kHeaderBytes, directory_bytes));
  storeLittle(&file[56], checksum(file.data(), 56));
  verify(memorySource(file.data(), file.size()), limits);
  return 0;
}
