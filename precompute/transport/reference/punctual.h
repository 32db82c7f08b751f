// Next-event estimation to point, spot and directional lights, whatever their number.
#pragma once
#include <vector>

#include "precompute/scene/scene.h"
#include "precompute/transport/reference/light_tree.h"

namespace lightwell::transport {

/// Few lights are all looked at; of many, one is picked from a light tree (point and spot) or by illuminance (directional).
class PunctualLights {
 public:
  /// `lights` must outlive this and not change.
  explicit PunctualLights(const std::vector<scene::Light>& lights);

  const std::vector<scene::Light>& lights() const { return lights_; }
  /// Indices of lights of which `sample` gives each a sample of its own, with `all_of_few`.
  const std::vector<uint32_t>& few() const { return few_; }

  struct Sample {
    Rgb irradiance_rgb;  // unoccluded, divided by the probability of the pick
    Vec3 to_light;       // unit
    float distance;      // internal units; infinite for a directional light
    uint32_t light;      // index into the lights
  };
  /// Appends to `samples` an unbiased estimate of the irradiance at `position` (unit normal `normal`). With `all_of_few` each of few
  /// lights gets a sample of its own; else one of them is picked by what it would give unoccluded. `u` in [0, 1).
  void sample(const Vec3& position, const Vec3& normal, bool all_of_few, float u, std::vector<Sample>& samples) const;

 private:
  const std::vector<scene::Light>& lights_;
  std::vector<uint32_t> few_;         // each looked at
  std::vector<uint32_t> local_;       // items of tree_
  LightTree tree_;
  std::vector<uint32_t> directional_;  // when many
  std::vector<double> directional_cdf_;
};

}  // namespace lightwell::transport
