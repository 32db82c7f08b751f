#include "precompute/transport/radiosity/probes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "precompute/core/error.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "precompute/transport/sphere_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kPlaceStream = 6ull << 40;
constexpr uint32_t kPlacingRays = 128;
constexpr float kMostBacks = 0.25f;        // share of rays that meet backs of single-sided surfaces: more of them see the inside of something
constexpr float kLeastClearance = 0.02f;   // in spacings
constexpr double kLeastPocket = 0.01;      // of the probes: fewer that share no surface with the others are in a sealed pocket
constexpr float kMove[] = {0.2f, 0.35f, 0.48f};  // spacings, tried one after the other

/// What is around a point.
struct View {
  uint32_t backs = 0;
  float nearest = std::numeric_limits<float>::infinity();
  std::vector<uint32_t> patches;
};

class Placer {
 public:
  Placer(const scene::Scene& scene, const trace::Tracer& shut, const GatedTracer& gated, uint64_t seed) : scene_(scene), tracer_(shut), gated_(gated), seed_(seed) {}

  View look(const Vec3& position, uint32_t index) {
    rays_ = sphereRays(position, kPlacingRays, seed_, kPlaceStream + index);
    hits_.resize(rays_.size());
    tracer_.closest(rays_, hits_);
    View view;
    for (const auto& hit : hits_) {
      if (hit.triangle == kNone) continue;
      view.nearest = std::min(view.nearest, hit.t);
      if (!hit.front && !scene_.materials[scene_.mesh.triangle_material[hit.triangle]].double_sided) ++view.backs;
    }
    gated_.trace(rays_, kNone, sets_, gated_hits_);
    for (const GatedHit& hit : gated_hits_) view.patches.push_back(hit.patch);
    std::sort(view.patches.begin(), view.patches.end());
    view.patches.erase(std::unique(view.patches.begin(), view.patches.end()), view.patches.end());
    return view;
  }
  static bool isOpen(const View& view, float spacing) {
    if (view.patches.empty() && view.backs > 0) return false;  // behind all of it
    return float(view.backs) <= kMostBacks * kPlacingRays && view.nearest >= kLeastClearance * spacing;
  }

  /// How near surfaces are around a probe, see Probes.
  void nearness(const Vec3& position, float spacing, uint32_t index, float* values) {
    rays_.clear();
    for (int j = 0; j <= kNearnessCells; ++j)
      for (int i = 0; i <= kNearnessCells; ++i) {
        Vec3 d(2.0f * float(i) / kNearnessCells - 1, 2.0f * float(j) / kNearnessCells - 1, 0);
        d.z = 1 - std::abs(d.x) - std::abs(d.y);
        if (d.z < 0) {
          const float x = (1 - std::abs(d.y)) * (d.x >= 0 ? 1.0f : -1.0f);
          d.y = (1 - std::abs(d.x)) * (d.y >= 0 ? 1.0f : -1.0f);
          d.x = x;
        }
        rays_.push_back({.origin = position, .direction = d.normalized(), .key = mixBits(combineKeys(kPlaceStream + index, rays_.size()))});
      }
    hits_.resize(rays_.size());
    tracer_.closest(rays_, hits_);
    for (size_t k = 0; k < rays_.size(); ++k) {
      const Vec3& d = rays_[k].direction;
      const float length = hits_[k].t * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
      values[k] = hits_[k].triangle == kNone ? 0.0f : spacing / std::max(length, 1e-6f * spacing);
    }
  }

 private:
  const scene::Scene& scene_;
  const trace::Tracer& tracer_;
  const GatedTracer& gated_;
  uint64_t seed_;
  GateSets sets_;
  std::vector<GatedHit> gated_hits_;
  std::vector<trace::Ray> rays_;
  std::vector<trace::Hit> hits_;
};

/// Sets that merge.
class Groups {
 public:
  explicit Groups(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<uint32_t> parent_;
};

std::array<int8_t, 3> roundedOffset(const Vec3& spacings) {
  std::array<int8_t, 3> steps;
  for (int k = 0; k < 3; ++k) steps[size_t(k)] = int8_t(std::clamp(std::lround(spacings[k] * 254), -127l, 127l));
  return steps;
}

Vec3 moved(const ProbeLattice& lattice, uint32_t point, const std::array<int8_t, 3>& offset) {
  return lattice.point(point) + Vec3(offset[0], offset[1], offset[2]) * (lattice.spacing / 254);
}

}  // namespace

Vec3 ProbeLattice::point(uint32_t index) const {
  return first + Vec3(float(index % count[0]), float(index / count[0] % count[1]), float(index / count[0] / count[1])) * spacing;
}

