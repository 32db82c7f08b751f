#include "precompute/transport/reference/path_batch.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

/// Dimensions of the random numbers. Those of vertex d start at kFirstVertex + d * kPerVertex.
enum Dimension : uint32_t {
  kPatch = 0,  // 1D: which patch of the texel
  kPlace = 1,  // 2D: where in it
  kFirstVertex = 2,
  kDirection = 0,   // 2D
  kEmitter = 1,     // 1D: which emitter
  kEmitterPlace = 2,  // 2D
  kLight = 3,       // 1D: which punctual light
  kSurvival = 4,    // 1D: Russian roulette
  kPerVertex = 5,
  kFirstSky = 1u << 20,  // 2D, one for each vertex
};
constexpr float kSegmentEnd = 1.0f - 0x1p-16f;  // a shadow segment stops short of the light itself

uint32_t dimensionOf(uint32_t depth, uint32_t which) { return kFirstVertex + depth * kPerVertex + which; }

Vec3 toWorld(const Vec3& local, const Vec3& axis) {
  Vec3 tangent, bitangent;
  orthonormalBasis(axis, tangent, bitangent);
  return tangent * local.x + bitangent * local.y + axis * local.z;
}

/// The vertex under a hit, on the side that the ray came from.
PathVertex vertexAt(const scene::Mesh& mesh, const trace::Hit& hit) {
  const auto& corner = mesh.triangles[hit.triangle];
  const float w = 1.0f - hit.u - hit.v;
  PathVertex vertex;
  vertex.position = mesh.positions[corner[0]] * w + mesh.positions[corner[1]] * hit.u + mesh.positions[corner[2]] * hit.v;
  vertex.geometric_normal = hit.geometric_normal;
  Vec3 normal = mesh.normals[corner[0]] * w + mesh.normals[corner[1]] * hit.u + mesh.normals[corner[2]] * hit.v;
  if (!hit.front) normal = -normal;
  const float length = normal.length();
  vertex.shading_normal = length > 0.0f ? normal / length : hit.geometric_normal;
  return vertex;
}

}  // namespace

void PathBatch::trace(const std::vector<PathStart>& starts, std::vector<Rgb>& irradiance_rgb, const Arrival* arrival) {
  const auto& [scene, atlas, tracer, emitters, punctual, sky, component, cancel, most_bounces] = context_;
  irradiance_rgb.assign(starts.size(), Rgb(0.0f));
  const auto add = [&](uint32_t path_index, const trace::Ray& ray, const Rgb& arrived_rgb) {
    irradiance_rgb[path_index] += arrived_rgb;
    if (arrival && maxComponent(arrived_rgb) > 0.0f) (*arrival)(path_index, ray.direction, arrived_rgb);
  };
  paths_.clear();
  for (uint32_t i = 0; i < starts.size(); ++i) {
    const PathStart& start = starts[i];
    const float pick = start.sampler.get1D(start.sample, kPatch);
    const Vec2 place = start.sampler.get2D(start.sample, kPlace);
    const atlas::SurfacePoint point = atlas::sampleSlot(scene.mesh, atlas, atlas.slots[start.slot], pick, place);
    Path path;
    path.index = i;
    const float side = start.back ? -1.0f : 1.0f;
    path.vertex = {point.position, point.normal * side, point.geometric_normal * side};
    paths_.push_back(path);
  }

  while (!paths_.empty()) {
    if (cancel) cancel->check();
    rays_.clear(), light_rays_.clear(), light_contributions_.clear(), emitter_rays_.clear(), emitter_contributions_.clear();
    size_t going_on = 0;
    for (Path& path : paths_) {
      const PathStart& start = starts[path.index];
      if (component != Component::indirect || path.depth > 0) {
        aimAtLights(path, start);
        if (!emitters.empty()) aimAtEmitter(path, start);
        if (sky) aimAtSky(path, start);
      }
      if (scatter(path, start)) paths_[going_on++] = path;
    }
    paths_.resize(going_on);

    transmittance_.resize(light_rays_.size());
    tracer.transmittance(light_rays_, transmittance_);
    for (size_t i = 0; i < light_contributions_.size(); ++i)
      add(light_contributions_[i].path_index, light_rays_[i], light_contributions_[i].irradiance_rgb * transmittance_[i]);

    hits_.resize(emitter_rays_.size());
    tracer.closest(emitter_rays_, hits_);
    for (size_t i = 0; i < emitter_contributions_.size(); ++i)
      if (hits_[i].triangle == emitter_contributions_[i].triangle)
        add(emitter_contributions_[i].path_index, emitter_rays_[i], emitter_contributions_[i].irradiance_rgb);

    hits_.resize(rays_.size());
    tracer.closest(rays_, hits_);
    going_on = 0;
    for (size_t i = 0; i < paths_.size(); ++i) {
      const uint32_t index = paths_[i].index;
      Rgb arrived_rgb = sky && hits_[i].triangle == kNone ? escape(paths_[i], rays_[i].direction) : Rgb(0.0f);
      const bool goes_on = arrive(paths_[i], starts[index], hits_[i], arrived_rgb);
      add(index, rays_[i], arrived_rgb);
      if (goes_on) paths_[going_on++] = paths_[i];
    }
    paths_.resize(going_on);
  }
}

