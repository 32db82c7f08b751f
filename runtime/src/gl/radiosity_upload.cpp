// Uploading form factors, and what a game changes of materials, portals and light.
#include <algorithm>
#include <bit>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/gl/radiosity_gl.h"

namespace lightwell::runtime::gl {
namespace {

/// Makes the textures one by one; the first failure stays in `result`.
class Uploader : ListUploader {
 public:
  Uploader(lw_gl_radiosity& out, const lw_radiosity& radiosity, const lw_gl_radiosity_options& options)
      : ListUploader(out.context->api, out.host, out.texture_bytes), out_(out), r_(radiosity), options_(options) {}

  lw_result upload() {
    out_.patches = r_.patches();
    out_.gate_sets = r_.gate_sets;
    out_.materials = r_.header.material_count;
    if (!allocate(out_.gate_open, r_.gates)) return result_;
    out_.width = r_.width;
    out_.height = r_.height;
    out_.levels = r_.levels;
    std::memcpy(out_.level_first, r_.level_first, sizeof out_.level_first);
    if (int32_t(r_.width) > api_.max_texture_size || int32_t(r_.height) > api_.max_texture_size)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "the atlas of %u x %u texels is larger than the context's textures", r_.width, r_.height);
    if (r_.nodes() > kMaxTargetElements)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "more than %llu patches and nodes", static_cast<unsigned long long>(kMaxTargetElements));
    if (const lw_result result = prepareRadiosity(*out_.context)) return result;
    api_.clearErrors();
    uploadLinks();
    uploadTexels();
    makeTargets();
    if (!result_)
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading the form factors: GL error 0x%04x", error);
    return result_;
  }

 private:
  void target(uint64_t count, Target& target) {
    if (!result_) result_ = createTarget(api_, out_.host, kTexelRgba32f, count, target, out_.texture_bytes);
    if (!result_) clearTarget(api_, target);
  }

  void uploadLinks() {
    const size_t patches = out_.patches;
    Array<uint32_t> row;
    if (!allocate(row, patches * 4) || !allocate(out_.row_sum, patches)) return;
    uint32_t link = 0;
    for (size_t i = 0; i < patches; ++i) {
      const uint32_t values[4] = {r_.row_first_run[i], r_.row_first_run[i + 1], link, std::bit_cast<uint32_t>(r_.row_scale[i])};
      std::memcpy(&row[i * 4], values, sizeof values);
      double sum = 0;
      for (const uint32_t end = values[1] > values[0] ? r_.run[values[1] - 1].end_link : link; link < end; ++link) sum += double(linkWeight(r_.link[link] & 255));
      out_.row_sum[i] = float(std::min(sum * double(r_.row_scale[i]), 1.0));
    }
    list(out_.link, kTexelR32ui, r_.link.size(), r_.link.data());
    list(out_.row, kTexelRgba32ui, patches, row.data());
    static_assert(sizeof(LinkRun) == 8);
    list(out_.run, kTexelRg32ui, r_.run.size(), r_.run.data());
    list(out_.share, kTexelR32f, r_.nodes(), r_.node_share.data());
    list(out_.gate, kTexelR32f, out_.gate_sets, nullptr);
    list(out_.albedo, kTexelRgba32f, patches, nullptr);
    list(out_.emitted, kTexelRgba32f, patches, nullptr);
    list(out_.kept, kTexelRgba32f, patches, nullptr);
  }

