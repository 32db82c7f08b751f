#include "tests/runtime/synthetic_radiosity.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "format/decode/pixel.h"

namespace lightwell::test {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

Point sum(const Point& a, const Point& b, double s = 1) { return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

double weightOf(uint8_t code) { return double((16u + (code & 15u)) << (code >> 4)); }

uint8_t nearestCode(double weight) {
  uint8_t best = 0;
  for (int code = 1; code < 256; ++code)
    if (std::abs(weightOf(uint8_t(code)) - weight) < std::abs(weightOf(best) - weight)) best = uint8_t(code);
  return best;
}

struct Patch {
  Point position, normal;
  double area;
  uint32_t wall;
};

}  // namespace

std::vector<Wall> boxWalls(Point low, Point high, uint32_t cells, double albedo, double emission) {
  const Point x{high[0] - low[0], 0, 0}, y{0, high[1] - low[1], 0}, z{0, 0, high[2] - low[2]};
  std::vector<Wall> walls;
  const auto add = [&](const Point& corner, const Point& a, const Point& b) { walls.push_back({corner, a, b, cells, albedo, emission, 0}); };
  add(low, y, z), add(sum(low, x), z, y);
  add(low, z, x), add(sum(low, y), x, z);
  add(low, x, y), add(sum(low, z), y, x);
  return walls;
}

SyntheticRadiosity makeRoom(const RoomOptions& options) {
  SyntheticRadiosity room;
  format::RadiosityContent& c = room.content;
  c.base = format::panesContent();
  c.base.left_out = {"prm", "geometry/alpha_uv", "geometry/triangle_alpha", "geometry/alpha_material", "geometry/alpha_texture_0", "atlas/emission"};
  c.base.meta.clear_errors();
  for (auto* v : {&c.base.position, &c.base.lightmap_uv}) v->clear();
  c.base.normal.clear(), c.base.index.clear(), c.base.triangle_flags.clear();

  // Walls side by side in the atlas, a texel apart.
  uint32_t width = 0, height = 0;
  for (const Wall& wall : options.walls) width += wall.cells + 1, height = std::max(height, wall.cells);
  std::vector<Patch> patches;
  bool emits = false;
  c.base.atlas.set_width(width), c.base.atlas_width = width, c.base.atlas.set_height(height);
  c.base.source.assign(size_t(width) * height, kNone);
  c.base.coverage.assign(size_t(width) * height, 0);
  c.base.albedo.assign(size_t(width) * height * 3, 0);
  std::vector<std::pair<uint32_t, uint32_t>> texels;  // texel, patch
  uint32_t left = 0;
  for (uint32_t w = 0; w < options.walls.size(); ++w) {
    const Wall& wall = options.walls[w];
    const Point across = cross(wall.a, wall.b);
    const double area = std::sqrt(dot(across, across));
    const Point normal{across[0] / area, across[1] / area, across[2] / area};
    const format::Oct16 oct = format::packOct({float(normal[0]), float(normal[1]), float(normal[2])});
    const auto first_vertex = uint32_t(c.base.position.size() / 3);
    for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      for (const double p : sum(sum(wall.corner, wall.a, u), wall.b, v)) c.base.position.push_back(float(p));
      c.base.normal.insert(c.base.normal.end(), {oct.x, oct.y});
      c.base.lightmap_uv.insert(c.base.lightmap_uv.end(), {float(left + uint32_t(u) * wall.cells) / float(width), float(uint32_t(v) * wall.cells) / float(height)});
    }
    for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) c.base.index.push_back(first_vertex + k);
    c.base.triangle_flags.insert(c.base.triangle_flags.end(), {0, 0});
    for (uint32_t j = 0; j < wall.cells; ++j)
      for (uint32_t i = 0; i < wall.cells; ++i) {
        const double n = wall.cells;
        patches.push_back({sum(sum(wall.corner, wall.a, (i + 0.5) / n), wall.b, (j + 0.5) / n), normal, area / (n * n), w});
        texels.emplace_back(j * width + left + i, uint32_t(patches.size() - 1));
        const Patch& patch = patches.back();
        c.patch_area.push_back(float(patch.area));
        for (const double p : patch.position) c.patch_position.push_back(float(p));
        c.patch_normal.insert(c.patch_normal.end(), {oct.x, oct.y});
        c.patch_material.push_back(wall.material);
        c.patch_albedo.insert(c.patch_albedo.end(), 3, float(wall.albedo));
        c.patch_emission.push_back(format::packRgb9e5({float(wall.emission), float(wall.emission), float(wall.emission)}));
        emits |= wall.emission > 0;
        room.wall_of_patch.push_back(w);
      }
    left += wall.cells + 1;
  }
  std::sort(texels.begin(), texels.end());
  for (const auto& [texel, patch] : texels) {
    c.base.source[texel] = texel;
    c.base.coverage[texel] = 1;
    c.texel.push_back(texel);
    c.texel_patch.insert(c.texel_patch.end(), {patch, kNone, kNone, kNone});
    c.texel_weight.insert(c.texel_weight.end(), {255, 0, 0, 0});
    c.texel_exposed.push_back(255);
  }
  c.base.atlas.set_covered_texels(uint32_t(texels.size()));
  c.header.set_patches(uint32_t(patches.size()));
  c.header.set_texels(uint32_t(texels.size()));
  c.header.set_has_emission(emits);
  if (!emits) c.patch_emission.clear();
  for (uint32_t m = 0; m < options.materials; ++m) c.header.add_materials()->set_name("material " + std::to_string(m));
  if (options.strips) {
    v1::RadiosityPortal& door = *c.header.add_portals();
    door.set_name("door");
    door.set_strips(options.strips);
    if (options.leaf_wall) {
      const Wall& leaf = options.walls[options.leaf_wall];
      const double length2 = dot(leaf.a, leaf.a);
      door.set_first_triangle(options.leaf_wall * 2);
      door.set_triangles(2);
      for (const double a : leaf.a) door.add_axis(float(a / length2));
      door.set_offset(float(-dot(leaf.corner, leaf.a) / length2));
    }
    c.gate_set_first = {0};
    for (const auto& set : options.gate_sets) {
      c.gate_set.insert(c.gate_set.end(), set.begin(), set.end());
      c.gate_set_first.push_back(uint32_t(c.gate_set.size()));
    }
  }

  c.link_first = {0};
  for (const Patch& to : patches) {
    std::map<std::pair<uint16_t, uint32_t>, double> row;  // gate set, node
    double most = 0;
    for (uint32_t j = 0; j < patches.size(); ++j) {
      const Patch& from = patches[j];
      const Point way = sum(from.position, to.position, -1);
      const double r2 = dot(way, way), cosines = dot(way, to.normal) * -dot(way, from.normal);
      if (cosines <= 0 || dot(way, to.normal) <= 0) continue;
      const double factor = cosines / (std::numbers::pi * r2 * r2) * from.area * (options.visible ? options.visible(to.wall, from.wall) : 1.0);
      if (factor <= 0) continue;
      const uint16_t set = options.gate_set ? options.gate_set(to.wall, from.wall) : uint16_t(0);
      const uint32_t group = j / 8, node = uint32_t(patches.size()) + group;
      const bool whole = options.merge && patches.size() > 8 && patches[group * 8].wall == from.wall &&
                         patches[std::min<size_t>(group * 8 + 7, patches.size() - 1)].wall == from.wall;
      most = std::max(most, row[{set, whole ? node : j}] += factor);
    }
    double total = 0;
    std::vector<uint8_t> codes;
    for (const auto& [key, factor] : row) total += weightOf(codes.emplace_back(nearestCode(factor / most * 1e6)));
    const float scale = total > 0 ? float(1 / total) : 0.0f;
    auto& links = room.row.emplace_back();
    size_t l = 0;
    for (const auto& [key, factor] : row) {
      links.push_back({key.second, key.first, weightOf(codes[l]) * double(scale)});
      c.link_node.push_back(key.second);
      c.link_code.push_back(codes[l++]);
      if (options.strips) c.link_gates.push_back(key.first);
    }
    c.row_scale.push_back(scale);
    c.link_first.push_back(uint32_t(c.link_node.size()));
  }
  return room;
}

