// Faces that touch, overlap, coincide, degenerate, or differ in size by orders of magnitude.
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

constexpr float kAlbedo = 0.5f;

Component componentOf(const Trial& trial) { return trial.is(Technique::lightmap) ? Component::total : Component::indirect; }

/// A closed room of one albedo with anything in it: all light is absorbed by it. Hidden surfaces have none.
Lit keepsEnergy(Trial& trial, const GltfDocument& room, double tolerance, int size = 32) {
  constexpr size_t kMostDrawn = 10000;  // triangles, once for each virtual light: more take minutes where a processor draws them
  const Component component = componentOf(trial);
  Trial::Setup setup{.component = component, .on_gl = !trial.is(Technique::vpl) || room.triangleCount() <= kMostDrawn};
  setup.settings.lightmap_size = size;
  Lit lit = trial.light(room, setup);
  trial.expectSection(lit, true);
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(kAlbedo), component, tolerance);
  return lit;
}

void touching(Trial& trial) {
  GltfDocument room = plainRoom();
  room.box({-1, -1.5, -1}, {0, 0.25, 0}, 0, false);    // on the floor
  room.box({0, -1.5, -1}, {0.75, -0.5, 0}, 0, false);  // and beside that one
  room.box({0, -0.5, -1}, {0.75, 0, 0}, 0, false);     // and on it
  keepsEnergy(trial, room, 0.05);
}

void interpenetrating(Trial& trial) {
  GltfDocument room = plainRoom();
  room.box({-1, -2, -1}, {0, 0.25, 0}, 0, false);      // through the floor
  room.box({-0.6, -1, -1.3}, {0.3, 0, 0.3}, 0, false); // and through that one
  keepsEnergy(trial, room, 0.05);
}

void duplicates(Trial& trial) {
  GltfDocument room = plainRoom();
  for (int i = 0; i < 2; ++i) room.box({-2, -1.5, -2}, {2, 1.5, 2}, room.material({}), true);
  const Component component = componentOf(trial);
  const Lit lit = trial.light(room, {.component = component});
  trial.expectSection(lit, true);
  const double emitted_lm = 10 * kLumenPerCandela * (component == Component::total ? 2 : 1);
  trial.expectNear("mean irradiance", lit.meanLuminance(), emitted_lm / 80, 0.03);
}

