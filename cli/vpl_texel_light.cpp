#include "cli/vpl_texel_light.h"

#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "precompute/core/random.h"

namespace lightwell::cli {
namespace {

constexpr uint64_t kSeed = 1;
constexpr uint32_t kLeastPoints = 4;
constexpr size_t kCoarseNodes = 24, kMostNodes = 1u << 13;
constexpr uint32_t kRestoringRays = 4;  // for each point of a texel
constexpr size_t kSecondNodes = 8;      // lights looked at where such a ray ends
constexpr double kFloor = 0.1;          // of the mean irradiance: what the error of a dark texel is relative to
enum Dimension : uint32_t { kPiece = 0, kPlace = 1, kRestore = 2, kLamps = 3, kCoarse = 16, kFine = 1u << 28, kSecond = 2u << 28 };

transport::LightBounds boundsOf(const lw_virtual_light& light) {
  const Vec3 position(light.position_m[0], light.position_m[1], light.position_m[2]), normal(light.normal[0], light.normal[1], light.normal[2]);
  const bool sphere = light.type == LW_VIRTUAL_SPHERE;
  transport::LightBounds bounds{.axis = normal, .normal_spread = sphere ? kPi : 0, .emission_spread = kPi / 2};
  bounds.box.extendBy(position);
  bounds.power = luminance({light.flux_rgb[0], light.flux_rgb[1], light.flux_rgb[2]});
  if (light.radius_m > 0) {
    Vec3 reach(light.radius_m);
    if (!sphere)
      for (int k = 0; k < 3; ++k) reach[k] *= std::sqrt(std::max(0.0f, 1 - normal[k] * normal[k]));
    bounds.box.extendBy(position - reach), bounds.box.extendBy(position + reach);
  }
  for (uint32_t i = 0; i < light.vertex_count; ++i)
    bounds.box.extendBy({light.vertices_m[i * 3], light.vertices_m[i * 3 + 1], light.vertices_m[i * 3 + 2]});
  return bounds;
}

bool isPartOf(const lw_virtual_light& light, transport::Component component) {
  return component == transport::Component::total || (light.bounce == 0) == (component == transport::Component::direct);
}

transport::LightTree treeOf(const std::vector<lw_virtual_light>& lights, transport::Component component) {
  std::vector<transport::LightBounds> bounds;
  for (const lw_virtual_light& light : lights) {
    bounds.push_back(boundsOf(light));
    if (!isPartOf(light, component)) bounds.back().power = 0;  // in no cut
  }
  return transport::LightTree(bounds);
}

}  // namespace

VirtualLightSet::VirtualLightSet(const VplEvaluation& evaluation, std::vector<lw_virtual_light> all)
    : lights(std::move(all)), tree(treeOf(lights, evaluation.component)), lamps(evaluation.scene.scene.lights) {
  double area = 0, flux = 0;
  for (const atlas::Slot& slot : evaluation.scene.atlas.slots) area += double(slot.area);
  const double metres = evaluation.scene.scene.metres_per_unit, surface_m2 = area * metres * metres;
  bool points = false;
  size_t parts = 0;
  for (const lw_virtual_light& light : lights) {
    if (!isPartOf(light, evaluation.component)) continue;
    ++parts;
    flux += double(luminance({light.flux_rgb[0], light.flux_rgb[1], light.flux_rgb[2]}));
    points |= light.type == LW_VIRTUAL_POINT;
  }
  if (surface_m2 > 0) mean_irradiance = flux / surface_m2;
  if (!points) return;
  most_share = evaluation.clamp.value_or(surface_m2 > 0 ? float(double(parts) / surface_m2) : 0.0f);
  if (!(most_share > 0) || !evaluation.restore) return;
  whole_tree = treeOf(lights, transport::Component::total);
  const auto decoded = [&]<typename T>(lw_array array, T value) {
    lw_array_info info{};
    std::vector<T> values;
    if (const lw_result result = lw_get_array_info(evaluation.container.get(), array, &info); result == LW_NOT_FOUND) return values;
    else evaluation.container.check(result);
    values.assign(info.bytes / sizeof(T), value);
    evaluation.container.check(lw_decode_array(evaluation.container.get(), array, values.data(), info.bytes));
    return values;
  };
  const bool direct = evaluation.component != transport::Component::indirect, indirect = evaluation.component != transport::Component::direct;
  const std::vector<uint8_t> albedo = indirect ? decoded(LW_ARRAY_ATLAS_ALBEDO, uint8_t(0)) : std::vector<uint8_t>();
  const std::vector<float> emission = direct ? decoded(LW_ARRAY_ATLAS_EMISSION, 0.0f) : std::vector<float>();
  const auto& slots = evaluation.scene.atlas.slots;
  albedo_rgb.assign(slots.size(), Rgb(0.0f)), emission_rgb.assign(slots.size(), Rgb(0.0f));
  for (size_t i = 0; i < slots.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const size_t at = size_t(slots[i].texel) * 3 + size_t(k);
      if (at < albedo.size()) albedo_rgb[i][k] = format::decodeSrgb(albedo[at]);
      if (at < emission.size()) emission_rgb[i][k] = emission[at];
    }
}

uint32_t pointsOf(const VplEvaluation& evaluation) { return std::max(evaluation.samples / 16, kLeastPoints); }

TexelLight::TexelLight(const VplEvaluation& evaluation, const VirtualLightSet& set)
    : evaluation_(evaluation), set_(set), metres_(float(evaluation.scene.scene.metres_per_unit)), cut_(set.tree), second_cut_(set.whole_tree) {}

TexelLight::At TexelLight::placed(const Vec3& position, const Vec3& normal, const Vec3& geometric_normal) const {
  return {position, position * metres_, normal, geometric_normal};
}

transport::Receivers TexelLight::around(std::span<const At> at) const {
  transport::Receivers receivers;
  Vec3 middle(0.0f), normal(0.0f);
  for (const At& a : at) middle += a.position_m / float(at.size()), normal += a.normal;
  receivers.center = middle;
  receivers.cos_spread = -1;
  if (normal.length2() > 0) {
    receivers.normal = normal.normalized(), receivers.cos_spread = 1;
    for (const At& a : at) receivers.cos_spread = std::min(receivers.cos_spread, receivers.normal.dot(a.normal));
  }
  for (const At& a : at) receivers.radius = std::max(receivers.radius, (a.position_m - middle).length());
  return receivers;
}

TexelLightResult TexelLight::of(const atlas::Slot& slot) {
  result_ = {};
  const Sampler sampler(kSeed, slot.texel);
  at_.clear();
  for (uint32_t i = 0; i < pointsOf(evaluation_); ++i) {
    const atlas::SurfacePoint p = atlas::sampleSlot(evaluation_.scene.scene.mesh, evaluation_.scene.atlas, slot, sampler.get1D(i, kPiece), sampler.get2D(i, kPlace));
    at_.push_back(placed(p.position, p.normal, p.geometric_normal));
  }
  cut_.begin(around(at_));
  // How bright it is here, shadows and all, says how much a node may be wrong by.
  cut_.refine(0, kCoarseNodes);
  std::vector<uint32_t> nodes(cut_.nodes().begin(), cut_.nodes().end());
  Vec3d sum(0.0);
  if (evaluation_.cut_error > 0) {
    sum = sumOfCut(set_.tree, nodes, at_, sampler, kCoarse);
    const double coarse = double(luminance(Rgb(sum)));
    cut_.refine(double(kPi) * evaluation_.cut_error * (coarse + kFloor * set_.mean_irradiance), kMostNodes);
  } else {
    cut_.refine(0, set_.lights.size());
  }
  if (cut_.nodes().size() != nodes.size() || !(evaluation_.cut_error > 0)) {
    nodes.assign(cut_.nodes().begin(), cut_.nodes().end());
    result_.removed = 0;
    sum = sumOfCut(set_.tree, nodes, at_, sampler, kFine);
  }
  if (!set_.albedo_rgb.empty()) {
    const Vec3d back_rgb = restored(at_, sampler);
    result_.restored = double(luminance(Rgb(back_rgb)));
    sum += back_rgb;
  }
  result_.irradiance_rgb = Rgb(sum);
  return result_;
}

Vec3d TexelLight::irradiance(uint32_t light, const At& at, double& removed) const {
  float rgb[3];
  const lw_virtual_light& l = set_.lights[light];
  evaluation_.container.check(lw_virtual_light_irradiance(&l, &at.position_m.x, &at.normal.x, 0.0f, rgb));
  const Vec3d irradiance_rgb(rgb[0], rgb[1], rgb[2]);
  removed = 0;
  if (l.type != LW_VIRTUAL_POINT || !(set_.most_share > 0)) return irradiance_rgb;
  const double given = double(luminance({rgb[0], rgb[1], rgb[2]})), flux = double(luminance({l.flux_rgb[0], l.flux_rgb[1], l.flux_rgb[2]}));
  const double most = flux * double(set_.most_share);
  if (!(given > most)) return irradiance_rgb;
  removed = given - most;
  return irradiance_rgb * (most / given);
}

bool TexelLight::segmentTo(uint32_t light, const At& at, const Vec2& uv, uint32_t key, trace::Ray& ray, float& weight) const {
  const lw_virtual_light& l = set_.lights[light];
  const Vec3 light_normal(l.normal[0], l.normal[1], l.normal[2]);
  Vec3 target_m;
  evaluation_.container.check(lw_virtual_light_point(&l, &uv.x, &target_m.x));
  const Vec3 target = target_m / metres_, offset = target - at.position;
  const float distance2 = offset.length2();
  weight = 0;
  if (!(distance2 > 0)) return false;
  const Vec3 direction = offset / std::sqrt(distance2);
  // A sphere's points count by distance alone: its light comes from all around it.
  const float sent = l.type == LW_VIRTUAL_SPHERE ? 1.0f : std::max(-direction.dot(light_normal), 0.0f);
  weight = std::max(direction.dot(at.normal), 0.0f) * sent / distance2;
  if (!(weight > 0) || !(direction.dot(at.geometric_normal) > 0)) return false;
  const Vec3 origin = trace::Tracer::offsetOrigin(at.position, at.geometric_normal, direction);
  const Vec3 from_light = trace::Tracer::offsetOrigin(target, light_normal, -direction);
  ray = {.origin = origin, .direction = from_light - origin, .t_max = 1.0f - 1e-4f, .key = key};
  return true;
}

Vec3d TexelLight::sumOfCut(const transport::LightTree& tree, std::span<const uint32_t> nodes, std::span<const At> at, const Sampler& sampler, uint32_t stream) {
  Vec3d sum(0.0);
  shadowed_.clear();
  result_.lights += nodes.size() * at.size();
  for (const uint32_t node : nodes) {
    const uint32_t dimension = stream + 2 * node;
    if (tree.firstChild(node) == kNone && at.size() > 1) {
      sum += ofSingle(tree.pickIn(node, at[0].position_m, at[0].normal, 0).item, at, sampler);
      continue;
    }
    for (uint32_t i = 0; i < at.size(); ++i) {
      const auto pick = tree.pickIn(node, at[i].position_m, at[i].normal, sampler.get1D(i, dimension));
      if (pick.item == kNone || !(pick.probability > 0)) continue;
      Shadowed shadowed;
      shadowed.irradiance_rgb = irradiance(pick.item, at[i], shadowed.removed) / double(pick.probability);
      shadowed.removed /= double(pick.probability);
      if (!(shadowed.irradiance_rgb.x + shadowed.irradiance_rgb.y + shadowed.irradiance_rgb.z > 0)) continue;
      float weight;
      if (segmentTo(pick.item, at[i], sampler.get2D(i, dimension + 1), mixBits(combineKeys(dimension, i)), shadowed.ray, weight)) shadowed_.push_back(shadowed);
    }
  }
  rays_.clear();
  for (const Shadowed& s : shadowed_) rays_.push_back(s.ray);
  visibility_.resize(rays_.size());
  evaluation_.tracer.transmittance(rays_, visibility_);
  result_.rays += rays_.size();
  for (size_t i = 0; i < shadowed_.size(); ++i) {
    sum += shadowed_[i].irradiance_rgb * (double(visibility_[i]) / double(at.size()));
    result_.removed += shadowed_[i].removed * double(visibility_[i]) / double(at.size());
  }
  return sum;
}

/// Exact irradiance times visible share, the latter as a ratio of two sums over the same rays (Heitz et al., "Combining Analytic Direct
/// Illumination and Stochastic Shadows", I3D 2018).
Vec3d TexelLight::ofSingle(uint32_t light, std::span<const At> at, const Sampler& sampler) {
  rays_.clear(), weight_.clear();
  Vec3d exact(0.0);
  double expected = 0, removed = 0;
  for (uint32_t i = 0; i < at.size(); ++i) {
    double some_removed;
    const Vec3d irradiance_rgb = irradiance(light, at[i], some_removed);
    if (!(irradiance_rgb.x + irradiance_rgb.y + irradiance_rgb.z > 0)) continue;
    exact += irradiance_rgb, removed += some_removed;
    trace::Ray ray;
    float weight;
    const bool reaches = segmentTo(light, at[i], sampler.get2D(i, kCoarse + light), mixBits(combineKeys(light, i)), ray, weight);
    expected += double(weight);
    if (reaches) rays_.push_back(ray), weight_.push_back(weight);
  }
  if (!(expected > 0)) return Vec3d(0.0);
  visibility_.resize(rays_.size());
  evaluation_.tracer.transmittance(rays_, visibility_);
  result_.rays += rays_.size();
  double seen = 0;
  for (size_t i = 0; i < rays_.size(); ++i) seen += double(weight_[i]) * double(visibility_[i]);
  result_.removed += removed * (seen / expected / double(at.size()));
  return exact * (seen / expected / double(at.size()));
}

Vec3d TexelLight::restored(std::span<const At> at, const Sampler& sampler) {
  // A point that reflects gives at most 1 / (pi d²) of its flux: farther away nothing was clamped.
  const float farthest = 1 / (metres_ * std::sqrt(kPi * set_.most_share));
  std::vector<trace::Ray> rays;
  std::vector<const At*> origins;
  for (uint32_t i = 0; i < at.size() * kRestoringRays; ++i) {
    const At& from = at[i / kRestoringRays];
    Vec3 tangent, bitangent;
    orthonormalBasis(from.normal, tangent, bitangent);
    const Vec3 local = sampleCosineHemisphere(sampler.get2D(i, kRestore)), direction = tangent * local.x + bitangent * local.y + from.normal * local.z;
    if (!(direction.dot(from.geometric_normal) > 0)) continue;
    rays.push_back({.origin = trace::Tracer::offsetOrigin(from.position, from.geometric_normal, direction), .direction = direction, .t_max = farthest,
                    .key = mixBits(combineKeys(kRestore, i))});
    origins.push_back(&from);
  }
  std::vector<trace::Hit> hits(rays.size());
  evaluation_.tracer.closest(rays, hits);
  result_.rays += rays.size();
  Vec3d sum(0.0);
  for (size_t i = 0; i < hits.size(); ++i) {
    const trace::Hit& hit = hits[i];
    if (hit.triangle == kNone) continue;
    const scene::Mesh& mesh = evaluation_.scene.scene.mesh;
    if (!hit.front && !evaluation_.scene.scene.materials[mesh.triangle_material[hit.triangle]].double_sided) continue;
    const float received = rays[i].direction.dot(origins[i]->normal), sent = -rays[i].direction.dot(hit.geometric_normal), distance_m = hit.t * metres_;
    const float share = received * sent / std::max(kPi * distance_m * distance_m, 1e-30f);
    if (!(share > set_.most_share)) continue;
    sum += reflected(rays[i], hit) * double(kPi * (1 - set_.most_share / share));
  }
  return sum / double(at.size() * kRestoringRays);
}

Vec3d TexelLight::reflected(const trace::Ray& ray, const trace::Hit& hit) {
  const scene::Mesh& mesh = evaluation_.scene.scene.mesh;
  const uint32_t slot = evaluation_.scene.atlas.slotAt(mesh, hit.triangle, hit.u, hit.v);
  const Vec3d radiance_rgb(set_.emission_rgb[slot]);
  if (!(maxComponent(set_.albedo_rgb[slot]) > 0)) return radiance_rgb;
  const atlas::SurfacePoint p = atlas::surfacePoint(mesh, hit.triangle, hit.u, hit.v);
  const At at = placed(p.position, hit.front ? p.normal : -p.normal, hit.geometric_normal);
  const Sampler sampler(kSeed, combineKeys(ray.key, hit.triangle));
  // Light of lamps, and of the lights themselves, which are not looked at up close twice.
  Vec3d irradiance_rgb(0.0);
  lamp_samples_.clear();
  set_.lamps.sample(at.position, at.normal, true, sampler.get1D(0, kLamps), lamp_samples_);
  for (const auto& lamp : lamp_samples_) {
    if (!(lamp.to_light.dot(at.geometric_normal) > 0)) continue;
    const trace::Ray shadow{.origin = trace::Tracer::offsetOrigin(at.position, at.geometric_normal, lamp.to_light), .direction = lamp.to_light, .t_max = lamp.distance,
                            .key = ray.key};
    float visibility = 0;
    evaluation_.tracer.transmittance(std::span(&shadow, 1), std::span(&visibility, 1));
    ++result_.rays;
    irradiance_rgb += Vec3d(lamp.irradiance_rgb) * double(visibility);
  }
  const double removed = result_.removed;
  second_cut_.begin(around(std::span(&at, 1)));
  second_cut_.refine(0, kSecondNodes);
  irradiance_rgb += sumOfCut(set_.whole_tree, second_cut_.nodes(), std::span(&at, 1), sampler, kSecond);
  result_.removed = removed;
  return radiance_rgb + irradiance_rgb * Vec3d(set_.albedo_rgb[slot]) / double(kPi);
}

}  // namespace lightwell::cli
