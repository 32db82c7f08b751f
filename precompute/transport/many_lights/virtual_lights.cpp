#include "precompute/transport/many_lights/virtual_lights.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>

#include "precompute/core/random.h"
#include "precompute/transport/many_lights/outline.h"
#include "precompute/transport/many_lights/planes.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::transport {
namespace {

constexpr float kPlaneDistance = 5e-4f;  // of the scene's radius
constexpr uint32_t kFewestPlanePoints = 8;
constexpr double kFewestLights = 8;  // a bounce that would get fewer is one with the bounce before it
constexpr double kGapWeight = 0.5;   // rho of equation 1
constexpr double kBorder = 1.5;      // mean distances between points
constexpr size_t kMostVertices = 8;
constexpr uint64_t kRepresentativeStream = 16ull << 40;
constexpr double kLeastAgreement = 0.4;  // mean cosine to the mean normal below which a cluster has no direction
constexpr double kFlat = 0.97;  // mean cosine to the mean normal from which on a cluster is as good as plane
// By how much of its area a square differs from the disk of equal area and middle, and what elongation adds.
constexpr double kDiskMismatch = 0.18;

/// Coordinates in which a cluster is cut: two in a plane, three elsewhere.
struct Frame {
  Vec3 origin{0.0f}, axis[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  bool planar = false;  // axis[2] is the plane's normal
  float at(const Vec3& p, int k) const { return axis[k].dot(p - origin); }
  Vec3 inWorld(const Vec2& p) const { return origin + axis[0] * p.x + axis[1] * p.y; }
};

struct Cluster {
  std::vector<uint32_t> points;
  uint32_t frame = 0;
  uint32_t source = 0, bounce = 0;
  float low[3], high[3];  // its cell
  double power = 0;       // luminous
};

class Clustering {
 public:
  Clustering(std::span<const VirtualPoint> points, float scene_radius, const ClusterOptions& options, const CancelFlag* cancel)
      : points_(points), scene_radius_(scene_radius), options_(options), cancel_(cancel) {}

  std::vector<VirtualLight> lights() {
    for (const auto& [key, members] : groups()) addGroup(key.first, key.second, members);
    split();
    std::stable_sort(clusters_.begin(), clusters_.end(),
                     [](const Cluster& a, const Cluster& b) { return std::pair(a.source, a.bounce) < std::pair(b.source, b.bounce); });
    std::vector<VirtualLight> lights;
    for (const Cluster& cluster : clusters_) lights.push_back(lightOf(cluster));
    return lights;
  }

 private:
  using Groups = std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>>;  // by source and bounce

  double powerOf(std::span<const uint32_t> members) const {
    double power = 0;
    for (const uint32_t i : members) power += double(luminance(points_[i].power_rgb));
    return power;
  }

  /// Late bounces are joined to those before them until each is worth some lights.
  Groups groups() const {
    Groups groups;
    double total = 0;
    for (uint32_t i = 0; i < points_.size(); ++i) {
      const double power = double(luminance(points_[i].power_rgb));
      if (!(power > 0)) continue;
      total += power;
      groups[{points_[i].source, points_[i].bounce}].push_back(i);
    }
    for (auto group = groups.end(); group != groups.begin();) {
      --group;
      const auto [source, bounce] = group->first;
      if (bounce <= 1 || powerOf(group->second) * options_.lights >= kFewestLights * total) continue;
      auto& before = groups[{source, bounce - 1}];
      before.insert(before.end(), group->second.begin(), group->second.end());
      group = groups.erase(group);
    }
    for (auto& [key, members] : groups) std::sort(members.begin(), members.end());
    return groups;
  }

