// What the caller lends to the library: memory and a place for messages. Owning arrays on top of it, without the C++ library's containers.
#pragma once
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

#include "format/decode/source.h"
#include "format/decode/status.h"
#include "lightwell/lightwell.h"

namespace lightwell::runtime {

class Host {
 public:
  using Message = void (*)(void* user, lw_result result, const char* text);
  Host() = default;
  Host(const format::Allocator& allocator, Message message, void* message_user)
      : allocator_(allocator), message_(message), message_user_(message_user) {}

  /// 16-byte aligned; null when the caller has none left.
  void* allocate(size_t bytes) const;
  void release(void* memory) const;
  const format::Allocator& allocator() const { return allocator_; }

  /// Reports and returns `result`.
  [[gnu::format(printf, 3, 4)]] lw_result fail(lw_result result, const char* format, ...) const;
  lw_result fail(const format::Fault& fault) const;

 private:
  format::Allocator allocator_;
  Message message_ = nullptr;
  void* message_user_ = nullptr;
};

/// A fixed-size array of trivial elements from the caller's memory.
template <class T>
class Array {
 public:
  Array() = default;
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Array() {
    if (data_) host_.release(data_);
  }

  /// Not initialised. False when there is no memory; what the array held before is gone either way.
  bool allocate(const Host& host, size_t count) {
    if (data_) host_.release(std::exchange(data_, nullptr));
    size_ = 0;
    host_ = host;
    if (count > SIZE_MAX / sizeof(T)) return false;
    data_ = static_cast<T*>(host.allocate(count ? count * sizeof(T) : sizeof(T)));
    if (data_) size_ = count;
    return data_ != nullptr;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  size_t size() const { return size_; }
  size_t bytes() const { return size_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  T& operator[](size_t i) { return data_[i]; }
  const T& operator[](size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  void swap(Array& other) noexcept {
    std::swap(host_, other.host_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }
  Host host_;
  T* data_ = nullptr;
  size_t size_ = 0;
};

/// A handle in the caller's memory; null when there is none. The handle's type has a member `host`.
template <class Handle>
Handle* createHandle(const Host& host) {
  static_assert(alignof(Handle) <= 16);
  void* memory = host.allocate(sizeof(Handle));
  if (!memory) return nullptr;
  Handle* handle = new (memory) Handle;
  handle->host = host;
  return handle;
}
template <class Handle>
void destroyHandle(Handle* handle) {
  if (!handle) return;
  const Host host = handle->host;
  handle->~Handle();
  host.release(handle);
}

bool allFinite(const float* values, size_t count);

}  // namespace lightwell::runtime
