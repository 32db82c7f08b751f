// Embree with nothing around it: what the tracer's speed is measured against. Not for bakes.
#pragma once
#include <embree3/rtcore.h>

#include <span>

#include "precompute/trace/tracer.h"

namespace lightwell::trace {

/// The scene's triangles; every surface opaque and double-sided.
class RawEmbree {
 public:
  /// Fastest: RTC_SCENE_FLAG_NONE and RTC_BUILD_QUALITY_HIGH. As the tracer has it: ROBUST, without which rays slip through shared edges, and MEDIUM. Throws std::runtime_error without memory.
  RawEmbree(const scene::Mesh& mesh, RTCSceneFlags flags, RTCBuildQuality quality);
  ~RawEmbree();
  RawEmbree(const RawEmbree&) = delete;
  RawEmbree& operator=(const RawEmbree&) = delete;

  /// Rays one by one, and as streams of 256.
  void intersectEach(std::span<RTCRayHit> rays) const;
  void intersectStream(std::span<RTCRayHit> rays) const;
  void occludeEach(std::span<RTCRay> rays) const;
  void occludeStream(std::span<RTCRay> rays) const;

 private:
  RTCDevice device_;
  RTCScene scene_;
};

RTCRay rawRay(const Ray& ray);
/// Ready to be intersected.
RTCRayHit rawRayHit(const Ray& ray);

}  // namespace lightwell::trace