  void addGroup(uint32_t source, uint32_t bounce, const std::vector<uint32_t>& members) {
    total_points_ += members.size();
    const size_t fair = points_.size() / (4 * std::max<size_t>(options_.lights, 1));
    DetectedPlanes found = detectPlanes(
        points_, members,
        {.distance = kPlaneDistance * scene_radius_, .least_points = std::max(kFewestPlanePoints, uint32_t(fair)), .seed = options_.seed},
        cancel_);
    // No more planes than there are lights for.
    const size_t most = std::max<size_t>(1, size_t(double(options_.lights) * double(members.size()) / double(points_.size())));
    std::stable_sort(found.planes.begin(), found.planes.end(),
                     [&](const PlanarPoints& a, const PlanarPoints& b) { return powerOf(a.points) > powerOf(b.points); });
    while (found.planes.size() > most) {
      found.rest.insert(found.rest.end(), found.planes.back().points.begin(), found.planes.back().points.end());
      found.planes.pop_back();
    }
    for (PlanarPoints& plane : found.planes) {
      const Frame frame = planeFrame(plane);
      add(source, bounce, frame, std::move(plane.points));
    }
    if (!found.rest.empty()) add(source, bounce, {}, std::move(found.rest));
  }

  Frame planeFrame(const PlanarPoints& plane) const {
    Frame frame{.planar = true};
    frame.axis[2] = plane.normal;
    Vec3d middle(0.0);
    for (const uint32_t i : plane.points) middle += Vec3d(points_[i].position);
    frame.origin = Vec3(middle / double(plane.points.size()));
    orthonormalBasis(plane.normal, frame.axis[0], frame.axis[1]);
    const Vec2 along = alignment(convexHull(placesIn(frame, plane.points)));
    const Vec3 s = frame.axis[0] * along.x + frame.axis[1] * along.y;
    frame.axis[0] = s.normalized();
    frame.axis[1] = plane.normal.cross(frame.axis[0]);
    return frame;
  }

  std::vector<Vec2> placesIn(const Frame& frame, const std::vector<uint32_t>& members) const {
    std::vector<Vec2> places;
    for (const uint32_t i : members) places.emplace_back(frame.at(points_[i].position, 0), frame.at(points_[i].position, 1));
    return places;
  }

  void add(uint32_t source, uint32_t bounce, const Frame& frame, std::vector<uint32_t> members) {
    Cluster cluster{
        .points = std::move(members), .frame = uint32_t(frames_.size()), .source = source, .bounce = bounce, .low = {}, .high = {}};
    for (int k = 0; k < 3; ++k) {
      cluster.low[k] = INFINITY, cluster.high[k] = -INFINITY;
      for (const uint32_t i : cluster.points) {
        cluster.low[k] = std::min(cluster.low[k], frame.at(points_[i].position, k));
        cluster.high[k] = std::max(cluster.high[k], frame.at(points_[i].position, k));
      }
    }
    cluster.power = powerOf(cluster.points);
    frames_.push_back(frame);
    clusters_.push_back(std::move(cluster));
  }

  /// The cluster of most power is cut in two until there are as many as wanted.
  void split() {
    const auto less = [&](uint32_t a, uint32_t b) {
      return clusters_[a].power != clusters_[b].power ? clusters_[a].power < clusters_[b].power : a > b;
    };
    std::priority_queue<uint32_t, std::vector<uint32_t>, decltype(less)> queue(less);
    for (uint32_t i = 0; i < clusters_.size(); ++i) queue.push(i);
    while (clusters_.size() < options_.lights && !queue.empty()) {
      const uint32_t most = queue.top();
      queue.pop();
      if (cancel_ && clusters_.size() % 64 == 0) cancel_->check();
      if (!cut(most)) continue;
      queue.push(most);
      queue.push(uint32_t(clusters_.size()) - 1);
    }
  }

  /// Equation 1: across the longest side, at a wide gap near the median. The second half becomes a new cluster. False when all points are
  /// in one place.
  bool cut(uint32_t index) {
    Cluster& cluster = clusters_[index];
    const Frame& frame = frames_[cluster.frame];
    const size_t n = cluster.points.size();
    int axis = -1;
    float longest = 0;
    std::vector<std::pair<float, uint32_t>> sorted(n);
    for (int k = 0; k < (frame.planar ? 2 : 3); ++k) {
      float low = INFINITY, high = -INFINITY;
      for (const uint32_t i : cluster.points) {
        const float at = frame.at(points_[i].position, k);
        low = std::min(low, at), high = std::max(high, at);
      }
      if (high - low > longest) longest = high - low, axis = k;
    }
    if (axis < 0) return false;
    for (size_t i = 0; i < n; ++i) sorted[i] = {frame.at(points_[cluster.points[i]].position, axis), cluster.points[i]};
    std::sort(sorted.begin(), sorted.end());
    size_t best = 0;
    double best_score = -1;
    for (size_t j = 1; j < n; ++j) {
      const double gap = double(sorted[j].first) - double(sorted[j - 1].first);
      const double off_median = std::abs((double(n) + 1) / 2 - double(j)) * 2 / double(n);
      const double score = gap * std::pow(std::max(0.0, 1 - off_median), kGapWeight);
      if (score > best_score) best = j, best_score = score;
    }
    const float place = 0.5f * (sorted[best - 1].first + sorted[best].first);
    Cluster second = cluster;
    second.low[axis] = cluster.high[axis] = place;
    cluster.points.clear(), second.points.clear();
    for (size_t i = 0; i < n; ++i) (i < best ? cluster : second).points.push_back(sorted[i].second);
    cluster.power = powerOf(cluster.points), second.power = powerOf(second.points);
    clusters_.push_back(std::move(second));
    return true;
  }

