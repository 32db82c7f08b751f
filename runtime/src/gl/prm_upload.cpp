// Uploading a precomputed radiance map: from the container's arrays to textures.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/frame.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/gl/prm_gl.h"
#include "runtime/src/prm.h"

namespace lightwell::runtime::gl {
namespace {

/// Makes the textures one by one; the first failure stays in `result`.
class Uploader : ListUploader {
 public:
  Uploader(lw_gl_prm& out, const lw_prm& prm, const lw_gl_prm_options& options)
      : ListUploader(out.context->api, out.host, out.texture_bytes), out_(out), prm_(prm), options_(options) {}

  lw_result upload() {
    const format::PrmHeader& h = prm_.header;
    out_.panes = !prm_.pane_sum_rgb.empty();
    out_.entries = h.entries;
    out_.clusters = h.clusters;
    out_.texels = h.texels;
    out_.blocks = out_.panes ? 0 : h.blocks;
    out_.quads = out_.panes ? 0 : (h.max_rank + 3) / 4;
    out_.width = prm_.width;
    out_.height = prm_.height;
    if (int32_t(prm_.width) > api_.max_texture_size || int32_t(prm_.height) > api_.max_texture_size)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "the atlas of %u x %u texels is larger than the context's textures", prm_.width,
                            prm_.height);
    if (h.entries > kMaxTargetElements || h.clusters >= kMaxTargetElements || uint64_t(out_.blocks) * out_.quads > kMaxTargetElements)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "more than %llu entry points, clusters or coefficients",
                            static_cast<unsigned long long>(kMaxTargetElements));
    api_.clearErrors();
    uploadEntries();
    if (out_.panes) uploadPanes();
    else uploadLocalBases();
    uploadTexels();
    makeTargets();
    if (!result_) result_ = out_.panes ? preparePanes(*out_.context) : reconstructsOnCpu() ? prepareOnCpu(out_) : prepareLocalBases(*out_.context);
    if (!result_ && !out_.entries_are_clusters) result_ = prepareClusters(*out_.context);
    if (!result_)
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading the radiance maps: GL error 0x%04x",
                              error);
    return result_;
  }

 private:
  void target(const TexelFormat& format, uint64_t count, Target& target) {
    if (!result_) result_ = createTarget(api_, out_.host, format, count, target, out_.texture_bytes);
  }

  void uploadEntries() {
    out_.entries_are_clusters = !out_.panes && out_.entries == out_.clusters;
    for (const float weight : prm_.entry_weight) out_.entries_are_clusters &= weight == 1.0f;
    Array<float> rgba;
    if (!allocate(rgba, uint64_t(out_.entries) * 4)) return;
    for (size_t e = 0; e < out_.entries; ++e) {
      std::memcpy(&rgba[e * 4], &prm_.entry_position_m[e * 3], 3 * sizeof(float));
      rgba[e * 4 + 3] = prm_.entry_weight[e];
    }
    list(out_.entry_position, kTexelRgba32f, out_.entries, rgba.data());
    const bool rectangles = !prm_.entry_rectangle.empty();
    for (size_t e = 0; e < out_.entries; ++e) {
      std::memcpy(&rgba[e * 4], &prm_.entry_normal[e * 3], 3 * sizeof(float));
      const float* half = rectangles ? &prm_.entry_rectangle[e * 3] : nullptr;
      rgba[e * 4 + 3] = half && half[0] > 0 && half[1] > 0 ? std::max(half[0], half[1]) : 0.0f;
    }
    list(out_.entry_normal, kTexelRgba32f, out_.entries, rgba.data());
    if (rectangles) {
      for (size_t e = 0; e < out_.entries; ++e) {
        const float *rectangle = &prm_.entry_rectangle[e * 3], turn_rad = rectangle[2] * 3.14159265f;
        const float along = rectangle[0] * std::cos(turn_rad), across = rectangle[0] * std::sin(turn_rad);
        float tangent[3], bitangent[3];
        frameAbout(&prm_.entry_normal[e * 3], tangent, bitangent);
        for (int k = 0; k < 3; ++k) rgba[e * 4 + k] = tangent[k] * along + bitangent[k] * across;
        rgba[e * 4 + 3] = rectangle[0] > 0 ? rectangle[1] / rectangle[0] : 0.0f;
      }
      list(out_.entry_rectangle, kTexelRgba32f, out_.entries, rgba.data());
    }
    Array<uint32_t> range;
    if (!allocate(range, uint64_t(out_.clusters) * 2) || !allocate(rgba, uint64_t(out_.clusters) * 4)) return;
    for (size_t c = 0; c < out_.clusters; ++c) {
      range[c * 2] = prm_.cluster_first_entry[c];
      range[c * 2 + 1] = prm_.cluster_first_entry[c + 1] - prm_.cluster_first_entry[c];
      for (int k = 0; k < 3; ++k) rgba[c * 4 + k] = out_.panes ? prm_.pane_sum_rgb[c * 3 + k] : 0.0f;
      rgba[c * 4 + 3] = 0.0f;
    }
    list(out_.cluster_range, kTexelRg32ui, out_.clusters, range.data());
    list(out_.pane_sum, kTexelRgba32f, out_.clusters, rgba.data());
  }

  void uploadPanes() {
    const uint64_t count = uint64_t(out_.clusters) * out_.texels;
    if (!allocate(out_.pane_sum_rgb, prm_.pane_sum_rgb.size())) return;
    std::memcpy(out_.pane_sum_rgb.data(), prm_.pane_sum_rgb.data(), prm_.pane_sum_rgb.bytes());
    if (prm_.pane_half.empty()) list(out_.pane, kTexelRgb9e5, count, prm_.pane_rgb9e5.data());
    else list(out_.pane, kTexelRgb16f, count, prm_.pane_half.data());
  }

  void uploadLocalBases() {
    out_.transport = retain(prm_);
    uint64_t basis_texels = 0;
    for (size_t b = 0; b < out_.blocks; ++b)
      basis_texels += uint64_t(prm_.block_first_texel[b + 1] - prm_.block_first_texel[b]) * ((prm_.block_rank[b] + 3u) / 4u);
    // Ranks are padded to fours, each four one RGBA texel.
    Array<int8_t> basis;
    if (!allocate(basis, basis_texels * 4)) return;
    std::memset(basis.data(), 0, basis.bytes());
    int8_t* to = basis.data();
    const int8_t* from = prm_.basis.data();
    for (size_t b = 0; b < out_.blocks; ++b) {
      const uint32_t rank = prm_.block_rank[b], padded = (rank + 3) / 4 * 4;
      for (uint32_t t = prm_.block_first_texel[b]; rank && t < prm_.block_first_texel[b + 1]; ++t, from += rank, to += padded)
        std::memcpy(to, from, rank);
    }
    list(out_.basis, kTexelRgba8Snorm, basis_texels, basis.data());
  }

  void picture(Name& name, const TexelFormat& format, const void* data) {
    if (!result_) name = createPicture(api_, format, int32_t(out_.width), int32_t(out_.height), kNearest, data, out_.texture_bytes);
  }

  /// Spreads the shown texels' values over the atlas, gutters included.
  template <class Write>
  void spread(Array<uint32_t>& value_of_texel, Write write) {
    const size_t atlas_texels = prm_.source.size();
    for (size_t i = 0; i < atlas_texels; ++i)
      write(i, prm_.source[i] == kNone ? kNone : value_of_texel[prm_.source[i]]);
  }

  void uploadTexels() {
    const uint64_t atlas_texels = prm_.source.size();
    Array<uint32_t> value_of_texel, map;
    if (!allocate(value_of_texel, atlas_texels) || !allocate(map, atlas_texels * 2)) return;
    std::memset(value_of_texel.data(), 0xff, value_of_texel.bytes());
    for (uint32_t i = 0; i < out_.texels; ++i) value_of_texel[prm_.texel[i]] = i;
    uploadConstants(value_of_texel);
    Array<uint32_t> address;  // per value: what the shader needs to find it
    if (!allocate(address, uint64_t(out_.texels) * 2)) return;
    if (out_.panes) {
      for (uint32_t i = 0; i < out_.texels; ++i) address[size_t(i) * 2] = i, address[size_t(i) * 2 + 1] = 0;
    } else {
      uint32_t at = 0;
      for (uint32_t b = 0; b < out_.blocks; ++b)
        for (uint32_t t = prm_.block_first_texel[b]; t < prm_.block_first_texel[b + 1]; ++t, at += (prm_.block_rank[b] + 3u) / 4u)
          address[size_t(t) * 2] = at, address[size_t(t) * 2 + 1] = b | (prm_.block_rank[b] + 3u) / 4u << 22;
    }
    spread(value_of_texel, [&](size_t i, uint32_t value) {
      map[i * 2] = value == kNone ? kNone : address[size_t(value) * 2];
      map[i * 2 + 1] = (value == kNone ? 0 : address[size_t(value) * 2 + 1]) | (prm_.source[i] == i ? 0 : 0x80000000u);
    });
    picture(out_.texel_map, kTexelRg32ui, map.data());
    uploadBuried(value_of_texel, address);
  }

  /// What emitters and sky add to the texels.
  void uploadConstants(Array<uint32_t>& value_of_texel) {
    const Array<uint32_t>* panes[4];
    if (prm_.header.has_emitter)
      panes[out_.constants++] = &prm_.emitter_direct_rgb9e5, panes[out_.constants++] = &prm_.emitter_indirect_rgb9e5;
    if (prm_.header.has_sky)
      panes[out_.constants++] = &prm_.sky_direct_rgb9e5, panes[out_.constants++] = &prm_.sky_indirect_rgb9e5;
    if (!out_.constants) return;
    out_.has_emitter = prm_.header.has_emitter;
    out_.has_sky = prm_.header.has_sky;
    out_.sky_scale = prm_.header.sky_scale;
    Array<uint32_t> values;
    const uint64_t count = uint64_t(prm_.source.size()) * out_.constants;
    if (!allocate(values, count)) return;
    spread(value_of_texel, [&](size_t i, uint32_t value) {
      for (uint32_t k = 0; k < out_.constants; ++k) values[i * out_.constants + k] = value == kNone ? 0 : (*panes[k])[value];
    });
    list(out_.constant, kTexelRgb9e5, count, values.data());
  }

  /// The values of texels that show another's; see kOwnValue.
  void uploadBuried(const Array<uint32_t>& value_of_texel, const Array<uint32_t>& address) {
    const auto isBuried = [&](size_t i) { return value_of_texel[i] != kNone && prm_.source[i] != i; };
    for (size_t i = 0; i < value_of_texel.size(); ++i) out_.buried_count += isBuried(i);
    Array<uint32_t> buried;
    if (!allocate(buried, uint64_t(out_.buried_count) * 8)) return;
    uint32_t* to = buried.data();
    for (size_t i = 0; i < value_of_texel.size(); ++i) {
      if (!isBuried(i)) continue;
      const size_t value = value_of_texel[i];
      const bool emitters = prm_.header.has_emitter, sky = prm_.header.has_sky;
      const uint32_t elements[8] = {uint32_t(i), address[value * 2], address[value * 2 + 1], 0,
                                    emitters ? prm_.emitter_direct_rgb9e5[value] : 0, emitters ? prm_.emitter_indirect_rgb9e5[value] : 0,
                                    sky ? prm_.sky_direct_rgb9e5[value] : 0, sky ? prm_.sky_indirect_rgb9e5[value] : 0};
      std::memcpy(to, elements, sizeof elements);
      to += 8;
    }
    list(out_.buried, kTexelRgba32ui, uint64_t(out_.buried_count) * 2, buried.data());
  }

  void makeTargets() {
    for (Target& t : out_.entry) target(kTexelRgba32f, out_.entries, t);
    target(kTexelRgba32f, out_.clusters, out_.cluster);
    if (out_.panes) {
      target(kTexelR32ui, out_.clusters, out_.rank);
      target(kTexelRgba32f, uint64_t(out_.clusters) + 1, out_.selected);
    } else {
      makeAmounts();
    }
    if (result_) return;
    const bool full = options_.atlas_format == LW_GL_ATLAS_RGBA32F;
    out_.max_value = full ? 3.0e38f : 65504.0f;
    out_.owns_atlas = options_.atlas_texture == 0;
    out_.atlas.width = int32_t(out_.width);
    out_.atlas.height = int32_t(out_.height);
    out_.atlas.texture = out_.owns_atlas ? createPicture(api_, full ? kTexelRgba32f : kTexelRgba16f, out_.atlas.width, out_.atlas.height,
                                                         kLinear, nullptr, out_.texture_bytes)
                                         : options_.atlas_texture;
    result_ = attachTarget(api_, out_.host, out_.atlas);
    if (result_) return;
    if (out_.owns_atlas) clearTarget(api_, out_.atlas);
    clearTarget(api_, out_.entry[0]);
    clearTarget(api_, out_.cluster);
  }

  /// Amounts come from the CPU each frame; see updateCoefficients.
  void makeAmounts() {
    const uint64_t count = uint64_t(out_.blocks) * out_.quads;
    out_.amount_width = int32_t(std::min<uint64_t>(count, 2048));
    out_.amount_height = int32_t((count + 2047) / 2048);  // at most 2048: kMaxTargetElements
    const uint64_t padded = uint64_t(out_.amount_width) * uint64_t(out_.amount_height);
    if (!allocate(out_.amount_rgba, padded * 16) || !allocate(out_.cluster_rgb, uint64_t(out_.clusters) * 3) ||
        !allocate(out_.cluster_rgba, uint64_t(out_.cluster.width) * uint64_t(out_.cluster.height) * 4))
      return;
    if (!out_.sums.allocate(out_.host, prm_)) return void(result_ = out_.host.fail(LW_OUT_OF_MEMORY, "no memory for the sums of %u blocks", out_.blocks));
    std::memset(out_.amount_rgba.data(), 0, out_.amount_rgba.bytes());
    out_.amount = createLayers(api_, kTexelRgba32f, out_.amount_width, out_.amount_height, 4, out_.amount_rgba.data(), out_.texture_bytes);
  }

  bool reconstructsOnCpu() const {
    return options_.reconstruct == LW_GL_RECONSTRUCT_AUTO ? out_.owns_atlas && isSoftware(api_) : options_.reconstruct == LW_GL_RECONSTRUCT_CPU;
  }

  lw_gl_prm& out_;
  const lw_prm& prm_;
  const lw_gl_prm_options& options_;
};

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_prm_create(lw_gl* context, const lw_prm* prm, const lw_gl_prm_options* given, lw_gl_prm** out) {
  if (!context || !prm || !out) return LW_INVALID_ARGUMENT;
  const lw_gl_prm_options options = given ? *given : lw_gl_prm_options LW_GL_PRM_OPTIONS_INIT;
  if (options.size < sizeof options || options.atlas_format > LW_GL_ATLAS_RGBA32F || options.reconstruct > LW_GL_RECONSTRUCT_CPU)
    return context->host.fail(LW_INVALID_ARGUMENT, "lw_gl_prm_options: a value is out of range");
  if (options.reconstruct == LW_GL_RECONSTRUCT_CPU && options.atlas_texture)
    return context->host.fail(LW_INVALID_ARGUMENT, "lw_gl_prm_options: the CPU makes the library's own atlas only");
  lw_gl_prm* gl_prm = createHandle<lw_gl_prm>(context->host);
  if (!gl_prm) return context->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the radiance maps");
  gl_prm->context = context;
  lw_result result;
  {
    const gl::StateGuard guard(context->api);
    result = gl::Uploader(*gl_prm, *prm, options).upload();
    context->api.clearErrors();
  }
  if (result) {
    lw_gl_prm_destroy(gl_prm);
    return result;
  }
  *out = gl_prm;
  return LW_OK;
}

void lw_gl_prm_destroy(lw_gl_prm* prm) {
  if (!prm) return;
  const gl::Api& api = prm->context->api;
  if (!prm->owns_atlas) prm->atlas.texture = 0;
  for (gl::Target* target : {&prm->entry[0], &prm->entry[1], &prm->cluster, &prm->rank, &prm->selected, &prm->atlas})
    gl::destroyTarget(api, *target);
  for (const gl::Name name :
       {prm->entry_position, prm->entry_normal, prm->entry_rectangle, prm->cluster_range, prm->pane_sum, prm->texel_map, prm->constant, prm->pane,
        prm->buried, prm->basis, prm->amount})
    if (name) api.DeleteTextures(1, &name);
  lw_prm_state_release(prm->state);
  lw_prm_release(prm->transport);
  destroyHandle(prm);
}

uint32_t lw_gl_prm_atlas_texture(const lw_gl_prm* prm) { return prm ? prm->atlas.texture : 0; }
uint64_t lw_gl_prm_texture_bytes(const lw_gl_prm* prm) { return prm ? prm->texture_bytes : 0; }
