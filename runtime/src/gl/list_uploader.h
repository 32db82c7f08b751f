// What every upload does: scratch memory and lists of texels, the first failure kept.
#pragma once
#include <bit>
#include <cstring>

#include "runtime/src/gl/texture.h"
#include "runtime/src/radiosity_view.h"

namespace lightwell::runtime::gl {

class ListUploader {
 protected:
  /// `texture_bytes` receives the bytes of what is created.
  ListUploader(const Api& api, const Host& host, uint64_t& texture_bytes) : api_(api), host_(host), texture_bytes_(texture_bytes) {}

  template <class T>
  bool allocate(Array<T>& array, uint64_t count) {
    if (result_) return false;
    if (array.allocate(host_, size_t(count))) return true;
    result_ = host_.fail(LW_OUT_OF_MEMORY, "no memory for %llu values", static_cast<unsigned long long>(count));
    return false;
  }
  void list(Name& name, const TexelFormat& format, uint64_t count, const void* data) {
    if (result_) return;
    name = createList(api_, format, count, data, texture_bytes_);
    if (!name) result_ = host_.fail(LW_LIMIT_EXCEEDED, "%llu elements are more than the context's texture arrays hold", static_cast<unsigned long long>(count));
  }

  /// What kAlphaTest reads.
  void uploadAlpha(const AlphaSurfaces& alpha, Name& material_list, Name& alpha_list) {
    Array<uint32_t> material;
    if (!allocate(material, alpha.material.size() * 8)) return;
    for (size_t m = 0; m < alpha.material.size(); ++m) {
      const lw_alpha_material& surface = alpha.material[m];
      const bool textured = surface.texture >= 0, blends = surface.mode != LW_ALPHA_MASK;
      const uint32_t values[8] = {uint32_t(alpha.first_alpha[m]), textured ? surface.texture_width : 0, textured ? surface.texture_height : 0,
                                  (surface.wrap_u & 3) | surface.wrap_v << 2, std::bit_cast<uint32_t>(surface.factor),
                                  std::bit_cast<uint32_t>(blends ? 0.5f : surface.cutoff), std::bit_cast<uint32_t>(blends ? 1.0f : 0.0f), 0};
      std::memcpy(&material[m * 8], values, sizeof values);
    }
    list(material_list, kTexelRgba32ui, alpha.material.size() * 2, material.data());
    list(alpha_list, kTexelR8, alpha.alpha.size(), alpha.alpha.data());
  }

  const Api& api_;
  const Host& host_;
  uint64_t& texture_bytes_;
  lw_result result_ = LW_OK;
};

}  // namespace lightwell::runtime::gl
