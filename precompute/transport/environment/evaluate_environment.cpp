#include "precompute/transport/environment/evaluate_environment.h"

#include <algorithm>

#include "format/decode/pixel.h"
#include "precompute/transport/environment/ggx_lobes.h"
#include "precompute/transport/environment/sky_nodes.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kCoarsestFace = 16;
// Node spacing over the lobe's standard deviation 1/√n: what the finest level is trusted with, and what a coarser one must reach.
constexpr float kFinestRatio = 0.9f, kCoarserRatio = 0.5f;
constexpr float kKinkedShininess = 4;  // below, the lobe's slope breaks at the horizon: it takes nodes at least this close:
constexpr float kKinkSpacing = 0.05f;
constexpr float kNegligible = 1e-7f;   // of the lobe's peak

}  // namespace

EnvironmentEvaluator::EnvironmentEvaluator(const Environment& environment) : cells_(environment.cells) {
  const EnvironmentSky& sky = environment.sky;
  const double node_solid_angle = 4 * std::numbers::pi / (6.0 * sky.face_cells * sky.face_cells);
  SkyNodes nodes(sky.face_cells);
  std::array<double, 3> total{};
  for (size_t n = 0; n < nodes.mass_rgb.size(); ++n)
    for (size_t c = 0; c < 3; ++c)
      total[c] += nodes.mass_rgb[n][c] = double(format::unpackHalf(sky.value[n * 3 + c])) * sky.scale * node_solid_angle;
  for (uint32_t face_cells = sky.face_cells;; face_cells /= 2) {
    Level level;
    level.spacing_rad = kPi / (2 * float(face_cells));
    const std::vector<double> uniform = uniformNodeMass(face_cells);
    for (size_t n = 0; n < nodes.mass_rgb.size(); ++n) {
      level.direction.push_back(Vec3(SkyNodes::direction(face_cells, n)));
      Rgb rest;
      for (size_t c = 0; c < 3; ++c)
        rest[int(c)] = float(nodes.mass_rgb[n][c] - total[c] / (4 * std::numbers::pi) * uniform[n % uniform.size()]);
      level.mass_rgb.push_back(rest);
    }
    levels_.push_back(std::move(level));
    if (face_cells % 4 != 0 || face_cells / 2 < kCoarsestFace) break;
    nodes = nodes.coarser();
  }
  mean_radiance_rgb_ = sky.flux_rgb / (4 * kPi);
  max_shininess_ = std::pow(kFinestRatio / levels_.front().spacing_rad, 2.0f);
}

Rgb EnvironmentEvaluator::skyAnswer(const EnvironmentQuery& query) const {
  const float n = std::min(query.shininess, max_shininess_);
  size_t chosen = 0;
  while (chosen + 1 < levels_.size()) {
    const float spacing = levels_[chosen + 1].spacing_rad;
    if (spacing * std::sqrt(n) > kCoarserRatio || (n < kKinkedShininess && spacing > kKinkSpacing)) break;
    ++chosen;
  }
  const Level& level = levels_[chosen];
  const float least_cosine = std::pow(kNegligible, 1 / n);
  std::array<double, 3> sum{};
  for (size_t i = 0; i < level.direction.size(); ++i) {
    const float cosine = level.direction[i].dot(query.axis);
    if (cosine <= least_cosine) continue;
    const float lobe = n == 1 ? cosine : std::exp(n * std::log(std::min(cosine, 1.0f)));
    for (int c = 0; c < 3; ++c) sum[size_t(c)] += double(level.mass_rgb[i][c]) * lobe;
  }
  const float full = 2 * kPi / (n + 1), same_energy = (n + 1) / (query.shininess + 1);
  Rgb answer;
  for (int c = 0; c < 3; ++c) answer[c] = std::max(0.0f, float(sum[size_t(c)] + double(mean_radiance_rgb_[c]) * full) * same_energy);
  return answer;
}

Rgb EnvironmentEvaluator::answer(const EnvironmentQuery& query) const {
  Rgb sum = skyAnswer(query);
  for (uint32_t i = 0; i < cells_.sun_count; ++i) {
    const CellShape sun = cellShape(cells_, i);
    sum += cells_.flux_rgb[i] * (query.shininess == 1 ? averageCosine(Reflectivity::spread, sun, query.axis)
                                                      : averageCosinePower(Reflectivity::spread, sun, query.axis, query.shininess));
  }
  return sum;
}

Rgb EnvironmentEvaluator::ggxRadiance(const Vec3& mirror, float roughness) const {
  Rgb sum(0, 0, 0);
  for (const PhongLobe& lobe : ggxLobes(roughness))
    sum += answer({mirror, lobe.shininess}) * (lobe.weight * (lobe.shininess + 1) / (2 * kPi));
  return sum;
}

Rgb EnvironmentEvaluator::answerFromCells(const EnvironmentQuery& query, Reflectivity model) const {
  std::array<double, 3> sum{};
  for (uint32_t i = 0; i < cells_.count(); ++i) {
    const CellShape cell = cellShape(cells_, i);
    const float average =
        query.shininess == 1 ? averageCosine(model, cell, query.axis) : averageCosinePower(model, cell, query.axis, query.shininess);
    for (int c = 0; c < 3; ++c) sum[size_t(c)] += double(cells_.flux_rgb[i][c]) * average;
  }
  return {float(sum[0]), float(sum[1]), float(sum[2])};
}

}  // namespace lightwell::transport
