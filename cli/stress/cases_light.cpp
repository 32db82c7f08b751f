// Lamps and emitters of any brightness, number and place.
#include "cli/stress/cases.h"
#include "precompute/core/random.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

Component componentOf(const Trial& trial) { return trial.is(Technique::lightmap) ? Component::total : Component::indirect; }

/// Twice the light is twice the irradiance, up to any factor.
void linear(Trial& trial, bool sun, double factor) {
  const auto lit = [&](double intensity) {
    GltfDocument scene;
    const uint32_t grey = scene.material({});
    scene.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
    scene.box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, grey, false);
    scene.lamp({.directional = sun, .position_m = {1, 2, 1}, .direction = Vec3(-1, -2, -1), .intensity = intensity});
    return trial.light(scene, {.component = componentOf(trial)});
  };
  const Lit one = lit(1), bright = lit(factor);
  trial.expectSection(bright, true);
  trial.expectSame("in proportion to the light", bright, one, factor, 4e-3);  // nine bits of RGB9E5
  if (!sun || !trial.is(Technique::lightmap)) return;
  const double open = factor * 2 / std::sqrt(6.0);  // cosine of the sun's height; the box adds what it reflects
  const double corner = bright.meanLuminance([&](const atlas::Slot& slot) {
    return slot.normal.y > 0.99f && Vec3d(slot.position).x * bright.metres_per_unit > 1.5;
  });
  trial.expectNear("irradiance of the open floor", corner, open, 0.02);
}

/// A lamp that all but touches what it lights. Half of its light falls on a spot as small as the gap.
void atWall(Trial& trial, const Vec3& position_m, bool corner) {
  GltfDocument room = plainRoom({}, 0);
  room.lamp({.position_m = position_m, .intensity = 10});
  const Component component = componentOf(trial);
  const Lit lit = trial.light(room, {.component = component});
  trial.expectSection(lit, true);
  // What walls send each other within a tenth of a millimetre of a corner is not in the points at which texels look at virtual lights.
  if (corner && trial.is(Technique::vpl)) trial.expectNear("received lumen", lit.flux_rgb().x, 0.75 * 10 * kLumenPerCandela, 0.35);
  else trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0.5f), component, 0.05);
}

void manyLamps(Trial& trial) {
  constexpr int kSide = 10, kLayers = 100;
  GltfDocument room = plainRoom({}, 0);
  for (int i = 0; i < kSide * kSide * kLayers; ++i) {
    const Sampler sampler(1, uint64_t(i));
    const Vec2 floor = sampler.get2D(0, 0);
    room.lamp({.position_m = Vec3(-1.9f + 3.8f * floor.x, -1.4f + 2.8f * sampler.get1D(0, 1), -1.9f + 3.8f * floor.y), .intensity = 1e-3});
  }
  const Component component = componentOf(trial);
  // Shadow rays from all entry points to all lamps are what the PRM's runtime asks of a game, and virtual lights tell lamps apart.
  const Lit lit = trial.light(room, {.component = component, .most_work = 0.01 * kSide * kSide * kLayers});
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0.5f), component, 0.05);
}

/// An emitter of 1e4 and one of 1e-4, both the size of a tile, in a room or in one each. Not for virtual lights in two rooms: these go where the power is.
void emitters(Trial& trial, bool two_rooms) {
  GltfDocument scene;
  const uint32_t grey = scene.material({});
  const uint32_t bright = scene.material({.emitted_radiance_rgb = Rgb(1e4f)}), dim = scene.material({.emitted_radiance_rgb = Rgb(1e-4f)});
  scene.box({-2, -1.5, -2}, {2, 1.5, 2}, grey, true);
  scene.quad({-0.5, 1.25, -0.5}, {1, 0, 0}, {0, 0, 1}, bright);
  const double offset_m = two_rooms ? 10 : 0;
  if (two_rooms) scene.box({8, -1.5, -2}, {12, 1.5, 2}, grey, true);
  scene.quad({offset_m - 0.5, -1.25, -0.5}, {0, 0, 1}, {1, 0, 0}, dim);
  const Lit lit = trial.light(scene, {.component = Component::total});
  trial.expectSection(lit, true);
  const auto meanOf = [&](bool right) {
    return lit.meanLuminance([&](const atlas::Slot& slot) {
      const double x_m = double(slot.position.x) * lit.metres_per_unit + lit.scene.scene.origin_m.x;
      return (x_m > 5) == right;
    });
  };
  if (two_rooms) {
    trial.expectNear("ratio of the rooms", meanOf(false) / meanOf(true), 1e8, 0.1);
  } else {
    GltfDocument alone;
    alone.box({-2, -1.5, -2}, {2, 1.5, 2}, alone.material({}), true);
    alone.quad({-0.5, 1.25, -0.5}, {1, 0, 0}, {0, 0, 1}, alone.material({.emitted_radiance_rgb = Rgb(1e4f)}));
    alone.quad({-0.5, -1.25, -0.5}, {0, 0, 1}, {1, 0, 0}, alone.material({}));
    const Lit without = trial.light(alone, {.component = Component::total});
    trial.expectSame("as without the dim one", lit, without, 1, 0.1);
  }
}

