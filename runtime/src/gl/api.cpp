#include "runtime/src/gl/api.h"

#include <cstring>

namespace lightwell::runtime::gl {
namespace {

template <class Function>
bool loadFunction(const lw_gl_config& config, const char* name, Function& function) {
  const lw_gl_proc address = config.loader(config.loader_user, name);
  std::memcpy(&function, &address, sizeof function);
  static_assert(sizeof function == sizeof address);
  return address != nullptr;
}

bool hasExtension(const Api& api, const char* name) {
  int32_t count = 0;
  api.GetIntegerv(kNumExtensions, &count);
  for (int32_t i = 0; i < count; ++i)
    if (const auto* extension = reinterpret_cast<const char*>(api.GetStringi(kExtensions, uint32_t(i))); extension && std::strcmp(extension, name) == 0) return true;
  return false;
}

}  // namespace

lw_result Api::load(const lw_gl_config& config, const Host& host) {
#define LW_GL_LOAD(result, name, parameters) \
  if (!loadFunction(config, "gl" #name, name)) return host.fail(LW_GL_UNSUPPORTED, "the loader found no gl" #name);
  LW_GL_FUNCTIONS(LW_GL_LOAD)
  const auto* text = reinterpret_cast<const char*>(GetString(kVersion));
  if (!text) return host.fail(LW_GL_UNSUPPORTED, "no OpenGL context is current");
  embedded = std::strncmp(text, "OpenGL ES", 9) == 0;
  int32_t major = 0, minor = 0;
  GetIntegerv(kMajorVersion, &major);
  GetIntegerv(kMinorVersion, &minor);
  version = major * 10 + minor;
  if (version < (embedded ? 30 : 33)) return host.fail(LW_GL_UNSUPPORTED, "OpenGL 3.3 or OpenGL ES 3.0 is needed; the context is %s", text);
  blends_floats = !embedded || hasExtension(*this, "GL_EXT_float_blend");
  if (embedded && version < 32 && !hasExtension(*this, "GL_EXT_color_buffer_float"))
    return host.fail(LW_GL_UNSUPPORTED, "the context has no EXT_color_buffer_float");
  indexed = !embedded || version >= 32;
  indexed_blending = version >= (embedded ? 32 : 40);
  if (indexed) {
    LW_GL_INDEXED_FUNCTIONS(LW_GL_LOAD)
  }
  if (indexed_blending) {
    LW_GL_INDEXED_BLENDING_FUNCTIONS(LW_GL_LOAD)
  }
  if (!embedded) {
    LW_GL_DESKTOP_FUNCTIONS(LW_GL_LOAD)
  }
#undef LW_GL_LOAD
  GetIntegerv(kMaxTextureSize, &max_texture_size);
  GetIntegerv(kMaxArrayTextureLayers, &max_array_layers);
  GetIntegerv(kMaxUniformBlockSize, &max_uniform_block_bytes);
  return LW_OK;
}

}  // namespace lightwell::runtime::gl
