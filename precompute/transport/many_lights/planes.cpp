#include "precompute/transport/many_lights/planes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kPlaneStream = 13ull << 40;
constexpr double kMissed = 0.01;  // probability that a plane of least_points is not among the hypotheses
constexpr uint32_t kMostHypotheses = 512;
constexpr uint32_t kScored = 512;  // points at which a hypothesis is judged before the best is looked at whole
constexpr double kConnected = 6;   // mean distances between points: parts of a plane farther apart are apart

struct Hypothesis {
  Vec3 point{0.0f}, normal{0.0f};
  bool holds(const VirtualPoint& p, const PlaneOptions& options) const {
    return normal.dot(p.normal) >= options.least_cosine && std::abs(normal.dot(p.position - point)) <= options.distance;
  }
};

/// Connected parts of points of a plane, by flood fill over an occupancy grid (Schnabel et al., section 4.4). Parts of too few points
/// belong to the nearest larger one; without any, all are one.
std::vector<std::vector<uint32_t>> connectedParts(std::span<const VirtualPoint> points, const std::vector<uint32_t>& members,
                                                  const Vec3& normal, uint32_t least) {
  Vec3 s, t;
  orthonormalBasis(normal, s, t);
  Vec2 low(INFINITY), high(-INFINITY);
  std::vector<Vec2> place;
  for (const uint32_t i : members) {
    place.emplace_back(s.dot(points[i].position), t.dot(points[i].position));
    for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], place.back()[k]), high[k] = std::max(high[k], place.back()[k]);
  }
  const double cell = kConnected * std::sqrt(double(high.x - low.x) * double(high.y - low.y) / double(members.size()));
  if (!(cell > 0)) return {members};
  using Cell = std::pair<int64_t, int64_t>;
  std::map<Cell, std::vector<uint32_t>> cells;  // of indices into members
  for (uint32_t m = 0; m < members.size(); ++m)
    cells[{int64_t((place[m].x - low.x) / cell), int64_t((place[m].y - low.y) / cell)}].push_back(m);
  struct Part {
    std::vector<uint32_t> members;
    Vec2 middle{0, 0};
  };
  std::vector<Part> large, small;
  std::vector<Cell> open;
  while (!cells.empty()) {
    Part part;
    const auto take = [&](std::map<Cell, std::vector<uint32_t>>::iterator at) {
      open.push_back(at->first);
      part.members.insert(part.members.end(), at->second.begin(), at->second.end());
      cells.erase(at);
    };
    take(cells.begin());
    while (!open.empty()) {
      const Cell from = open.back();
      open.pop_back();
      for (int64_t dx = -1; dx <= 1; ++dx)
        for (int64_t dy = -1; dy <= 1; ++dy)
          if (const auto next = cells.find({from.first + dx, from.second + dy}); next != cells.end()) take(next);
    }
    for (const uint32_t m : part.members) part.middle += place[m] / float(part.members.size());
    (part.members.size() >= least ? large : small).push_back(std::move(part));
  }
  if (large.empty()) return {members};
  for (const Part& part : small) {
    const auto nearest = std::min_element(large.begin(), large.end(), [&](const Part& a, const Part& b) {
      return (a.middle - part.middle).length2() < (b.middle - part.middle).length2();
    });
    nearest->members.insert(nearest->members.end(), part.members.begin(), part.members.end());
  }
  std::vector<std::vector<uint32_t>> result;
  for (Part& part : large) {
    std::sort(part.members.begin(), part.members.end());
    for (uint32_t& m : part.members) m = members[m];
    result.push_back(std::move(part.members));
  }
  return result;
}

}  // namespace

DetectedPlanes detectPlanes(std::span<const VirtualPoint> points, std::span<const uint32_t> members, const PlaneOptions& options,
                            const CancelFlag* cancel) {
  DetectedPlanes result;
  result.rest.assign(members.begin(), members.end());
  const Sampler sampler(options.seed, kPlaneStream);
  const uint32_t least = std::max(options.least_points, 3u);
  for (uint32_t round = 0; result.rest.size() >= least; ++round) {
    if (cancel) cancel->check();
    const std::vector<uint32_t>& rest = result.rest;
    const size_t stride = std::max<size_t>(1, rest.size() / kScored);
    const double hits = double(least) / double(rest.size());
    const auto wanted = hits < 1 ? uint32_t(std::clamp(std::log(kMissed) / std::log1p(-hits), 1.0, double(kMostHypotheses))) : 1u;
    Hypothesis best{};
    size_t best_score = 0;
    for (uint32_t i = 0; i < wanted; ++i) {
      const VirtualPoint& drawn = points[rest[std::min(size_t(sampler.get1D(i, round) * float(rest.size())), rest.size() - 1)]];
      const Hypothesis hypothesis{drawn.position, drawn.normal};
      size_t score = 0;
      for (size_t k = i % stride; k < rest.size(); k += stride) score += hypothesis.holds(points[rest[k]], options);
      if (score > best_score) best = hypothesis, best_score = score;
    }
    std::vector<uint32_t> on_plane, others;
    for (const uint32_t i : rest) (best.holds(points[i], options) ? on_plane : others).push_back(i);
    if (on_plane.size() < least) break;
    Vec3d normal(0.0);
    for (const uint32_t i : on_plane) normal += Vec3d(points[i].normal);
    for (auto& part : connectedParts(points, on_plane, best.normal, least))
      result.planes.push_back({Vec3(normal.normalized()), std::move(part)});
    result.rest = std::move(others);
  }
  return result;
}

}  // namespace lightwell::transport
