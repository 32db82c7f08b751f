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

/// The importer's scaling is by powers of two: no number is rounded otherwise. Where metres as floats lie between, it may be.
template <int exponent>
void powerOfTwo(Trial& trial) {
  const bool exact = trial.is(plan::Technique::lightmap) || trial.is(plan::Technique::vpl);
  samePlaced(trial, {.scale = std::ldexp(1.0, exponent)}, exact ? 0 : 0.1);
}
template <int exponent>
void powerOfTen(Trial& trial) {
  samePlaced(trial, {.scale = std::pow(10.0, exponent)}, 0.1);
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
       [](Trial& trial) { samePlaced(trial, {.translation_m = {1e6f, -1e6f, 1e6f}, .by_nodes = true}, 0.1); }},
      {"far-1e6-vertices", "vertices on the grid that floats have there: the same irradiance", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.translation_m = {1e6f, -1e6f, 1e6f}}, 0.1); }},
      {"mirrored", "a node that mirrors: the same irradiance, mirrored", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.mirrored = true, .by_nodes = true}, 0.2); }},
      {"mirrored-tiny-far", "mirrored, 1 mm in size and 100 km away at once", kOfLamps,
       [](Trial& trial) { samePlaced(trial, {.scale = 1e-3, .translation_m = {1e5f, 0, -1e5f}, .mirrored = true, .by_nodes = true}, 0.2); }},
  };
}

}  // namespace lightwell::stress
