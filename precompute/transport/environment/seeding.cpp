#include "precompute/transport/environment/seeding.h"

#include <algorithm>
#include <numeric>
#include <queue>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr double kFloorShare = 0.02;         // of the importance, spread evenly over the sphere
constexpr uint32_t kCandidatesPerSeed = 5;

/// Index of the element in which `u` (a share of the total) falls.
size_t inverseCdf(const std::vector<double>& cdf, double u) {
  const auto it = std::upper_bound(cdf.begin(), cdf.end(), u * cdf.back());
  return std::min(size_t(it - cdf.begin()), cdf.size() - 1);
}

struct Part {
  std::vector<uint32_t> texels;
  double weight = 0, spread = 0;  // spread: Σ importance · squared chord to the mean
  Vec3d mean{0, 0, 0};
};

Part makePart(const SkyGrid& grid, const std::vector<double>& importance, std::vector<uint32_t> texels) {
  Part part;
  for (uint32_t i : texels) part.weight += importance[i], part.mean += Vec3d(grid.direction[i]) * importance[i];
  part.mean /= part.weight;
  part.spread = texels.size() > 1 ? part.weight * (1 - part.mean.length2()) : 0;
  part.texels = std::move(texels);
  return part;
}

/// The direction in which the part's power is spread most: power iteration on the 3 × 3 covariance.
Vec3d principalAxis(const SkyGrid& grid, const std::vector<double>& importance, const Part& part) {
  double c[3][3] = {};
  for (uint32_t i : part.texels) {
    const Vec3d d = Vec3d(grid.direction[i]) - part.mean;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) c[a][b] += importance[i] * d[a] * d[b];
  }
  Vec3d axis(0.577, 0.592, 0.563);
  for (int step = 0; step < 12; ++step) {
    Vec3d next;
    for (int a = 0; a < 3; ++a) next[a] = c[a][0] * axis.x + c[a][1] * axis.y + c[a][2] * axis.z;
    const double length = next.length();
    if (!(length > 0)) break;
    axis = next / length;
  }
  return axis;
}

}  // namespace

std::vector<double> seedImportance(const SkyGrid& grid, double exponent, uint32_t seeds) {
  double flux = 0, solid_angle = 0;
  for (size_t i = 0; i < grid.size(); ++i) flux += luminance(grid.flux_rgb[i]), solid_angle += grid.solid_angle_sr[i];
  const double mean = flux > 0 ? flux / solid_angle : 1;
  std::vector<double> importance(grid.size(), 0.0);
  double total = 0;
  for (size_t i = 0; i < grid.size(); ++i) {
    if (grid.solid_angle_sr[i] <= 0) continue;
    importance[i] = grid.solid_angle_sr[i] * std::pow(luminance(grid.flux_rgb[i]) / grid.solid_angle_sr[i] / mean, exponent);
    total += importance[i];
  }
  const double floor = (total > 0 ? kFloorShare * total : 1.0) / solid_angle;
  for (size_t i = 0; i < grid.size(); ++i) importance[i] += floor * grid.solid_angle_sr[i];
  // Capping lowers the total and with it the cap; a few rounds settle it well enough.
  for (int round = 0; round < 4; ++round) {
    const double cap = std::accumulate(importance.begin(), importance.end(), 0.0) / std::max(1u, seeds);
    for (double& v : importance) v = std::min(v, cap);
  }
  const double sum = std::accumulate(importance.begin(), importance.end(), 0.0);
  for (double& v : importance) v /= sum;
  return importance;
}

std::vector<Vec3> blueNoiseSeeds(const SkyGrid& grid, const std::vector<double>& importance, uint32_t count, uint64_t seed) {
  struct Candidate {
    Vec3 direction;
    float radius;  // chord: about half the distance of neighbours in the wished density
    double crowding = 0;
  };
  const size_t width = size_t(grid.width);
  std::vector<double> row_cdf(static_cast<size_t>(grid.height));
  std::vector<std::vector<double>> column_cdf(row_cdf.size());
  double rows = 0;
  for (size_t y = 0; y < row_cdf.size(); ++y) {
    double sum = 0;
    for (size_t x = 0; x < width; ++x) column_cdf[y].push_back(sum += importance[y * width + x]);
    row_cdf[y] = rows += sum;
  }
  std::vector<uint8_t> used(grid.size(), 0);
  std::vector<Candidate> candidates;
  const Sampler sampler(seed, 0x656e7600);
  for (uint32_t s = 0; s < count * kCandidatesPerSeed; ++s) {
    const Vec2 u = sampler.get2D(s, 0);
    const size_t y = inverseCdf(row_cdf, u.x), texel = y * width + inverseCdf(column_cdf[y], u.y);
    if (importance[texel] <= 0 || used[texel]) continue;
    used[texel] = 1;
    const double cell_solid_angle = std::min(4 * std::numbers::pi, grid.solid_angle_sr[texel] / (importance[texel] * count));
    candidates.push_back({grid.direction[texel], float(std::sqrt(cell_solid_angle / std::numbers::pi))});
  }
  const auto crowding = [](const Candidate& a, const Candidate& b) {
    const double reach = double(a.radius) + b.radius, distance = (a.direction - b.direction).length();
    return distance < 2 * reach ? std::pow(1 - distance / (2 * reach), 8) : 0.0;
  };
  for (Candidate& a : candidates)
    for (const Candidate& b : candidates)
      if (&a != &b) a.crowding += crowding(a, b);
  while (candidates.size() > count) {
    const auto worst =
        std::max_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.crowding < b.crowding; });
    const Candidate removed = *worst;
    candidates.erase(worst);
    for (Candidate& c : candidates) c.crowding -= crowding(c, removed);
  }
  std::vector<Vec3> seeds;
  for (const Candidate& c : candidates) seeds.push_back(c.direction);
  return seeds;
}

std::vector<Vec3> bisectionSeeds(const SkyGrid& grid, const std::vector<double>& importance, uint32_t count) {
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < grid.size(); ++i)
    if (importance[i] > 0) all.push_back(i);
  std::vector<Part> parts;
  parts.push_back(makePart(grid, importance, std::move(all)));
  const auto less_spread = [&](size_t a, size_t b) {
    return parts[a].spread != parts[b].spread ? parts[a].spread < parts[b].spread : a > b;
  };
  std::priority_queue<size_t, std::vector<size_t>, decltype(less_spread)> queue(less_spread);
  queue.push(0);
  while (parts.size() < count && parts[queue.top()].spread > 0) {
    const size_t split = queue.top();
    queue.pop();
    const Vec3d axis = principalAxis(grid, importance, parts[split]), mean = parts[split].mean;
    std::vector<uint32_t> sides[2];
    for (uint32_t i : parts[split].texels) sides[(Vec3d(grid.direction[i]) - mean).dot(axis) > 0].push_back(i);
    if (sides[0].empty() || sides[1].empty()) {
      parts[split].spread = 0;
      queue.push(split);
      continue;
    }
    parts[split] = makePart(grid, importance, std::move(sides[0]));
    parts.push_back(makePart(grid, importance, std::move(sides[1])));
    queue.push(split);
    queue.push(parts.size() - 1);
  }
  std::vector<Vec3> seeds;
  for (const Part& part : parts)
    seeds.push_back(part.mean.length() > 1e-6 ? Vec3(part.mean.normalized()) : grid.direction[part.texels.front()]);
  return seeds;
}

}  // namespace lightwell::transport
