// The truth for lamps that move: irradiance after exactly one reflection, by path tracing.
#pragma once
#include <span>
#include <vector>

#include "precompute/bake/container_scene.h"
#include "precompute/trace/tracer.h"

namespace lightwell::bench {

class OneBounce {
 public:
  /// All must outlive this. Albedo is the container's.
  OneBounce(const format::Reader& reader, const bake::ContainerScene& container, const trace::Tracer& tracer);

  /// Of slots of the atlas: `samples` paths each, the same for every light, so that differences between lights have hardly any noise.
  std::vector<Rgb> irradiance(std::span<const uint32_t> slots, const scene::Light& light, uint32_t samples, uint64_t seed, int threads) const;

 private:
  const bake::ContainerScene& container_;
  const trace::Tracer& tracer_;
  std::vector<Rgb> albedo_;  // of the atlas's texels
};

}  // namespace lightwell::bench
