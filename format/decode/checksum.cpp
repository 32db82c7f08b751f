#include "format/decode/checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <new>

namespace lightwell::format {

uint64_t checksum(const void* data, size_t bytes) { return XXH3_64bits(data, bytes); }

ChecksumStream::ChecksumStream() {
  static_assert(sizeof(state_) >= sizeof(XXH3_state_t) && alignof(XXH3_state_t) <= 64);
  XXH3_64bits_reset(new (state_) XXH3_state_t);
}
void ChecksumStream::update(const void* data, size_t bytes) {
  XXH3_64bits_update(std::launder(reinterpret_cast<XXH3_state_t*>(state_)), data, bytes);
}
uint64_t ChecksumStream::digest() const { return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_))); }

}  // namespace lightwell::format
