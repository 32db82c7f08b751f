// The texel atlas: which surface lies under which texel, exactly.
//
// Every texel that any triangle touches in UV space is covered. Its surface is the list of clipped triangle pieces (patches);
// position, normal and colour are area-weighted means over them (experience: centre sampling costs 3 to 8 % bias on game levels).
#pragma once
#include <cstdint>
#include <vector>

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
  uint32_t texel;
  uint32_t first_patch, patch_count;  // patch_count ≥ 1
  uint32_t chart;       // connected region of the atlas that may be interpolated across
  Vec3 position;        // area-weighted centroid of the patches, internal units
  Vec3 normal;          // unit, area-weighted mean of shading normals
  float area;           // internal units²
  Rgb albedo_rgb;       // area-weighted, ≤ 0.999
  Rgb emitted_radiance_rgb;
  bool double_sided;    // any patch of it
};

struct Atlas {
  int width = 0, height = 0;
  std::vector<Vec2> uv;             // one per vertex of Scene::mesh (after buildAtlas, which may split vertices), in [0, 1]
  std::vector<Slot> slots;
  std::vector<Patch> patches;
  std::vector<uint32_t> texel_slot;  // width * height; kNone where uncovered
  /// width * height: the texel whose value a texel shows. Itself for valid covered texels; a valid neighbour of the same chart for
  /// buried ones; the nearest covered texel for gutters; kNone far from everything.
  std::vector<uint32_t> source;
  uint32_t chart_count = 0;
  bool unwrapped = false;  // true when (some) UVs were generated, and the reason was reported

  /// The slot under the point (u, v) of a triangle: that of its lightmap texel. Never kNone for a triangle of the scene.
  uint32_t slotAt(const scene::Mesh& mesh, uint32_t triangle, float u, float v) const;
};

struct AtlasOptions {
  int size = 256;           // width = height
  int padding_texels = 2;   // between generated charts
  float chart_normal_deviation = 0.7f;  // radians within one generated chart
};

/// Uses TEXCOORD_1 where it is sound, else unwraps (reported); vertices of `scene.mesh` may be duplicated along chart seams.
/// Throws InputError when the charts cannot fit.
Atlas buildAtlas(scene::Scene& scene, const AtlasOptions& options, Diagnostics& diagnostics);

/// A point of the slot's surface from u in [0, 1)³-like inputs: `pick` chooses the patch by area, `u` the place in it.
struct SurfacePoint {
  uint32_t triangle;
  float u, v;        // barycentrics
  Vec3 position;     // internal units
  Vec3 normal;       // unit interpolated shading normal
  Vec3 geometric_normal;  // unit, front side
};
SurfacePoint sampleSlot(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot, float pick, const Vec2& u);

/// Finds slots that see mostly back faces (buried or leaking) with a few rays each and rewrites `source` for them. Needs the tracer;
/// declared here, defined in validity.cpp.
}  // namespace lightwell::atlas
