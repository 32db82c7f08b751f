#include "precompute/transport/environment/bake_environment.h"

#include <algorithm>

#include "format/decode/pixel.h"
#include "precompute/core/error.h"
#include "precompute/core/parallel.h"
#include "precompute/transport/environment/sky_harmonics.h"
#include "precompute/transport/environment/sky_nodes.h"

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr int kBands = 16;  // fixed, so that sums are formed in the same order for any number of threads
constexpr double kSplatsPerCell = 4;  // along an edge: finer texels than this are spread as points, wider ones in parts

struct SkySums {
  SkyNodes nodes;
  std::array<double, 3> flux{};
  std::array<std::array<double, 3>, 9> harmonics{};
};

/// Spreads one texel in `parts` × `parts` pieces of equal radiance.
void splatTexel(const SkyGrid& grid, int x, int y, int parts, SkySums& sums) {
  const size_t i = size_t(y) * size_t(grid.width) + size_t(x);
  const auto add = [&](const Vec3d& direction, double share) {
    std::array<double, 3> flux;
    for (size_t c = 0; c < 3; ++c) sums.flux[c] += flux[c] = grid.flux_rgb[i][c] * share;
    sums.nodes.splat(direction, flux);
    const std::array<double, 9> basis = sphericalHarmonics(direction);
    for (size_t k = 0; k < 9; ++k)
      for (size_t c = 0; c < 3; ++c) sums.harmonics[k][c] += basis[k] * flux[c];
  };
  if (parts == 1) return add(Vec3d(grid.direction[i]), 1);
  const auto theta = [&](int part) { return (y + (part + 0.5) / parts) / grid.height * kPiD; };
  double weight = 0;
  for (int v = 0; v < parts; ++v) weight += std::sin(theta(v)) * parts;
  for (int v = 0; v < parts; ++v)
    for (int u = 0; u < parts; ++u)
      add(grid.directionAt(theta(v), ((x + (u + 0.5) / parts) / grid.width - 0.5) * 2 * kPiD), std::sin(theta(v)) / weight);
}

}  // namespace

EnvironmentSky bakeSky(const SkyGrid& grid, const std::vector<uint32_t>& label, uint32_t sun_count, uint32_t face_cells, int threads) {
  const double texel_angle = kPiD / std::min(grid.height, grid.width / 2 + 1), node_angle = kPiD / (2 * face_cells);
  const int parts = std::clamp(int(std::ceil(kSplatsPerCell * texel_angle / node_angle - 1e-6)), 1, 64);
  std::vector<SkySums> bands(kBands, SkySums{SkyNodes(face_cells)});
  parallelFor(kBands, 1, threads, nullptr, [&](size_t begin, size_t end) {
    for (size_t band = begin; band < end; ++band)
      for (int y = grid.height * int(band) / kBands; y < grid.height * int(band + 1) / kBands; ++y)
        for (int x = 0; x < grid.width; ++x)
          if (label[size_t(y) * size_t(grid.width) + size_t(x)] >= sun_count) splatTexel(grid, x, y, parts, bands[band]);
  });
  for (int band = 1; band < kBands; ++band) {
    bands[0].nodes.add(bands[size_t(band)].nodes);
    for (size_t c = 0; c < 3; ++c) {
      bands[0].flux[c] += bands[size_t(band)].flux[c];
      for (size_t k = 0; k < 9; ++k) bands[0].harmonics[k][c] += bands[size_t(band)].harmonics[k][c];
    }
  }
  const SkySums& sums = bands[0];
  EnvironmentSky sky;
  sky.face_cells = face_cells;
  for (size_t c = 0; c < 3; ++c) {
    sky.flux_rgb[int(c)] = float(sums.flux[c]);
    for (size_t k = 0; k < 9; ++k) sky.radiance_sh[k][int(c)] = float(sums.harmonics[k][c]);
  }
  const double node_solid_angle = 4 * kPiD / (6.0 * face_cells * face_cells);
  double largest = 0;
  for (const auto& mass : sums.nodes.mass_rgb)
    for (double m : mass) largest = std::max(largest, std::abs(m) / node_solid_angle);
  // The brightest node lands in [2^14, 2^15): 2^-24 of the half then is 39 stops below it.
  sky.scale = largest > 0 ? float(std::exp2(std::clamp(std::floor(std::log2(largest)) - 14, -100.0, 100.0))) : 1.0f;
  for (const auto& mass : sums.nodes.mass_rgb)
    for (double m : mass) sky.value.push_back(format::packHalf(float(m / node_solid_angle / sky.scale)));
  return sky;
}

Environment bakeEnvironment(EnvironmentMap& map, const EnvironmentSettings& settings, Diagnostics& diagnostics, const CancelFlag* cancel) {
  if (settings.grid_width < 64 || settings.grid_width > 8192) throw UsageError("the working resolution of a sky is 64 to 8192 columns");
  return bakeEnvironment(makeSkyGrid(map, settings.grid_width, diagnostics, cancel), settings, cancel);
}

Environment bakeEnvironment(const SkyGrid& grid, const EnvironmentSettings& settings, const CancelFlag* cancel) {
  const uint32_t face_cells = settings.sky_face_cells;
  if (face_cells < 16 || face_cells > 256 || face_cells % 2 != 0)
    throw UsageError("the faces of a sky take an even number of cells from 16 to 256");
  Decomposition decomposition = decompose(grid, settings.decomposition, cancel);
  Environment environment;
  environment.sky = bakeSky(grid, decomposition.label, decomposition.cells.sun_count, face_cells, settings.decomposition.threads);
  environment.cells = std::move(decomposition.cells);
  return environment;
}

}  // namespace lightwell::transport
