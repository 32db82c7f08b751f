// The light of many virtual lights on a texel: the cut of them that matters there, shadow rays, and what a clamp took away.
#pragma once
#include <vector>

#include "cli/vpl_evaluator.h"
#include "precompute/core/random.h"
#include "precompute/transport/many_lights/light_cut.h"
#include "precompute/transport/reference/punctual.h"

namespace lightwell::cli {

/// What all texels share. Metres.
struct VirtualLightSet {
  VirtualLightSet(const VplEvaluation& evaluation, std::vector<lw_virtual_light> all);

  std::vector<lw_virtual_light> lights;
  transport::LightTree tree;        // of the lights that are asked for
  transport::LightTree whole_tree;  // of all of them
  double mean_irradiance = 0;     // luminous, if what the lights give were spread evenly over all surfaces
  float most_share = 0;           // irradiance ÷ flux of a point is at most this, 1/m²; 0: no clamp
  std::vector<Rgb> albedo_rgb, emission_rgb;  // [slots], of what is restored; empty when nothing is
  transport::PunctualLights lamps;            // internal units
};

/// Points of each texel.
uint32_t pointsOf(const VplEvaluation& evaluation);

struct TexelLightResult {
  Rgb irradiance_rgb{0.0f};
  double removed = 0, restored = 0;  // luminous irradiance: by the clamp, and what makes up for it (irradiance_rgb has it)
  uint64_t rays = 0, lights = 0;     // lights: looked at by a point, all points together
};

/// One texel after the other; keeps its arrays.
class TexelLight {
 public:
  TexelLight(const VplEvaluation& evaluation, const VirtualLightSet& set);

  TexelLightResult of(const atlas::Slot& slot);

 private:
  struct At {
    Vec3 position, position_m, normal, geometric_normal;  // position: internal units
  };
  struct Shadowed {
    trace::Ray ray;
    Vec3d irradiance_rgb;
    double removed;
  };
  At placed(const Vec3& position, const Vec3& normal, const Vec3& geometric_normal) const;
  transport::Receivers around(std::span<const At> at) const;
  /// Irradiance by a light without shadow, clamped; `removed` by the clamp, luminous.
  Vec3d irradiance(uint32_t light, const At& at, double& removed) const;
  /// A segment to the point of a light at `uv`; `weight`: what that point gives, as far as it differs over the light. False for nothing.
  bool segmentTo(uint32_t light, const At& at, const Vec2& uv, uint32_t key, trace::Ray& ray, float& weight) const;
  /// Sum over the nodes of the cut, mean over the points.
  Vec3d sumOfCut(const transport::LightTree& tree, std::span<const uint32_t> nodes, std::span<const At> at, const Sampler& sampler, uint32_t stream);
  Vec3d ofSingle(uint32_t light, std::span<const At> at, const Sampler& sampler);
  Vec3d restored(std::span<const At> at, const Sampler& sampler);
  Vec3d reflected(const trace::Ray& ray, const trace::Hit& hit);

  const VplEvaluation& evaluation_;
  const VirtualLightSet& set_;
  float metres_;
  transport::LightCut cut_, second_cut_;
  TexelLightResult result_;
  std::vector<At> at_;
  std::vector<Shadowed> shadowed_;
  std::vector<trace::Ray> rays_;
  std::vector<float> weight_, visibility_;
  std::vector<transport::PunctualLights::Sample> lamp_samples_;
};

}  // namespace lightwell::cli
