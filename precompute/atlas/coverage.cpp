#include "precompute/atlas/coverage.h"

namespace lightwell::atlas {
namespace {

struct TexelPatch {
  uint32_t texel;
  Patch patch;
};

std::vector<TexelPatch> clipTriangles(const scene::Mesh& mesh, const Atlas& atlas) {
  std::vector<TexelPatch> result;
  result.reserve(mesh.triangles.size() * 2);
  const CellRange range{0, atlas.width, 0, atlas.height};
  for (uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    ClipVertex corner[3];
    cornersInTexels(mesh, atlas.uv, triangle, atlas.width, atlas.height, corner);
    const double area = triangleArea(mesh, triangle);
    clipToCells(corner, range, [&](long x, long y, const ClipPolygon& piece) {
      if (format::isNegligible(piece)) return;
      const uint32_t texel = uint32_t(y) * uint32_t(atlas.width) + uint32_t(x);
      for (int i = 2; i < piece.count; ++i) {
        const float patch_area = float(area * piece.fanShare(i));
        if (!(patch_area > 0)) continue;
        Patch patch{triangle, {}, patch_area};
        const int fan[3] = {0, i - 1, i};
        for (int k = 0; k < 3; ++k) patch.corner[k] = Vec2(float(piece.vertex[fan[k]].u), float(piece.vertex[fan[k]].v));
        result.push_back({texel, patch});
      }
    });
  }
  return result;
}

}  // namespace

void cornersInTexels(const scene::Mesh& mesh, const std::vector<Vec2>& uv, uint32_t triangle, int width, int height,
                     ClipVertex (&corner)[3]) {
  static constexpr double kBarycentric[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  for (int k = 0; k < 3; ++k) {
    const Vec2& p = uv[mesh.triangles[triangle][k]];
    corner[k] = {format::toTexels(p.x, width), format::toTexels(p.y, height), kBarycentric[k][0], kBarycentric[k][1]};
  }
}

double triangleArea(const scene::Mesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3d origin(mesh.positions[a]);
  const double area = 0.5 * (Vec3d(mesh.positions[b]) - origin).cross(Vec3d(mesh.positions[c]) - origin).length();
  return std::max(area, 1e-30);
}

void buildCoverage(const scene::Mesh& mesh, Atlas& atlas) {
  const std::vector<TexelPatch> pieces = clipTriangles(mesh, atlas);
  const size_t texels = size_t(atlas.width) * atlas.height;

  // Counting sort by texel; stable, so that a texel lists its patches by ascending triangle.
  std::vector<uint32_t> end(texels, 0);
  for (const TexelPatch& piece : pieces) ++end[piece.texel];
  atlas.slots.clear();
  atlas.texel_slot.assign(texels, kNone);
  uint32_t first = 0;
  for (size_t texel = 0; texel < texels; ++texel) {
    const uint32_t count = end[texel];
    end[texel] = first;
    if (count == 0) continue;
    atlas.texel_slot[texel] = uint32_t(atlas.slots.size());
    Slot slot;
    slot.texel = uint32_t(texel);
    slot.first_patch = first;
    slot.patch_count = count;
    atlas.slots.push_back(slot);
    first += count;
  }
  atlas.patches.resize(pieces.size());
  atlas.triangle_slot.assign(mesh.triangles.size(), kNone);
  std::vector<float> largest(mesh.triangles.size(), 0.0f);
  for (const TexelPatch& piece : pieces) {
    atlas.patches[end[piece.texel]++] = piece.patch;
    float& most = largest[piece.patch.triangle];
    if (piece.patch.area > most) {
      most = piece.patch.area;
      atlas.triangle_slot[piece.patch.triangle] = atlas.texel_slot[piece.texel];
    }
  }

  atlas.patch_cumulative_area.resize(pieces.size());
  for (Slot& slot : atlas.slots) {
    double area = 0;
    for (uint32_t i = 0; i < slot.patch_count; ++i) {
      area += atlas.patches[slot.first_patch + i].area;
      atlas.patch_cumulative_area[slot.first_patch + i] = float(area);
    }
    slot.area = float(area);
  }
}

}  // namespace lightwell::atlas
