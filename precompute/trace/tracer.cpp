#include "precompute/trace/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "precompute/core/random.h"

namespace lightwell::trace {
namespace {

/// Triangles that must be looked at for each hit: for their alpha, or because a part of them is open. Their Embree primitive i is the scene's triangle `triangle[i]`.
struct CutOuts {
  const scene::Scene* scene;
  std::vector<uint32_t> triangle;
  std::vector<float> portal_open;  // per portal; empty: all shut

  /// Whether an open portal has left nothing there.
  bool isOpen(uint32_t of, float u, float v) const {
    for (size_t i = 0; i < portal_open.size(); ++i) {
      const scene::Portal& portal = scene->portals[i];
      if (!portal.holds(of)) continue;
      const auto& corner = scene->mesh.triangles[of];
      const auto& p = scene->mesh.positions;
      return portal.place(p[corner[0]] * (1 - u - v) + p[corner[1]] * u + p[corner[2]] * v) < portal_open[i];
    }
    return false;
  }
};

/// What an occlusion ray gathers on its way: Embree hands the context to the filter functions.
struct OcclusionContext {
  RTCIntersectContext embree;  // first, so that a pointer to it is a pointer to the whole
  float transmittance;
};

bool needsAlpha(const scene::Scene& scene, const scene::Material& material) {
  if (material.alpha_mode == scene::AlphaMode::opaque) return false;
  const bool constant = material.base_color_texture == kNone && scene.mesh.colors.empty();
  return !constant || material.alpha < 1.0f;
}

/// Closest hits: a surface of alpha a stops a ray with probability a. The decision is a function of the ray's key and the triangle, hence
/// the same however often Embree asks.
void passOrStop(const RTCFilterFunctionNArguments* args) {
  const auto& cut_outs = *static_cast<const CutOuts*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    const uint32_t triangle = cut_outs.triangle[RTCHitN_primID(args->hit, args->N, i)];
    const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
    if (cut_outs.isOpen(triangle, u, v)) {
      args->valid[i] = 0;
      continue;
    }
    const float alpha = scene::surfaceAlpha(*cut_outs.scene, triangle, u, v);
    if (alpha >= 1.0f) continue;
    const uint32_t key = RTCRayN_id(args->ray, args->N, i);
    if (float(mixBits(combineKeys(key, triangle)) >> 8) * 0x1p-24f >= alpha) args->valid[i] = 0;
  }
}

/// Occlusion: light is attenuated by each surface on the way and the ray goes on until nothing is left of it.
void attenuate(const RTCFilterFunctionNArguments* args) {
  const auto& cut_outs = *static_cast<const CutOuts*>(args->geometryUserPtr);
  auto& context = *reinterpret_cast<OcclusionContext*>(args->context);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    const uint32_t triangle = cut_outs.triangle[RTCHitN_primID(args->hit, args->N, i)];
    const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
    const float alpha = cut_outs.isOpen(triangle, u, v) ? 0.0f : scene::surfaceAlpha(*cut_outs.scene, triangle, u, v);
    context.transmittance *= std::clamp(1.0f - alpha, 0.0f, 1.0f);
    if (context.transmittance > 0.0f) args->valid[i] = 0;
  }
}

/// Not for a ray that meets nothing by definition: an empty or undefined segment, or one that is nowhere.
bool isTraceable(const Ray& ray) {
  const Vec3 sum = ray.origin + ray.direction;
  return ray.t_max > ray.t_min && std::isfinite(sum.x + sum.y + sum.z) && ray.direction != Vec3(0.0f);
}

void setRay(RTCRay& out, const Ray& ray) {
  out.org_x = ray.origin.x, out.org_y = ray.origin.y, out.org_z = ray.origin.z;
  out.dir_x = ray.direction.x, out.dir_y = ray.direction.y, out.dir_z = ray.direction.z;
  out.tnear = std::max(ray.t_min, 0.0f), out.tfar = ray.t_max;
  out.time = 0.0f, out.mask = ~0u, out.id = ray.key, out.flags = 0;
}

}  // namespace

struct Tracer::Impl {
  explicit Impl(const scene::Scene& scene) : scene(scene) {}
  ~Impl() {
    if (embree_scene) rtcReleaseScene(embree_scene);
    if (vertices) rtcReleaseBuffer(vertices);
    if (device) rtcReleaseDevice(device);
  }

  void check(const char* step) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error(std::string("Embree could not ") + step +
                               (error == RTC_ERROR_OUT_OF_MEMORY ? ": out of memory" : ": error " + std::to_string(int(error))));
  }
  unsigned attach(const std::vector<uint32_t>& triangles, const CutOuts* filtered);

  const scene::Scene& scene;
  RTCDevice device = nullptr;
  RTCScene embree_scene = nullptr;
  RTCBuffer vertices = nullptr;
  std::vector<uint32_t> opaque;  // scene triangles of geometry kOpaque
  CutOuts cut_outs;              // of geometry kCutOut
  std::array<const uint32_t*, 2> triangle_of{};  // per Embree geometry: primitive to scene triangle
  std::atomic<uint64_t> closest_rays{0}, occlusion_rays{0};
};

