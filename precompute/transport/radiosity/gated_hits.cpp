#include "precompute/transport/radiosity/gated_hits.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr int kMostFaces = 64;               // of leaves along one ray
constexpr float kPastFace = 0x1p-19f;        // of the distance: where a ray goes on behind a face
constexpr float kBeforeSurface = 1 - 0x1p-19f;

}  // namespace

/// The gates of one ray, and its hits.
class GatedTracer::Path {
 public:
  Path(uint32_t ray, GateEntry at_origin, GateSets& sets, std::vector<GatedHit>& hits) : ray_(ray), sets_(sets), hits_(hits) {
    if (at_origin != kNoEntry) entries_.push_back(at_origin);
  }
  bool isOpen(uint32_t gate) const { return has(openGate(gate)); }
  bool isClosed(uint32_t gate) const { return has(closedGate(gate)); }
  bool mayPass() const {
    return size_t(std::count_if(entries_.begin(), entries_.end(), [](GateEntry e) { return !transport::isClosed(e); })) < kMostOpenGates;
  }
  void pass(uint32_t gate) { entries_.push_back(openGate(gate)); }
  /// A hit that needs `more`, too, unless that contradicts the set.
  void end(uint32_t patch, GateEntry more = kNoEntry) {
    if (patch == kNone || (more != kNoEntry && has(GateEntry(more ^ 1)))) return;
    const bool adds = more != kNoEntry && !has(more);
    if (adds) entries_.push_back(more);
    hits_.push_back({ray_, patch, sets_.number(entries_)});
    if (adds) entries_.pop_back();
  }

 private:
  bool has(GateEntry entry) const { return std::find(entries_.begin(), entries_.end(), entry) != entries_.end(); }

  uint32_t ray_;
  GateSets& sets_;
  std::vector<GatedHit>& hits_;
  std::vector<GateEntry> entries_;
};

GatedTracer::GatedTracer(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& shut, const trace::Tracer* open, const Sides& sides,
                         const Patches& patches)
    : scene_(scene), atlas_(atlas), shut_(shut), open_(open), sides_(sides), patches_(patches), zones_(scene) {}

uint32_t GatedTracer::patchAt(const trace::Hit& hit) const {
  if (hit.triangle == kNone) return kNone;
  const uint32_t side = sides_.met(atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v), hit.front);
  return side != kNone ? patches_.patch_of_side[side] : kNone;
}

void GatedTracer::trace(std::span<const trace::Ray> rays, uint32_t origin_patch, GateSets& sets, std::vector<GatedHit>& hits) const {
  std::vector<trace::Hit> first(rays.size());
  shut_.closest(rays, first);
  hits.clear();
  for (uint32_t i = 0; i < rays.size(); ++i) {
    if (zones_.empty()) {
      const uint32_t patch = patchAt(first[i]);
      if (patch != kNone) hits.push_back({i, patch, 0});
      continue;
    }
    Path path(i, origin_patch != kNone ? zones_.entryAt(patches_.zone[origin_patch], rays[i].origin) : kNoEntry, sets, hits);
    follow(rays[i], first[i], path);
  }
}

void GatedTracer::follow(const trace::Ray& ray, const trace::Hit& first, Path& path) const {
  const auto pointAt = [&](float t) { return ray.origin + ray.direction * t; };
  const auto endOnSurface = [&](const trace::Hit& hit) {
    const uint32_t patch = patchAt(hit);
    if (patch != kNone) path.end(patch, zones_.entryAt(patches_.zone[patch], pointAt(hit.t)));
  };
  trace::Hit hit = first, last;
  bool last_known = false;  // what the ray meets when all portals are open
  for (int face = 0; hit.triangle != kNone; ++face) {
    const Vec3 point = pointAt(hit.t);
    const uint32_t gate = zones_.gateOf(hit.triangle, point);
    if (gate == kNone) break;
    // The leaf from which the ray comes is there; one too many stands as if it were shut.
    if (path.isClosed(gate) || face == kMostFaces) return path.end(patchAt(hit));
    if (!path.isOpen(gate)) {
      if (!path.mayPass()) return path.end(patchAt(hit));
      path.end(patchAt(hit), closedGate(gate));
      path.pass(gate);
    }
    if (!last_known) {
      open_->closest({&ray, 1}, {&last, 1});
      last_known = true;
    }
    trace::Ray rest = ray;
    rest.t_min = hit.t + std::max(hit.t, 1.0f) * kPastFace;
    rest.t_max = std::min(ray.t_max, last.triangle != kNone ? last.t * kBeforeSurface : ray.t_max);
    hit = {};
    if (rest.t_max > rest.t_min) shut_.closest({&rest, 1}, {&hit, 1});
  }
  endOnSurface(last_known ? last : hit);
}

}  // namespace lightwell::transport
