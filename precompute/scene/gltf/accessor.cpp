#include "precompute/scene/gltf/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "precompute/scene/gltf/limits.h"

namespace lightwell::scene::gltf {
namespace {

size_t byteSize(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
    case ComponentType::u8: return 1;
    case ComponentType::i16:
    case ComponentType::u16: return 2;
    case ComponentType::u32:
    case ComponentType::f32: return 4;
  }
  return 0;
}

ComponentType componentType(const JsonValue& value) {
  const size_t number = value.unsignedInteger();
  if (number < 5120 || number > 5126 || number == 5124) value.fail("is " + std::to_string(number) + ", which is no component type");
  return ComponentType(int(number));
}

int componentCount(const JsonValue& type) {
  const std::string& name = type.string();
  if (name == "SCALAR") return 1;
  if (name == "VEC2") return 2;
  if (name == "VEC3") return 3;
  if (name == "VEC4") return 4;
  if (name == "MAT4") return 16;
  type.fail("\"" + name + "\" is not a type of accessor that a scene can use here");
}

template <typename T>
T load(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

double loadComponent(const uint8_t* bytes, ComponentType type) {
  switch (type) {
    case ComponentType::i8: return load<int8_t>(bytes);
    case ComponentType::u8: return load<uint8_t>(bytes);
    case ComponentType::i16: return load<int16_t>(bytes);
    case ComponentType::u16: return load<uint16_t>(bytes);
    case ComponentType::u32: return load<uint32_t>(bytes);
    case ComponentType::f32: return load<float>(bytes);
  }
  return 0;
}

/// Elements at a fixed distance from each other, proven to lie inside their buffer view.
struct Elements {
  const uint8_t* first;
  size_t stride;
  const uint8_t* at(size_t i) const { return first + i * stride; }
};

/// The elements that `place` (an accessor, or a part of its sparse object) puts into a buffer view. Fails at `reference`.
Elements locate(Document& document, const JsonValue& reference, const JsonValue& place, size_t count, size_t element_bytes,
                bool may_interleave) {
  const BufferView view = document.view(place.at("bufferView"));
  const size_t offset = place.unsignedOr("byteOffset", 0);
  const size_t stride = may_interleave && view.stride != 0 ? view.stride : element_bytes;
  if (stride < element_bytes) reference.fail("the byteStride of " + place.at("bufferView").path() + " is shorter than an element");
  const size_t available = offset <= view.bytes.size() ? view.bytes.size() - offset : 0;
  if (count > 0 && (available < element_bytes || (available - element_bytes) / stride < count - 1))
    reference.fail(place.path() + " needs " + std::to_string(count) + " elements of " + std::to_string(element_bytes) +
                   " bytes, more than its buffer view of " + std::to_string(view.bytes.size()) + " bytes holds");
  return {view.bytes.data() + offset, stride};
}

/// Calls visit(element index, raw bytes) for the elements of the buffer view, then for those that the sparse object replaces.
template <typename Visit>
void forEachElement(Document& document, const JsonValue& reference, const AccessorLayout& layout, Visit visit) {
  const JsonValue accessor = document.element("accessors", reference);
  const size_t element_bytes = byteSize(layout.component_type) * size_t(layout.components);
  if (accessor.find("bufferView")) {
    const Elements elements = locate(document, reference, accessor, layout.count, element_bytes, true);
    for (size_t i = 0; i < layout.count; ++i) visit(i, elements.at(i));
  }
  const auto sparse = accessor.find("sparse");
  if (!sparse) return;
  const size_t count = sparse->at("count").unsignedInteger();
  if (count > layout.count) sparse->at("count").fail("is larger than the accessor's own count");
  const JsonValue indices = sparse->at("indices");
  const ComponentType index_type = componentType(indices.at("componentType"));
  if (index_type != ComponentType::u8 && index_type != ComponentType::u16 && index_type != ComponentType::u32)
    indices.at("componentType").fail("is not unsigned");
  const Elements where = locate(document, reference, indices, count, byteSize(index_type), false);
  const Elements what = locate(document, reference, sparse->at("values"), count, element_bytes, false);
  for (size_t i = 0; i < count; ++i) {
    const size_t target = size_t(loadComponent(where.at(i), index_type));
    if (target >= layout.count)
      indices.fail("element " + std::to_string(i) + " is " + std::to_string(target) + ", past the accessor's end");
    visit(target, what.at(i));
  }
}

}  // namespace

float dequantize(double raw, ComponentType type, bool normalized) {
  if (!normalized) return float(raw);
  switch (type) {
    case ComponentType::i8: return float(std::max(raw / 127.0, -1.0));
    case ComponentType::u8: return float(raw / 255.0);
    case ComponentType::i16: return float(std::max(raw / 32767.0, -1.0));
    case ComponentType::u16: return float(raw / 65535.0);
    case ComponentType::u32:
    case ComponentType::f32: break;
  }
  return float(raw);
}

AccessorLayout readLayout(const Document& document, const JsonValue& reference) {
  const JsonValue accessor = document.element("accessors", reference);
  AccessorLayout layout;
  layout.component_type = componentType(accessor.at("componentType"));
  layout.components = componentCount(accessor.at("type"));
  layout.count = accessor.at("count").unsignedInteger();
  layout.normalized = accessor.booleanOr("normalized", false);
  if (layout.count > 3 * kMaxTriangles) accessor.at("count").fail("is larger than the limit of " + std::to_string(3 * kMaxTriangles));
  if (!accessor.find("bufferView") && layout.count > kMaxUnbackedElements)
    accessor.at("count").fail("is absurd for an accessor without data");
  return layout;
}

FloatElements readFloats(Document& document, const JsonValue& reference, int min_components, int max_components) {
  const AccessorLayout layout = readLayout(document, reference);
  if (layout.components < min_components || layout.components > max_components)
    reference.fail("the accessor has " + std::to_string(layout.components) + " components where " + std::to_string(min_components) +
                   (min_components == max_components ? "" : " to " + std::to_string(max_components)) + " belong");
  if (layout.component_type == ComponentType::u32) reference.fail("the accessor has 32-bit integers where real numbers belong");
  if (layout.count > kMaxVertices) reference.fail("the accessor has more elements than the limit of " + std::to_string(kMaxVertices));
  FloatElements result;
  result.components = layout.components;
  result.count = layout.count;
  result.values.assign(layout.count * size_t(layout.components), 0.0f);
  const size_t component_bytes = byteSize(layout.component_type);
  forEachElement(document, reference, layout, [&](size_t i, const uint8_t* bytes) {
    for (int c = 0; c < layout.components; ++c) {
      const double raw = loadComponent(bytes + size_t(c) * component_bytes, layout.component_type);
      if (!std::isfinite(raw)) reference.fail("element " + std::to_string(i) + " is not finite");
      result.values[i * size_t(layout.components) + size_t(c)] = dequantize(raw, layout.component_type, layout.normalized);
    }
  });
  return result;
}

std::vector<uint32_t> readIndices(Document& document, const JsonValue& reference) {
  const AccessorLayout layout = readLayout(document, reference);
  const bool is_unsigned = layout.component_type == ComponentType::u8 || layout.component_type == ComponentType::u16 ||
                           layout.component_type == ComponentType::u32;
  if (layout.components != 1 || !is_unsigned || layout.normalized) reference.fail("indices have to be unsigned scalars, not normalised");
  std::vector<uint32_t> indices(layout.count, 0);
  forEachElement(document, reference, layout,
                 [&](size_t i, const uint8_t* bytes) { indices[i] = uint32_t(loadComponent(bytes, layout.component_type)); });
  return indices;
}

}  // namespace lightwell::scene::gltf