void noLights(Trial& trial) {
  const Component component = componentOf(trial);
  const Lit lit = trial.light(plainRoom({}, 0), {.component = component});
  if (trial.is(Technique::prm) || trial.is(Technique::radiosity)) {
    trial.expectSection(lit, true);
    trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);
  } else {
    trial.expectSection(lit, false);
  }
}

void lampOutside(Trial& trial) {
  GltfDocument room = plainRoom({}, 0);
  room.lamp({.position_m = {0, 4, 0}, .intensity = 1e6});
  room.lamp({.directional = true, .direction = {0.3f, -1, 0.2f}, .intensity = 1e6});
  const Lit lit = trial.light(room, {.component = componentOf(trial)});
  trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);
}

}  // namespace

std::vector<Case> lightCases() {
  const std::string sum = "all surfaces together absorb what the lamp gives", proportion = "in proportion to the light";
  return {
      {"sun-1e9", "1e9 lux: " + proportion + ", the open floor exact", kOfLamps, [](Trial& trial) { linear(trial, true, 1e9); }},
      {"sun-1e-9", "1e-9 lux: " + proportion, kOfLamps, [](Trial& trial) { linear(trial, true, 1e-9); }},
      {"lamp-1e12", "1e12 cd: " + proportion, kOfLamps, [](Trial& trial) { linear(trial, false, 1e12); }},
      {"lamp-1e-4-of-wall", "0.1 mm of a wall: " + sum, kOfLamps, [](Trial& trial) { atWall(trial, {0.3f, 0.4f, 2 - 1e-4f}, false); }},
      {"lamp-1e-4-of-corner", "0.1 mm of three walls: " + sum, kOfLamps, [](Trial& trial) { atWall(trial, {2 - 1e-4f, 1.5f - 1e-4f, 2 - 1e-4f}, true); }},
      {"lamp-in-wall", "on the very plane of a wall: what goes to the front of it is received", kOfLamps,
       [](Trial& trial) {
         GltfDocument room = plainRoom({}, 0);
         room.lamp({.position_m = {0.3f, 0.4f, 2}, .intensity = 10});
         const Component component = componentOf(trial);
         const Lit lit = trial.light(room, {.component = component});
         const double most = 10 * kLumenPerCandela * (component == Component::total ? 2 : 1), got = lit.flux_rgb().x;
         trial.expect("received lumen", got >= 0.95 * most / 2 && got <= 1.05 * most, "between half of it, what goes to the front, and all", std::to_string(got / most));
       }},
      {"lamps-10000", sum, kOfLamps, manyLamps},
      {"emitters-1e8", "radiance 1e4 and 1e-4 in one room: as without the dim one", kOfLamps, [](Trial& trial) { emitters(trial, false); }},
      {"emitters-1e8-apart", "radiance 1e4 and 1e-4 in two rooms alike: 1e8 times the light", {Technique::prm, Technique::radiosity, Technique::lightmap}, [](Trial& trial) { emitters(trial, true); }},
      {"no-lights", "no light at all: nothing received, or the section left out with a reason", kOfLamps, noLights},
      {"one-sided-walls", "lamps behind walls that show their backs: nothing received", kOfLamps, lampOutside},
  };
}

}  // namespace lightwell::stress
