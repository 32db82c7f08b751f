// The texel atlas: which surface lies under which texel, exactly.
//
// Every texel that any triangle touches in UV space is covered. Its surface is the list of clipped triangle pieces (patches);
// position, normal and colour are area-weighted means over them (experience: centre sampling costs 3 to 8 % bias on game levels).
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/atlas/grow.h"
#include "precompute/core/diagnostics.h"
#include "precompute/scene/scene.h"

namespace lightwell::atlas {

/// One convex piece of a triangle inside one texel, cut into triangles: corners as barycentrics (u, v) of the scene triangle.
struct Patch {
  uint32_t triangle;
  Vec2 corner[3];  // (u, v) as scene::surfaceColor takes them
  float area;      // internal units², > 0
};

/// The surface under one covered texel. Slots are ordered by texel index (y * width + x).
struct Slot {
  uint32_t texel = 0;
  uint32_t first_patch = 0, patch_count = 0;  // patch_count ≥ 1
  uint32_t chart = 0;            // connected region of the atlas that may be interpolated across
  Vec3 position{0, 0, 0};        // area-weighted centroid of the patches, internal units
  Vec3 normal{0, 0, 0};          // unit, area-weighted mean of shading normals
  float area = 0;                // internal units²
  Rgb albedo_rgb{0, 0, 0};       // area-weighted, ≤ 0.999
  Rgb emitted_radiance_rgb{0, 0, 0};
  bool double_sided = false;     // any patch of it
};

struct Atlas {
  int width = 0, height = 0;
  std::vector<Vec2> uv;             // one per vertex of Scene::mesh (after buildAtlas, which may split vertices), in [0, 1]
  std::vector<Slot> slots;
  std::vector<Patch> patches;
  std::vector<uint32_t> triangle_slot;  // per triangle: the slot that holds its largest patch
  /// Per patch: area of its slot's patches up to and with this one. May be empty: sampleSlot then adds the areas up itself, each time.
  std::vector<float> patch_cumulative_area;
  std::vector<uint32_t> texel_slot;  // width * height; kNone where uncovered
  /// width * height: the texel whose value a texel shows. Itself for valid covered texels; a valid neighbour of the same chart for
  /// buried ones; the nearest covered texel for gutters; kNone far from everything.
  std::vector<uint32_t> source;
  uint32_t chart_count = 0;
  bool unwrapped = false;  // true when (some) UVs were generated, and the reason was reported

  /// The slot under the point (u, v) of a triangle: that of its light-map texel; at a texel's border, where rounding might lead onto
  /// another chart or off the surface, that of the nearest texel that holds the triangle. Never kNone for a triangle of the scene.
  uint32_t slotAt(const scene::Mesh& mesh, uint32_t triangle, float u, float v) const;
};

struct AtlasOptions {
  int size = 256;           // width = height
  int padding_texels = 2;   // at least so many free texels between generated charts, and between them and charts of the scene
  float chart_normal_deviation = 0.7f;  // radians between triangles of a generated chart and its plane, in [0, 1.4]; leftovers 1.5 times
  ChartSource charts;       // empty: grown here, on the threads of the call
};

/// Uses TEXCOORD_1 where it is sound, exactly as given, else unwraps (reported); vertices of `scene.mesh` may be duplicated along chart
/// seams. Where only some objects need an unwrap, their charts go into the free space of the atlas; where that is too small, everything
/// is unwrapped anew. `threads`: 0 for all of the machine; the result does not depend on it.
/// Throws InputError when the charts cannot fit, with the smallest size that would do; UsageError for a size outside [1, 8192].
Atlas buildAtlas(scene::Scene& scene, const AtlasOptions& options, Diagnostics& diagnostics, int threads = 0);

struct SurfacePoint {
  uint32_t triangle;
  float u, v;        // barycentrics
  Vec3 position;     // internal units
  Vec3 normal;       // unit interpolated shading normal
  Vec3 geometric_normal;  // unit, front side
};
/// A point of the slot's surface, uniform in area for uniform `pick` in [0, 1) and `u` in [0, 1)²: `pick` chooses the patch, `u`
/// the place in it.
SurfacePoint sampleSlot(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot, float pick, const Vec2& u);
/// Which slots stand for their texel, one flag each: those whose centre or half of them is covered, and where none of the texels around is one of the same
/// chart (slivers, specks), every slot. The others are rims that a neighbour stands for: in a mean over texels they would count too much.
std::vector<char> standingSlots(const scene::Mesh& mesh, const Atlas& atlas);
/// The point at barycentrics (1 − u − v, u, v) of a triangle.
SurfacePoint surfacePoint(const scene::Mesh& mesh, uint32_t triangle, float u, float v);

}  // namespace lightwell::atlas