/// Next-event estimation: queues shadow rays to punctual lights.
void PathBatch::aimAtLights(const Path& path, const PathStart& start) {
  const PathVertex& vertex = path.vertex;
  light_samples_.clear();
  const float u_light = start.sampler.get1D(start.sample, dimensionOf(path.depth, kLight));
  context_.punctual.sample(vertex.position, vertex.shading_normal, path.depth == 0, u_light, light_samples_);
  for (const PunctualLights::Sample& light : light_samples_) {
    if (!(light.to_light.dot(vertex.geometric_normal) > 0.0f)) continue;
    const Vec3 origin = trace::Tracer::offsetOrigin(vertex.position, vertex.geometric_normal, light.to_light);
    if (std::isfinite(light.distance))
      light_rays_.push_back({origin, vertex.position + light.to_light * light.distance - origin, 0.0f, kSegmentEnd});
    else
      light_rays_.push_back({origin, light.to_light});
    light_contributions_.push_back({path.index, path.throughput_rgb * light.irradiance_rgb});
  }
}

/// Next-event estimation: queues a ray to a point of an emitter. It must meet that very triangle first, by the same rule as any other ray:
/// of emitters that coincide (levels have them) each ray then sees one, whichever technique sent it, and none counts twice.
void PathBatch::aimAtEmitter(const Path& path, const PathStart& start) {
  const PathVertex& vertex = path.vertex;
  const auto emitter = context_.emitters.sample(vertex.position, vertex.shading_normal,
                                                start.sampler.get1D(start.sample, dimensionOf(path.depth, kEmitter)),
                                                start.sampler.get2D(start.sample, dimensionOf(path.depth, kEmitterPlace)));
  if (!emitter) return;
  const Vec3 to_emitter = emitter->position - vertex.position;
  const float distance = to_emitter.length();
  if (!(distance > 0.0f)) return;
  const Vec3 direction = to_emitter / distance;
  const float cos_receiver = direction.dot(vertex.shading_normal);
  const float cos_side = -direction.dot(emitter->geometric_normal);
  const float cos_emitter = emitter->double_sided ? std::abs(cos_side) : cos_side;
  if (!(cos_receiver > 0.0f && cos_emitter > 0.0f && direction.dot(vertex.geometric_normal) > 0.0f)) return;
  if (!(maxComponent(emitter->radiance_rgb) > 0.0f)) return;
  // Balance heuristic (Veach 1997, section 9.2.2): f / p_light * p_light / (p_light + p_cosine) leaves f / (p_light + p_cosine).
  const float pdf_light = emitter->pdf_area * distance * distance / cos_emitter, pdf_cosine = cos_receiver / kPi;
  const Vec3 origin = trace::Tracer::offsetOrigin(vertex.position, vertex.geometric_normal, direction);
  emitter_rays_.push_back({origin, (emitter->position - origin).normalized(), 0.0f, std::numeric_limits<float>::infinity(),
                           mixBits(combineKeys(start.key, 2 * path.depth + 1))});
  emitter_contributions_.push_back(
      {path.index, emitter->triangle, path.throughput_rgb * emitter->radiance_rgb * (cos_receiver / (pdf_light + pdf_cosine))});
}

