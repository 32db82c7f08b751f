#include "precompute/trace/raw_embree.h"

#include <algorithm>
#include <stdexcept>

namespace lightwell::trace {
namespace {

constexpr size_t kBatch = 256;  // rays of one call of streams

}  // namespace

RawEmbree::RawEmbree(const scene::Mesh& mesh, RTCSceneFlags flags, RTCBuildQuality quality)
    : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
  rtcSetSceneFlags(scene_, flags);
  rtcSetSceneBuildQuality(scene_, quality);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<Vec3*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.positions.size()));
  auto* corners = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangles.size()));
  if (!vertices || !corners) throw std::runtime_error("Embree has no memory for the scene");
  std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
  for (const auto& triangle : mesh.triangles) corners = std::copy_n(triangle.data(), 3, corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

RawEmbree::~RawEmbree() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void RawEmbree::intersectEach(std::span<RTCRayHit> rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (auto& ray : rays) rtcIntersect1(scene_, &context, &ray);
}

void RawEmbree::intersectStream(std::span<RTCRayHit> rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < rays.size(); i += kBatch)
    rtcIntersect1M(scene_, &context, &rays[i], unsigned(std::min<size_t>(kBatch, rays.size() - i)), sizeof(RTCRayHit));
}

void RawEmbree::occludeEach(std::span<RTCRay> rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (auto& ray : rays) rtcOccluded1(scene_, &context, &ray);
}

void RawEmbree::occludeStream(std::span<RTCRay> rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < rays.size(); i += kBatch)
    rtcOccluded1M(scene_, &context, &rays[i], unsigned(std::min<size_t>(kBatch, rays.size() - i)), sizeof(RTCRay));
}

RTCRay rawRay(const Ray& ray) {
  RTCRay raw{};
  raw.org_x = ray.origin.x, raw.org_y = ray.origin.y, raw.org_z = ray.origin.z;
  raw.dir_x = ray.direction.x, raw.dir_y = ray.direction.y, raw.dir_z = ray.direction.z;
  raw.tnear = ray.t_min, raw.tfar = ray.t_max, raw.mask = ~0u;
  return raw;
}

RTCRayHit rawRayHit(const Ray& ray) {
  RTCRayHit raw{};
  raw.ray = rawRay(ray);
  raw.hit.geomID = raw.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return raw;
}

}  // namespace lightwell::trace
