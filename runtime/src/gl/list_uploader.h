// What every upload does: scratch memory and lists of texels, the first failure kept.
#pragma once
#include "runtime/src/gl/texture.h"

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

  const Api& api_;
  const Host& host_;
  uint64_t& texture_bytes_;
  lw_result result_ = LW_OK;
};

}  // namespace lightwell::runtime::gl