  /// The plane through the middle of the points, across their mean normal.
  Frame tangentFrame(const VirtualLight& light) const {
    Frame frame{.origin = light.position, .planar = true};
    frame.axis[2] = light.normal;
    orthonormalBasis(light.normal, frame.axis[0], frame.axis[1]);
    return frame;
  }

  /// The surface that a point stands for where a cluster spans none: that of the points of a sphere around the scene.
  double areaPerPoint() const {
    return 4.0 * double(kPi) * double(scene_radius_) * double(scene_radius_) / double(std::max<size_t>(total_points_, 1));
  }

  uint32_t representative(std::span<const uint32_t> members, double power) const {
    double rest = double(Sampler(options_.seed, combineKeys(kRepresentativeStream, members.front())).get1D(0, 0)) * power;
    for (const uint32_t i : members)
      if ((rest -= double(luminance(points_[i].power_rgb))) < 0) return i;
    return members.back();
  }

  VirtualLight lightOf(const Cluster& cluster) const {
    VirtualLight light{.source = cluster.source, .bounce = cluster.bounce};
    Vec3d power(0.0), position(0.0), normal(0.0);
    double weight = 0;
    for (const uint32_t i : cluster.points) {
      const VirtualPoint& p = points_[i];
      const double share = double(luminance(p.power_rgb));
      power += Vec3d(p.power_rgb);
      position += Vec3d(p.position) * share;
      normal += Vec3d(p.normal) * share;
      weight += share;
    }
    const double mean_cosine = normal.length() / weight;
    // Walls that face each other have no light in common: one of the points, picked by power, stands for all. Of many such clusters the sum is right.
    if (!frames_[cluster.frame].planar && mean_cosine < kLeastAgreement && cluster.points.size() > 1) {
      Cluster one = cluster;
      one.points = {representative(cluster.points, weight)};
      light = lightOf(one);
      light.power_rgb = Rgb(power);
      return light;
    }
    light.power_rgb = Rgb(power);
    light.position = Vec3(position / weight);
    const Frame& own = frames_[cluster.frame];
    light.normal = own.planar ? own.axis[2] : mean_cosine > 1e-3 ? Vec3(normal.normalized()) : points_[cluster.points.front()].normal;

    const Frame frame = own.planar ? own : tangentFrame(light);
    const Polygon2 all = convexHull(placesIn(frame, cluster.points));
    const Polygon2 hull = simplified(all, kMostVertices);
    const double hull_area = areaOf(hull);
    const float border = float(kBorder * std::sqrt(std::max(hull_area, 0.0) / double(cluster.points.size())));
    Polygon2 outline;
    if (hull_area > 0) {
      Vec2 low(INFINITY), high(-INFINITY);
      for (int k = 0; k < 2; ++k) {
        if (own.planar)
          low[k] = cluster.low[k], high[k] = cluster.high[k];
        else
          for (const Vec2& corner : hull) low[k] = std::min(low[k], corner[k] - border), high[k] = std::max(high[k], corner[k] + border);
      }
      outline = simplified(grownInto({low, {high.x, low.y}, high, {low.x, high.y}}, hull, border), kMostVertices);
    }
    double area = outline.size() >= 3 ? areaOf(outline) : 0;
    // Points in a row or in one place: a square as large as their share of the scene.
    if (const double least = 1e-10 * double(scene_radius_) * double(scene_radius_); !(area > least)) {
      area = std::max(areaPerPoint() * double(cluster.points.size()), least);
      const float half = 0.5f * float(std::sqrt(area));
      const Vec2 middle(frame.at(light.position, 0), frame.at(light.position, 1));
      outline = {middle + Vec2(-half, -half), middle + Vec2(half, -half), middle + Vec2(half, half), middle + Vec2(-half, half)};
    }
    light.type = options_.type.value_or(typeFor(cluster, own.planar ? 1.0 : mean_cosine, outline, hull_area, area));
    if (light.type == VirtualLightType::polygon) {
      light.position = frame.inWorld(centroidOf(outline));
      for (const Vec2& corner : outline) light.vertices.push_back(frame.inWorld(corner));
    } else if (light.type != VirtualLightType::point) {
      light.radius = float(std::sqrt(area / std::numbers::pi));
    }
    return light;
  }

