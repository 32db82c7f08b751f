// Lamps that nothing was baked for (lightwell_dynamic): one reflection, from virtual lights that OpenGL finds in each frame.
#include "cli/dynamic_evaluator.h"
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

using plan::Technique;

constexpr float kAlbedo = 0.5f;
constexpr uint32_t kPoints = 16384;  // for the shadow maps of virtual lights

/// Where no wall hides another shadows are left out: what is tested then has an exact sum.
template <bool incremental>
Trial::Setup setupOf(bool shadows) {
  Trial::Setup setup;
  setup.settings.points = kPoints;
  setup.dynamic = Dynamic{.incremental = incremental, .shadow_side = shadows ? 32u : 0u};
  return setup;
}

/// A closed room receives, after one reflection of it, just what has been reflected.
template <bool incremental>
void lampAt(Trial& trial, const Vec3d& position_m, double tolerance) {
  GltfDocument room = plainRoom({}, 0);
  room.lamp({.position_m = position_m, .intensity = 10});
  for (const bool shadows : {false, true}) {
    const Lit lit = trial.light(room, setupOf<incremental>(shadows));
    trial.expectNear(shadows ? "received lumen, with shadow maps" : "received lumen", lit.flux_rgb().x, 10 * kLumenPerCandela * double(kAlbedo), tolerance);
  }
}

template <bool incremental>
void outside(Trial& trial) {
  GltfDocument room = plainRoom({}, 0);
  room.lamp({.position_m = {0, 4, 0}, .intensity = 1e6});
  room.lamp({.directional = true, .direction = {0.3, -1, 0.2}, .intensity = 1e6});
  trial.expectAtMost("received lumen", trial.light(room, setupOf<incremental>(true)).flux_rgb().x, 0);
}

template <bool incremental>
void inProportion(Trial& trial, bool sun, double factor) {
  const auto lit = [&](double intensity) {
    GltfDocument scene;
    const uint32_t grey = scene.material({});
    scene.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
    scene.box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, grey, false);
    scene.lamp({.directional = sun, .position_m = {1, 2, 1}, .direction = {-1, -2, -1}, .intensity = intensity});
    return trial.light(scene, setupOf<incremental>(true));
  };
  const Lit one = lit(1), bright = lit(factor);
  trial.expect("light", one.meanLuminance() > 0, "some", std::to_string(one.meanLuminance()));
  trial.expectSame("in proportion to the light", bright, one, factor, 1e-3);
}

template <bool incremental>
void placed(Trial& trial, const Placement& placement) {
  GltfDocument room = plainRoom();
  room.box({-1, -1.5, -1}, {0, 0.25, 0}, 0, false);
  room.layOut(1);
  const Lit here = trial.light(room, setupOf<incremental>(true));
  room.place(placement);
  trial.expectSame("the same room", trial.light(room, setupOf<incremental>(true)), here, 1, 0.01);
}

template <bool incremental>
void black(Trial& trial) {
  trial.expectAtMost("received lumen", trial.light(plainRoom({.albedo_rgb = Rgb(0)}), setupOf<incremental>(true)).flux_rgb().x, 0);
}

/// There is nothing to draw: creation says what is missing.
template <bool incremental>
void nothing(Trial& trial) {
  GltfDocument scene;
  scene.lamp({.position_m = {0, 1, 0}, .intensity = 10});
  const std::filesystem::path file = trial.bench().bake({.scene = &scene, .technique = trial.technique(), .settings = setupOf<incremental>(true).settings});
  const cli::RuntimeContainer runtime(file);
  std::string reason;
  try {
    cli::evaluateDynamicOnGl({.container = runtime, .scene = scene::Scene{}, .incremental = incremental});
  } catch (const std::exception& error) {
    reason = error.what();
  }
  trial.expect("refusal", reason.find("geometry") != std::string::npos, "names geometry", reason.empty() ? "none" : reason);
}

template <bool incremental>
void append(std::vector<Case>& cases) {
  const std::string sum = "a closed room receives what is reflected once", as = "the same irradiance", of = incremental ? "iir-" : "rsm-";
  const std::vector<Technique> vpl = {Technique::vpl};
  const auto add = [&](const std::string& name, const std::string& holds, void (*run)(Trial&)) { cases.push_back({of + name, holds, vpl, run, false, true}); };
  add("room", sum, [](Trial& trial) { lampAt<incremental>(trial, {0.5, 0.75, -0.25}, 0.05); });
  add("lamp-1e-4-of-wall", "0.1 mm of a wall: " + sum, [](Trial& trial) { lampAt<incremental>(trial, {0.3, 0.4, 2 - 1e-4}, 0.05); });
  add("lamp-outside", "lamps behind walls that show their backs: nothing received", outside<incremental>);
  add("sun-1e9", "1e9 lux: in proportion to the light", [](Trial& trial) { inProportion<incremental>(trial, true, 1e9); });
  add("sun-1e-9", "1e-9 lux: in proportion to the light", [](Trial& trial) { inProportion<incremental>(trial, true, 1e-9); });
  add("lamp-1e12", "1e12 cd: in proportion to the light", [](Trial& trial) { inProportion<incremental>(trial, false, 1e12); });
  add("scale-1e-4", "lamps scaled by the square: " + as + " as in metres", [](Trial& trial) { placed<incremental>(trial, {.scale = 1e-4}); });
  add("scale-1e6", "lamps scaled by the square: " + as + " as in metres", [](Trial& trial) { placed<incremental>(trial, {.scale = 1e6}); });
  add("far-1e6", "1,000 km from the origin: " + as, [](Trial& trial) { placed<incremental>(trial, {.translation_m = {1e6, -1e6, 1e6}, .by_nodes = true}); });
  add("albedo-0", "nothing reflected, nothing received", black<incremental>);
  add("no-surfaces", "refused, naming what is missing", nothing<incremental>);
}

}  // namespace

std::vector<Case> dynamicCases() {
  std::vector<Case> cases;
  append<false>(cases);
  append<true>(cases);
  return cases;
}

}  // namespace lightwell::stress
