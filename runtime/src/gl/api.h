// The part of OpenGL 3.3 core and OpenGL ES 3.0 that is used, loaded through the caller. Names and values are the Khronos registry's,
// written here so that no OpenGL header is needed to build.
#pragma once
#include <cstddef>
#include <cstdint>

#include "lightwell/lightwell_gl.h"
#include "runtime/src/host.h"

#if defined(_WIN32) && !defined(_WIN64)
#define LW_GL_CALL __stdcall
#else
#define LW_GL_CALL
#endif

namespace lightwell::runtime::gl {

using Enum = uint32_t;
using Name = uint32_t;

inline constexpr Enum kNoError = 0, kOutOfMemory = 0x0505, kTriangles = 0x0004, kCullFace = 0x0B44, kViewport = 0x0BA2, kBlend = 0x0BE2,
                      kColorLogicOp = 0x0BF2, kScissorTest = 0x0C11, kColorWritemask = 0x0C23, kUnpackSwapBytes = 0x0CF0,
                      kUnpackLsbFirst = 0x0CF1, kUnpackRowLength = 0x0CF2, kUnpackSkipRows = 0x0CF3, kUnpackSkipPixels = 0x0CF4,
                      kUnpackAlignment = 0x0CF5, kPackSwapBytes = 0x0D00, kPackLsbFirst = 0x0D01, kPackRowLength = 0x0D02,
                      kPackSkipRows = 0x0D03, kPackSkipPixels = 0x0D04, kPackAlignment = 0x0D05, kPolygonMode = 0x0B40,
                      kMaxTextureSize = 0x0D33, kTexture2d = 0x0DE1, kByte = 0x1400, kUnsignedByte = 0x1401,
                      kUnsignedShort = 0x1403, kUnsignedInt = 0x1405,
                      kFloat = 0x1406, kHalfFloat = 0x140B, kRed = 0x1903, kRgb = 0x1907, kRgba = 0x1908, kFill = 0x1B02, kRenderer = 0x1F01, kVersion = 0x1F02,
                      kExtensions = 0x1F03, kNearest = 0x2600, kLinear = 0x2601, kTextureMagFilter = 0x2800, kTextureMinFilter = 0x2801,
                      kTextureWrapS = 0x2802, kTextureWrapT = 0x2803, kClipDistance0 = 0x3000, kUnpackSkipImages = 0x806D,
                      kUnpackImageHeight = 0x806E, kTextureWrapR = 0x8072, kTextureBinding2d = 0x8069, kClampToEdge = 0x812F,
                      kTextureMaxLevel = 0x813D, kMajorVersion = 0x821B, kMinorVersion = 0x821C, kNumExtensions = 0x821D, kR32f = 0x822E,
                      kR32ui = 0x8236, kRg32ui = 0x823C, kRgInteger = 0x8228, kTexture0 = 0x84C0, kActiveTexture = 0x84E0,
                      kTextureCubeMap = 0x8513, kTextureBindingCubeMap = 0x8514, kVertexArrayBinding = 0x85B5, kRgba32f = 0x8814,
                      kRgba16f = 0x881A, kRgb16f = 0x881B, kTextureCompareMode = 0x884C, kTextureCompareFunc = 0x884D,
                      kCompareRefToTexture = 0x884E, kLequal = 0x0203, kGequal = 0x0206, kPixelPackBuffer = 0x88EB,
                      kPixelUnpackBuffer = 0x88EC, kPixelPackBufferBinding = 0x88ED, kPixelUnpackBufferBinding = 0x88EF,
                      kMaxArrayTextureLayers = 0x88FF, kSamplerBinding = 0x8919, kFragmentShader = 0x8B30, kVertexShader = 0x8B31,
                      kCompileStatus = 0x8B81, kLinkStatus = 0x8B82, kCurrentProgram = 0x8B8D, kTexture2dArray = 0x8C1A,
                      kTextureBinding2dArray = 0x8C1D, kRgb9e5 = 0x8C3D, kUnsignedInt5999Rev = 0x8C3E, kRasterizerDiscard = 0x8C89,
                      kReadFramebuffer = 0x8CA8, kDrawFramebuffer = 0x8CA9, kDrawFramebufferBinding = 0x8CA6,
                      kReadFramebufferBinding = 0x8CAA, kFramebufferComplete = 0x8CD5, kColorAttachment0 = 0x8CE0, kRgba32ui = 0x8D70,
                      kRgb16ui = 0x8D77, kRgb8ui = 0x8D7D,
                      kRedInteger = 0x8D94, kRgbInteger = 0x8D98, kRgbaInteger = 0x8D99,
                      kRgba8Snorm = 0x8F97, kColor = 0x1800, kFrontAndBack = 0x0408, kDepth = 0x1801, kDepthTest = 0x0B71,
                      kDepthWritemask = 0x0B72, kDepthFunc = 0x0B74, kStencilTest = 0x0B90, kScissorBox = 0x0C10,
                      kPolygonOffsetFill = 0x8037, kDepthComponent = 0x1902, kDepthComponent16 = 0x81A5, kDepthAttachment = 0x8D00,
                      kStaticDraw = 0x88E4, kUniformBuffer = 0x8A11, kUniformBufferBinding = 0x8A28, kMaxUniformBlockSize = 0x8A30,
                      kUniformBlockDataSize = 0x8A40, kPoints = 0x0000, kOne = 0x0001, kGreater = 0x0204, kFuncAdd = 0x8006, kBlendEquationRgb = 0x8009,
                      kBlendDstRgb = 0x80C8, kBlendSrcRgb = 0x80C9, kBlendDstAlpha = 0x80CA, kBlendSrcAlpha = 0x80CB, kR8 = 0x8229,
                      kProgramPointSize = 0x8642, kBlendEquationAlpha = 0x883D, kDepthComponent32f = 0x8CAC, kColorBufferBit = 0x4000;
/// What glGetUniformBlockIndex answers when there is no such block.
inline constexpr uint32_t kInvalidIndex = 0xffffffffu;

// X(return type, name without "gl", parameters)
#define LW_GL_FUNCTIONS(X) \
  X(void, ActiveTexture, (Enum unit)) \
  X(void, AttachShader, (Name program, Name shader)) \
  X(void, BindBuffer, (Enum target, Name buffer)) \
  X(void, BindBufferBase, (Enum target, uint32_t index, Name buffer)) \
  X(void, BindFramebuffer, (Enum target, Name framebuffer)) \
  X(void, BindSampler, (uint32_t unit, Name sampler)) \
  X(void, BindTexture, (Enum target, Name texture)) \
  X(void, BindVertexArray, (Name array)) \
  X(void, BlendEquationSeparate, (Enum rgb, Enum alpha)) \
  X(void, BlendFuncSeparate, (Enum source_rgb, Enum target_rgb, Enum source_alpha, Enum target_alpha)) \
  X(void, BlitFramebuffer, (int32_t x0, int32_t y0, int32_t x1, int32_t y1, int32_t to_x0, int32_t to_y0, int32_t to_x1, int32_t to_y1, \
                            uint32_t mask, Enum filter)) \
  X(void, BufferData, (Enum target, ptrdiff_t bytes, const void* data, Enum usage)) \
  X(void, BufferSubData, (Enum target, ptrdiff_t offset, ptrdiff_t bytes, const void* data)) \
  X(Enum, CheckFramebufferStatus, (Enum target)) \
  X(void, ClearBufferfv, (Enum buffer, int32_t index, const float* value)) \
  X(void, ClearBufferuiv, (Enum buffer, int32_t index, const uint32_t* value)) \
  X(void, ColorMask, (uint8_t r, uint8_t g, uint8_t b, uint8_t a)) \
  X(void, CompileShader, (Name shader)) \
  X(Name, CreateProgram, (void)) \
  X(Name, CreateShader, (Enum type)) \
  X(void, DeleteBuffers, (int32_t count, const Name* names)) \
  X(void, DeleteFramebuffers, (int32_t count, const Name* names)) \
  X(void, DeleteProgram, (Name program)) \
  X(void, DeleteSamplers, (int32_t count, const Name* names)) \
  X(void, DeleteShader, (Name shader)) \
  X(void, DeleteTextures, (int32_t count, const Name* names)) \
  X(void, DeleteVertexArrays, (int32_t count, const Name* names)) \
  X(void, DepthFunc, (Enum function)) \
  X(void, DepthMask, (uint8_t flag)) \
  X(void, Disable, (Enum capability)) \
  X(void, DrawArrays, (Enum mode, int32_t first, int32_t count)) \
  X(void, DrawBuffers, (int32_t count, const Enum* buffers)) \
  X(void, Enable, (Enum capability)) \
  X(void, Finish, (void)) \
  X(void, FramebufferTexture2D, (Enum target, Enum attachment, Enum texture_target, Name texture, int32_t level)) \
  X(void, FramebufferTextureLayer, (Enum target, Enum attachment, Name texture, int32_t level, int32_t layer)) \
  X(void, GenBuffers, (int32_t count, Name* names)) \
  X(void, GenFramebuffers, (int32_t count, Name* names)) \
  X(void, GenSamplers, (int32_t count, Name* names)) \
  X(void, GenTextures, (int32_t count, Name* names)) \
  X(void, GenVertexArrays, (int32_t count, Name* names)) \
  X(void, GetActiveUniformBlockiv, (Name program, uint32_t block, Enum name, int32_t* values)) \
  X(void, GetBooleanv, (Enum name, uint8_t* values)) \
  X(Enum, GetError, (void)) \
  X(void, GetIntegerv, (Enum name, int32_t* values)) \
  X(void, GetProgramInfoLog, (Name program, int32_t capacity, int32_t* length, char* text)) \
  X(void, GetProgramiv, (Name program, Enum name, int32_t* value)) \
  X(void, GetShaderInfoLog, (Name shader, int32_t capacity, int32_t* length, char* text)) \
  X(void, GetShaderiv, (Name shader, Enum name, int32_t* value)) \
  X(const uint8_t*, GetString, (Enum name)) \
  X(const uint8_t*, GetStringi, (Enum name, uint32_t index)) \
  X(uint32_t, GetUniformBlockIndex, (Name program, const char* name)) \
  X(int32_t, GetUniformLocation, (Name program, const char* name)) \
  X(uint8_t, IsEnabled, (Enum capability)) \
  X(void, LinkProgram, (Name program)) \
  X(void*, MapBufferRange, (Enum target, ptrdiff_t offset, ptrdiff_t bytes, uint32_t access)) \
  X(void, PixelStorei, (Enum name, int32_t value)) \
  X(void, ReadBuffer, (Enum buffer)) \
  X(void, ReadPixels, (int32_t x, int32_t y, int32_t width, int32_t height, Enum format, Enum type, void* pixels)) \
  X(void, SamplerParameteri, (Name sampler, Enum name, int32_t value)) \
  X(void, Scissor, (int32_t x, int32_t y, int32_t width, int32_t height)) \
  X(void, ShaderSource, (Name shader, int32_t count, const char* const* strings, const int32_t* lengths)) \
  X(void, TexImage2D, (Enum target, int32_t level, int32_t internal_format, int32_t width, int32_t height, int32_t border, Enum format, \
                       Enum type, const void* pixels)) \
  X(void, TexImage3D, (Enum target, int32_t level, int32_t internal_format, int32_t width, int32_t height, int32_t depth, int32_t border, \
                       Enum format, Enum type, const void* pixels)) \
  X(void, TexParameteri, (Enum target, Enum name, int32_t value)) \
  X(void, TexSubImage2D, (Enum target, int32_t level, int32_t x, int32_t y, int32_t width, int32_t height, Enum format, Enum type, \
                          const void* pixels)) \
  X(void, TexSubImage3D, (Enum target, int32_t level, int32_t x, int32_t y, int32_t z, int32_t width, int32_t height, int32_t depth, \
                          Enum format, Enum type, const void* pixels)) \
  X(void, Uniform1f, (int32_t location, float x)) \
  X(void, Uniform1i, (int32_t location, int32_t x)) \
  X(void, Uniform2f, (int32_t location, float x, float y)) \
  X(void, Uniform4fv, (int32_t location, int32_t count, const float* values)) \
  X(void, UniformBlockBinding, (Name program, uint32_t block, uint32_t binding)) \
  X(void, UniformMatrix4fv, (int32_t location, int32_t count, uint8_t transpose, const float* values)) \
  X(uint8_t, UnmapBuffer, (Enum target)) \
  X(void, UseProgram, (Name program)) \
  X(void, Viewport, (int32_t x, int32_t y, int32_t width, int32_t height))

// State of single draw buffers: OpenGL, and OpenGL ES since 3.2.
#define LW_GL_INDEXED_FUNCTIONS(X) \
  X(void, ColorMaski, (uint32_t index, uint8_t r, uint8_t g, uint8_t b, uint8_t a)) \
  X(void, Disablei, (Enum capability, uint32_t index)) \
  X(void, Enablei, (Enum capability, uint32_t index)) \
  X(void, GetBooleani_v, (Enum name, uint32_t index, uint8_t* values)) \
  X(uint8_t, IsEnabledi, (Enum capability, uint32_t index))

// Blend functions of single draw buffers: OpenGL since 4.0, and OpenGL ES since 3.2.
#define LW_GL_INDEXED_BLENDING_FUNCTIONS(X) \
  X(void, BlendEquationSeparatei, (uint32_t index, Enum rgb, Enum alpha)) \
  X(void, BlendFuncSeparatei, (uint32_t index, Enum source_rgb, Enum target_rgb, Enum source_alpha, Enum target_alpha)) \
  X(void, GetIntegeri_v, (Enum name, uint32_t index, int32_t* values))

#define LW_GL_DESKTOP_FUNCTIONS(X) X(void, PolygonMode, (Enum face, Enum mode))

/// The functions, called as api.DrawArrays(…), and what kind of context it is.
struct Api {
#define LW_GL_MEMBER(result, name, parameters) result(LW_GL_CALL* name) parameters = nullptr;
  LW_GL_FUNCTIONS(LW_GL_MEMBER)
  LW_GL_INDEXED_FUNCTIONS(LW_GL_MEMBER)
  LW_GL_INDEXED_BLENDING_FUNCTIONS(LW_GL_MEMBER)
  LW_GL_DESKTOP_FUNCTIONS(LW_GL_MEMBER)
#undef LW_GL_MEMBER
  bool embedded = false;  // OpenGL ES
  int version = 0;        // 33 for 3.3
  bool indexed = false;   // the indexed functions are there
  bool indexed_blending = false;
  bool blends_floats = false;  // of 32 bits
  int32_t max_texture_size = 0, max_array_layers = 0, max_uniform_block_bytes = 0;

  lw_result load(const lw_gl_config& config, const Host& host);
  void clearErrors() const {
    for (int i = 0; i < 64 && GetError() != kNoError; ++i) {}
  }
};

}  // namespace lightwell::runtime::gl
