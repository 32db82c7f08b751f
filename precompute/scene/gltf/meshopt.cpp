#include "precompute/scene/gltf/meshopt.h"

#include <meshoptimizer.h>

#include <limits>

namespace lightwell::scene::gltf {
namespace {

/// No codec of meshoptimizer expands further: the vertex codec spends at least 2 bits on 16 bytes.
constexpr size_t kMaxExpansion = 1024;

void applyFilter(const JsonValue& extension, const std::string& filter, std::vector<uint8_t>& bytes, size_t count, size_t stride) {
  if (filter == "NONE") return;
  if (filter == "OCTAHEDRAL") {
    if (stride != 4 && stride != 8) extension.fail("the filter OCTAHEDRAL wants a byteStride of 4 or 8");
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  } else if (filter == "QUATERNION") {
    if (stride != 8) extension.fail("the filter QUATERNION wants a byteStride of 8");
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  } else if (filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  } else {
    extension.at("filter").fail("is \"" + filter + "\", which is not known");
  }
}

}  // namespace

std::vector<uint8_t> decodeMeshopt(const JsonValue& extension, std::span<const uint8_t> compressed) {
  const std::string mode = extension.at("mode").string();
  const std::string filter = extension.stringOr("filter", "NONE");
  const size_t count = extension.at("count").unsignedInteger(), stride = extension.at("byteStride").unsignedInteger();
  const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES", indices = mode == "INDICES";
  if (!attributes && !triangles && !indices) extension.at("mode").fail("is \"" + mode + "\", which is not known");
  if (attributes ? (stride == 0 || stride % 4 != 0 || stride > 256) : (stride != 2 && stride != 4))
    extension.at("byteStride").fail("is " + std::to_string(stride) + ", which the mode " + mode + " does not allow");
  if (triangles && count % 3 != 0) extension.at("count").fail("is not a multiple of 3");
  if (!attributes && filter != "NONE") extension.at("filter").fail("belongs to the mode ATTRIBUTES only");
  if (count > std::numeric_limits<uint32_t>::max() || count * stride / kMaxExpansion > compressed.size())
    extension.at("count").fail("is more than " + std::to_string(compressed.size()) + " compressed bytes can hold");

  std::vector<uint8_t> bytes(count * stride);
  int error;
  if (attributes) error = meshopt_decodeVertexBuffer(bytes.data(), count, stride, compressed.data(), compressed.size());
  else if (triangles) error = meshopt_decodeIndexBuffer(bytes.data(), count, stride, compressed.data(), compressed.size());
  else error = meshopt_decodeIndexSequence(bytes.data(), count, stride, compressed.data(), compressed.size());
  if (error != 0) extension.fail("the compressed data is damaged");
  applyFilter(extension, filter, bytes, count, stride);
  return bytes;
}

}  // namespace lightwell::scene::gltf