  void uploadTexels() {
    const uint64_t atlas_texels = r_.source.size(), texels = r_.header.texels;
    Array<uint32_t> own, map, weight;
    if (!allocate(own, atlas_texels) || !allocate(map, atlas_texels * 2) || !allocate(weight, texels * 2)) return;
    std::memset(own.data(), 0xff, own.bytes());
    for (uint32_t i = 0; i < texels; ++i) {
      own[r_.texel[i]] = i;
      weight[size_t(i) * 2] = 0;
      for (uint32_t k = 0; k < 4; ++k) weight[size_t(i) * 2] |= uint32_t(r_.texel_weight[size_t(i) * 4 + k]) << (8 * k);
      weight[size_t(i) * 2 + 1] = r_.texel_exposed[i];
    }
    for (size_t i = 0; i < atlas_texels; ++i) {
      map[i * 2] = r_.source[i] == kNone ? kNone : own[r_.source[i]];
      map[i * 2 + 1] = own[i];
    }
    if (!result_)
      out_.texel_map = createPicture(api_, kTexelRg32ui, int32_t(out_.width), int32_t(out_.height), kNearest, map.data(), out_.texture_bytes);
    list(out_.texel_patch, kTexelRgba32ui, texels, r_.texel_patch.data());
    list(out_.texel_weight, kTexelRg32ui, texels, weight.data());
  }

  void makeTargets() {
    for (Target* t : {&out_.direct, &out_.emitters, &out_.irradiance[0], &out_.irradiance[1], &out_.irradiance[2]}) target(out_.patches, *t);
    for (Target* t : {&out_.node, &out_.level}) target(r_.nodes(), *t);
    if (result_) return;
    const bool full = options_.atlas_format == LW_GL_ATLAS_RGBA32F;
    out_.max_value = full ? 3.0e38f : 65504.0f;
    out_.owns_atlas = options_.atlas_texture == 0;
    out_.atlas.width = int32_t(out_.width);
    out_.atlas.height = int32_t(out_.height);
    out_.atlas.texture = out_.owns_atlas ? createPicture(api_, full ? kTexelRgba32f : kTexelRgba16f, out_.atlas.width, out_.atlas.height, kLinear, nullptr,
                                                         out_.texture_bytes)
                                         : options_.atlas_texture;
    result_ = attachTarget(api_, out_.host, out_.atlas);
    if (!result_ && out_.owns_atlas) clearTarget(api_, out_.atlas);
  }

  lw_gl_radiosity& out_;
  const lw_radiosity& r_;
  const lw_gl_radiosity_options& options_;
};

