// Reads an input as numbers and byte strings; zeros after its end.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace lightwell::fuzz {

class Feed {
 public:
  Feed(const uint8_t* data, size_t size) : rest_(data, size) {}
  bool empty() const { return rest_.empty(); }
  template <class T>
  T take() {
    T value{};
    const size_t size = std::min(sizeof(T), rest_.size());
    std::memcpy(&value, rest_.data(), size);
    rest_ = rest_.subspan(size);
    return value;
  }
  /// At most `most`, in as many bytes as that needs.
  uint32_t upTo(uint32_t most) { return (most < 256 ? take<uint8_t>() : most < 65536 ? take<uint16_t>() : take<uint32_t>()) % (most + 1); }
  std::string bytes(size_t size) {
    const auto part = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(part.size());
    return {part.begin(), part.end()};
  }
  std::string all() { return bytes(rest_.size()); }

 private:
  std::span<const uint8_t> rest_;
};

}  // namespace lightwell::fuzz
