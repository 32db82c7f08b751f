#include "precompute/transport/reference/light_tree.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace lightwell::transport {
namespace {

constexpr int kBuckets = 12;
constexpr int kMaxHeuristicDepth = 48;  // below it nodes are halved by count, so that no input makes a deep tree
constexpr float kCosineSlack = 1e-3f;   // rounding must never hide a light that shines

/// An angle in [0, π] by its cosine and sine.
struct Angle {
  float cosine, sine;
};
float sineOf(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }
/// max(0, a − b)
Angle difference(const Angle& a, const Angle& b) {
  if (a.cosine >= b.cosine) return {1.0f, 0.0f};
  return {a.cosine * b.cosine + a.sine * b.sine, a.sine * b.cosine - a.cosine * b.sine};
}

float angleBetween(const Vec3& a, const Vec3& b) {
  return 2.0f * std::atan2((a - b).length(), (a + b).length());  // Kahan: exact near 0 and π
}

/// The smallest cone around two cones of directions.
void uniteCones(const Vec3& axis_a, float spread_a, const Vec3& axis_b, float spread_b, Vec3& axis, float& spread) {
  const float between = angleBetween(axis_a, axis_b);
  if (std::min(between + spread_b, kPi) <= spread_a) {
    axis = axis_a, spread = spread_a;
    return;
  }
  if (std::min(between + spread_a, kPi) <= spread_b) {
    axis = axis_b, spread = spread_b;
    return;
  }
  spread = 0.5f * (spread_a + between + spread_b);
  const Vec3 turn_axis = axis_a.cross(axis_b);
  if (spread >= kPi || turn_axis.length2() == 0.0f) {
    axis = axis_a, spread = kPi;
    return;
  }
  // Rotate axis_a toward axis_b by what the united cone exceeds its own.
  const float turn = spread - spread_a;
  const Vec3 side = turn_axis.cross(axis_a).normalized();
  axis = (axis_a * std::cos(turn) + side * std::sin(turn)).normalized();
}

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  if (a.power <= 0.0f) return b;
  if (b.power <= 0.0f) return a;
  LightBounds both;
  both.box = a.box;
  both.box.extendBy(b.box);
  uniteCones(a.axis, a.normal_spread, b.axis, b.normal_spread, both.axis, both.normal_spread);
  both.emission_spread = std::max(a.emission_spread, b.emission_spread);
  both.two_sided = a.two_sided || b.two_sided;
  both.power = a.power + b.power;
  return both;
}

/// The surface area orientation heuristic: power × solid angle of the emission × surface area (the diagonal's square where there is none).
double splitCost(const LightBounds& b) {
  if (b.power <= 0.0f) return 0.0;
  const double o = b.normal_spread, w = std::min<double>(b.normal_spread + b.emission_spread, std::numbers::pi);
  const double solid_angle = 2 * std::numbers::pi * (1 - std::cos(o)) +
                             std::numbers::pi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  const Vec3 size = b.box.size();
  const double area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x) + 1e-4 * size.length2();
  return b.power * solid_angle * area;
}

