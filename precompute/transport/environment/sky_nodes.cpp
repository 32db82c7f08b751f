#include "precompute/transport/environment/sky_nodes.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr double kQuarterPi = std::numbers::pi / 4;

/// Four consecutive nodes on a line and their weights.
struct Stencil {
  uint32_t first;
  std::array<double, 4> weight;
};

/// Cubic Lagrange weights at `position` in [0, m], moved inward at the ends of the line.
Stencil cubicStencil(double position, uint32_t m) {
  const double inside = std::clamp(position, 0.0, double(m));
  const uint32_t first = std::min(uint32_t(std::max(0.0, std::floor(inside) - 1)), m - 3);
  const double t = inside - first;
  return {first, {(t - 1) * (t - 2) * (t - 3) / -6, t * (t - 2) * (t - 3) / 2, t * (t - 1) * (t - 3) / -2, t * (t - 1) * (t - 2) / 6}};
}

double nodeTangent(uint32_t i, uint32_t m) { return std::tan((2.0 * i / m - 1) * kQuarterPi); }

}  // namespace

Vec3d SkyNodes::direction(uint32_t m, size_t index) {
  const size_t per_face = size_t(m + 1) * size_t(m + 1);
  const uint32_t face = uint32_t(index / per_face), j = uint32_t(index % per_face / (m + 1)), i = uint32_t(index % (m + 1));
  const int axis = int(face / 2);
  Vec3d d;
  d[axis] = face % 2 == 0 ? 1 : -1;
  d[(axis + 1) % 3] = nodeTangent(i, m);
  d[(axis + 2) % 3] = nodeTangent(j, m);
  return d.normalized();
}

void SkyNodes::splat(const Vec3d& d, const std::array<double, 3>& flux_rgb) {
  const int axis = std::abs(d.x) >= std::abs(d.y) && std::abs(d.x) >= std::abs(d.z) ? 0 : std::abs(d.y) >= std::abs(d.z) ? 1 : 2;
  const double depth = std::abs(d[axis]), m = face_cells;
  const auto position = [&](double tangent) { return (std::atan(tangent) / kQuarterPi + 1) * 0.5 * m; };
  const Stencil column = cubicStencil(position(d[(axis + 1) % 3] / depth), face_cells);
  const Stencil row = cubicStencil(position(d[(axis + 2) % 3] / depth), face_cells);
  const size_t stride = face_cells + 1, face = size_t(axis) * 2 + (d[axis] < 0);
  for (size_t j = 0; j < 4; ++j)
    for (size_t i = 0; i < 4; ++i) {
      const double weight = column.weight[i] * row.weight[j];
      auto& mass = mass_rgb[(face * stride + row.first + j) * stride + column.first + i];
      for (size_t c = 0; c < 3; ++c) mass[c] += weight * flux_rgb[c];
    }
}

void SkyNodes::add(const SkyNodes& other) {
  for (size_t n = 0; n < mass_rgb.size(); ++n)
    for (size_t c = 0; c < 3; ++c) mass_rgb[n][c] += other.mass_rgb[n][c];
}

SkyNodes SkyNodes::coarser() const {
  SkyNodes half(face_cells / 2);
  const size_t fine_stride = face_cells + 1, stride = half.face_cells + 1;
  std::vector<Stencil> stencil;
  for (uint32_t i = 0; i <= face_cells; ++i) stencil.push_back(cubicStencil(0.5 * i, half.face_cells));
  for (size_t face = 0; face < 6; ++face)
    for (size_t y = 0; y < fine_stride; ++y)
      for (size_t x = 0; x < fine_stride; ++x) {
        const auto& from = mass_rgb[(face * fine_stride + y) * fine_stride + x];
        for (size_t j = 0; j < 4; ++j)
          for (size_t i = 0; i < 4; ++i) {
            const double weight = stencil[x].weight[i] * stencil[y].weight[j];
            if (weight == 0) continue;
            auto& to = half.mass_rgb[(face * stride + stencil[y].first + j) * stride + stencil[x].first + i];
            for (size_t c = 0; c < 3; ++c) to[c] += weight * from[c];
          }
      }
  return half;
}

std::vector<double> uniformNodeMass(uint32_t m) {
  // Gauss-Legendre points, four a cell; dω = da db / (1 + a² + b²)^(3/2) with a = tan α, da = (1 + a²) dα.
  constexpr std::array abscissa = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr std::array gauss_weight = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  struct Point {
    double tangent, weight;
    Stencil stencil;
  };
  std::vector<Point> points;
  for (uint32_t cell = 0; cell < m; ++cell)
    for (size_t k = 0; k < 4; ++k) {
      const double position = cell + 0.5 * (1 + abscissa[k]);
      const double tangent = std::tan((2 * position / m - 1) * kQuarterPi);
      points.push_back({tangent, gauss_weight[k] * kQuarterPi / m * (1 + tangent * tangent), cubicStencil(position, m)});
    }
  std::vector<double> mass(size_t(m + 1) * size_t(m + 1), 0.0);
  for (const Point& b : points)
    for (const Point& a : points) {
      const double solid_angle = a.weight * b.weight / std::pow(1 + a.tangent * a.tangent + b.tangent * b.tangent, 1.5);
      for (size_t j = 0; j < 4; ++j)
        for (size_t i = 0; i < 4; ++i)
          mass[(b.stencil.first + j) * (m + 1) + a.stencil.first + i] += solid_angle * a.stencil.weight[i] * b.stencil.weight[j];
    }
  return mass;
}

}  // namespace lightwell::transport
