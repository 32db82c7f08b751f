// What a task's bytes depend on, as text.
#pragma once
#include <bit>
#include <string>
#include <type_traits>
#include <vector>

#include "precompute/bake/key.h"
#include "precompute/bake/task_graph.h"

namespace lightwell::bake {

class Parameters {
 public:
  explicit Parameters(const Key& scene) : text_(scene.hex()) {}
  /// Numbers; floats by their bits.
  template <class... Values>
  Parameters& add(Values... values) {
    (append(values), ...);
    return *this;
  }
  Parameters& add(const Key& key) {
    text_.append(1, ' ').append(key.hex());
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  template <class Value>
  void append(Value value) {
    if constexpr (std::is_same_v<Value, float>) return append(std::bit_cast<uint32_t>(value));
    else text_.append(1, ' ').append(std::to_string(int64_t(value)));
  }
  std::string text_;
};

inline std::vector<ByteView> viewsOf(std::span<const Blob> blobs) {
  std::vector<ByteView> views;
  for (const auto& blob : blobs) views.emplace_back(*blob);
  return views;
}

}  // namespace lightwell::bake
