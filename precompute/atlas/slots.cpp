#include "precompute/atlas/slots.h"

#include <algorithm>

#include "precompute/core/parallel.h"
#include "precompute/core/random.h"

namespace lightwell::atlas {
namespace {

constexpr uint32_t kMostSamples = 64;      // of textures, per slot
constexpr float kMostAlbedo = 0.999f;
constexpr uint64_t kSeed = 0xa77a5;        // the atlas does not depend on the seed of a bake

Vec2 lerp(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& barycentric) {
  return a * (1 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y;
}

/// How many texels of `texture` the patch covers, or half its longest extent if that is more.
float footprint(const scene::Texture& texture, const std::vector<Vec2>& uv, const scene::Mesh& mesh, const Patch& patch) {
  if (uv.empty()) return 0;
  const auto& [a, b, c] = mesh.triangles[patch.triangle];
  Vec2 p[3];
  for (int k = 0; k < 3; ++k) p[k] = lerp(uv[a], uv[b], uv[c], patch.corner[k]) * Vec2(float(texture.width), float(texture.height));
  const Vec2 side = p[1] - p[0], other = p[2] - p[0];
  const float area = 0.5f * std::abs(side.cross(other));
  const float length = std::max({side.length(), other.length(), (p[2] - p[1]).length()});
  return std::max(area, 0.5f * length);
}

uint32_t sampleCount(const scene::Scene& scene, const Patch& patch, uint32_t most) {
  const scene::Material& material = scene.materials[scene.mesh.triangle_material[patch.triangle]];
  float texels = 0;
  if (material.base_color_texture != kNone)
    texels = std::max(texels, footprint(scene.textures[material.base_color_texture], scene.mesh.base_uv, scene.mesh, patch));
  if (material.emissive_texture != kNone)
    texels = std::max(texels, footprint(scene.textures[material.emissive_texture], scene.mesh.emissive_uv, scene.mesh, patch));
  if (texels <= 0) return 1;  // colour is at most linear over the patch: its centroid says all
  return std::min(most, uint32_t(std::ceil(std::min(texels, 1e6f))) + 1);
}

class ColorMean {
 public:
  void add(const scene::SurfaceColor& color, double weight) {
    const double present = weight * color.alpha;
    albedo_ += Vec3d(color.albedo_rgb) * present;
    emitted_ += Vec3d(color.emitted_radiance_rgb) * present;
    present_ += present;
    albedo_anyway_ += Vec3d(color.albedo_rgb) * weight;
    emitted_anyway_ += Vec3d(color.emitted_radiance_rgb) * weight;
    weight_ += weight;
  }
  Rgb albedo() const { return mean(albedo_, albedo_anyway_); }
  Rgb emitted() const { return mean(emitted_, emitted_anyway_); }

 private:
  Rgb mean(const Vec3d& over_present, const Vec3d& over_all) const {
    if (present_ > 0) return Rgb(over_present / present_);
    return weight_ > 0 ? Rgb(over_all / weight_) : Rgb(0, 0, 0);
  }
  Vec3d albedo_{0, 0, 0}, emitted_{0, 0, 0}, albedo_anyway_{0, 0, 0}, emitted_anyway_{0, 0, 0};
  double present_ = 0, weight_ = 0;
};

void fillSlot(const scene::Scene& scene, const Atlas& atlas, Slot& slot) {
  const scene::Mesh& mesh = scene.mesh;
  const Sampler sampler(kSeed, slot.texel);
  const uint32_t most = std::max(1u, kMostSamples / slot.patch_count);
  Vec3d position(0, 0, 0), normal(0, 0, 0), largest_normal(0, 0, 1);
  double area = 0, largest = -1;
  ColorMean color;
  slot.double_sided = false;
  for (uint32_t i = 0; i < slot.patch_count; ++i) {
    const Patch& patch = atlas.patches[slot.first_patch + i];
    const Vec2 center = (patch.corner[0] + patch.corner[1] + patch.corner[2]) / 3.0f;
    const SurfacePoint point = surfacePoint(mesh, patch.triangle, center.x, center.y);
    const double patch_area = patch.area;
    position += Vec3d(point.position) * patch_area;
    normal += Vec3d(point.normal) * patch_area;
    area += patch_area;
    if (patch_area > largest) largest = patch_area, largest_normal = Vec3d(point.normal);
    slot.double_sided |= scene.materials[mesh.triangle_material[patch.triangle]].double_sided;

    const uint32_t samples = sampleCount(scene, patch, most);
    if (samples == 1) {
      color.add(scene::surfaceColor(scene, patch.triangle, center.x, center.y), patch_area);
      continue;
    }
    for (uint32_t s = 0; s < samples; ++s) {
      const Vec2 at = lerp(patch.corner[0], patch.corner[1], patch.corner[2], sampleTriangle(sampler.get2D(s, i)));
      color.add(scene::surfaceColor(scene, patch.triangle, at.x, at.y), patch_area / samples);
    }
  }
  slot.position = Vec3(position / area);
  // Normals that cancel out (a texel folded over) leave no mean; the largest patch then speaks for the texel.
  const double length = normal.length();
  slot.normal = Vec3(length > 1e-3 * area ? normal / length : largest_normal);
  slot.albedo_rgb = color.albedo();
  for (int c = 0; c < 3; ++c) slot.albedo_rgb[c] = std::clamp(slot.albedo_rgb[c], 0.0f, kMostAlbedo);
  slot.emitted_radiance_rgb = color.emitted();
}

}  // namespace

void fillSlots(const scene::Scene& scene, Atlas& atlas, int threads) {
  parallelFor(atlas.slots.size(), 256, threads, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) fillSlot(scene, atlas, atlas.slots[i]);
  });
}

}  // namespace lightwell::atlas