  /// The type with the least expected error: of a polygon, the part of its area that is only supposed; of a disk, its difference in shape.
  /// Neither is good for what is not flat.
  VirtualLightType typeFor(const Cluster& cluster, double mean_cosine, const Polygon2& outline, double hull_area, double area) const {
    if (mean_cosine < kFlat) return VirtualLightType::sphere;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    const Vec2 along = alignment(outline);
    for (const Vec2& corner : outline)
      for (int k = 0; k < 2; ++k) {
        const double at = k == 0 ? along.dot(corner) : along.dot(Vec2(corner.y, -corner.x));
        low[k] = std::min(low[k], at), high[k] = std::max(high[k], at);
      }
    const double side[2] = {high[0] - low[0], high[1] - low[1]};
    const double elongation = std::max(side[0], side[1]) / std::max(std::min(side[0], side[1]), 1e-6 * std::max(side[0], side[1]));
    const double supposed = cluster.points.size() < 3 ? 1 : (area - std::max(hull_area, 0.0)) / area;
    return supposed <= kDiskMismatch * elongation + 0.5 * supposed ? VirtualLightType::polygon : VirtualLightType::disk;
  }

  std::span<const VirtualPoint> points_;
  float scene_radius_;
  const ClusterOptions& options_;
  const CancelFlag* cancel_;
  size_t total_points_ = 0;
  std::vector<Frame> frames_;
  std::vector<Cluster> clusters_;
};

}  // namespace

std::vector<VirtualLight> clusterPoints(std::span<const VirtualPoint> points, float scene_radius, const ClusterOptions& options,
                                        const CancelFlag* cancel) {
  return Clustering(points, scene_radius, options, cancel).lights();
}

namespace {

/// What of a light has a fixed size.
struct Record {
  uint32_t type, source, bounce, vertices;
  Vec3 position, normal;
  Rgb power_rgb;
  float radius;
};

}  // namespace

Bytes toBytes(std::span<const VirtualLight> lights) {
  std::vector<Record> records;
  std::vector<Vec3> vertices;
  for (const VirtualLight& l : lights) {
    records.push_back({uint32_t(l.type), l.source, l.bounce, uint32_t(l.vertices.size()), l.position, l.normal, l.power_rgb, l.radius});
    vertices.insert(vertices.end(), l.vertices.begin(), l.vertices.end());
  }
  ByteWriter writer;
  writer.array(records);
  writer.array(vertices);
  return writer.take();
}

std::vector<VirtualLight> readVirtualLights(ByteView bytes) {
  ByteReader reader(bytes);
  const auto records = reader.array<Record>();
  const auto vertices = reader.array<Vec3>();
  require(reader.empty());
  std::vector<VirtualLight> lights;
  size_t first = 0;
  for (const Record& r : records) {
    require(r.type >= 1 && r.type <= uint32_t(VirtualLightType::polygon) && r.vertices <= vertices.size() - first);
    lights.push_back({VirtualLightType(r.type),
                      r.source,
                      r.bounce,
                      r.position,
                      r.normal,
                      r.power_rgb,
                      r.radius,
                      {vertices.begin() + std::ptrdiff_t(first), vertices.begin() + std::ptrdiff_t(first + r.vertices)}});
    first += r.vertices;
  }
  require(first == vertices.size());
  return lights;
}

}  // namespace lightwell::transport
