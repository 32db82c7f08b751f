// EXT_meshopt_compression: one compressed buffer view.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/scene/json_value.h"

namespace lightwell::scene::gltf {

/// Decodes `compressed` as the extension object of a buffer view says (mode, filter, count, byteStride): count * byteStride bytes.
/// Throws InputError at the extension's path.
std::vector<uint8_t> decodeMeshopt(const JsonValue& extension, std::span<const uint8_t> compressed);

}  // namespace lightwell::scene::gltf
