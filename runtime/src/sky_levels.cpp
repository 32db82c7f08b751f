#include "runtime/src/sky_levels.h"

#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"

namespace lightwell::runtime {
namespace {

constexpr double kPi = 3.14159265358979323846, kQuarterPi = kPi / 4;
constexpr uint32_t kCoarsestFace = 16, kTileNodes = 8;  // nodes along an edge of a tile
constexpr float kKinkedShininess = 4, kKinkSpacing = 0.05f;  // below, the lobe's slope breaks at the horizon: it takes nodes at least this close
constexpr float kNegligible = 1e-7f;                         // of the lobe's peak

/// Four consecutive nodes on a line and the weights of cubic Lagrange interpolation at `position` in [0, m].
struct Stencil {
  uint32_t first;
  double weight[4];
};
Stencil cubicStencil(double position, uint32_t m) {
  const double inside = std::clamp(position, 0.0, double(m));
  const double floor = std::floor(inside);
  const uint32_t first = std::min(floor > 1 ? uint32_t(floor) - 1 : 0u, m - 3);
  const double t = inside - first;
  return {first, {(t - 1) * (t - 2) * (t - 3) / -6, t * (t - 2) * (t - 3) / 2, t * (t - 1) * (t - 3) / -2, t * (t - 1) * (t - 2) / 6}};
}

double nodeTangent(double i, uint32_t m) { return std::tan((2 * i / m - 1) * kQuarterPi); }

/// The masses of a sky of radiance 1 on one face's nodes, [(m + 1)²]: cubic interpolation's weights, integrated with Gauss-Legendre points.
bool uniformMass(const Host& host, uint32_t m, Array<double>& mass) {
  constexpr double abscissa[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr double gauss_weight[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  struct Point {
    double tangent, weight;
    Stencil stencil;
  };
  Array<Point> points;
  if (!points.allocate(host, size_t(m) * 4) || !mass.allocate(host, size_t(m + 1) * (m + 1))) return false;
  for (size_t i = 0; i < points.size(); ++i) {
    const double position = double(i / 4) + 0.5 * (1 + abscissa[i % 4]), tangent = nodeTangent(position, m);
    points[i] = {tangent, gauss_weight[i % 4] * kQuarterPi / m * (1 + tangent * tangent), cubicStencil(position, m)};
  }
  for (double& v : mass) v = 0;
  for (const Point& b : points)
    for (const Point& a : points) {
      const double square = 1 + a.tangent * a.tangent + b.tangent * b.tangent, solid_angle = a.weight * b.weight / (square * std::sqrt(square));
      for (uint32_t j = 0; j < 4; ++j)
        for (uint32_t i = 0; i < 4; ++i)
          mass[(b.stencil.first + j) * size_t(m + 1) + a.stencil.first + i] += solid_angle * a.stencil.weight[i] * b.stencil.weight[j];
    }
  return true;
}

/// The same masses on half as many cells along an edge.
bool coarsen(const Host& host, uint32_t m, const Array<double>& mass_rgb, Array<double>& coarse_rgb) {
  const uint32_t half = m / 2;
  const size_t stride = half + 1;
  Array<Stencil> stencil;
  if (!stencil.allocate(host, size_t(m) + 1) || !coarse_rgb.allocate(host, 18 * stride * stride)) return false;
  for (uint32_t i = 0; i <= m; ++i) stencil[i] = cubicStencil(0.5 * i, half);
  for (double& v : coarse_rgb) v = 0;
  const double* from = mass_rgb.data();
  for (size_t face = 0; face < 6; ++face)
    for (uint32_t y = 0; y <= m; ++y)
      for (uint32_t x = 0; x <= m; ++x, from += 3)
        for (uint32_t j = 0; j < 4; ++j)
          for (uint32_t i = 0; i < 4; ++i) {
            const double weight = stencil[x].weight[i] * stencil[y].weight[j];
            double* to = &coarse_rgb[((face * stride + stencil[y].first + j) * stride + stencil[x].first + i) * 3];
            for (int c = 0; c < 3; ++c) to[c] += weight * from[c];
          }
  return true;
}

/// Unit direction at tangents of node coordinates (x, y) on a face: axis ±x, ±y, ±z, then the two next axes in cyclic order.
void faceDirection(uint32_t face, double x, double y, uint32_t m, float* direction) {
  const uint32_t axis = face / 2;
  const double a = nodeTangent(x, m), b = nodeTangent(y, m), scale = 1 / std::sqrt(1 + a * a + b * b);
  direction[axis] = float(face % 2 == 0 ? scale : -scale);
  direction[(axis + 1) % 3] = float(a * scale);
  direction[(axis + 2) % 3] = float(b * scale);
}

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool buildLevel(const Host& host, uint32_t m, const Array<double>& mass_rgb, const double* mean_radiance_rgb, SkyLevel& level) {
  Array<double> uniform;
  const uint32_t side = m + 1, tiles_along = (side + kTileNodes - 1) / kTileNodes;
  if (!uniformMass(host, m, uniform) || !level.nodes.allocate(host, size_t(6) * side * side) ||
      !level.tiles.allocate(host, size_t(6) * tiles_along * tiles_along + 1))
    return false;
  level.spacing_rad = float(kPi / (2 * m));
  float least_cosine = 1;
  uint32_t node = 0, tile = 0;
  for (uint32_t face = 0; face < 6; ++face)
    for (uint32_t y0 = 0; y0 < side; y0 += kTileNodes)
      for (uint32_t x0 = 0; x0 < side; x0 += kTileNodes) {
        const uint32_t x1 = std::min(x0 + kTileNodes, side), y1 = std::min(y0 + kTileNodes, side);
        SkyTile& t = level.tiles[tile++];
        t.first = node;
        faceDirection(face, 0.5 * (x0 + x1 - 1), 0.5 * (y0 + y1 - 1), m, t.center);
        for (uint32_t y = y0; y < y1; ++y)
          for (uint32_t x = x0; x < x1; ++x) {
            SkyNode& n = level.nodes[node++];
            faceDirection(face, x, y, m, n.direction);
            const size_t on_face = size_t(y) * side + x;
            for (uint32_t c = 0; c < 3; ++c)
              n.mass_rgb[c] = float(mass_rgb[(face * size_t(side) * side + on_face) * 3 + c] - mean_radiance_rgb[c] * uniform[on_face]);
            least_cosine = std::min(least_cosine, dot(t.center, n.direction));
          }
      }
  level.tiles[tile] = {{0, 0, 0}, node};
  level.cos_tile = least_cosine - 1e-6f;
  level.sin_tile = std::sqrt(std::max(0.0f, 1 - level.cos_tile * level.cos_tile));
  return true;
}

}  // namespace

bool nodeMasses(const Host& host, const format::EnvironmentHeader& header, const Array<uint16_t>& node_half, Array<double>& mass_rgb) {
  if (!mass_rgb.allocate(host, node_half.size())) return false;
  const double unit = header.node_scale * 4 * kPi / (6.0 * header.face_cells * header.face_cells);
  for (size_t i = 0; i < node_half.size(); ++i) mass_rgb[i] = unit * format::unpackHalf(node_half[i]);
  return true;
}

bool SkyLevels::build(const Host& host, const format::EnvironmentHeader& header, const Array<uint16_t>& node_half) {
  uint32_t m = header.face_cells;
  Array<double> mass_rgb, coarse_rgb;
  if (!nodeMasses(host, header, node_half, mass_rgb)) return false;
  double total[3] = {};
  for (size_t i = 0; i < mass_rgb.size(); ++i) total[i % 3] += mass_rgb[i];
  double grid_mean[3];
  for (int c = 0; c < 3; ++c) {
    mean_radiance_rgb_[c] = header.sky_flux_rgb[c] / (4 * kPi);
    grid_mean[c] = total[c] / (4 * kPi);  // what rounding left of it: the rest then adds to zero
  }
  for (level_count_ = 0; level_count_ < kMostLevels;) {
    if (!buildLevel(host, m, mass_rgb, grid_mean, levels_[level_count_++])) return false;
    if (m % 4 != 0 || m / 2 < kCoarsestFace) break;
    if (!coarsen(host, m, mass_rgb, coarse_rgb)) return false;
    mass_rgb = static_cast<Array<double>&&>(coarse_rgb);
    m /= 2;
  }
  return true;
}

float SkyLevels::maxShininess() const {
  const float ratio = kFinestRatio / levels_[0].spacing_rad;
  return std::max(1.0f, ratio * ratio);
}

const SkyLevel& SkyLevels::levelFor(float shininess, float node_ratio) const {
  uint32_t chosen = 0;
  while (chosen + 1 < level_count_) {
    const float spacing = levels_[chosen + 1].spacing_rad;
    if (spacing * std::sqrt(shininess) > node_ratio || (shininess < kKinkedShininess && spacing > kKinkSpacing)) break;
    ++chosen;
  }
  return levels_[chosen];
}

void SkyLevels::addIntegral(const float* axis, float shininess, double* sum_rgb, float node_ratio) const {
  const float n = std::min(shininess, maxShininess());
  const SkyLevel& level = levelFor(n, node_ratio);
  const float least_cosine = std::pow(kNegligible, 1 / n);
  // cos(ψ + r) of the lobe's end ψ and a tile's radius r: farther tiles hold nothing. Beyond ψ + r = π there are none.
  const float sine = std::sqrt(std::max(0.0f, 1 - least_cosine * least_cosine));
  const float least_to_tile = level.cos_tile < -least_cosine ? -2.0f : least_cosine * level.cos_tile - sine * level.sin_tile - 1e-5f;
  double sum[3] = {};
  for (size_t t = 0; t + 1 < level.tiles.size(); ++t) {
    const SkyTile& tile = level.tiles[t];
    if (dot(tile.center, axis) < least_to_tile) continue;
    float tile_sum[3] = {};
    for (const SkyNode *node = &level.nodes[tile.first], *end = level.nodes.data() + (&tile)[1].first; node != end; ++node) {
      const float cosine = dot(node->direction, axis);
      if (cosine <= least_cosine) continue;
      const float lobe = n == 1 ? cosine : std::exp(n * std::log(std::min(cosine, 1.0f)));
      for (int c = 0; c < 3; ++c) tile_sum[c] += node->mass_rgb[c] * lobe;
    }
    for (int c = 0; c < 3; ++c) sum[c] += tile_sum[c];
  }
  const double full = 2 * kPi / (double(n) + 1), same_energy = (double(n) + 1) / (double(shininess) + 1);
  for (int c = 0; c < 3; ++c) sum_rgb[c] += (sum[c] + mean_radiance_rgb_[c] * full) * same_energy;
}

}  // namespace lightwell::runtime
