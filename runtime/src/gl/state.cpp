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

DepthStateGuard::DepthStateGuard(const Api& api) : api_(api) {
  api.GetIntegerv(kScissorBox, scissor_);
  api.GetIntegerv(kDepthFunc, &function_);
  api.GetBooleanv(kDepthWritemask, &mask_);
  test_ = api.IsEnabled(kDepthTest);
  stencil_ = api.IsEnabled(kStencilTest);
  offset_ = api.IsEnabled(kPolygonOffsetFill);
}

DepthStateGuard::~DepthStateGuard() {
  const auto set = [this](Enum capability, bool on) { on ? api_.Enable(capability) : api_.Disable(capability); };
  api_.Scissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  api_.Disable(kScissorTest);  // as StateGuard, which puts back what it was, has set it
  api_.DepthFunc(Enum(function_));
  api_.DepthMask(mask_);
  set(kDepthTest, test_);
  set(kStencilTest, stencil_);
  set(kPolygonOffsetFill, offset_);
}

SumGuard::SumGuard(const Api& api) : api_(api) {
  equation_rgb_ = get(kBlendEquationRgb);
  equation_alpha_ = get(kBlendEquationAlpha);
  source_rgb_ = get(kBlendSrcRgb);
  target_rgb_ = get(kBlendDstRgb);
  source_alpha_ = get(kBlendSrcAlpha);
  target_alpha_ = get(kBlendDstAlpha);
  set(kFuncAdd, kFuncAdd, kOne, kOne, kOne, kOne);
  if (api.embedded) return;
  point_size_ = api.IsEnabled(kProgramPointSize);
  if (!point_size_) api.Enable(kProgramPointSize);
}

SumGuard::~SumGuard() {
  if (!point_size_) api_.Disable(kProgramPointSize);
  set(Enum(equation_rgb_), Enum(equation_alpha_), Enum(source_rgb_), Enum(target_rgb_), Enum(source_alpha_), Enum(target_alpha_));
  blend(false);
}

void SumGuard::blend(bool on) const {
  if (api_.indexed)
    on ? api_.Enablei(kBlend, 0) : api_.Disablei(kBlend, 0);
  else
    on ? api_.Enable(kBlend) : api_.Disable(kBlend);
}

int32_t SumGuard::get(Enum name) const {
  int32_t value = 0;
  api_.indexed_blending ? api_.GetIntegeri_v(name, 0, &value) : api_.GetIntegerv(name, &value);
  return value;
}

void SumGuard::set(Enum equation_rgb, Enum equation_alpha, Enum source_rgb, Enum target_rgb, Enum source_alpha, Enum target_alpha) const {
  if (api_.indexed_blending) {
    api_.BlendEquationSeparatei(0, equation_rgb, equation_alpha);
    api_.BlendFuncSeparatei(0, source_rgb, target_rgb, source_alpha, target_alpha);
  } else {
    api_.BlendEquationSeparate(equation_rgb, equation_alpha);
    api_.BlendFuncSeparate(source_rgb, target_rgb, source_alpha, target_alpha);
  }
}

}  // namespace lightwell::runtime::gl
