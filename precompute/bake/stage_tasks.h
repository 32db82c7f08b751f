// What stages that are cut into tasks have in common: parameters as text, ranges, views of inputs.
#pragma once
#include <algorithm>
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
  Parameters& add(const Parameters& others) {
    text_.append(1, ' ').append(others.text_);
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

/// Adds one task for each piece of [0, count), `piece` elements long: "SECTION/NAME/0", … `stage(first, end, inputs)` yields its bytes.
template <class Stage>
std::vector<TaskIndex> addRange(TaskGraph& graph, const std::string& section, const std::string& name, const Parameters& parameters, uint32_t count,
                                uint32_t piece, double cost_each, const std::vector<TaskIndex>& inputs, const Stage& stage) {
  std::vector<TaskIndex> tasks;
  for (uint32_t first = 0; first < count; first += piece) {
    const uint32_t end = std::min(count, first + piece);
    tasks.push_back(graph.add({section + "/" + name + "/" + std::to_string(first / piece), name, section + "/" + name,
                               parameters.text() + " [" + std::to_string(first) + ", " + std::to_string(end) + ")", inputs,
                               cost_each * (end - first), [stage, first, end](const TaskInputs& in) { return stage(first, end, in); }}));
  }
  return tasks;
}

inline std::vector<ByteView> viewsOf(std::span<const Blob> blobs) {
  std::vector<ByteView> views;
  for (const auto& blob : blobs) views.emplace_back(*blob);
  return views;
}

}  // namespace lightwell::bake
