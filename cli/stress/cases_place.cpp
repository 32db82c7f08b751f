// Scenes of any size, anywhere: light does not depend on the unit of length, nor on where the origin is.
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

/// A room with a box in it, all lengths multiples of 1/4 m, each wall with the same texels wherever it stands.
GltfDocument furnished() {
  GltfDocument room = plainRoom();
  room.box({-1, -1.5, -1}, {0, 0.25, 0}, 0, false);
  room.layOut(1);
  return room;
}

void samePlaced(Trial& trial, const Placement& placement, double tolerance) {
  GltfDocument room = furnished();
  const Lit here = trial.light(room);
  room.place(placement);
  const Lit there = trial.light(room);
  trial.expectSection(there, true);
  trial.expectSame("the same room", there, here, 1, tolerance);
}

/// Where rounding differs: radiance maps, whose lamps for training are in the room's metres, and radiosity, whose patches are cut by thresholds, are other approximations of the same light.
double roundedTolerance(const Trial& trial) {
  switch (trial.technique()) {
    case plan::Technique::prm: return 0.1;
    case plan::Technique::radiosity: return 0.05;
    case plan::Technique::vpl: return 0.01;
    default: return 0.02;
  }
}

/// The importer's scaling is by powers of two: no number is rounded otherwise. Where metres as floats lie between, it may be.
template <int exponent>
void powerOfTwo(Trial& trial) {
  const bool exact = trial.is(plan::Technique::lightmap) || trial.is(plan::Technique::vpl);
  samePlaced(trial, {.scale = std::ldexp(1.0, exponent)}, exact ? 0 : roundedTolerance(trial));
}
template <int exponent>
void powerOfTen(Trial& trial) {
  samePlaced(trial, {.scale = std::pow(10.0, exponent)}, roundedTolerance(trial));
}

/// One mesh twice, the second a mirror image of the first: winding, normals and light are, too.
void mirroredInstances(Trial& trial) {
  constexpr double kApart_m = 10;
  GltfDocument rooms = plainRoom();
  rooms.box({-1, -1.5, -1}, {0, 0.25, 0}, 0, false);
  rooms.repeat({kApart_m, 0, 0}, true);
  rooms.lamp({.position_m = {kApart_m - 0.5, 0.75, -0.25}, .intensity = 10});
  Trial::Setup setup;
  setup.settings.lightmap_size = 64;
  const Lit lit = trial.light(rooms, setup);
  trial.expectSection(lit, true);
  const auto is = [&](bool mirrored, bool left) {
    return [&lit, mirrored, left](const atlas::Slot& slot) {
      const double x_m = double(slot.position.x) * lit.metres_per_unit + lit.scene.scene.origin_m.x;
      return mirrored ? x_m > kApart_m / 2 && (x_m > kApart_m) == left : x_m < kApart_m / 2 && (x_m < 0) == left;
    };
  };
  for (const bool left : {true, false})
    trial.expectNear(left ? "mean irradiance at the box" : "mean irradiance at the lamp", lit.meanLuminance(is(true, left)), lit.meanLuminance(is(false, left)), 0.05);
}

}  // namespace

std::vector<Case> placeCases() {
  const std::string scaled = "lamps scaled by the square: the same irradiance as in metres";
  return {
      {"scale-1e-4", scaled, kOfLamps, powerOfTen<-4>},
      {"scale-1e-2", scaled, kOfLamps, powerOfTen<-2>},
      {"scale-1e3", scaled, kOfLamps, powerOfTen<3>},
      {"scale-1e6", scaled, kOfLamps, powerOfTen<6>},
      {"scale-2^-14", scaled + "; light maps and virtual lights to the last bit", kOfLamps, powerOfTwo<-14>},
      {"scale-2^20", scaled + "; light maps and virtual lights to the last bit", kOfLamps, powerOfTwo<20>},
      {"far-1e6-nodes", "moved by a node's transform: the same irradiance", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.translation_m = {1e6f, -1e6f, 1e6f}, .by_nodes = true}, 0.01); }},
      {"far-1e6-vertices", "vertices on the grid that floats have there: the same irradiance", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.translation_m = {1e6f, -1e6f, 1e6f}}, 0.01); }},
      {"mirrored", "a node that mirrors: the same irradiance, mirrored", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.mirrored = true, .by_nodes = true}, 0.1); }},
      {"mirrored-instances", "one mesh twice, once mirrored: the same irradiance in both halves of both", kOfLamps, mirroredInstances},
      {"mirrored-tiny-far", "mirrored, 1 mm in size and 100 km away at once", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.scale = 1e-3, .translation_m = {1e5f, 0, -1e5f}, .mirrored = true, .by_nodes = true}, 0.1); }},
  };
}

}  // namespace lightwell::stress