/// Makes one Embree geometry of the given scene triangles; with alpha looked up at every hit when `filtered`.
unsigned Tracer::Impl::attach(const std::vector<uint32_t>& triangles, const CutOuts* filtered) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(Vec3), scene.mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles.size());
  check("make an index buffer");
  auto* corner = static_cast<uint32_t*>(indices);
  for (const uint32_t triangle : triangles) corner = std::copy_n(scene.mesh.triangles[triangle].data(), 3, corner);
  if (filtered) {
    rtcSetGeometryUserData(geometry, const_cast<CutOuts*>(filtered));
    rtcSetGeometryIntersectFilterFunction(geometry, passOrStop);
    rtcSetGeometryOccludedFilterFunction(geometry, attenuate);
  }
  rtcCommitGeometry(geometry);
  const unsigned id = rtcAttachGeometry(embree_scene, geometry);
  rtcReleaseGeometry(geometry);
  return id;
}

Tracer::Tracer(const scene::Scene& scene, int threads, std::vector<float> portal_open) : impl_(std::make_unique<Impl>(scene)) {
  if (!portal_open.empty() && portal_open.size() != scene.portals.size()) throw std::logic_error("Tracer: one value for each portal is needed");
  Impl& impl = *impl_;
  impl.cut_outs.scene = &scene;
  impl.cut_outs.portal_open = std::move(portal_open);
  const scene::Mesh& mesh = scene.mesh;
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    float open = 0;
    for (size_t p = 0; p < impl.cut_outs.portal_open.size(); ++p)
      if (scene.portals[p].holds(i)) open = impl.cut_outs.portal_open[p];
    if (open >= 1) continue;
    (open > 0 || needsAlpha(scene, scene.materials[mesh.triangle_material[i]]) ? impl.cut_outs.triangle : impl.opaque).push_back(i);
  }

  impl.device = rtcNewDevice(threads > 0 ? ("threads=" + std::to_string(threads)).c_str() : nullptr);
  if (!impl.device) throw std::runtime_error("Embree could not start: error " + std::to_string(int(rtcGetDeviceError(nullptr))));
  impl.embree_scene = rtcNewScene(impl.device);
  // Robust: without it 6 % of the rays aimed at shared edges of a closed mesh escape, with it none does. It costs a fifth of the rate.
  rtcSetSceneFlags(impl.embree_scene, RTC_SCENE_FLAG_ROBUST);
  // Medium, not high: after spatial splits a filter function may be asked twice about one triangle. Incoherent rays are as fast.
  rtcSetSceneBuildQuality(impl.embree_scene, RTC_BUILD_QUALITY_MEDIUM);
  if (!mesh.triangles.empty()) {
    const size_t vertex_bytes = mesh.positions.size() * sizeof(Vec3);
    impl.vertices = rtcNewBuffer(impl.device, vertex_bytes + 16);  // Embree reads the last vertex with a 16-byte load
    impl.check("make a vertex buffer");
    std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<Vec3*>(rtcGetBufferData(impl.vertices)));
    if (!impl.opaque.empty()) impl.triangle_of[impl.attach(impl.opaque, nullptr)] = impl.opaque.data();
    const std::vector<uint32_t>& filtered = impl.cut_outs.triangle;
    if (!filtered.empty()) impl.triangle_of[impl.attach(filtered, &impl.cut_outs)] = filtered.data();
  }
  rtcCommitScene(impl.embree_scene);
  impl.check("build the acceleration structure");
}

Tracer::~Tracer() = default;

void Tracer::closest(std::span<const Ray> rays, std::span<Hit> hits) const {
  if (rays.size() != hits.size()) throw std::logic_error("Tracer::closest: as many hits as rays are needed");
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < rays.size(); ++i) {
    hits[i] = Hit{};
    if (!isTraceable(rays[i])) continue;
    RTCRayHit ray_hit;
    setRay(ray_hit.ray, rays[i]);
    ray_hit.hit.geomID = ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->embree_scene, &context, &ray_hit);
    const RTCHit& found = ray_hit.hit;
    if (found.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    const Vec3 normal(found.Ng_x, found.Ng_y, found.Ng_z);
    hits[i].triangle = impl_->triangle_of[found.geomID][found.primID];
    hits[i].t = ray_hit.ray.tfar;
    hits[i].u = found.u;
    hits[i].v = found.v;
    hits[i].front = normal.dot(rays[i].direction) < 0.0f;
    hits[i].geometric_normal = (hits[i].front ? normal : -normal).normalized();
  }
  impl_->closest_rays.fetch_add(rays.size(), std::memory_order_relaxed);
}

void Tracer::transmittance(std::span<const Ray> rays, std::span<float> transmittance) const {
  if (rays.size() != transmittance.size()) throw std::logic_error("Tracer::transmittance: as many results as rays are needed");
  OcclusionContext context;
  rtcInitIntersectContext(&context.embree);
  for (size_t i = 0; i < rays.size(); ++i) {
    transmittance[i] = 1.0f;
    if (!isTraceable(rays[i])) continue;
    RTCRay ray;
    setRay(ray, rays[i]);
    context.transmittance = 1.0f;
    rtcOccluded1(impl_->embree_scene, &context.embree, &ray);
    transmittance[i] = ray.tfar < 0.0f ? 0.0f : context.transmittance;  // Embree marks an occluded ray with tfar = -inf
  }
  impl_->occlusion_rays.fetch_add(rays.size(), std::memory_order_relaxed);
}

RayCounts Tracer::counts() const { return {impl_->closest_rays.load(), impl_->occlusion_rays.load()}; }

Vec3 Tracer::offsetOrigin(const Vec3& position, const Vec3& geometric_normal, const Vec3& direction) {
  const float magnitude = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z), 4.0f});
  const float offset = magnitude * 0x1p-18f;
  return position + geometric_normal * (geometric_normal.dot(direction) < 0.0f ? -offset : offset);
}

}  // namespace lightwell::trace
