// Any triangles: light-map coordinates are made for them, each inside the atlas, and every triangle finds its texel.
#include <cmath>

#include "precompute/atlas/atlas.h"
#include "tests/fuzz/feed.h"
#include "tests/fuzz/require.h"

namespace lightwell::fuzz {
namespace {

/// Coordinates on a coarse lattice make triangles that touch, overlap, or have no area; a few are any finite numbers.
float coordinate(Feed& feed, bool free) { return free ? float(feed.take<int16_t>()) / 2048 : float(feed.take<uint8_t>() % 8); }

scene::Scene soup(Feed& feed) {
  scene::Scene scene;
  scene.file = "soup.glb";
  scene.materials.resize(1);
  scene::Mesh& mesh = scene.mesh;
  const uint8_t flags = feed.take<uint8_t>();
  const bool has_uv = flags & 1, free = flags & 2, shared = flags & 4;
  const uint32_t objects = 1 + feed.upTo(2);
  for (uint32_t o = 0; o < objects; ++o) {
    scene::Object object;
    object.gltf_path = "nodes[" + std::to_string(o) + "]";
    object.first_triangle = uint32_t(mesh.triangles.size()), object.first_vertex = uint32_t(mesh.positions.size());
    object.has_lightmap_uv = has_uv && o == 0;
    const uint32_t vertices = 3 + feed.upTo(40), triangles = 1 + feed.upTo(60);
    for (uint32_t i = 0; i < vertices; ++i) {
      const float x = coordinate(feed, free), y = coordinate(feed, free), z = coordinate(feed, free);
      mesh.positions.emplace_back(x, y, z);
      mesh.normals.push_back(i % 3 == 0 ? Vec3(0, 0, 1) : i % 3 == 1 ? Vec3(0, 1, 0) : Vec3(-1, 0, 0));
      mesh.lightmap_uv.push_back(object.has_lightmap_uv ? Vec2(float(feed.take<uint8_t>()) / 255, float(feed.take<uint8_t>()) / 255) : Vec2(NAN, NAN));
      scene.bounds.extendBy(mesh.positions.back());
    }
    for (uint32_t i = 0; i < triangles; ++i) {
      const uint32_t first = object.first_vertex, a = shared ? i % vertices : feed.upTo(vertices - 1);
      mesh.triangles.push_back({first + a, first + feed.upTo(vertices - 1), first + feed.upTo(vertices - 1)});
      mesh.triangle_material.push_back(0);
      mesh.triangle_object.push_back(o);
    }
    object.triangle_count = triangles, object.vertex_count = vertices;
    scene.objects.push_back(object);
  }
  return scene;
}

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell;
  fuzz::Feed feed(data, size);
  atlas::AtlasOptions options;
  options.size = 1 << (4 + feed.upTo(3));
  options.padding_texels = int(feed.upTo(3));
  scene::Scene scene = fuzz::soup(feed);
  Diagnostics diagnostics;
  try {
    const atlas::Atlas atlas = atlas::buildAtlas(scene, options, diagnostics, 1);
    fuzz::require(atlas.uv.size() == scene.mesh.positions.size(), "coordinates for each vertex");
    for (const Vec2& uv : atlas.uv) fuzz::require(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1, "coordinates inside the atlas");
    for (const atlas::Slot& slot : atlas.slots)
      fuzz::require(slot.area > 0 && std::isfinite(slot.area) && std::abs(slot.normal.length2() - 1) < 1e-3f && slot.patch_count > 0, "texels with surface");
    for (uint32_t i = 0; i < scene.mesh.triangles.size() && !atlas.slots.empty(); ++i)
      fuzz::require(atlas.slotAt(scene.mesh, i, 0.25f, 0.25f) < atlas.slots.size(), "a texel for each triangle");
  } catch (const InputError& error) {
    fuzz::require(!error.reason.empty(), "a reason");
  }
  return 0;
}