/// Reorders [begin, end) of `order` into two non-empty halves and returns where the second one starts.
uint32_t* split(uint32_t* begin, uint32_t* end, std::span<const LightBounds> items, int depth) {
  Box3 centers;
  for (const uint32_t* i = begin; i != end; ++i) centers.extendBy(items[*i].box.center());
  const Vec3 size = centers.size();
  double best_cost = std::numeric_limits<double>::infinity();
  int best_axis = -1, best_bucket = 0;
  const auto bucketOf = [&](uint32_t item, int axis) {
    const float place = (items[item].box.center()[axis] - centers.min[axis]) / size[axis];
    return std::clamp(int(place * kBuckets), 0, kBuckets - 1);
  };
  for (int axis = 0; axis < 3 && depth < kMaxHeuristicDepth; ++axis) {
    if (!(size[axis] > 0.0f)) continue;
    std::array<LightBounds, kBuckets> bucket{};
    for (const uint32_t* i = begin; i != end; ++i) {
      LightBounds& b = bucket[bucketOf(*i, axis)];
      b = unite(b, items[*i]);
    }
    std::array<double, kBuckets> cost_below{};
    LightBounds below{}, above{};
    for (int k = 0; k + 1 < kBuckets; ++k) cost_below[k] = splitCost(below = unite(below, bucket[k]));
    // Long thin nodes are bad to cut across: the axis is weighted by its share of the extent.
    const double stretch = size.x > size.y ? std::max(size.x, size.z) : std::max(size.y, size.z);
    for (int k = kBuckets - 2; k >= 0; --k) {
      above = unite(above, bucket[k + 1]);
      const double cost = stretch / size[axis] * (cost_below[k] + splitCost(above));
      if (cost < best_cost) best_cost = cost, best_axis = axis, best_bucket = k;
    }
  }
  if (best_axis >= 0) {
    uint32_t* middle = std::stable_partition(begin, end, [&](uint32_t i) { return bucketOf(i, best_axis) <= best_bucket; });
    if (middle != begin && middle != end) return middle;
  }
  return begin + (end - begin) / 2;
}

}  // namespace

LightTree::Reach::Reach(const LightBounds& bounds)
    : center(bounds.box.isEmpty() ? Vec3(0.0f) : bounds.box.center()),
      radius2(bounds.box.isEmpty() ? 0.0f : 0.25f * bounds.box.size().length2()),
      axis(bounds.axis),
      cos_normal_spread(std::cos(bounds.normal_spread)),
      sin_normal_spread(std::sin(bounds.normal_spread)),
      cos_emission_spread(std::cos(std::min(bounds.emission_spread, kPi)) - kCosineSlack),
      power(bounds.power),
      two_sided(bounds.two_sided) {}

float LightTree::Reach::importance(const Vec3& position, const Vec3& normal) const {
  const Vec3 to_light = center - position;
  const float center_distance2 = to_light.length2();
  if (center_distance2 <= radius2 || center_distance2 == 0.0f) return power / std::max(radius2, 1e-12f);  // inside: any direction
  const Vec3 direction = to_light / std::sqrt(center_distance2);
  const float sin2_box = radius2 / center_distance2, cos_box = std::sqrt(1.0f - sin2_box), sin_box = std::sqrt(sin2_box);

  float cos_axis = -direction.dot(axis);
  if (two_sided) cos_axis = std::abs(cos_axis);
  const Angle beyond_normals = difference({cos_axis, sineOf(cos_axis)}, {cos_normal_spread, sin_normal_spread});
  const Angle emission = difference(beyond_normals, {cos_box, sin_box});
  if (emission.cosine < cos_emission_spread) return 0.0f;
  const float cos_normal = direction.dot(normal);
  const Angle incidence = difference({cos_normal, sineOf(cos_normal)}, {cos_box, sin_box});
  if (incidence.cosine < -kCosineSlack) return 0.0f;
  return power * std::max(emission.cosine, kCosineSlack) * std::max(incidence.cosine, kCosineSlack) / center_distance2;
}

float LightTree::Reach::bound(const Receivers& receivers) const {
  const Vec3 to_light = center - receivers.center;
  const float distance = to_light.length(), reach = std::sqrt(radius2) + receivers.radius, nearest = distance - reach;
  if (!(nearest > 0.0f)) return std::numeric_limits<float>::infinity();
  const Vec3 direction = to_light / distance;
  const float sin_around = reach / distance;
  const Angle around{sineOf(sin_around), sin_around};
  float cos_axis = -direction.dot(axis);
  if (two_sided) cos_axis = std::abs(cos_axis);
  const Angle emission = difference(difference({cos_axis, sineOf(cos_axis)}, {cos_normal_spread, sin_normal_spread}), around);
  if (emission.cosine < cos_emission_spread) return 0.0f;
  const float cos_normal = direction.dot(receivers.normal);
  const Angle incidence =
      difference(difference({cos_normal, sineOf(cos_normal)}, {receivers.cos_spread, sineOf(receivers.cos_spread)}), around);
  if (incidence.cosine < -kCosineSlack) return 0.0f;
  return power * std::max(emission.cosine, kCosineSlack) * std::max(incidence.cosine, kCosineSlack) / (nearest * nearest);
}

