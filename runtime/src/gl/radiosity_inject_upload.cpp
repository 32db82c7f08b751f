// Uploading what injecting light needs: the container's triangles, and whose light each of their texels receives.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/gl/radiosity_gl.h"
#include "runtime/src/radiosity_injector.h"

namespace lightwell::runtime::gl {
namespace {

/// Makes the textures one by one; the first failure stays in `result`.
class Uploader : ListUploader {
 public:
  /// `from` is the CPU's injector of the same geometry and form factors.
  Uploader(lw_gl_radiosity_injector& out, lw_radiosity_injector& from) 
      : ListUploader(out.target->context->api, out.host, out.texture_bytes), out_(out), from_(from) {}

  lw_result upload() {
    if (int32_t(out_.side) > api_.max_texture_size) return out_.host.fail(LW_LIMIT_EXCEEDED, "a view of %u pixels is larger than the context's textures", out_.side);
    out_.triangles = from_.surfaces.triangles();
    std::memcpy(out_.bounds_min_m, from_.bounds_min_m, sizeof out_.bounds_min_m);
    std::memcpy(out_.bounds_max_m, from_.bounds_max_m, sizeof out_.bounds_max_m);
    if (!out_.corner.allocate(out_.host, (size_t(out_.side) + 1) * 2)) return out_.host.fail(LW_OUT_OF_MEMORY, "no memory for a view of %u pixels", out_.side);
    api_.clearErrors();
    uploadTriangles();
    makeLeaves();
    uploadPatches();
    uploadAlpha(from_.surfaces.alpha, out_.alpha_material, out_.alpha);
    if (!result_) makeView();
    if (!result_)
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading triangles: GL error 0x%04x", error);
    return result_;
  }

 private:
  void uploadTriangles() {
    const uint64_t corners = uint64_t(out_.triangles) * 3;
    Array<float> corner;
    Array<uint32_t> triangle;
    if (!allocate(corner, corners * 8) || !allocate(triangle, uint64_t(out_.triangles) * 4)) return;
    const AlphaSurfaces& alpha = from_.surfaces.alpha;
    for (size_t c = 0; c < corners; ++c) {
      const size_t v = from_.surfaces.index[c];
      float* values = &corner[c * 8];
      std::memcpy(values, &from_.surfaces.position_m[v * 3], 3 * sizeof(float));
      std::memcpy(values + 3, &from_.lightmap_uv[v * 2], 2 * sizeof(float));
      for (size_t k = 0; k < 2; ++k) values[5 + k] = alpha.uv.empty() ? 0 : alpha.uv[v * 2 + k];
      values[7] = 0;
    }
    PatchFinder(from_).findNearest();
    for (size_t t = 0; t < out_.triangles; ++t) {
      const uint32_t material = alpha.triangle_material.empty() ? kNone : alpha.triangle_material[t];
      const Leaf* leaf = from_.surfaces.leafOf(uint32_t(t));
      const uint32_t leaf_number = leaf ? uint32_t(leaf - from_.surfaces.leaf.data()) + 1 : 0;
      const uint32_t values[4] = {leaf_number << 1 | (from_.flags[t] & uint32_t(LW_TRIANGLE_DOUBLE_SIDED) ? 1u : 0u), material < alpha.material.size() ? material : kNone,
                                  from_.nearest_patch[t * 2], from_.nearest_patch[t * 2 + 1]};
      std::memcpy(&triangle[t * 4], values, sizeof values);
    }
    list(out_.corners, kTexelRgba32f, corners * 2, corner.data());
    list(out_.triangle, kTexelRgba32ui, out_.triangles, triangle.data());
  }

  void makeLeaves() {
    const Array<Leaf>& leaves = from_.surfaces.leaf;
    const size_t gates = from_.surfaces.gate_open.size();
    Array<float>& values = out_.leaf_values;
    if (!allocate(values, std::max<size_t>(leaves.size() * 6 + gates, 1))) return;
    std::memset(values.data(), 0, values.bytes());
    for (size_t i = 0; i < leaves.size(); ++i) {
      std::memcpy(&values[i * 6], leaves[i].axis_per_m, 3 * sizeof(float));
      values[i * 6 + 3] = leaves[i].offset;
      values[i * 6 + 4] = float(leaves.size() * 6 + leaves[i].first_gate);
      values[i * 6 + 5] = float(leaves[i].strips);
    }
    list(out_.leaf, kTexelR32f, values.size(), values.data());
  }

