// Accessors: sparse, normalised, quantised and interleaved elements out of buffer views, every read inside its view.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/scene/gltf/document.h"
#include "precompute/scene/json_value.h"

namespace lightwell::scene::gltf {

/// The componentType of glTF.
enum class ComponentType { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

/// What an accessor declares.
struct AccessorLayout {
  ComponentType component_type;
  int components;  // 1 to 4, or 16 for MAT4
  size_t count;
  bool normalized;
};

/// Reads and checks the declaration of the accessor that `reference` (an index) names.
AccessorLayout readLayout(const Document& document, const JsonValue& reference);

/// The elements of an accessor as floats: count * components, element by element. Normalised integers are mapped to [0, 1] or [−1, 1]
/// (glTF 2.0, section 3.11), other integers taken at their value. An accessor without a buffer view is zero (but for its sparse part).
struct FloatElements {
  int components = 0;
  size_t count = 0;
  std::vector<float> values;
};
/// Throws InputError at `reference` unless the accessor has one of the widths `min_components` to `max_components` and finite values.
FloatElements readFloats(Document& document, const JsonValue& reference, int min_components, int max_components);

/// The elements of a scalar accessor of unsigned integers. Throws InputError at `reference`.
std::vector<uint32_t> readIndices(Document& document, const JsonValue& reference);

/// The value that the raw bits of an integer component stand for.
float dequantize(double raw, ComponentType type, bool normalized);

}  // namespace lightwell::scene::gltf