std::vector<double> SyntheticRadiosity::solve(const std::vector<double>& albedo, const std::vector<double>& direct, const std::vector<double>& emission,
                                              const std::vector<double>& set_factor) const {
  const size_t n = patches();
  // (1 − F ρ) E = F (ρ direct + π emission), the right side in the last column.
  std::vector<std::vector<double>> m(n, std::vector<double>(n + 1));
  for (size_t i = 0; i < n; ++i) {
    m[i][i] = 1;
    for (const Link& link : row[i]) {
      const double weight = link.weight * (set_factor.empty() ? 1.0 : set_factor[link.gate_set]);
      size_t begin = link.node, end = begin + 1;
      if (begin >= n) begin = (begin - n) * 8, end = std::min(begin + 8, n);
      double area = 0;
      for (size_t j = begin; j < end; ++j) area += double(content.patch_area[j]);
      for (size_t j = begin; j < end; ++j) {
        const double f = weight * double(content.patch_area[j]) / area;
        m[i][j] -= f * albedo[j];
        m[i][n] += f * (albedo[j] * direct[j] + std::numbers::pi * emission[j]);
      }
    }
  }
  for (size_t k = 0; k < n; ++k) {  // diagonally dominant: no pivoting
    for (size_t i = k + 1; i < n; ++i) {
      const double f = m[i][k] / m[k][k];
      for (size_t j = k; f != 0 && j <= n; ++j) m[i][j] -= f * m[k][j];
    }
  }
  std::vector<double> result(n);
  for (size_t k = n; k-- > 0;) {
    double value = m[k][n];
    for (size_t j = k + 1; j < n; ++j) value -= m[k][j] * result[j];
    result[k] = value / m[k][k];
  }
  return result;
}

}  // namespace lightwell::test