ProbeLattice makeProbeLattice(const Box3& bounds, const ProbeOptions& options, double metres_per_unit) {
  ProbeLattice lattice;
  if ((options.spacing <= 0 && options.budget == 0) || bounds.isEmpty()) return lattice;
  const Vec3 extent = bounds.size();
  const auto counts = [&](double spacing) {
    std::array<double, 3> count;
    for (int k = 0; k < 3; ++k) count[size_t(k)] = std::max(1.0, std::ceil(double(extent[k]) / spacing - 1e-4));
    return count;
  };
  const auto points = [&](double spacing) {
    const auto count = counts(spacing);
    return count[0] * count[1] * count[2];
  };
  double spacing = options.spacing;
  const double largest = std::max({extent.x, extent.y, extent.z, 1e-3f});
  if (spacing <= 0)
    for (spacing = largest; points(spacing / 1.02) <= options.budget;) spacing /= 1.02;
  if (points(spacing) > double(kMostLatticePoints)) {
    double least = spacing;
    while (points(least) > double(kMostLatticePoints)) least *= 1.01;
    char text[160];
    std::snprintf(text, sizeof text, "--probe-spacing: the scene would have more than %llu probes; at least %.3g m is possible",
                  static_cast<unsigned long long>(kMostLatticePoints), least * metres_per_unit);
    throw UsageError(text);
  }
  const auto count = counts(spacing);
  lattice.spacing = float(spacing);
  for (int k = 0; k < 3; ++k) {
    lattice.count[size_t(k)] = uint32_t(count[size_t(k)]);
    lattice.first[k] = bounds.center()[k] - 0.5f * lattice.spacing * float(lattice.count[size_t(k)] - 1);
  }
  return lattice;
}

Probes placeProbes(const scene::Scene& scene, const trace::Tracer& shut, const GatedTracer& gated, uint32_t patches, const ProbeOptions& options) {
  Probes probes;
  probes.lattice = makeProbeLattice(scene.bounds, options, scene.metres_per_unit);
  const ProbeLattice& lattice = probes.lattice;
  const auto points = uint32_t(lattice.size());
  enum Fate : uint8_t { kStays, kMoved, kInside };
  std::vector<uint8_t> fate(points, kInside);
  std::vector<std::array<int8_t, 3>> offset(points, {0, 0, 0});
  std::vector<std::vector<uint32_t>> seen(points);
  parallelFor(points, 64, options.threads, options.cancel, [&](size_t begin, size_t end) {
    Placer placer(scene, shut, gated, options.seed);
    for (uint32_t i = uint32_t(begin); i < end; ++i) {
      View view = placer.look(lattice.point(i), i);
      if (Placer::isOpen(view, lattice.spacing)) fate[i] = kStays;
      for (const float distance : kMove) {
        if (fate[i] != kInside) break;
        // Toward the neighbours: 6 faces, then 12 edges, then 8 corners.
        for (int order = 1; order <= 3 && fate[i] == kInside; ++order)
          for (int k = 0; k < 27 && fate[i] == kInside; ++k) {
            const Vec3 way(float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1));
            if (int(way.length2()) != order) continue;
            offset[i] = roundedOffset(way * distance);
            view = placer.look(moved(lattice, i, offset[i]), i);
            if (Placer::isOpen(view, lattice.spacing)) fate[i] = kMoved;
          }
      }
      if (fate[i] != kInside) seen[i] = std::move(view.patches);
    }
  });

  // Probes that see a common patch are in the same air.
  Groups groups(size_t(points) + patches);
  uint32_t open = 0;
  for (uint32_t i = 0; i < points; ++i) {
    open += fate[i] != kInside;
    for (const uint32_t patch : seen[i]) groups.join(i, points + patch);
  }
  std::vector<uint32_t> members(size_t(points) + patches, 0);
  for (uint32_t i = 0; i < points; ++i)
    if (fate[i] != kInside) ++members[groups.find(i)];
  for (uint32_t i = 0; i < points; ++i) {
    if (fate[i] == kInside) ++probes.inside;
    else if (!seen[i].empty() && members[groups.find(i)] < kLeastPocket * open) ++probes.sealed;
    else {
      probes.moved += fate[i] == kMoved;
      probes.lattice_point.push_back(i);
      probes.offset.push_back(offset[i]);
      probes.position.push_back(moved(lattice, i, offset[i]));
    }
  }
  probes.nearness.resize(probes.position.size() * kNearnessNodes);
  parallelFor(probes.position.size(), 64, options.threads, options.cancel, [&](size_t begin, size_t end) {
    Placer placer(scene, shut, gated, options.seed);
    for (size_t i = begin; i < end; ++i) placer.nearness(probes.position[i], lattice.spacing, probes.lattice_point[i], &probes.nearness[i * kNearnessNodes]);
  });
  probes.position.insert(probes.position.end(), options.points.begin(), options.points.end());
  return probes;
}

}  // namespace lightwell::transport
