// XXH3-64 (seed 0), the checksum of header, directory and chunks.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lightwell::format {

uint64_t checksum(const void* data, size_t bytes);

/// The same over data that arrives in pieces.
class ChecksumStream {
 public:
  ChecksumStream();
  void update(const void* data, size_t bytes);
  uint64_t digest() const;

 private:
  alignas(64) unsigned char state_[640];
};

}  // namespace lightwell::format