LightTree::LightTree(std::span<const LightBounds> items) : leaf_(items.size(), kNone) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < items.size(); ++i)
    if (items[i].power > 0.0f) order.push_back(i);
  if (order.empty()) return;

  struct Work {
    uint32_t node, *begin, *end;
    int depth;
  };
  nodes_.reserve(2 * order.size() - 1);
  nodes_.emplace_back();
  std::vector<LightBounds> bounds(1);  // of the nodes
  std::vector<Work> stack{{0, order.data(), order.data() + order.size(), 0}};
  while (!stack.empty()) {
    const Work work = stack.back();
    stack.pop_back();
    if (work.end - work.begin == 1) {
      nodes_[work.node].item = *work.begin;
      bounds[work.node] = items[*work.begin];
      leaf_[*work.begin] = work.node;
      continue;
    }
    const uint32_t child = uint32_t(nodes_.size());
    nodes_[work.node].first_child = child;
    nodes_.resize(child + 2);
    bounds.resize(child + 2);
    nodes_[child].parent = nodes_[child + 1].parent = work.node;
    uint32_t* middle = split(work.begin, work.end, items, work.depth);
    stack.push_back({child, work.begin, middle, work.depth + 1});
    stack.push_back({child + 1, middle, work.end, work.depth + 1});
  }
  for (size_t i = nodes_.size(); i-- > 0;) {  // children come after their parent
    if (const uint32_t child = nodes_[i].first_child; child != kNone) bounds[i] = unite(bounds[child], bounds[child + 1]);
    nodes_[i].reach = Reach(bounds[i]);
  }
}

float LightTree::firstChildProbability(uint32_t first_child, const Vec3& position, const Vec3& normal) const {
  const float first = nodes_[first_child].reach.importance(position, normal);
  const float second = nodes_[first_child + 1].reach.importance(position, normal);
  return first + second > 0.0f ? first / (first + second) : -1.0f;
}

LightTree::Pick LightTree::pick(const Vec3& position, const Vec3& normal, float u) const {
  return nodes_.empty() ? Pick{} : pickIn(0, position, normal, u);
}

float LightTree::bound(uint32_t node, const Receivers& receivers) const { return nodes_[node].reach.bound(receivers); }

LightTree::Pick LightTree::pickIn(uint32_t node, const Vec3& position, const Vec3& normal, float u) const {
  Pick pick{kNone, 1.0f};
  while (nodes_[node].first_child != kNone) {
    const uint32_t child = nodes_[node].first_child;
    const float first = firstChildProbability(child, position, normal);
    if (first < 0.0f) return {};
    const bool take_first = u < first;
    const float chance = take_first ? first : 1.0f - first;
    u = std::min(take_first ? u / first : (u - first) / chance, 0x1.fffffep-1f);
    pick.probability *= chance;
    node = take_first ? child : child + 1;
  }
  pick.item = nodes_[node].item;
  return pick;
}

float LightTree::probability(uint32_t item, const Vec3& position, const Vec3& normal) const {
  float probability = 1.0f;
  uint32_t node = leaf_[item];
  if (node == kNone) return 0.0f;
  for (; nodes_[node].parent != kNone; node = nodes_[node].parent) {
    const uint32_t first_child = nodes_[nodes_[node].parent].first_child;
    const float first = firstChildProbability(first_child, position, normal);
    if (first < 0.0f) return 0.0f;
    probability *= node == first_child ? first : 1.0f - first;
  }
  return probability;
}

}  // namespace lightwell::transport
