// Content keys: what makes two computations the same computation.
#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace lightwell::bake {

/// XXH3-128 of everything that a task's bytes depend on.
struct Key {
  uint64_t high = 0, low = 0;
  auto operator<=>(const Key&) const = default;
  /// 32 lower-case hexadecimal digits.
  std::string hex() const;
};

/// Hashes a sequence of values. Every piece is preceded by its length, so that ("ab", "c") and ("a", "bc") differ.
class KeyHasher {
 public:
  KeyHasher();
  ~KeyHasher();
  KeyHasher(const KeyHasher&) = delete;
  KeyHasher& operator=(const KeyHasher&) = delete;

  KeyHasher& add(std::string_view text) { return addBytes(text.data(), text.size()); }
  KeyHasher& add(const Key& key);
  /// Numbers, and arrays of types without padding.
  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
  KeyHasher& add(T value) { return addBytes(&value, sizeof value); }
  template <class T>
  KeyHasher& addArray(const T* values, size_t count) { return addBytes(values, count * sizeof(T)); }

  Key finish() const;

 private:
  KeyHasher& addBytes(const void* data, size_t size);
  struct State;
  std::unique_ptr<State> state_;
};

/// XXH3-128 of some bytes.
Key hashBytes(std::span<const uint8_t> bytes);

}  // namespace lightwell::bake
