#include "precompute/transport/environment/suns.h"

#include <algorithm>
#include <numbers>

namespace lightwell::transport {
namespace {

constexpr double kEdgeRatio = 1.0 / 8;  // a texel that the disc covers to an eighth still belongs to it
constexpr int kRimTexels = 3;

/// The neighbours of a texel across the seam and the poles: left, right, above, below.
std::array<uint32_t, 4> neighbours(const SkyGrid& grid, uint32_t index) {
  const int w = grid.width, h = grid.height, x = int(index) % w, y = int(index) / w;
  const auto at = [&](int column, int row) {
    if (row < 0 || row >= h) row = std::clamp(row, 0, h - 1), column += w / 2;
    return uint32_t(row * w + (column + w) % w);
  };
  return {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)};
}

/// The connected texels around `peak` whose `radiance` reaches `threshold`; empty when they cover more than `max_solid_angle`. Taken texels
/// are set to radiance −1.
std::vector<uint32_t> growSpot(const SkyGrid& grid, uint32_t peak, float threshold, double max_solid_angle, std::vector<float>& radiance) {
  std::vector<uint32_t> spot = {peak};
  radiance[peak] = -1;
  double solid_angle = grid.solid_angle_sr[peak];
  for (size_t next = 0; next < spot.size() && solid_angle <= max_solid_angle; ++next)
    for (uint32_t n : neighbours(grid, spot[next]))
      if (radiance[n] >= threshold) {
        radiance[n] = -1;
        spot.push_back(n);
        solid_angle += grid.solid_angle_sr[n];
      }
  if (solid_angle > max_solid_angle) spot.clear();
  std::sort(spot.begin(), spot.end());
  return spot;
}

/// Mean radiance (luminance) of the texels that are kRimTexels away from the spot.
double rimRadiance(const SkyGrid& grid, const std::vector<uint32_t>& spot) {
  std::vector<uint32_t> ring = spot, all = spot;
  for (int step = 0; step < kRimTexels; ++step) {
    std::vector<uint32_t> grown;
    for (uint32_t i : ring)
      for (uint32_t n : neighbours(grid, i)) grown.push_back(n);
    std::sort(grown.begin(), grown.end());
    grown.erase(std::unique(grown.begin(), grown.end()), grown.end());
    ring.clear();
    std::set_difference(grown.begin(), grown.end(), all.begin(), all.end(), std::back_inserter(ring));
    std::vector<uint32_t> joined;
    std::set_union(all.begin(), all.end(), ring.begin(), ring.end(), std::back_inserter(joined));
    all = std::move(joined);
  }
  double flux = 0, solid_angle = 0;
  for (uint32_t i : ring) flux += luminance(grid.flux_rgb[i]), solid_angle += grid.solid_angle_sr[i];
  return solid_angle > 0 ? flux / solid_angle : 0;
}

}  // namespace

std::vector<std::vector<uint32_t>> findSuns(const SkyGrid& grid, const SunSettings& settings) {
  const double max_solid_angle = 4 * std::numbers::pi * std::pow(std::sin(0.5 * settings.max_radius_rad), 2);
  std::vector<float> radiance(grid.size());  // luminance
  double total = 0;
  for (size_t i = 0; i < grid.size(); ++i) {
    const double flux = luminance(grid.flux_rgb[i]);
    total += flux;
    radiance[i] = float(flux / grid.solid_angle_sr[i]);
  }
  std::vector<std::pair<double, std::vector<uint32_t>>> suns;  // by flux
  double rest = total;
  for (int tries = 0; tries < settings.max_suns; ++tries) {
    const auto peak = std::max_element(radiance.begin(), radiance.end());
    const float brightest = *peak;
    if (brightest <= 0) break;
    std::vector<uint32_t> spot =
        growSpot(grid, uint32_t(peak - radiance.begin()), float(brightest * kEdgeRatio), max_solid_angle, radiance);
    if (spot.empty()) break;  // the brightest thing is wide: cells can follow it, and nothing else is a sun
    double flux = 0;
    for (uint32_t i : spot) flux += luminance(grid.flux_rgb[i]);
    const double mean_of_rest = std::max(0.0, rest - flux) / (4 * std::numbers::pi);
    if (brightest < mean_of_rest * std::exp2(settings.stops_above_mean)) break;  // as will be all that is dimmer
    if (brightest < rimRadiance(grid, spot) * std::exp2(settings.stops_above_surroundings) || flux < settings.min_share * total) continue;
    rest -= flux;
    suns.emplace_back(flux, std::move(spot));
  }
  std::stable_sort(suns.begin(), suns.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::vector<uint32_t>> spots;
  for (auto& [flux, spot] : suns) spots.push_back(std::move(spot));
  return spots;
}

}  // namespace lightwell::transport