/// Next-event estimation: queues a shadow ray to a direction of the sky. Balance heuristic as for emitters.
void PathBatch::aimAtSky(const Path& path, const PathStart& start) {
  const PathVertex& vertex = path.vertex;
  const SkyLight::Sample sky = context_.sky->sample(start.sampler.get2D(start.sample, kFirstSky + path.depth));
  const float cos_receiver = sky.direction.dot(vertex.shading_normal);
  if (!(cos_receiver > 0.0f && sky.direction.dot(vertex.geometric_normal) > 0.0f)) return;
  light_rays_.push_back({trace::Tracer::offsetOrigin(vertex.position, vertex.geometric_normal, sky.direction), sky.direction});
  light_contributions_.push_back(
      {path.index, path.throughput_rgb * sky.radiance_rgb * (cos_receiver / (sky.pdf_solid_angle + cos_receiver / kPi))});
}

/// What a path's ray brings from the sky.
Rgb PathBatch::escape(const Path& path, const Vec3& direction) const {
  if (context_.component == Component::indirect && path.depth == 0) return Rgb(0.0f);
  const SkyLight::Value sky = context_.sky->at(direction);
  const float weight = path.pdf_direction > 0.0f ? path.pdf_direction / (path.pdf_direction + sky.pdf_solid_angle) : 0.0f;
  return path.throughput_rgb * sky.radiance_rgb * (kPi * weight);
}

/// Queues the ray of a path's next direction. False when the path ends here.
bool PathBatch::scatter(Path& path, const PathStart& start) {
  if (context_.component == Component::direct && context_.emitters.empty() && !context_.sky) return false;
  const uint32_t dimension = dimensionOf(path.depth, kDirection);
  const Vec3 local = sampleCosineHemisphere(start.sampler.get2D(start.sample, dimension));
  const Vec3 direction = toWorld(local, path.vertex.shading_normal);
  if (!(direction.dot(path.vertex.geometric_normal) > 0.0f)) return false;  // from below the surface nothing is received
  path.pdf_direction = local.z / kPi;
  rays_.push_back({trace::Tracer::offsetOrigin(path.vertex.position, path.vertex.geometric_normal, direction), direction, 0.0f,
                   std::numeric_limits<float>::infinity(), mixBits(combineKeys(start.key, 2 * path.depth))});
  return true;
}

/// The path's ray met a surface: adds what that emits, reflects there. False when the path ends.
bool PathBatch::arrive(Path& path, const PathStart& start, const trace::Hit& hit, Rgb& irradiance_rgb) const {
  const auto& [scene, atlas, tracer, emitters, punctual, sky, component, cancel, most_bounces] = context_;
  if (hit.triangle == kNone) return false;
  if (!hit.front && !scene.materials[scene.mesh.triangle_material[hit.triangle]].double_sided) return false;
  const scene::SurfaceColor color = scene::surfaceColor(scene, hit.triangle, hit.u, hit.v);
  const PathVertex next = vertexAt(scene.mesh, hit);

  // Without emitters in the context somebody else counts their light.
  if (maxComponent(color.emitted_radiance_rgb) > 0.0f && !emitters.empty() && (component != Component::indirect || path.depth > 0)) {
    const Vec3 way = next.position - path.vertex.position;
    const float distance2 = way.length2();
    const float cos_emitter = std::abs(way.dot(next.geometric_normal)) / std::sqrt(distance2);
    const float pdf_area = emitters.pdfArea(hit.triangle, hit.u, hit.v, path.vertex.position, path.vertex.shading_normal);
    // Written so that a hit at no distance or at grazing incidence, where the light's density is 0 or infinite, stays finite.
    const float cosine_share = path.pdf_direction * cos_emitter, light_share = pdf_area * distance2;
    const float weight = cosine_share > 0.0f ? cosine_share / (cosine_share + light_share) : 0.0f;
    irradiance_rgb += path.throughput_rgb * color.emitted_radiance_rgb * (kPi * weight);
  }
  if (component == Component::direct || path.depth >= most_bounces) return false;

  path.throughput_rgb *= color.albedo_rgb;
  const float survival = std::min(1.0f, maxComponent(path.throughput_rgb));
  if (!(start.sampler.get1D(start.sample, dimensionOf(path.depth, kSurvival)) < survival)) return false;
  path.throughput_rgb /= survival;
  path.vertex = next;
  ++path.depth;
  return true;
}

}  // namespace lightwell::transport
