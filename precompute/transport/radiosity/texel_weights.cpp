#include "precompute/transport/radiosity/texel_weights.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/parallel.h"

namespace lightwell::transport {
namespace {

constexpr float kLeastCosine = 0.9f;      // between the normals of what is mixed: about 25°
constexpr float kMostRise = 0.2f;         // of a patch above the texel's plane, as a share of its distance
constexpr uint32_t kMostCandidates = 12;  // patches around a texel
constexpr float kReach = 2.0f;            // how far they may be, in extents of the own patch
constexpr float kLift = 0.02f;            // of rays between patches above the surface, as a share of their length
constexpr float kMissPenalty = 16;        // squared distance from the texel to what is interpolated at, against spread of the patches

struct Candidate {
  uint32_t patch;
  Vec2 at;          // in the texel's plane, the texel at 0
  float distance2;
};

struct Mix {
  std::array<uint32_t, 4> patch{kNone, kNone, kNone, kNone};
  std::array<float, 4> weight{};
  int used = 0;

  void add(uint32_t other, float share) {
    const auto known = std::find(patch.begin(), patch.begin() + used, other) - patch.begin();
    if (known == used) patch[size_t(used++)] = other;
    weight[size_t(known)] += share;
  }
};

class Interpolator {
 public:
  Interpolator(const atlas::Atlas& atlas, const trace::Tracer& tracer, const Patches& patches, const PatchTree& tree)
      : atlas_(atlas), tracer_(tracer), patches_(patches), tree_(tree), bounds_(tree.nodeCount()) {
    for (uint32_t patch = 0; patch < patches.count(); ++patch) bounds_[patch].extendBy(patches.position[patch]);
    for (uint32_t node = patches.count(); node < tree.nodeCount(); ++node)
      for (uint32_t child = tree.first_child[node - patches.count()]; child < tree.first_child[node - patches.count() + 1]; ++child)
        bounds_[node].extendBy(bounds_[child]);
  }

  Mix mix(uint32_t slot) const {
    Mix result;
    const uint32_t own = patches_.patch_of_side[slot];
    result.add(own, 0);
    if (bilinear(slot, own, result)) return result;
    result = {};
    result.add(own, 0);
    delaunay(candidates(slot, own), result);
    return result;
  }

 private:
  /// Not through a shut door.
  bool mayMix(uint32_t a, uint32_t b) const { return patches_.zone.empty() || transport::mayMix(patches_.zone[a], patches_.zone[b]); }

  /// Between the four squares around the texel. False where one is missing, incomplete, of another size or of another orientation.
  bool bilinear(uint32_t slot_index, uint32_t own, Mix& result) const {
    const atlas::Slot& slot = atlas_.slots[slot_index];
    const int texel_x = int(slot.texel) % atlas_.width, texel_y = int(slot.texel) / atlas_.width, k = patches_.texels_per_side[own];
    const float x = (float(texel_x) + 0.5f) / float(k) - 0.5f, y = (float(texel_y) + 0.5f) / float(k) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    for (int i = 0; i < 4; ++i) {
      const int column = x0 + (i & 1), row = y0 + (i >> 1);
      const float share = (i & 1 ? x - float(x0) : 1 - (x - float(x0))) * (i >> 1 ? y - float(y0) : 1 - (y - float(y0)));
      if (share <= 0) continue;
      const uint32_t other = column == texel_x / k && row == texel_y / k ? own : patchOfSquare(column, row, k, texel_x, texel_y, slot.chart);
      // Squares that reach over the chart's border have their middle elsewhere.
      if (other == kNone || patches_.sidesOf(other).size() != size_t(k * k) || patches_.texels_per_side[other] != k) return false;
      if (patches_.normal[other].dot(patches_.normal[own]) < kLeastCosine || !mayMix(own, other)) return false;
      result.add(other, share);
    }
    return true;
  }

  /// The patch in a square of the light map: that of its texel nearest to the one given.
  uint32_t patchOfSquare(int column, int row, int k, int texel_x, int texel_y, uint32_t chart) const {
    const int x = std::clamp(texel_x, column * k, column * k + k - 1), y = std::clamp(texel_y, row * k, row * k + k - 1);
    if (column < 0 || row < 0 || x >= atlas_.width || y >= atlas_.height) return kNone;
    const uint32_t slot = atlas_.texel_slot[size_t(y) * size_t(atlas_.width) + size_t(x)];
    return slot == kNone || atlas_.slots[slot].chart != chart ? kNone : patches_.patch_of_side[slot];
  }

