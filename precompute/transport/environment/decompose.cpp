#include "precompute/transport/environment/decompose.h"

#include <algorithm>
#include <numeric>

#include "precompute/core/error.h"
#include "precompute/core/parallel.h"
#include "precompute/transport/environment/seeding.h"
#include "precompute/transport/environment/spherical_voronoi.h"

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr int kRelaxationWidth = 512, kFastWidth = 256;
constexpr int kRounds = 40, kFastRounds = 4;
constexpr size_t kTexelsPerPiece = 16384;  // fixed, so that sums are formed in the same order for any number of threads

/// Sums of `Sum::add(texel)` per label, with a summation order that does not depend on the threads.
template <class Sum, class Add>
std::vector<Sum> sumByLabel(size_t texels, size_t labels, int threads, const std::vector<uint32_t>& label, const Add& add) {
  const size_t pieces = (texels + kTexelsPerPiece - 1) / kTexelsPerPiece;
  std::vector<std::vector<Sum>> partial(pieces);
  parallelFor(pieces, 1, threads, nullptr, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      partial[p].resize(labels);
      for (size_t i = p * kTexelsPerPiece; i < std::min(texels, (p + 1) * kTexelsPerPiece); ++i)
        if (label[i] != kNone) add(partial[p][label[i]], i);
    }
  });
  std::vector<Sum> sums(labels);
  for (const auto& piece : partial)
    for (size_t s = 0; s < labels; ++s) sums[s] += piece[s];
  return sums;
}

struct WeightSum {
  double weight = 0, solid_angle = 0;
  Vec3d moment{0, 0, 0};
  void operator+=(const WeightSum& o) { weight += o.weight, solid_angle += o.solid_angle, moment += o.moment; }
};

struct CellSum {
  std::array<double, 3> flux{};
  double solid_angle = 0;
  Vec3d power_moment{0, 0, 0}, area_moment{0, 0, 0};
  void operator+=(const CellSum& o) {
    for (size_t c = 0; c < 3; ++c) flux[c] += o.flux[c];
    solid_angle += o.solid_angle, power_moment += o.power_moment, area_moment += o.area_moment;
  }
};

struct SpreadSum {
  double weight = 0, deficit = 0, xx = 0, xy = 0, yy = 0;
  void operator+=(const SpreadSum& o) { weight += o.weight, deficit += o.deficit, xx += o.xx, xy += o.xy, yy += o.yy; }
};

Vec3 unitOr(const Vec3d& v, const Vec3& fallback) { return v.length() > 1e-12 ? Vec3(v.normalized()) : fallback; }

/// Lloyd's method: moves seeds to the centroids of their cells' weight until they lie still. Cells that lost all texels vanish.
/// Weighted by a density ρ, seeds settle at a density as √ρ (Gersho's conjecture in two dimensions). Returns Σ weight · (1 − cosine to the
/// seed).
double relax(const SkyGrid& grid, const std::vector<double>& weight, int rounds, int threads, const CancelFlag* cancel,
             std::vector<Vec3>& seed) {
  const SphericalVoronoi voronoi(grid);
  double spread = 0;
  for (int round = 0; round < rounds; ++round) {
    if (cancel) cancel->check();
    const std::vector<uint32_t> label = voronoi.assign(seed, threads);
    const auto sums = sumByLabel<WeightSum>(grid.size(), seed.size(), threads, label, [&](WeightSum& sum, size_t i) {
      sum.weight += weight[i];
      sum.moment += Vec3d(grid.direction[i]) * weight[i];
    });
    float moved = 0;
    size_t kept = 0;
    spread = 0;
    for (size_t s = 0; s < seed.size(); ++s) {
      if (sums[s].weight <= 0) continue;
      const Vec3 centroid = unitOr(sums[s].moment, seed[s]);
      spread += sums[s].weight - sums[s].moment.length();
      moved = std::max(moved, (centroid - seed[s]).length());
      seed[kept++] = centroid;
    }
    seed.resize(kept);
    if (moved < 1e-5f) break;
  }
  return spread;
}

/// What the container keeps of every label: exact sums, direction and spread of the power (of the area where a cell is black).
EnvironmentCells summarise(const SkyGrid& grid, const std::vector<uint32_t>& label, size_t labels, int threads) {
  const auto sums = sumByLabel<CellSum>(grid.size(), labels, threads, label, [&](CellSum& sum, size_t i) {
    const Vec3d d(grid.direction[i]);
    for (size_t c = 0; c < 3; ++c) sum.flux[c] += grid.flux_rgb[i][c];
    sum.solid_angle += grid.solid_angle_sr[i];
    sum.power_moment += d * luminance(grid.flux_rgb[i]);
    sum.area_moment += d * grid.solid_angle_sr[i];
  });
  EnvironmentCells cells;
  std::vector<Vec3> tangent(labels), bitangent(labels);
  for (size_t s = 0; s < labels; ++s) {
    const bool black = luminance(sums[s].flux) <= 0;
    cells.direction.push_back(unitOr(black ? sums[s].area_moment : sums[s].power_moment, unitOr(sums[s].area_moment, Vec3(0, 1, 0))));
    cells.flux_rgb.push_back({float(sums[s].flux[0]), float(sums[s].flux[1]), float(sums[s].flux[2])});
    cells.solid_angle_sr.push_back(float(sums[s].solid_angle));
    cells.cos_radius.push_back(float(1 - sums[s].solid_angle / (2 * kPiD)));
    orthonormalBasis(cells.direction[s], tangent[s], bitangent[s]);
  }
  const auto spreads = sumByLabel<SpreadSum>(grid.size(), labels, threads, label, [&](SpreadSum& sum, size_t i) {
    const uint32_t s = label[i];
    const bool black = luminance(sums[s].flux) <= 0;
    const double weight = black ? grid.solid_angle_sr[i] : luminance(grid.flux_rgb[i]);
    // Offsets from the axis, not cosines: exact for a cell of one texel.
    const Vec3d offset = Vec3d(grid.direction[i]) - Vec3d(cells.direction[s]);
    const double x = offset.dot(Vec3d(tangent[s])), y = offset.dot(Vec3d(bitangent[s]));
    const double own = grid.solid_angle_sr[i] / (4 * kPiD);  // a texel's own variance per axis, were it a small disc
    sum.weight += weight;
    sum.deficit += weight * (0.5 * offset.length2() + own);
    sum.xx += weight * (x * x + own), sum.xy += weight * x * y, sum.yy += weight * (y * y + own);
  });
  for (const SpreadSum& sum : spreads) {
    cells.spread.push_back(float(std::min(1.0, sum.deficit / sum.weight)));
    cells.covariance.push_back({float(sum.xx / sum.weight), float(sum.xy / sum.weight), float(sum.yy / sum.weight)});
  }
  return cells;
}

