#include "runtime/src/gl/texture.h"

#include "runtime/src/gl/state.h"

#include <algorithm>

#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl {
namespace {

constexpr uint64_t kRow = glsl::kRow;

void setParameters(const Api& api, Enum target, Enum filter) {
  api.TexParameteri(target, kTextureMinFilter, int32_t(filter));
  api.TexParameteri(target, kTextureMagFilter, int32_t(filter));
  api.TexParameteri(target, kTextureWrapS, int32_t(kClampToEdge));
  api.TexParameteri(target, kTextureWrapT, int32_t(kClampToEdge));
  api.TexParameteri(target, kTextureMaxLevel, 0);
}

struct Extent {
  int32_t width, height, layers;
};
Extent extentOf(uint64_t count) {
  count = std::max<uint64_t>(count, 1);
  const uint64_t rows = (count + kRow - 1) / kRow;
  return {int32_t(std::min(count, kRow)), int32_t(std::min(rows, kRow)), int32_t((rows + kRow - 1) / kRow)};
}

lw_result checkFramebuffer(const Api& api, const Host& host) {
  const Enum status = api.CheckFramebufferStatus(kDrawFramebuffer);
  return status == kFramebufferComplete ? LW_OK : host.fail(LW_GL_FAILED, "a framebuffer is incomplete (0x%04x)", status);
}

}  // namespace

void uploadList(const Api& api, Name texture, const TexelFormat& format, uint64_t count, const void* data) {
  api.BindTexture(kTexture2dArray, texture);
  const auto* bytes = static_cast<const uint8_t*>(data);
  const uint64_t full_rows = count / kRow, rest = count % kRow;
  for (uint64_t row = 0; row < full_rows;) {
    const uint64_t rows = std::min(full_rows - row, kRow - row % kRow);  // up to the end of the layer
    api.TexSubImage3D(kTexture2dArray, 0, 0, int32_t(row % kRow), int32_t(row / kRow), int32_t(kRow), int32_t(rows), 1, format.format,
                      format.type, bytes + row * kRow * format.bytes);
    row += rows;
  }
  if (rest)
    api.TexSubImage3D(kTexture2dArray, 0, 0, int32_t(full_rows % kRow), int32_t(full_rows / kRow), int32_t(rest), 1, 1, format.format,
                      format.type, bytes + full_rows * kRow * format.bytes);
}

Name createList(const Api& api, const TexelFormat& format, uint64_t count, const void* data, uint64_t& texture_bytes) {
  if (count > uint64_t(INT32_MAX)) return 0;  // lwAddress takes an int
  const Extent extent = extentOf(count);
  if (extent.width > api.max_texture_size || extent.height > api.max_texture_size || extent.layers > api.max_array_layers) return 0;
  Name texture = 0;
  api.GenTextures(1, &texture);
  api.BindTexture(kTexture2dArray, texture);
  setParameters(api, kTexture2dArray, kNearest);
  api.TexImage3D(kTexture2dArray, 0, int32_t(format.internal), extent.width, extent.height, extent.layers, 0, format.format, format.type,
                 nullptr);
  texture_bytes += uint64_t(extent.width) * extent.height * extent.layers * format.bytes;
  if (data && count) uploadList(api, texture, format, count, data);
  return texture;
}

Name createPicture(const Api& api, const TexelFormat& format, int32_t width, int32_t height, Enum filter, const void* data,
                   uint64_t& texture_bytes) {
  Name texture = 0;
  api.GenTextures(1, &texture);
  api.BindTexture(kTexture2d, texture);
  setParameters(api, kTexture2d, filter);
  api.TexImage2D(kTexture2d, 0, int32_t(format.internal), width, height, 0, format.format, format.type, data);
  texture_bytes += uint64_t(width) * uint64_t(height) * format.bytes;
  return texture;
}

lw_result attachTarget(const Api& api, const Host& host, Target& target) {
  api.GenFramebuffers(1, &target.framebuffer);
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  api.FramebufferTexture2D(kDrawFramebuffer, kColorAttachment0, kTexture2d, target.texture, 0);
  return checkFramebuffer(api, host);
}

lw_result createTarget(const Api& api, const Host& host, const TexelFormat& format, uint64_t count, Target& target,
                       uint64_t& texture_bytes) {
  const Extent extent = extentOf(count);
  target.width = extent.width;
  target.height = extent.height;
  target.texture = createPicture(api, format, extent.width, extent.height, kNearest, nullptr, texture_bytes);
  return attachTarget(api, host, target);
}

Name createLayers(const Api& api, const TexelFormat& format, int32_t width, int32_t height, int32_t layers, const void* data, uint64_t& texture_bytes) {
  Name name = 0;
  api.GenTextures(1, &name);
  api.BindTexture(kTexture2dArray, name);
  setParameters(api, kTexture2dArray, kNearest);
  api.TexImage3D(kTexture2dArray, 0, int32_t(format.internal), width, height, layers, 0, format.format, format.type, data);
  texture_bytes += uint64_t(width) * uint64_t(height) * uint64_t(layers) * format.bytes;
  return name;
}

lw_result createLayeredTarget(const Api& api, const Host& host, const TexelFormat& format, uint64_t count, Target& target,
                              uint64_t& texture_bytes) {
  const Extent extent = extentOf(count);
  target.width = extent.width;
  target.height = extent.height;
  api.GenTextures(1, &target.texture);
  api.BindTexture(kTexture2dArray, target.texture);
  setParameters(api, kTexture2dArray, kNearest);
  api.TexImage3D(kTexture2dArray, 0, int32_t(format.internal), extent.width, extent.height, 4, 0, format.format, format.type, nullptr);
  texture_bytes += uint64_t(extent.width) * uint64_t(extent.height) * 4 * format.bytes;
  api.GenFramebuffers(1, &target.framebuffer);
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  Enum buffers[4];
  for (int32_t i = 0; i < 4; ++i) {
    buffers[i] = kColorAttachment0 + Enum(i);
    api.FramebufferTextureLayer(kDrawFramebuffer, buffers[i], target.texture, 0, i);
  }
  api.DrawBuffers(4, buffers);
  return checkFramebuffer(api, host);
}

lw_result readTarget(const Api& api, const Host& host, const Target& target, float* rgba) {
  const StateGuard guard(api);
  api.clearErrors();
  api.BindFramebuffer(kReadFramebuffer, target.framebuffer);
  api.ReadPixels(0, 0, target.width, target.height, kRgba, kFloat, rgba);
  const Enum error = api.GetError();
  return error == kNoError ? LW_OK : host.fail(LW_GL_FAILED, "reading back: GL error 0x%04x", error);
}

void clearTarget(const Api& api, const Target& target) {
  constexpr float kZero[4] = {};
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  api.ClearBufferfv(kColor, 0, kZero);
}

void destroyTarget(const Api& api, Target& target) {
  if (target.framebuffer) api.DeleteFramebuffers(1, &target.framebuffer);
  if (target.texture) api.DeleteTextures(1, &target.texture);
  target = {};
}

}  // namespace lightwell::runtime::gl
