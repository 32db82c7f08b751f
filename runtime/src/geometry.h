// Decoding what the evaluators need of the section geometry.
#pragma once
#include "runtime/src/container.h"
#include "runtime/src/radiosity_view.h"

namespace lightwell::runtime {

/// Decodes an array whose element has `components` numbers.
template <class T>
lw_result decodeArray(const lw_container* container, lw_array array, Array<T>& values) {
  lw_array_info info;
  if (const lw_result result = lw_get_array_info(container, array, &info)) return result;
  if (!values.allocate(container->host, info.bytes / sizeof(T))) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu bytes of geometry", info.bytes);
  return lw_decode_array(container, array, values.data(), info.bytes);
}

/// Materials, texture coordinates and textures of triangles with alpha; empty arrays when no triangle's flags say so.
lw_result loadAlpha(const lw_container* container, const Array<uint8_t>& flags, AlphaSurfaces& alpha);

}  // namespace lightwell::runtime
