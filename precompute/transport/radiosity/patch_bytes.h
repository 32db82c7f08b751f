// Patches, without their colours, as the result of a task.
#pragma once
#include "precompute/core/bytes.h"
#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

struct ExposedPatches {
  std::vector<float> exposed;  // per side
  Patches patches;
};

Bytes patchBytes(const ExposedPatches& patches);

/// The inverse, for `sides` sides. Throws std::runtime_error for bytes that patchBytes did not write.
ExposedPatches readPatches(ByteView bytes, size_t sides);

}  // namespace lightwell::transport
