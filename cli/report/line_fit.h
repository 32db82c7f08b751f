// The slope of a cloud of points on double logarithmic paper.
#pragma once
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace lightwell::report {

/// y = factor · x^slope, least squares of the logarithms (ordinary linear regression). Points that are not finite and positive in both are left out; none of fewer than `fewest` that are left, or
/// of points at one x.
struct PowerLaw {
  double factor = 0, slope = 0;
  double at(double x) const { return factor * std::pow(x, slope); }
};

inline std::optional<PowerLaw> fitPowerLaw(std::span<const std::pair<double, double>> points, size_t fewest = 3) {
  double n = 0, mean_x = 0, mean_y = 0;
  const auto usable = [](const auto& p) { return std::isfinite(p.first) && std::isfinite(p.second) && p.first > 0 && p.second > 0; };
  for (const auto& p : points)
    if (usable(p)) ++n, mean_x += std::log(p.first), mean_y += std::log(p.second);
  if (n < double(fewest) || n < 2) return std::nullopt;
  mean_x /= n, mean_y /= n;
  double xx = 0, xy = 0;
  for (const auto& p : points) {
    if (!usable(p)) continue;
    const double dx = std::log(p.first) - mean_x;
    xx += dx * dx, xy += dx * (std::log(p.second) - mean_y);
  }
  if (!(xx > 1e-12 * n)) return std::nullopt;
  const double slope = xy / xx;
  return PowerLaw{std::exp(mean_y - slope * mean_x), slope};
}

}  // namespace lightwell::report