  /// The patches nearest to the texel that continue its surface, nearest first.
  std::vector<Candidate> candidates(uint32_t slot_index, uint32_t own) const {
    const atlas::Slot& slot = atlas_.slots[slot_index];
    const Vec3 normal = slot.normal;
    Vec3 tangent, bitangent;
    orthonormalBasis(normal, tangent, bitangent);
    const float reach = kReach * std::max(std::sqrt(patches_.area[own]), std::sqrt(slot.area));
    std::vector<Candidate> found;
    const auto consider = [&](uint32_t patch) {
      const Vec3 to = patches_.position[patch] - slot.position;
      const float distance2 = to.dot(to), rise = normal.dot(to);
      const bool continues = distance2 <= reach * reach && rise * rise <= kMostRise * kMostRise * distance2 && patches_.normal[patch].dot(normal) >= kLeastCosine && mayMix(own, patch);
      if (patch != own && !continues) return;
      found.push_back({patch, {tangent.dot(to), bitangent.dot(to)}, distance2});
    };
    consider(own);
    std::vector<uint32_t> open;
    for (uint32_t node = tree_.level_first[tree_.levelCount() - 1]; node < tree_.nodeCount(); ++node) open.push_back(node);
    while (!open.empty()) {
      const uint32_t node = open.back();
      open.pop_back();
      Vec3 outside;
      for (int axis = 0; axis < 3; ++axis)
        outside[axis] = std::max({0.0f, bounds_[node].min[axis] - slot.position[axis], slot.position[axis] - bounds_[node].max[axis]});
      if (outside.dot(outside) > reach * reach) continue;
      if (node < patches_.count()) {
        if (node != own) consider(node);
        continue;
      }
      const uint32_t index = node - patches_.count();
      for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) open.push_back(child);
    }
    std::sort(found.begin() + 1, found.end(),
              [](const Candidate& a, const Candidate& b) { return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.patch < b.patch; });
    if (found.size() > kMostCandidates) found.resize(kMostCandidates);
    // What something stands between does not continue the surface.
    std::vector<trace::Ray> rays;
    for (size_t i = 1; i < found.size(); ++i) {
      const float lift = kLift * std::sqrt(found[i].distance2);
      const Vec3 from = trace::Tracer::offsetOrigin(slot.position, normal, normal) + normal * lift;
      const Vec3& other = patches_.normal[found[i].patch];
      const Vec3 to = trace::Tracer::offsetOrigin(patches_.position[found[i].patch], other, other) + other * lift;
      rays.push_back({from, to - from, 0, 1, slot_index});
    }
    std::vector<float> passes(rays.size());
    tracer_.transmittance(rays, passes);
    size_t kept = 1;
    for (size_t i = 1; i < found.size(); ++i)
      if (passes[i - 1] > 0.5f) found[kept++] = found[i];
    found.resize(kept);
    return found;
  }

  /// The weights that make least of Σ w d² + penalty |Σ w x|²: of a triangle around the texel, else of an edge or a corner beside it.
  static void delaunay(const std::vector<Candidate>& all, Mix& result) {
    float best = INFINITY;
    std::array<size_t, 3> choice{};
    std::array<float, 3> weights{};
    const size_t count = all.size();
    for (size_t a = 0; a < count; ++a) {
      const float cost = (1 + kMissPenalty) * all[a].distance2;
      if (cost < best) best = cost, choice = {a, a, a}, weights = {1, 0, 0};
    }
    for (size_t a = 0; a < count; ++a)
      for (size_t b = a + 1; b < count; ++b) {
        const Vec2 edge = all[b].at - all[a].at;
        const float length2 = edge.dot(edge);
        if (!(length2 > 0)) continue;
        // Along the edge the cost is a parabola in the share t of b.
        const float slope = 2 * kMissPenalty * all[a].at.dot(edge) + all[b].distance2 - all[a].distance2;
        const float t = -slope / (2 * kMissPenalty * length2);
        if (!(t > 0 && t < 1)) continue;
        const Vec2 miss = all[a].at + edge * t;
        const float cost = (1 - t) * all[a].distance2 + t * all[b].distance2 + kMissPenalty * miss.dot(miss);
        if (cost < best) best = cost, choice = {a, b, a}, weights = {1 - t, t, 0};
      }
    for (size_t a = 0; a < count; ++a)
      for (size_t b = a + 1; b < count; ++b)
        for (size_t c = b + 1; c < count; ++c) {
          const float whole = cross(all[b].at - all[a].at, all[c].at - all[a].at);
          const float wa = cross(all[b].at, all[c].at) / whole, wb = cross(all[c].at, all[a].at) / whole, wc = 1 - wa - wb;
          if (!(wa >= 0 && wb >= 0 && wc >= 0)) continue;  // also where the three lie on a line
          const float cost = wa * all[a].distance2 + wb * all[b].distance2 + wc * all[c].distance2;
          if (cost < best) best = cost, choice = {a, b, c}, weights = {wa, wb, wc};
        }
    for (size_t i = 0; i < 3; ++i)
      if (weights[i] > 0) result.add(all[choice[i]].patch, weights[i]);
  }

  static float cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  const Patches& patches_;
  const PatchTree& tree_;
  std::vector<Box3> bounds_;  // of the positions below each node
};

}  // namespace

TexelWeights makeTexelWeights(const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches, const PatchTree& tree,
                              int threads, const CancelFlag* cancel) {
  TexelWeights result;
  for (uint32_t slot = 0; slot < sides.front_count; ++slot)
    if (patches.patch_of_side[slot] != kNone) result.slot.push_back(slot);
  result.patch.resize(result.slot.size());
  result.weight.resize(result.slot.size());
  const Interpolator interpolator(atlas, tracer, patches, tree);
  parallelFor(result.slot.size(), 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Mix mix = interpolator.mix(result.slot[i]);
      result.patch[i] = mix.patch;
      result.weight[i] = mix.weight;
    }
  });
  return result;
}

}  // namespace lightwell::transport