void backToBack(Trial& trial) {
  GltfDocument room = plainRoom();
  room.quad({-1, -0.5, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  room.quad({-1, -0.5, -1}, {2, 0, 0}, {0, 0, 2}, 0);
  keepsEnergy(trial, room, 0.05);
}

/// The floor is cut into strips a millionth as wide as they are long, the rest of it left whole.
void slivers(Trial& trial) {
  constexpr int kStrips = 64;
  constexpr double kWidth_m = 4e-6;
  GltfDocument room;
  const uint32_t grey = room.material({});
  const Vec3d low(-2, -1.5, -2), x(4, 0, 0), y(0, 3, 0), z(0, 0, 4);
  for (int i = 0; i < kStrips; ++i) room.quad(low + Vec3d(0, 0, kWidth_m * i), {0, 0, kWidth_m}, x, grey);
  room.quad(low + Vec3d(0, 0, kWidth_m * kStrips), {0, 0, 4 - kWidth_m * kStrips}, x, grey);
  room.quad(low + y, x, z, grey);
  room.quad(low, y, z, grey), room.quad(low + x, z, y, grey), room.quad(low, x, y, grey), room.quad(low + z, y, x, grey);
  room.lamp({.position_m = {0.5f, 0.75f, -0.25f}, .intensity = 10});
  keepsEnergy(trial, room, 0.03, 64);
}

void zeroArea(Trial& trial) {
  GltfDocument room = plainRoom();
  for (int i = 0; i < 100; ++i) {
    const Vec3d p(-1 + 0.02 * i, 0, 0);
    room.triangle(p, p, p, 0);                                            // a point
    room.triangle(p, p + Vec3d(0, 0.5, 0), p + Vec3d(0, 1, 0), 0);        // a line
    room.triangle(p, p + Vec3d(0, 1, 0), p + Vec3d(1e-11, 0.5, 0), 0);    // all but one
  }
  const Lit lit = keepsEnergy(trial, room, 0.03);
  trial.expectWarning(lit, "degenerate");
}

/// 400 charts that are smaller than a texel.
void specks(Trial& trial) {
  GltfDocument room = plainRoom();
  for (int i = 0; i < 400; ++i) {
    const Vec3d p(-1.5 + 0.15 * (i % 20), -1.4 + 0.1 * (i / 20), -1.5 + 0.007 * i);
    room.triangle(p, p + Vec3d(1e-3, 0, 0), p + Vec3d(0, 0, 1e-3), 0);
  }
  keepsEnergy(trial, room, 0.05, 64);
}

template <uint32_t side>
void manyTriangles(Trial& trial) {
  GltfDocument room;
  const uint32_t grey = room.material({});
  const Vec3d low(-2, -1.5, -2), x(4, 0, 0), y(0, 3, 0), z(0, 0, 4);
  room.quad(low, z, x, grey);
  room.quad(low, y, z, grey), room.quad(low + x, z, y, grey), room.quad(low, x, y, grey), room.quad(low + z, y, x, grey);
  room.grid(low + y, x, z, side, side, grey);
  room.lamp({.position_m = {0.5f, 0.75f, -0.25f}, .intensity = 10});
  keepsEnergy(trial, room, 0.03);
}

/// A sheet with as much hole as leaf between a sun and the floor. Its shadow is known.
void foliage(Trial& trial) {
  GltfDocument scene;
  const uint32_t floor = scene.material({.albedo_rgb = Rgb(0.1f)});
  const uint32_t leaves = scene.material({.albedo_rgb = Rgb(0.1f), .double_sided = true, .holes = 64});
  scene.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, floor);
  scene.quad({-4, 1, -4}, {8, 0, 0}, {0, 0, 8}, leaves);
  scene.lamp({.directional = true, .direction = {0, -1, 0}, .intensity = 100});
  const Component component = trial.is(Technique::lightmap) ? Component::direct : Component::indirect;
  const Lit lit = trial.light(scene, {.component = component});
  trial.expectSection(lit, true);
  const double on_floor = lit.meanLuminance([&](const atlas::Slot& slot) { return double(slot.position.y) * lit.metres_per_unit + lit.scene.scene.origin_m.y < 0.5; });
  if (component == Component::direct) trial.expectNear("mean irradiance of the floor", on_floor, 50, 0.03);
  else trial.expectAtMost("mean irradiance of the floor", on_floor, 50 * 0.1);  // what the floor reflects, all of it sent back
}

/// Two rooms with a wall between them that has no thickness; the lamp is in one. No texel is in both.
void thinWall(Trial& trial) {
  GltfDocument scene;
  const uint32_t grey = scene.material({});
  scene.box({-4, -1.5, -2}, {0, 1.5, 2}, grey, true);
  scene.box({0, -1.5, -2}, {4, 1.5, 2}, grey, true);
  scene.layOut(1);
  scene.lamp({.position_m = {-2, 0.5f, 0.25f}, .intensity = 10});
  Trial::Setup setup{.component = componentOf(trial)};
  setup.settings.lightmap_size = 64;
  const Lit lit = trial.light(scene, setup);
  const auto side = [&](bool dark) {
    return [&lit, dark](const atlas::Slot& slot) {
      const double x_m = double(slot.position.x) * lit.metres_per_unit;
      return (x_m > 1e-3 || (x_m > -1e-3 && slot.normal.x > 0.9f)) == dark;
    };
  };
  const double bright = lit.meanLuminance(side(false));
  trial.expect("light in the bright room", bright > 0, "some", std::to_string(bright));
  trial.expectAtMost("greatest irradiance in the dark one", lit.mostLuminance(side(true)), 1e-3 * bright);
}

}  // namespace

std::vector<Case> geometryCases() {
  const std::string sum = "all surfaces together absorb what the lamp gives";
  return {
      {"touching", "boxes that stand on the floor, beside and on each other: " + sum, kOfLamps, touching},
      {"interpenetrating", "boxes through the floor and each other: " + sum, kOfLamps, interpenetrating},
      {"duplicate-faces", "each wall three times in one place: the irradiance of one", kOfLamps, duplicates},
      {"back-to-back", "a sheet of two faces in one place: " + sum, kOfLamps, backToBack},
      {"slivers-1e6", "triangles 4 m long, 4 µm wide: " + sum, kOfLamps, slivers},
      {"zero-area", "points and lines among the triangles: dropped with a warning; " + sum, kOfLamps, zeroArea},
      {"specks", "400 charts smaller than a texel: " + sum, kOfLamps, specks},
      {"triangles-1e5", "two triangles beside 1e5 tiny ones: " + sum, kOfLamps, manyTriangles<224>},
      {"triangles-1e6", "two triangles beside a million tiny ones: " + sum, kOfLamps, manyTriangles<708>, true},
      {"foliage", "a sheet that is half hole: half of the sun on the floor", kOfLamps, foliage},
      {"thin-wall", "a wall without thickness, one side of it lit: at most 0.1 % behind it", kOfLamps, thinWall},
  };
}

}  // namespace lightwell::stress
