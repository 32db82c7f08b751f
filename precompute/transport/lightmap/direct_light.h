// Light straight from lamps, emitters and the sky on every side of the surface, with more samples where shadows have their edges.
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/lightmap/direct_sampler.h"
#include "precompute/transport/lightmap/gather.h"
#include "precompute/transport/reference/path_batch.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

struct DirectOptions {
  uint32_t samples = 16;         // per side, at least: a multiple of 4
  uint32_t most_samples = 1024;  // per front
  uint32_t edge_samples = 256;   // per front where neighbouring texels differ
  float error = 0.015f;          // standard error that is aimed at, relative to the irradiance and a tenth of the scene's mean
  uint32_t soft_samples = 128;   // per front, of emitters of many kinds and the sky: a multiple of 4; an eighth of it on backs
  uint64_t seed = 1;
  const TiltKernel* tilt = nullptr;  // null: gradients are not wanted
};

/// Light of lamps and plain emitters, with `options.samples` samples on each of the sides [first, end): their means, in order.
std::vector<Rgb> firstDirectLight(const DirectSampler::Context& context, const DirectOptions& options, uint32_t first, uint32_t end);

/// The same with ever four times as many samples where the error wants it, and at once with many where the first samples of neighbouring texels differ: a lamp that is
/// near, or a shadow's edge, may have been missed by all of a texel's first samples. Backs, which only matter for what they reflect, are left as they are.
/// `first_light_rgb`: firstDirectLight of all sides. Two independent estimates.
GatheredPair directLight(const DirectSampler::Context& context, const DirectOptions& options, std::span<const Rgb> first_light_rgb, uint32_t first, uint32_t end);

/// Light of emitters that are not plain and of the sky, which has soft shadows only and is shared between texels: two independent estimates. `context` has no lamps.
GatheredPair softLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end);

/// Where light straight from lamps is looked up by rays that end on a texel.
enum class LookUp : uint8_t {
  by_distance,  // one value for all of the texel, but for rays that start near
  at_point,     // it is so far from that of a texel beside it that one value will not do for what sees a part of it
  of_texel,     // a spot much smaller than the texel, which points would miss
};
/// LookUp of each slot.
std::vector<uint8_t> unevenSlots(const scene::Mesh& mesh, const atlas::Atlas& atlas, const PunctualLights& lamps, std::span<const Rgb> irradiance_rgb);

}  // namespace lightwell::transport