/// By patch, into a target; rows are padded.
lw_result uploadTarget(const lw_gl_radiosity& out, const Target& target, const Array<Float4>& values) {
  const Api& api = out.context->api;
  const size_t texels = size_t(target.width) * size_t(target.height);
  Array<Float4> padded;
  if (!padded.allocate(out.host, texels)) return out.host.fail(LW_OUT_OF_MEMORY, "no memory for %zu values", texels);
  std::memcpy(padded.data(), values.data(), values.bytes());
  std::memset(padded.data() + values.size(), 0, padded.bytes() - values.bytes());
  api.ActiveTexture(kTexture0);
  api.BindTexture(kTexture2d, target.texture);
  api.TexSubImage2D(kTexture2d, 0, 0, 0, target.width, target.height, kRgba, kFloat, padded.data());
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_radiosity_create(lw_gl* context, const lw_radiosity* radiosity, const lw_gl_radiosity_options* given, lw_gl_radiosity** out) {
  if (!context || !radiosity || !out) return LW_INVALID_ARGUMENT;
  const lw_gl_radiosity_options options = given ? *given : lw_gl_radiosity_options LW_GL_RADIOSITY_OPTIONS_INIT;
  if (options.size < sizeof options || options.atlas_format > LW_GL_ATLAS_RGBA32F)
    return context->host.fail(LW_INVALID_ARGUMENT, "lw_gl_radiosity_options: a value is out of range");
  lw_radiosity_state* as_baked = nullptr;
  lw_result result = lw_radiosity_state_create(radiosity, &as_baked);
  if (result) return result;
  lw_gl_radiosity* gl_radiosity = createHandle<lw_gl_radiosity>(context->host);
  if (!gl_radiosity) {
    lw_radiosity_state_destroy(as_baked);
    return context->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the form factors");
  }
  gl_radiosity->context = context;
  {
    const gl::StateGuard guard(context->api);
    result = gl::Uploader(*gl_radiosity, *radiosity, options).upload();
    context->api.clearErrors();
  }
  if (!result) result = lw_gl_radiosity_upload(gl_radiosity, as_baked, LW_GL_RADIOSITY_MATERIALS | LW_GL_RADIOSITY_PORTALS | LW_GL_RADIOSITY_BLOCKERS);
  lw_radiosity_state_destroy(as_baked);
  if (result) {
    lw_gl_radiosity_destroy(gl_radiosity);
    return result;
  }
  *out = gl_radiosity;
  return LW_OK;
}

lw_result lw_gl_radiosity_upload(lw_gl_radiosity* r, const lw_radiosity_state* state, uint32_t what) {
  if (!r || !state) return LW_INVALID_ARGUMENT;
  if (what > (LW_GL_RADIOSITY_MATERIALS | LW_GL_RADIOSITY_PORTALS | LW_GL_RADIOSITY_DIRECT | LW_GL_RADIOSITY_BLOCKERS))
    return r->host.fail(LW_INVALID_ARGUMENT, "nothing of this kind can be uploaded");
  if (state->albedo.size() != r->patches || state->gate_set_factor.size() != r->gate_sets || state->gate_open.size() != r->gate_open.size() || state->material.size() != r->materials)
    return r->host.fail(LW_INVALID_ARGUMENT, "the state is of other form factors");
  const gl::StateGuard guard(r->context->api);
  const gl::Api& api = r->context->api;
  api.ActiveTexture(gl::kTexture0);
  if (what & LW_GL_RADIOSITY_MATERIALS) {
    gl::uploadList(api, r->albedo, gl::kTexelRgba32f, r->patches, state->albedo.data());
    gl::uploadList(api, r->emitted, gl::kTexelRgba32f, r->patches, state->emitted.data());
    r->emits = state->emits;
    for (int k = 0; k < 3; ++k) {
      r->gain_rgb[k] = 0;
      for (size_t i = 0; i < r->patches; ++i) r->gain_rgb[k] = std::max(r->gain_rgb[k], state->albedo[i].v[k] * r->row_sum[i]);
    }
  }
  if (what & LW_GL_RADIOSITY_PORTALS) {
    gl::uploadList(api, r->gate, gl::kTexelR32f, r->gate_sets, state->gate_set_factor.data());
    std::memcpy(r->gate_open.data(), state->gate_open.data(), r->gate_open.bytes());
    ++r->portals_uploaded;
  }
  if (what & LW_GL_RADIOSITY_BLOCKERS) gl::uploadList(api, r->kept, gl::kTexelRgba32f, r->patches, state->kept.data());
  if (what & (LW_GL_RADIOSITY_MATERIALS | LW_GL_RADIOSITY_PORTALS)) r->emitters_valid = false;
  return what & LW_GL_RADIOSITY_DIRECT ? gl::uploadTarget(*r, r->direct, state->direct) : LW_OK;
}

void lw_gl_radiosity_destroy(lw_gl_radiosity* r) {
  if (!r) return;
  const gl::Api& api = r->context->api;
  if (!r->owns_atlas) r->atlas.texture = 0;
  for (gl::Target* target : {&r->direct, &r->emitters, &r->irradiance[0], &r->irradiance[1], &r->irradiance[2], &r->node, &r->level, &r->atlas})
    gl::destroyTarget(api, *target);
  for (const gl::Name name : {r->link, r->row, r->run, r->gate, r->share, r->albedo, r->emitted, r->kept, r->texel_map, r->texel_patch, r->texel_weight})
    if (name) api.DeleteTextures(1, &name);
  destroyHandle(r);
}

uint32_t lw_gl_radiosity_atlas_texture(const lw_gl_radiosity* r) { return r ? r->atlas.texture : 0; }
uint64_t lw_gl_radiosity_texture_bytes(const lw_gl_radiosity* r) { return r ? r->texture_bytes : 0; }
