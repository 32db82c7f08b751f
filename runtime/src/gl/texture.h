// Textures as the evaluator uses them: long lists, and what shaders render into.
#pragma once
#include "runtime/src/gl/api.h"

namespace lightwell::runtime::gl {

/// How one element is stored, given to glTexImage and glTexSubImage.
struct TexelFormat {
  Enum internal, format, type;
  uint32_t bytes;
};
inline constexpr TexelFormat kTexelRgba32f{kRgba32f, kRgba, kFloat, 16}, kTexelRgba16f{kRgba16f, kRgba, kHalfFloat, 8},
    kTexelR32f{kR32f, kRed, kFloat, 4}, kTexelR32ui{kR32ui, kRedInteger, kUnsignedInt, 4},
    kTexelRg32ui{kRg32ui, kRgInteger, kUnsignedInt, 8}, kTexelRgba32ui{kRgba32ui, kRgbaInteger, kUnsignedInt, 16},
    kTexelRgb9e5{kRgb9e5, kRgb, kUnsignedInt5999Rev, 4}, kTexelRgb16f{kRgb16f, kRgb, kHalfFloat, 6},
    kTexelRgb8ui{kRgb8ui, kRgbInteger, kUnsignedByte, 3}, kTexelRgb16ui{kRgb16ui, kRgbInteger, kUnsignedShort, 6},
    kTexelRgba8Snorm{kRgba8Snorm, kRgba, kByte, 4}, kTexelR8{kR8, kRed, kUnsignedByte, 1},
    kTexelDepth32f{kDepthComponent32f, kDepthComponent, kFloat, 4};

/// A list of elements in the layers of a GL_TEXTURE_2D_ARRAY: element i is at x = i % 2048, y = i / 2048 % 2048, layer i / 2048²
/// (lwAddress). Bound to the active unit afterwards. 0 when the context's limits are too small. `data` may be null.
Name createList(const Api& api, const TexelFormat& format, uint64_t count, const void* data, uint64_t& texture_bytes);
/// Replaces all elements.
void uploadList(const Api& api, Name texture, const TexelFormat& format, uint64_t count, const void* data);

/// One layer of the same addressing (lwPixel) to render into; GL_TEXTURE_2D, nearest.
struct Target {
  Name texture = 0, framebuffer = 0;
  int32_t width = 0, height = 0;
};
/// The most elements that a Target can hold.
inline constexpr uint64_t kMaxTargetElements = uint64_t(2048) * 2048;

/// GL_TEXTURE_2D_ARRAY of `layers` pictures of this size, nearest; data may be null. Errors: api.GetError().
Name createLayers(const Api& api, const TexelFormat& format, int32_t width, int32_t height, int32_t layers, const void* data, uint64_t& texture_bytes);

/// A picture; GL_TEXTURE_2D, clamped to the edge, bound to the active unit afterwards.
Name createPicture(const Api& api, const TexelFormat& format, int32_t width, int32_t height, Enum filter, const void* data,
                   uint64_t& texture_bytes);
/// For `count` elements. Fails with LW_GL_FAILED.
lw_result createTarget(const Api& api, const Host& host, const TexelFormat& format, uint64_t count, Target& target,
                       uint64_t& texture_bytes);
/// Four layers, drawn into at once as colour attachments 0 to 3.
lw_result createLayeredTarget(const Api& api, const Host& host, const TexelFormat& format, uint64_t count, Target& target,
                              uint64_t& texture_bytes);
/// A framebuffer around a texture that exists.
lw_result attachTarget(const Api& api, const Host& host, Target& target);
/// Reads a float target, [height][width][4]. Waits for the GPU; saves and restores state. Fails with LW_GL_FAILED.
lw_result readTarget(const Api& api, const Host& host, const Target& target, float* rgba);
/// Sets all elements of a float target to zero.
void clearTarget(const Api& api, const Target& target);
void destroyTarget(const Api& api, Target& target);

}  // namespace lightwell::runtime::gl
