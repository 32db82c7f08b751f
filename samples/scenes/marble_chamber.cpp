// A marble hall of about 3,300 triangles, the size of the test scene of "On Making Light Maps Dynamic" (figure 6): a nave between two
// arcades, aisles of different tint, a stair with a red carpet up to a statue, a coffered ceiling, red drapery.
#include "samples/scenes/cell_building.h"
#include "samples/scenes/chart_layout.h"
#include "samples/scenes/shapes.h"

namespace lightwell::samples {
namespace {

// The plan, in metres (multiples of 1/8, so that what touches does so exactly): x across, z along the nave; the dais is at the far
// end (z < 0).
constexpr float kNave = 2.875f, kPier = 0.75f, kAisle = 5.875f, kEnd = 9.0f;
constexpr float kNaveHeight = 6.2f, kAisleHeight = 4.9f, kBeam = 0.3f, kImpost = 3.0f, kPlinth = 0.25f, kDais = 0.75f;
constexpr int kPiers = 4, kArchSegments = 8;
constexpr float kSpan = (2 * kEnd - kPiers * kPier) / float(kPiers + 1);

float pierStart(int pier) { return -kEnd + kSpan + float(pier) * (kSpan + kPier); }

struct Stones {
  uint32_t white, grey, dark, carpet, gold, west_wall, east_wall, ceiling, bronze, drape;
};

/// One arcade: both faces above the columns, each in one piece, and the soffits of the arches. `side` is −1 in the west, 1 in the east.
void addArcade(Node& node, const Stones& stone, float side) {
  const float radius = kSpan / 2;
  std::vector<float> springs{-kEnd};  // where openings begin and end
  for (int pier = 0; pier < kPiers; ++pier)
    for (const float end : {pierStart(pier), pierStart(pier) + kPier}) springs.push_back(end);
  springs.push_back(kEnd);
  const auto arch = [&](size_t bay, int k) {
    const float angle = kPi * float(k) / kArchSegments, from = springs[2 * bay];
    if (k == 0) return Vec3(0, kImpost, from);
    if (k == kArchSegments) return Vec3(0, kImpost, springs[2 * bay + 1]);
    return Vec3(0, kImpost + radius * std::sin(angle), from + radius * (1 - std::cos(angle)));
  };
  struct Face {
    float x, facing, top, top_at_piers;
    uint32_t material;
  };
  for (const Face& face : {Face{side * kNave, -side, kNaveHeight, kNaveHeight, stone.white},
                           Face{side * (kNave + kPier), side, kAisleHeight, kAisleHeight - kBeam,
                                side < 0 ? stone.west_wall : stone.east_wall}}) {
    std::vector<Vec3> corners;
    const auto strip = [&](const Vec3& low_from, const Vec3& low_to, float top) {
      std::array<Vec3, 4> quad{low_from, low_to, Vec3(0, top, low_to.z), Vec3(0, top, low_from.z)};
      if (face.facing > 0) std::swap(quad[1], quad[3]);
      for (Vec3 corner : quad) {
        corner.x = face.x;
        corners.push_back(corner);
      }
    };
    for (size_t bay = 0; bay <= kPiers; ++bay) {
      for (int k = 0; k < kArchSegments; ++k) strip(arch(bay, k), arch(bay, k + 1), face.top);
      if (bay < kPiers) strip({0, kImpost, springs[2 * bay + 1]}, {0, kImpost, springs[2 * bay + 2]}, face.top_at_piers);
    }
    addPlanarChart(node, face.material, corners, 4);
  }
  for (size_t bay = 0; bay <= kPiers; ++bay) {
    Chart soffit;
    soffit.material = stone.grey;
    for (int k = 0; k <= kArchSegments; ++k) {
      const float angle = kPi * float(k) / kArchSegments;
      const Vec3 toward_axis(0, -std::sin(angle), std::cos(angle));
      for (const float x : {kNave, kNave + kPier})
        soffit.addVertex(arch(bay, k) + Vec3(side * x, 0, 0), toward_axis, {radius * angle, x});
    }
    for (uint32_t k = 0; k < kArchSegments; ++k) {
      const uint32_t a = 2 * k, b = a + 1, c = a + 3, d = a + 2;
      if (side > 0) {
        soffit.triangles.push_back({a, b, c});
        soffit.triangles.push_back({a, c, d});
      } else {
        soffit.triangles.push_back({a, c, b});
        soffit.triangles.push_back({a, d, c});
      }
    }
    node.charts.push_back(std::move(soffit));
  }
}

CellGrid planHall(const Stones& stone) {
  const float carpet = 0.75f, stair = 2.1f, tread = 0.32f, foot = -4.6f, pedestal = 0.45f, statue_z = -7.9f, bench = 0.42f;
  const int steps = 5;
  std::vector<float> xs{-carpet, carpet, -stair, stair, -pedestal, pedestal}, zs{-kEnd, kEnd, statue_z - pedestal, statue_z + pedestal};
  for (const float s : {-1.0f, 1.0f})
    for (const float x : {kNave, kNave + kPier, kAisle, kAisle - bench}) xs.push_back(s * x);
  for (int pier = 0; pier < kPiers; ++pier) zs.insert(zs.end(), {pierStart(pier), pierStart(pier) + kPier});
  for (int step = 0; step < steps; ++step) zs.push_back(foot - float(step) * tread);
  const float tile = 1.4f, door_end = kEnd - 0.7f;
  for (int row = 0; row < 9; ++row) zs.push_back(foot + tile * float(row + 1));
  // Coffers: 2 × 5, each with one inner step.
  const float coffer = 1.9f, coffer_pitch_x = 2.5f, coffer_pitch_z = 3.4f, inset = 0.3f;
  std::vector<Vec2> coffers;
  for (int column = 0; column < 2; ++column)
    for (int row = 0; row < 5; ++row) {
      const Vec2 center((float(column) - 0.5f) * coffer_pitch_x, (float(row) - 2.0f) * coffer_pitch_z);
      coffers.push_back(center);
      for (const float d : {-coffer / 2, -coffer / 2 + inset, coffer / 2 - inset, coffer / 2}) {
        xs.push_back(center.x + d);
        zs.push_back(center.y + d);
      }
    }
  CellGrid grid(gridLines(xs), gridLines(zs));

  // Aisles with a bench along the wall and a beam at each pier.
  for (const float s : {-1.0f, 1.0f}) {
    const uint32_t wall = s < 0 ? stone.west_wall : stone.east_wall;
    const auto across = [&](float from, float to, float z0, float z1, const std::function<void(Cell&)>& change) {
      grid.edit(std::min(s * from, s * to), std::max(s * from, s * to), z0, z1, change);
    };
    across(kNave + kPier, kAisle, -kEnd, kEnd, [&](Cell& c) {
      c = {.floor_m = 0, .ceiling_m = kAisleHeight, .floor_material = stone.grey, .ceiling_material = stone.ceiling, .wall_material = wall,
           .riser_material = stone.white, .lintel_material = wall};
    });
    across(kAisle - bench, kAisle, -kEnd, kEnd, [&](Cell& c) {
      c.floor_m = 0.45f;
      c.floor_material = stone.white;
    });
    for (int pier = 0; pier < kPiers; ++pier)
      across(kNave + kPier, kAisle, pierStart(pier), pierStart(pier) + kPier, [&](Cell& c) {
        c.ceiling_m = kAisleHeight - kBeam;
        c.ceiling_material = c.lintel_material = stone.white;
      });
    // Under the arcade everything above the floor is the arcade's own.
    across(kNave, kNave + kPier, -kEnd, kEnd, [&](Cell& c) {
      c = {.floor_m = 0, .ceiling_m = kImpost, .floor_material = stone.dark, .wall_material = stone.white, .riser_material = stone.white,
           .makes_ceiling = false, .makes_lintels = false};
    });
    for (int pier = 0; pier < kPiers; ++pier)
      across(kNave, kNave + kPier, pierStart(pier), pierStart(pier) + kPier, [&](Cell& c) {
        c.floor_m = kPlinth;
        c.makes_floor = false;
      });
  }

  // The nave: chequered tiles, a carpet, the stair, the dais with the statue's pedestal.
  grid.edit(-kNave, kNave, -kEnd, kEnd, [&](Cell& c) {
    c = {.floor_m = 0, .ceiling_m = kNaveHeight, .floor_material = stone.dark, .ceiling_material = stone.ceiling,
         .wall_material = stone.white, .riser_material = stone.white, .lintel_material = stone.white};
  });
  for (int row = 0; row < 9; ++row) {
    const float z0 = foot + tile * float(row), z1 = std::min(z0 + tile, door_end);
    const float tile_lines[] = {-kNave, -stair, -carpet, carpet, stair, kNave};
    for (int column = 0; column < 5; ++column)
      if (column != 2 && (row + column) % 2 == 0)
        grid.edit(tile_lines[column], tile_lines[column + 1], z0, z1, [&](Cell& c) { c.floor_material = stone.white; });
  }
  grid.edit(-stair, stair, -kEnd, foot, [&](Cell& c) {
    c.floor_m = kDais;
    c.floor_material = stone.white;
  });
  for (int step = 0; step + 1 < steps; ++step)
    grid.edit(-stair, stair, foot - float(step + 1) * tread, foot - float(step) * tread, [&](Cell& c) {
      c.floor_m = kDais * float(step + 1) / steps;
    });
  grid.edit(-carpet, carpet, statue_z + 0.9f, kEnd - 0.5f, [&](Cell& c) {
    c.floor_m += 0.02f;
    c.floor_material = c.riser_material = stone.carpet;
  });
  grid.edit(-pedestal, pedestal, statue_z - pedestal, statue_z + pedestal, [&](Cell& c) {
    c.floor_m = kDais + 0.9f;
    c.floor_material = c.riser_material = stone.dark;
  });
  for (const Vec2& center : coffers)
    for (const float half : {coffer / 2, coffer / 2 - inset})
      grid.edit(center.x - half, center.x + half, center.y - half, center.y + half, [&](Cell& c) {
        c.ceiling_m = kNaveHeight + (half == coffer / 2 ? 0.22f : 0.4f);
        c.ceiling_material = half == coffer / 2 ? stone.white : stone.gold;
      });
  return grid;
}

void addStatue(Node& node, uint32_t material, const Vec3& foot) {
  const ProfilePoint robe[] = {{0.34f, 0}, {0.29f, 0.1f}, {0.19f, 0.8f}, {0.25f, 1.15f}, {0.22f, 1.32f}, {0.07f, 1.46f}};
  addLathe(node, material, foot, robe, 10);
  addSphere(node, material, foot + Vec3(0, 1.6f, 0), 0.15f, 8, 5);
}

void addUrn(Node& node, uint32_t stone, uint32_t bronze, const Vec3& foot) {
  addOpenBox(node, stone, foot + Vec3(-0.3f, 0, -0.3f), foot + Vec3(0.3f, 0.8f, 0.3f));
  const ProfilePoint body[] = {{0.16f, 0}, {0.08f, 0.1f}, {0.25f, 0.35f}, {0.28f, 0.52f}, {0.21f, 0.8f}, {0, 0.62f}};
  addLathe(node, bronze, foot + Vec3(0, 0.8f, 0), body, 10);
}

/// A hanging cloth in soft folds, its front toward `facing`, its upper edge centred at `top`.
void addDrape(Node& node, uint32_t material, const Vec3& top, const Vec3& facing, float width_m, float height_m) {
  const Vec3 right = Vec3(0, 1, 0).cross(facing);
  addSheet(node, material, 12, 1, [&](float s, float t) {
    const float fold = 0.07f * std::sin(s * 3 * 2 * kPi) * (1.1f - t * 0.5f);
    return top + right * ((s - 0.5f) * width_m) - Vec3(0, (1 - t) * height_m, 0) + facing * fold;
  });
}

}  // namespace

SampleScene makeMarbleChamber() {
  SampleScene scene;
  scene.name = "marble_chamber";
  const Stones stone{.white = scene.addMaterial("white_marble", {0.80f, 0.78f, 0.73f}),
                     .grey = scene.addMaterial("grey_marble", {0.52f, 0.52f, 0.53f}),
                     .dark = scene.addMaterial("dark_marble", {0.16f, 0.18f, 0.17f}),
                     .carpet = scene.addMaterial("carpet", {0.56f, 0.035f, 0.03f}),
                     .gold = scene.addMaterial("gilded_coffer", {0.72f, 0.52f, 0.2f}),
                     .west_wall = scene.addMaterial("siena_marble", {0.78f, 0.52f, 0.26f}),
                     .east_wall = scene.addMaterial("verde_marble", {0.30f, 0.50f, 0.38f}),
                     .ceiling = scene.addMaterial("stucco", {0.78f, 0.75f, 0.68f}),
                     .bronze = scene.addMaterial("bronze", {0.30f, 0.19f, 0.09f}),
                     .drape = scene.addMaterial("red_drapery", {0.60f, 0.04f, 0.05f})};

  Node& hall = scene.nodes.emplace_back();
  hall.name = "hall";
  for (const float side : {-1.0f, 1.0f}) {
    addArcade(hall, stone, side);
    for (int pier = 0; pier < kPiers; ++pier)
      addColumn(hall, stone.white, stone.white, {.plinth_top = {side * (kNave + kPier / 2), kPlinth, pierStart(pier) + kPier / 2},
                                    .soffit_m = kImpost, .half_width_m = kPier / 2, .radius_m = 0.25f});
  }
  planHall(stone).build(hall);

  Node& statue = scene.nodes.emplace_back();
  statue.name = "statue";
  addStatue(statue, stone.white, {0, kDais + 0.9f, -7.9f});
  Node& urns = scene.nodes.emplace_back();
  urns.name = "urns";
  for (const float x : {-2.35f, 2.35f}) addUrn(urns, stone.grey, stone.bronze, {x, 0, 8.0f});
  Node& drapery = scene.nodes.emplace_back();
  drapery.name = "drapery";
  for (const float x : {-1.7f, 1.7f}) addDrape(drapery, stone.drape, {x, 5.2f, -kEnd + 0.12f}, {0, 0, 1}, 1.2f, 3.9f);
  for (const int bay : {1, 3}) {
    const float z = pierStart(bay) - kSpan / 2;
    addDrape(drapery, stone.drape, {-kAisle + 0.12f, 4.2f, z}, {1, 0, 0}, 1.4f, 3.2f);
  }

  scene.lamps.push_back({.name = "lamp", .position_m = {0.6f, 2.6f, 1.5f}, .color_rgb = {1, 0.87f, 0.7f}, .intensity = 220});
  for (Node& node : scene.nodes) stitch(node);
  layOutCharts(scene, 256, 2);
  return scene;
}

}  // namespace lightwell::samples