  void uploadPatches() {
    const lw_radiosity& r = *from_.radiosity;
    const PatchFinder finder(from_);
    Array<uint32_t> texel;
    Array<float> patch;
    if (!allocate(texel, from_.value_of_texel.size() * 2) || !allocate(patch, uint64_t(r.patches()) * 4)) return;
    for (size_t t = 0; t < from_.value_of_texel.size(); ++t)
      for (const bool front : {true, false}) texel[t * 2 + !front] = finder.patchOf(uint32_t(t), front);
    for (size_t p = 0; p < r.patches(); ++p) {
      std::memcpy(&patch[p * 4], &r.patch_normal[p * 3], 3 * sizeof(float));
      patch[p * 4 + 3] = 1 / r.patch_area_m2[p];
    }
    out_.texel_patches = createPicture(api_, kTexelRg32ui, int32_t(r.width), int32_t(r.height), kNearest, texel.data(), out_.texture_bytes);
    list(out_.patch, kTexelRgba32f, r.patches(), patch.data());
  }

  void makeView() {
    const auto side = int32_t(out_.side);
    out_.depth = createPicture(api_, kTexelDepth32f, side, side, kNearest, nullptr, out_.texture_bytes);
    out_.seen.width = out_.seen.height = side;
    out_.seen.texture = createPicture(api_, kTexelRg32ui, side, side, kNearest, nullptr, out_.texture_bytes);
    result_ = attachTarget(api_, out_.host, out_.seen);
    if (result_) return;
    api_.FramebufferTexture2D(kDrawFramebuffer, kDepthAttachment, kTexture2d, out_.depth, 0);
    if (const Enum status = api_.CheckFramebufferStatus(kDrawFramebuffer); status != kFramebufferComplete)
      result_ = out_.host.fail(LW_GL_FAILED, "a framebuffer with depth is incomplete (0x%04x)", status);
  }

  lw_gl_radiosity_injector& out_;
  lw_radiosity_injector& from_;
};

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_radiosity_injector_create(lw_gl_radiosity* target, const lw_container* container, const lw_radiosity* radiosity, uint32_t side,
                                          lw_gl_radiosity_injector** out) {
  if (!target || !container || !radiosity || !out) return LW_INVALID_ARGUMENT;
  const gl::Api& api = target->context->api;
  if (!api.blends_floats) return target->host.fail(LW_GL_UNSUPPORTED, "injecting light adds up 32-bit floats; the context has no EXT_float_blend");
  if (side < 8 || side > 4096) return target->host.fail(LW_INVALID_ARGUMENT, "a view has 8 to 4096 pixels along its side, not %u", side);
  if (radiosity->patches() != target->patches || radiosity->width != target->width || radiosity->height != target->height)
    return target->host.fail(LW_INVALID_ARGUMENT, "the lw_gl_radiosity is of other form factors");
  lw_radiosity_injector* from = nullptr;
  if (const lw_result result = lw_radiosity_injector_create(container, radiosity, 8, &from)) return result;
  lw_gl_radiosity_injector* injector = createHandle<lw_gl_radiosity_injector>(target->host);
  lw_result result = LW_OK;
  if (injector) {
    injector->target = target;
    injector->side = side;
    const gl::StateGuard guard(api);
    result = gl::prepareInjection(*target->context);
    if (!result) result = gl::Uploader(*injector, *from).upload();
    api.clearErrors();
  } else {
    result = target->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the injector");
  }
  lw_radiosity_injector_destroy(from);
  if (result) {
    lw_gl_radiosity_injector_destroy(injector);
    return result;
  }
  *out = injector;
  return LW_OK;
}

void lw_gl_radiosity_injector_destroy(lw_gl_radiosity_injector* injector) {
  if (!injector) return;
  const gl::Api& api = injector->target->context->api;
  gl::destroyTarget(api, injector->seen);
  for (const gl::Name name : {injector->corners, injector->triangle, injector->texel_patches, injector->patch, injector->alpha_material, injector->alpha, injector->leaf, injector->depth})
    if (name) api.DeleteTextures(1, &name);
  destroyHandle(injector);
}

uint64_t lw_gl_radiosity_injector_texture_bytes(const lw_gl_radiosity_injector* injector) { return injector ? injector->texture_bytes : 0; }
