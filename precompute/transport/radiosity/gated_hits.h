// What rays meet when the scene's portals may be open or shut: patches, each with the set of gates that has to be as it says for the ray to end there.
//
// A ray that meets a leaf ends on it while that strip is closed, and goes on while it is open. Which strip it is, is a matter of the point where it meets the leaf, not of the texel there.
// A leaf's other face is part of the same gate. In every state of the portals exactly one of a ray's hits counts, or none where it meets what reflects nothing.
#pragma once
#include "precompute/trace/tracer.h"
#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

struct GatedHit {
  uint32_t ray;    // index
  uint32_t patch;
  uint32_t set;    // of gates, the one at the ray's own origin included
};

class GatedTracer {
 public:
  /// `open`: tracer of the scene with all portals open; may be null when there are none. All must outlive this.
  GatedTracer(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& shut, const trace::Tracer* open, const Sides& sides, const Patches& patches);

  /// Replaces `hits` by what the rays meet, in their order; sets are numbered in `sets`. `origin_patch`: the patch on which rays start (its zone may hold a gate), or kNone for rays from the
  /// air. A ray passes kMostOpenGates gates at most; the next leaf stops it as if it were shut in every state, so that no energy is lost.
  void trace(std::span<const trace::Ray> rays, uint32_t origin_patch, GateSets& sets, std::vector<GatedHit>& hits) const;

  static constexpr size_t kMostOpenGates = 6;  // three leaves that have a thickness

  const PortalZones& zones() const { return zones_; }

 private:
  class Path;
  void follow(const trace::Ray& ray, const trace::Hit& first, Path& path) const;
  uint32_t patchAt(const trace::Hit& hit) const;

  const scene::Scene& scene_;
  const atlas::Atlas& atlas_;
  const trace::Tracer& shut_;
  const trace::Tracer* open_;
  const Sides& sides_;
  const Patches& patches_;
  PortalZones zones_;
};

}  // namespace lightwell::transport
