// Plain values in a task's result. Host byte order: results travel between machines of one architecture; the container is written elsewhere.
#pragma once
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "precompute/bake/task_graph.h"

namespace lightwell::bake {

class ByteWriter {
 public:
  template <class T>
    requires std::is_trivially_copyable_v<T>
  ByteWriter& value(const T& v) { return append(&v, sizeof v); }
  /// Count (u64), then the elements; `T` must be free of padding, lest equal results differ in their bytes.
  template <class T>
    requires std::is_trivially_copyable_v<T>
  ByteWriter& array(const std::vector<T>& v) { return value(uint64_t(v.size())).append(v.data(), v.size() * sizeof(T)); }
  Bytes take() { return std::move(bytes_); }

 private:
  ByteWriter& append(const void* data, size_t size) {
    const auto* begin = static_cast<const uint8_t*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
    return *this;
  }
  Bytes bytes_;
};

/// Throws std::runtime_error when the bytes end early.
class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}
  template <class T>
  T value() {
    T v;
    copy(&v, sizeof v);
    return v;
  }
  template <class T>
  std::vector<T> array() {
    const auto count = value<uint64_t>();
    if (count > size_t(end_ - at_) / sizeof(T)) throw std::runtime_error("a task's result is cut short");
    std::vector<T> v(count);
    copy(v.data(), count * sizeof(T));
    return v;
  }
  bool atEnd() const { return at_ == end_; }

 private:
  void copy(void* to, size_t size) {
    if (size > size_t(end_ - at_)) throw std::runtime_error("a task's result is cut short");
    if (size) std::memcpy(to, at_, size);
    at_ += size;
  }
  const uint8_t *at_, *end_;
};

}  // namespace lightwell::bake
