#include "runtime/src/gl/state.h"

namespace lightwell::runtime::gl {
namespace {

struct PixelStore {
  Enum name;
  int32_t plain;      // tightly packed
  bool desktop_only;
};
constexpr PixelStore kPixelStore[] = {
    {kUnpackAlignment, 1, false}, {kUnpackRowLength, 0, false}, {kUnpackSkipRows, 0, false}, {kUnpackSkipPixels, 0, false},
    {kUnpackImageHeight, 0, false}, {kUnpackSkipImages, 0, false}, {kPackAlignment, 1, false}, {kPackRowLength, 0, false},
    {kPackSkipRows, 0, false}, {kPackSkipPixels, 0, false}, {kUnpackSwapBytes, 0, true}, {kUnpackLsbFirst, 0, true},
    {kPackSwapBytes, 0, true}, {kPackLsbFirst, 0, true}};
constexpr Enum kCapability[] = {kScissorTest, kCullFace, kRasterizerDiscard};

}  // namespace

StateGuard::StateGuard(const Api& api) : api_(api) {
  static_assert(sizeof kPixelStore / sizeof kPixelStore[0] == kPixelStoreCount);
  static_assert(sizeof kCapability / sizeof kCapability[0] == kCapabilities);
  api.GetIntegerv(kCurrentProgram, &program_);
  api.GetIntegerv(kVertexArrayBinding, &vertex_array_);
  api.GetIntegerv(kDrawFramebufferBinding, &draw_framebuffer_);
  api.GetIntegerv(kReadFramebufferBinding, &read_framebuffer_);
  api.GetIntegerv(kViewport, viewport_);
  api.GetIntegerv(kActiveTexture, &active_texture_);
  for (uint32_t unit = 0; unit < kUnits; ++unit) {
    api.ActiveTexture(kTexture0 + unit);
    api.GetIntegerv(kTextureBinding2d, &units_[unit].texture_2d);
    api.GetIntegerv(kTextureBinding2dArray, &units_[unit].texture_2d_array);
    api.GetIntegerv(kTextureBindingCubeMap, &units_[unit].texture_cube);
    api.GetIntegerv(kSamplerBinding, &units_[unit].sampler);
    if (units_[unit].sampler) api.BindSampler(unit, 0);
  }
  for (int i = 0; i < kCapabilities; ++i) {
    capabilities_[i] = api.IsEnabled(kCapability[i]);
    if (capabilities_[i]) api.Disable(kCapability[i]);
  }
  if (api.indexed) {
    for (uint32_t i = 0; i < kDrawBuffers; ++i) {
      blend_[i] = api.IsEnabledi(kBlend, i);
      api.GetBooleani_v(kColorWritemask, i, color_mask_[i]);
      api.Disablei(kBlend, i);
      api.ColorMaski(i, 1, 1, 1, 1);
    }
  } else {
    blend_[0] = api.IsEnabled(kBlend);
    api.GetBooleanv(kColorWritemask, color_mask_[0]);
    api.Disable(kBlend);
    api.ColorMask(1, 1, 1, 1);
  }
  api.GetIntegerv(kPixelPackBufferBinding, &pack_buffer_);
  api.GetIntegerv(kPixelUnpackBufferBinding, &unpack_buffer_);
  if (pack_buffer_) api.BindBuffer(kPixelPackBuffer, 0);
  if (unpack_buffer_) api.BindBuffer(kPixelUnpackBuffer, 0);
  for (int i = 0; i < kPixelStoreCount; ++i) {
    if (kPixelStore[i].desktop_only && api.embedded) continue;
    api.GetIntegerv(kPixelStore[i].name, &pixel_stores_[i]);
    if (pixel_stores_[i] != kPixelStore[i].plain) api.PixelStorei(kPixelStore[i].name, kPixelStore[i].plain);
  }
  if (!api.embedded) {
    logic_op_ = api.IsEnabled(kColorLogicOp);
    if (logic_op_) api.Disable(kColorLogicOp);
    api.GetIntegerv(kPolygonMode, polygon_mode_);
    if (polygon_mode_[0] != int32_t(kFill)) api.PolygonMode(kFrontAndBack, kFill);
    for (int i = 0; i < kClipDistances; ++i) {
      clip_distances_[i] = api.IsEnabled(kClipDistance0 + Enum(i));
      if (clip_distances_[i]) api.Disable(kClipDistance0 + Enum(i));
    }
  }
}

StateGuard::~StateGuard() {
  const Api& api = api_;
  if (!api.embedded) {
    for (int i = 0; i < kClipDistances; ++i)
      if (clip_distances_[i]) api.Enable(kClipDistance0 + Enum(i));
    if (polygon_mode_[0] != int32_t(kFill)) api.PolygonMode(kFrontAndBack, Enum(polygon_mode_[0]));
    if (logic_op_) api.Enable(kColorLogicOp);
  }
  for (int i = 0; i < kPixelStoreCount; ++i)
    if (!(kPixelStore[i].desktop_only && api.embedded) && pixel_stores_[i] != kPixelStore[i].plain)
      api.PixelStorei(kPixelStore[i].name, pixel_stores_[i]);
  if (pack_buffer_) api.BindBuffer(kPixelPackBuffer, Name(pack_buffer_));
  if (unpack_buffer_) api.BindBuffer(kPixelUnpackBuffer, Name(unpack_buffer_));
  if (api.indexed) {
    for (uint32_t i = 0; i < kDrawBuffers; ++i) {
      if (blend_[i]) api.Enablei(kBlend, i);
      api.ColorMaski(i, color_mask_[i][0], color_mask_[i][1], color_mask_[i][2], color_mask_[i][3]);
    }
  } else {
    if (blend_[0]) api.Enable(kBlend);
    api.ColorMask(color_mask_[0][0], color_mask_[0][1], color_mask_[0][2], color_mask_[0][3]);
  }
  for (int i = 0; i < kCapabilities; ++i)
    if (capabilities_[i]) api.Enable(kCapability[i]);
  for (uint32_t unit = 0; unit < kUnits; ++unit) {
    api.ActiveTexture(kTexture0 + unit);
    api.BindTexture(kTexture2d, Name(units_[unit].texture_2d));
    api.BindTexture(kTexture2dArray, Name(units_[unit].texture_2d_array));
    api.BindTexture(kTextureCubeMap, Name(units_[unit].texture_cube));
    api.BindSampler(unit, Name(units_[unit].sampler));
  }
  api.ActiveTexture(Enum(active_texture_));
  api.Viewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  api.BindFramebuffer(kDrawFramebuffer, Name(draw_framebuffer_));
  api.BindFramebuffer(kReadFramebuffer, Name(read_framebuffer_));
  api.BindVertexArray(Name(vertex_array_));
  api.UseProgram(Name(program_));
}

}  // namespace lightwell::runtime::gl
