// The sample scenes: closed where they say so, wound consistently, laid out without overlap, and committed as generated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>

#include "samples/scenes/glb_writer.h"

namespace lightwell::samples {
namespace {

std::vector<SampleScene> allScenes() { return makeAllScenes(); }

using Point = std::array<long, 3>;
Point quantised(const Vec3& p) { return {std::lround(p.x * 4096), std::lround(p.y * 4096), std::lround(p.z * 4096)}; }

const Node& nodeNamed(const SampleScene& scene, const std::string& name) {
  for (const Node& node : scene.nodes)
    if (node.name == name) return node;
  throw std::out_of_range(name);
}

/// Directed edges minus their opposites; empty for a closed, consistently wound surface.
std::map<std::pair<Point, Point>, int> unmatchedEdges(const Node& node) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const Chart& chart : node.charts)
    for (const auto& t : chart.triangles)
      for (size_t k = 0; k < 3; ++k) {
        const Point a = quantised(chart.positions[t[k]]), b = quantised(chart.positions[t[(k + 1) % 3]]);
        if (a < b) ++edges[{a, b}];
        else --edges[{b, a}];
      }
  std::erase_if(edges, [](const auto& edge) { return edge.second == 0; });
  return edges;
}

double signedVolume(const Node& node) {
  double volume = 0;
  for (const Chart& chart : node.charts)
    for (const auto& t : chart.triangles)
      volume += double(chart.positions[t[0]].dot(chart.positions[t[1]].cross(chart.positions[t[2]]))) / 6;
  return volume;
}

TEST(SampleScenes, RoomsAreClosedAndFaceInward) {
  for (const auto& [scene, shell] :
       {std::pair{makeCornellBox(false), "room"}, {makeMarbleChamber(), "hall"}, {makeCorridorDoor(), "building"}}) {
    const Node& node = nodeNamed(scene, shell);
    EXPECT_TRUE(unmatchedEdges(node).empty()) << scene.name << ": " << unmatchedEdges(node).size() << " open edges";
    EXPECT_LT(signedVolume(node), -50) << scene.name << " must face its inside";
  }
}

TEST(SampleScenes, NormalsAgreeWithWinding) {
  for (const SampleScene& scene : allScenes())
    for (const Node& node : scene.nodes)
      for (const Chart& chart : node.charts)
        for (const auto& t : chart.triangles) {
          const Vec3 geometric = (chart.positions[t[1]] - chart.positions[t[0]]).cross(chart.positions[t[2]] - chart.positions[t[0]]);
          ASSERT_GT(geometric.length(), 0) << scene.name << "/" << node.name;
          for (uint32_t corner : t) {
            EXPECT_NEAR(chart.normals[corner].length(), 1, 1e-3) << scene.name << "/" << node.name;
            EXPECT_GT(chart.normals[corner].dot(geometric.normalized()), 0.2f) << scene.name << "/" << node.name;
          }
        }
}

TEST(SampleScenes, NoTwoTrianglesShareAPlaneAndOverlap) {
  // Equal or opposite triangles would fight in the depth buffer.
  for (const SampleScene& scene : allScenes()) {
    std::map<std::array<Point, 3>, int> seen;
    for (const Node& node : scene.nodes)
      for (const Chart& chart : node.charts)
        for (const auto& t : chart.triangles) {
          std::array<Point, 3> key{quantised(chart.positions[t[0]]), quantised(chart.positions[t[1]]), quantised(chart.positions[t[2]])};
          std::sort(key.begin(), key.end());
          EXPECT_TRUE(node.translation_m != Vec3(0) || ++seen[key] == 1) << scene.name << "/" << node.name;
        }
  }
}

TEST(SampleScenes, LayoutKeepsChartsApart) {
  for (const SampleScene& scene : allScenes()) {
    if (scene.lightmap_size == 0) continue;
    const int size = scene.lightmap_size;
    std::vector<int> owner(size_t(size) * size_t(size), -1);
    int chart_number = 0;
    for (const Node& node : scene.nodes)
      for (const Chart& chart : node.charts) {
        Vec2 low(1), high(0);
        for (const Vec2& uv : chart.lightmap_uv)
          for (int c = 0; c < 2; ++c) {
            low[c] = std::min(low[c], uv[c]);
            high[c] = std::max(high[c], uv[c]);
          }
        ASSERT_GE(std::min(low.x, low.y), 0) << scene.name;
        ASSERT_LE(std::max(high.x, high.y), 1) << scene.name;
        // The texels a chart's rectangle touches, grown by one texel, belong to no other chart.
        for (int y = int(low.y * float(size)) - 1; y <= int(high.y * float(size)) + 1; ++y)
          for (int x = int(low.x * float(size)) - 1; x <= int(high.x * float(size)) + 1; ++x) {
            if (x < 0 || y < 0 || x >= size || y >= size) continue;
            int& texel = owner[size_t(y) * size_t(size) + size_t(x)];
            ASSERT_TRUE(texel == -1 || texel == chart_number)
                << scene.name << "/" << node.name << ": texel " << x << ", " << y << " of charts " << texel << " and " << chart_number;
            const bool inside = x >= int(low.x * float(size)) && x <= int(high.x * float(size)) && y >= int(low.y * float(size)) &&
                                y <= int(high.y * float(size));
            if (inside) texel = chart_number;
          }
        // No fold inside a chart: all triangles are wound alike in it.
        int positive = 0, negative = 0;
        for (const auto& t : chart.triangles) {
          const Vec2 ab = chart.lightmap_uv[t[1]] - chart.lightmap_uv[t[0]], ac = chart.lightmap_uv[t[2]] - chart.lightmap_uv[t[0]];
          (ab.x * ac.y - ab.y * ac.x > 0 ? positive : negative)++;
        }
        EXPECT_TRUE(positive == 0 || negative == 0) << scene.name << "/" << node.name;
        ++chart_number;
      }
  }
}

TEST(SampleScenes, ChamberHasThePapersSize) {
  const SampleScene scene = makeMarbleChamber();
  EXPECT_NEAR(double(scene.triangleCount()), 3335, 335);
  ASSERT_EQ(scene.lamps.size(), 1u);
}

TEST(SampleScenes, CourtyardLeavesTheLayoutToTheBake) { EXPECT_EQ(makeColonnadeCourtyard().lightmap_size, 0); }

TEST(SampleScenes, CommittedFilesAreTheGeneratedOnes) {
  for (const SampleScene& scene : allScenes()) {
    const std::string file = std::string(LIGHTWELL_SAMPLE_DIRECTORY) + "/" + scene.name + ".glb";
    std::ifstream in(file, std::ios::binary);
    ASSERT_TRUE(in) << file;
    const std::vector<uint8_t> committed{std::istreambuf_iterator<char>(in), {}};
    EXPECT_TRUE(committed == encodeGlb(scene)) << file << ": run lightwell_make_samples samples/scenes";
    EXPECT_LT(committed.size(), 300'000u);
  }
}

}  // namespace
}  // namespace lightwell::samples
