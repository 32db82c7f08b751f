// Plain arrays in byte strings: what tasks hand to each other. Host byte order; these bytes never leave the machine that made them.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace lightwell {

using Bytes = std::vector<uint8_t>;
using ByteView = std::span<const uint8_t>;

class ByteWriter {
 public:
  /// Appends the element count (64 bits) and the elements.
  template <class T>
  void array(std::span<const T> values) {
    static_assert(std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>);
    const uint64_t count = values.size();
    raw(&count, sizeof count);
    raw(values.data(), values.size_bytes());
  }
  template <class T>
  void array(const std::vector<T>& values) {
    array(std::span<const T>(values));
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void raw(const void* data, size_t size) {
    const auto* begin = static_cast<const uint8_t*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }
  Bytes bytes_;
};

/// Reads what ByteWriter wrote, in the same order. Throws std::runtime_error when the bytes are too short: a damaged task result.
class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : rest_(bytes) {}
  template <class T>
  std::vector<T> array() {
    static_assert(std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>);
    uint64_t count = 0;
    raw(&count, sizeof count);
    if (count > rest_.size() / sizeof(T)) throw std::runtime_error("a task result is damaged");
    std::vector<T> values(count);
    raw(values.data(), count * sizeof(T));
    return values;
  }
  bool empty() const { return rest_.empty(); }

 private:
  void raw(void* to, size_t size) {
    if (size > rest_.size()) throw std::runtime_error("a task result is damaged");
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  std::span<const uint8_t> rest_;
};

}  // namespace lightwell
