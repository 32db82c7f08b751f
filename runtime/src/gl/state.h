// Every GL state that the library touches, saved when a scope begins and restored when it ends. lightwell_gl.h lists it for the user.
#pragma once
#include "runtime/src/gl/api.h"

namespace lightwell::runtime::gl {

/// Texture units 0 to kUnits − 1 are used.
inline constexpr uint32_t kUnits = 7;
/// Draw buffers 0 to kDrawBuffers − 1 are used.
inline constexpr uint32_t kDrawBuffers = 4;

/// On construction saves the state and sets what drawing and uploading need: nothing blends, tests, masks or discards; pixels are tightly
/// packed in client memory; no sampler objects on the units used.
class StateGuard {
 public:
  explicit StateGuard(const Api& api);
  ~StateGuard();
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;

 private:
  static constexpr int kPixelStoreCount = 14, kCapabilities = 3, kClipDistances = 8;
  struct Unit {
    int32_t texture_2d, texture_2d_array, texture_cube, sampler;
  };
  const Api& api_;
  int32_t program_, vertex_array_, draw_framebuffer_, read_framebuffer_, viewport_[4], active_texture_, pack_buffer_, unpack_buffer_;
  int32_t pixel_stores_[kPixelStoreCount];
  int32_t polygon_mode_[2];
  Unit units_[kUnits];
  bool capabilities_[kCapabilities], blend_[kDrawBuffers], logic_op_, clip_distances_[kClipDistances];
  uint8_t color_mask_[kDrawBuffers][4];
};

/// The states of drawing with a depth test, which StateGuard leaves alone, saved and restored inside of one. Sets nothing.
class DepthStateGuard {
 public:
  explicit DepthStateGuard(const Api& api);
  ~DepthStateGuard();
  DepthStateGuard(const DepthStateGuard&) = delete;
  DepthStateGuard& operator=(const DepthStateGuard&) = delete;

 private:
  const Api& api_;
  int32_t scissor_[4] = {}, function_ = 0;
  uint8_t mask_ = 0;
  bool test_, stencil_, offset_;
};

/// How points are added up in draw buffer 0: sums as blending, one pixel a point. Inside of a StateGuard, whose state it leaves: blending off.
class SumGuard {
 public:
  explicit SumGuard(const Api& api);
  ~SumGuard();
  SumGuard(const SumGuard&) = delete;
  SumGuard& operator=(const SumGuard&) = delete;

  /// Switches blending of draw buffer 0.
  void blend(bool on) const;

 private:
  int32_t get(Enum name) const;
  void set(Enum equation_rgb, Enum equation_alpha, Enum source_rgb, Enum target_rgb, Enum source_alpha, Enum target_alpha) const;
  const Api& api_;
  int32_t equation_rgb_, equation_alpha_, source_rgb_, target_rgb_, source_alpha_, target_alpha_;
  bool point_size_ = true;
};

}  // namespace lightwell::runtime::gl
