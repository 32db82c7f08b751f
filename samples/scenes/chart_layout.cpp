#include "samples/scenes/chart_layout.h"

#define STB_RECT_PACK_IMPLEMENTATION
#include <stb_rect_pack.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

namespace lightwell::samples {
namespace {

bool lessPosition(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Whether p lies on the open segment ab; `where` receives its parameter.
bool insideSegment(const Vec3& a, const Vec3& b, const Vec3& p, float& where) {
  const Vec3 ab = b - a, ap = p - a;
  where = ap.dot(ab) / ab.length2();
  return where > 1e-4f && where < 1 - 1e-4f && (ap - ab * where).length2() < 1e-8f;
}

void splitTriangles(Chart& chart, const std::vector<Vec3>& points) {
  std::vector<std::array<uint32_t, 3>> pending = std::move(chart.triangles);
  chart.triangles.clear();
  while (!pending.empty()) {
    const std::array<uint32_t, 3> t = pending.back();
    pending.pop_back();
    // The point nearest to the middle of an edge splits best.
    float best = 1;
    int best_edge = -1;
    float best_where = 0;
    Vec3 best_point;
    for (int edge = 0; edge < 3; ++edge) {
      const Vec3 &a = chart.positions[t[size_t(edge)]], &b = chart.positions[t[size_t((edge + 1) % 3)]];
      const float margin = 1e-3f;
      const float x_min = std::min(a.x, b.x) - margin, x_max = std::max(a.x, b.x) + margin;
      const auto first = std::lower_bound(points.begin(), points.end(), x_min, [](const Vec3& p, float x) { return p.x < x; });
      for (auto p = first; p != points.end() && p->x <= x_max; ++p) {
        float where;
        if (!insideSegment(a, b, *p, where) || std::abs(where - 0.5f) >= best) continue;
        best = std::abs(where - 0.5f);
        best_edge = edge;
        best_where = where;
        best_point = *p;
      }
    }
    if (best_edge < 0) {
      chart.triangles.push_back(t);
      continue;
    }
    const uint32_t a = t[size_t(best_edge)], b = t[size_t((best_edge + 1) % 3)], c = t[size_t((best_edge + 2) % 3)];
    const Vec3 normal = (chart.normals[a] * (1 - best_where) + chart.normals[b] * best_where).normalized();
    const Vec2 uv = chart.metric_uv[a] * (1 - best_where) + chart.metric_uv[b] * best_where;
    const uint32_t middle = chart.addVertex(best_point, normal, uv);
    pending.push_back({middle, b, c});
    pending.push_back({a, middle, c});
  }
}

void weld(Chart& chart) {
  const auto key = [&](uint32_t i) {
    const Vec3 &p = chart.positions[i], &n = chart.normals[i];
    const Vec2& uv = chart.metric_uv[i];
    return std::array<int64_t, 8>{std::lround(p.x * 4096), std::lround(p.y * 4096), std::lround(p.z * 4096), std::lround(n.x * 4096),
                                  std::lround(n.y * 4096), std::lround(n.z * 4096), std::lround(uv.x * 256), std::lround(uv.y * 256)};
  };
  std::map<std::array<int64_t, 8>, uint32_t> index_of;
  Chart welded;
  welded.material = chart.material;
  for (const auto& triangle : chart.triangles) {
    std::array<uint32_t, 3> mapped{};
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t i = triangle[corner];
      const auto [entry, added] = index_of.try_emplace(key(i), uint32_t(welded.positions.size()));
      if (added) welded.addVertex(chart.positions[i], chart.normals[i], chart.metric_uv[i]);
      mapped[corner] = entry->second;
    }
    welded.triangles.push_back(mapped);
  }
  chart = std::move(welded);
}

/// A chart's bounding rectangle, turned so that its longer side lies along u.
struct Extent {
  Vec2 min, size_m;
  bool turned;
  Vec2 local(const Vec2& uv) const { return turned ? Vec2(uv.y - min.y, min.x + size_m.y - uv.x) : uv - min; }
};

Extent extentOf(const Chart& chart) {
  Vec2 min = chart.metric_uv[0], max = min;
  for (const Vec2& uv : chart.metric_uv) {
    min = {std::min(min.x, uv.x), std::min(min.y, uv.y)};
    max = {std::max(max.x, uv.x), std::max(max.y, uv.y)};
  }
  const Vec2 size = max - min;
  return size.y > size.x ? Extent{min, {size.y, size.x}, true} : Extent{min, size, false};
}

/// Whole texels between the first and the last texel centre that a length spans.
int spanTexels(float length_m, float texels_per_metre) { return std::max(1, int(std::ceil(length_m * texels_per_metre - 1e-3f))); }

bool packAll(const std::vector<Extent>& extents, int size, int padding, float density, std::vector<stbrp_rect>& rects) {
  rects.resize(extents.size());
  for (size_t i = 0; i < extents.size(); ++i) {
    rects[i] = {};
    rects[i].id = int(i);
    rects[i].w = stbrp_coord(spanTexels(extents[i].size_m.x, density) + 1 + padding);
    rects[i].h = stbrp_coord(spanTexels(extents[i].size_m.y, density) + 1 + padding);
    if (rects[i].w > size + padding || rects[i].h > size + padding) return false;
  }
  stbrp_context context;
  std::vector<stbrp_node> nodes(size_t(size + padding));
  stbrp_init_target(&context, size + padding, size + padding, nodes.data(), int(nodes.size()));
  return stbrp_pack_rects(&context, rects.data(), int(rects.size())) == 1;
}

}  // namespace

void stitch(Node& node) {
  std::vector<Vec3> points;
  for (const Chart& chart : node.charts) points.insert(points.end(), chart.positions.begin(), chart.positions.end());
  std::sort(points.begin(), points.end(), lessPosition);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  for (Chart& chart : node.charts) {
    splitTriangles(chart, points);
    weld(chart);
  }
}

float layOutCharts(SampleScene& scene, int size, int padding_texels) {
  std::vector<Chart*> charts;
  std::vector<Extent> extents;
  for (Node& node : scene.nodes)
    for (Chart& chart : node.charts) {
      charts.push_back(&chart);
      extents.push_back(extentOf(chart));
    }
  float fits = 0, fails = float(size);  // texels per metre
  std::vector<stbrp_rect> rects;
  for (int step = 0; step < 32; ++step) {
    const float density = (fits + fails) / 2;
    (packAll(extents, size, padding_texels, density, rects) ? fits : fails) = density;
  }
  if (fits == 0 || !packAll(extents, size, padding_texels, fits, rects))
    throw std::runtime_error(scene.name + ": the charts do not fit the light map");
  for (size_t i = 0; i < charts.size(); ++i) {
    const Extent& extent = extents[i];
    const Vec2 span(float(rects[i].w - 1 - padding_texels), float(rects[i].h - 1 - padding_texels));
    charts[i]->lightmap_uv.clear();
    for (const Vec2& uv : charts[i]->metric_uv) {
      const Vec2 local = extent.local(uv);
      charts[i]->lightmap_uv.push_back({(float(rects[i].x) + 0.5f + local.x / extent.size_m.x * span.x) / float(size),
                                        (float(rects[i].y) + 0.5f + local.y / extent.size_m.y * span.y) / float(size)});
    }
  }
  scene.lightmap_size = size;
  return fits;
}

}  // namespace lightwell::samples
