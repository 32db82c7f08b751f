// Answers from what the container holds: the light of the whole environment, unoccluded, for a diffuse or a Phong lobe.
#pragma once
#include "precompute/transport/environment/environment.h"
#include "precompute/transport/environment/reflectivity.h"

namespace lightwell::transport {

/// ∫ L(ω) max(0, cos ψ)^shininess dω, ψ from `axis` (unit). Shininess 1 about a normal is the irradiance. In [1, 1e5].
struct EnvironmentQuery {
  Vec3 axis;
  float shininess = 1;
};

class EnvironmentEvaluator {
 public:
  explicit EnvironmentEvaluator(const Environment& environment);  // copies what it needs

  /// The sky's nodes and the suns: the default. Lobes narrower than maxShininess() see the sky with that one, at their own energy; suns
  /// always sharp.
  Rgb answer(const EnvironmentQuery& query) const;
  /// Mean radiance under the GGX filter of a perceptual roughness about the mirror direction (see ggx_lobes.h).
  Rgb ggxRadiance(const Vec3& mirror, float roughness) const;
  /// Cells alone, as light that is tested for visibility cell by cell.
  Rgb answerFromCells(const EnvironmentQuery& query, Reflectivity model) const;
  float maxShininess() const { return max_shininess_; }

 private:
  struct Level {
    float spacing_rad;
    std::vector<Vec3> direction;
    std::vector<Rgb> mass_rgb;  // less the mean radiance, which is answered in closed form
  };
  Rgb skyAnswer(const EnvironmentQuery& query) const;

  EnvironmentCells cells_;
  std::vector<Level> levels_;  // finest first
  Rgb mean_radiance_rgb_;
  float max_shininess_;
};

}  // namespace lightwell::transport
