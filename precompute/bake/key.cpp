#include "precompute/bake/key.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

namespace lightwell::bake {

std::string Key::hex() const {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(high), static_cast<unsigned long long>(low));
  return text;
}

struct KeyHasher::State {
  XXH3_state_t xxh;
};

KeyHasher::KeyHasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->xxh); }
KeyHasher::~KeyHasher() = default;

KeyHasher& KeyHasher::add(const Key& key) {
  const uint64_t words[2] = {key.high, key.low};
  return addBytes(words, sizeof words);
}

KeyHasher& KeyHasher::addBytes(const void* data, size_t size) {
  const uint64_t length = size;
  XXH3_128bits_update(&state_->xxh, &length, sizeof length);
  if (size) XXH3_128bits_update(&state_->xxh, data, size);
  return *this;
}

Key KeyHasher::finish() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->xxh);
  return {hash.high64, hash.low64};
}

Key hashBytes(std::span<const uint8_t> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.high64, hash.low64};
}

}  // namespace lightwell::bake
