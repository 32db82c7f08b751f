#include "precompute/scene/gltf/draco.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include <cmath>
#include <new>
#include <stdexcept>

#include "precompute/scene/gltf/limits.h"

namespace lightwell::scene::gltf {
namespace {

bool isIntegral(draco::DataType type) { return type >= draco::DT_INT8 && type <= draco::DT_UINT32; }

/// Decodes a mesh; null when the data is damaged. An allocation that fails counts as damage: only absurd claims ask for that much.
std::unique_ptr<draco::Mesh> decode(std::span<const uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  try {
    auto result = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    return result.ok() ? std::move(result).value() : nullptr;
  } catch (const std::bad_alloc&) {
    return nullptr;
  } catch (const std::length_error&) {
    return nullptr;
  }
}

}  // namespace

struct DracoMesh::Impl {
  Document& document;
  JsonValue extension;
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(Document& document, const JsonValue& primitive, const JsonValue& extension) {
  const BufferView view = document.view(extension.at("bufferView"));
  impl_ = std::make_unique<Impl>(Impl{document, extension, decode(view.bytes)});
  if (!impl_->mesh) extension.fail("the compressed mesh is damaged");
  const draco::Mesh& mesh = *impl_->mesh;
  if (mesh.num_points() > kMaxVertices || mesh.num_faces() > kMaxTriangles) extension.fail("the compressed mesh is larger than the limits");
  indices_.reserve(size_t(mesh.num_faces()) * 3);
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& point : mesh.face(f)) {
      if (point.value() >= mesh.num_points()) extension.fail("a face of the compressed mesh names a point that does not exist");
      indices_.push_back(point.value());
    }
  // The exporters write what they compressed into the accessor; a difference means that the two do not belong together.
  if (const auto reference = primitive.find("indices"); reference && primitive.unsignedOr("mode", 4) == 4)
    if (const size_t declared = readLayout(document, *reference).count; declared != indices_.size())
      reference->fail("declares " + std::to_string(declared) + " indices, but the compressed mesh has " + std::to_string(indices_.size()));
}

DracoMesh::~DracoMesh() = default;

bool DracoMesh::has(const std::string& attribute) const { return impl_->extension.at("attributes").find(attribute).has_value(); }

FloatElements DracoMesh::read(const std::string& attribute, const JsonValue& reference, int min_components, int max_components) const {
  const JsonValue id = impl_->extension.at("attributes").at(attribute);
  const AccessorLayout layout = readLayout(impl_->document, reference);
  const draco::Mesh& mesh = *impl_->mesh;
  const draco::PointAttribute* source = mesh.GetAttributeByUniqueId(uint32_t(id.unsignedInteger()));
  if (source == nullptr) id.fail("the compressed mesh has no such attribute");
  const int components = source->num_components();
  if (components < min_components || components > max_components || components != layout.components)
    id.fail("the compressed attribute has " + std::to_string(components) + " components");
  if (layout.count != mesh.num_points())
    reference.fail("declares " + std::to_string(layout.count) + " elements, but the compressed mesh has " +
                   std::to_string(mesh.num_points()) + " points");

  FloatElements result;
  result.components = components;
  result.count = mesh.num_points();
  result.values.resize(result.count * size_t(components));
  const bool integral = isIntegral(source->data_type());
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex index = source->mapped_index(point);
    float* out = result.values.data() + size_t(point.value()) * size_t(components);
    bool ok = index.value() < source->size();
    if (ok && integral) {
      int64_t raw[4] = {};
      ok = source->ConvertValue<int64_t>(index, int8_t(components), raw);
      for (int c = 0; c < components; ++c) out[c] = dequantize(double(raw[c]), layout.component_type, layout.normalized);
    } else if (ok) {
      ok = source->ConvertValue<float>(index, int8_t(components), out);
    }
    for (int c = 0; c < components; ++c) ok = ok && std::isfinite(out[c]);
    if (!ok) id.fail("value " + std::to_string(point.value()) + " of the compressed attribute is broken");
  }
  return result;
}

}  // namespace lightwell::scene::gltf