/// Renumbers labels: suns keep theirs, the rest follow by falling luminance of their flux, empty ones vanish. Returns how many are left.
size_t orderLabels(const SkyGrid& grid, size_t suns, size_t labels, int threads, std::vector<uint32_t>& label) {
  const auto sums = sumByLabel<WeightSum>(grid.size(), labels, threads, label, [&](WeightSum& sum, size_t i) {
    sum.weight += luminance(grid.flux_rgb[i]);
    sum.solid_angle += grid.solid_angle_sr[i];
  });
  std::vector<uint32_t> order;
  for (uint32_t s = 0; s < labels; ++s)
    if (sums[s].solid_angle > 0) order.push_back(s);
  std::stable_sort(order.begin() + long(suns), order.end(), [&](uint32_t a, uint32_t b) { return sums[a].weight > sums[b].weight; });
  std::vector<uint32_t> rank(labels, kNone);
  for (uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
  for (uint32_t& l : label) l = rank[l];
  return order.size();
}

std::vector<Vec3> placeSeeds(const SkyGrid& grid, const DecompositionSettings& settings, uint32_t count, const CancelFlag* cancel) {
  const std::vector<double> weight = seedImportance(grid, 2 * settings.density_exponent, count);
  std::vector<Vec3> bisected = bisectionSeeds(grid, weight, count);
  const double bisected_spread = relax(grid, weight, settings.fast ? kFastRounds : kRounds, settings.threads, cancel, bisected);
  if (settings.fast) return bisected;
  std::vector<Vec3> scattered = blueNoiseSeeds(grid, seedImportance(grid, settings.density_exponent, count), count, settings.seed);
  const double scattered_spread = relax(grid, weight, kRounds, settings.threads, cancel, scattered);
  return scattered_spread <= bisected_spread ? scattered : bisected;
}

}  // namespace

Decomposition decompose(const SkyGrid& grid, const DecompositionSettings& settings, const CancelFlag* cancel) {
  if (settings.samples < 1 || settings.samples > 4096) throw UsageError("an environment takes 1 to 4096 samples");
  if (!(settings.density_exponent >= 0 && settings.density_exponent <= 1))
    throw UsageError("the density exponent of an environment lies between 0 and 1");
  std::vector<std::vector<uint32_t>> suns = findSuns(grid, settings.suns);
  if (suns.size() >= settings.samples) suns.resize(settings.samples - 1);
  const uint32_t sun_count = uint32_t(suns.size());
  std::vector<uint8_t> is_sun(grid.size(), 0);
  for (const auto& sun : suns)
    for (uint32_t i : sun) is_sun[i] = 1;
  const int coarse_width = settings.fast ? kFastWidth : kRelaxationWidth;
  const SkyGrid coarse = reduceSkyGrid(grid, coarse_width, is_sun);
  const std::vector<Vec3> seed = placeSeeds(coarse, settings, settings.samples - sun_count, cancel);

  // The fast path cuts the sky along blocks of texels, with the suns' texels behind them; the best path cuts the texels themselves.
  SkyGrid blocks;
  if (settings.fast) {
    blocks = coarse;
    for (const auto& sun : suns)
      for (uint32_t i : sun) {
        blocks.direction.push_back(grid.direction[i]);
        blocks.flux_rgb.push_back(grid.flux_rgb[i]);
        blocks.solid_angle_sr.push_back(grid.solid_angle_sr[i]);
      }
  }
  const SkyGrid& cut = settings.fast ? blocks : grid;
  std::vector<uint32_t> label = SphericalVoronoi(settings.fast ? coarse : grid).assign(seed, settings.threads);
  for (uint32_t& l : label) l += sun_count;
  for (uint32_t s = 0; s < sun_count; ++s)
    for (uint32_t i : suns[s]) {
      if (settings.fast)
        label.push_back(s);
      else
        label[i] = s;
    }
  const size_t count = orderLabels(cut, sun_count, sun_count + seed.size(), settings.threads, label);
  Decomposition result;
  result.cells = summarise(cut, label, count, settings.threads);
  result.cells.sun_count = sun_count;
  if (!settings.fast) {
    result.label = std::move(label);
    return result;
  }
  result.label = expandLabels(grid, coarse_width, label);
  for (uint32_t s = 0; s < sun_count; ++s)
    for (uint32_t i : suns[s]) result.label[i] = s;
  return result;
}

}  // namespace lightwell::transport
