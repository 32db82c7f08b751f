// Light from the sky: closed boxes under it, suns in it, lobes of any width about it.
#include "cli/runtime_handles.h"
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

const std::vector<Technique> kOfSkies = {Technique::prm, Technique::lightmap, Technique::vpl, Technique::environment};

ImageRgba constantSky(float radiance, int width = 64) {
  return {width, width / 2, std::vector<std::array<float, 4>>(size_t(width) * size_t(width / 2), {radiance, radiance, radiance, 1})};
}

/// All there is of straight and reflected light, for those that have both.
Component allOf(const Trial& trial) {
  return trial.is(Technique::environment) ? Component::direct : trial.is(Technique::vpl) ? Component::indirect : Component::total;
}

/// A box closed all around, its faces inside and outside `thickness_m` apart.
void closedBox(Trial& trial, double thickness_m) {
  GltfDocument scene;
  const uint32_t grey = scene.material({});
  const Vec3d half(2, 1.5, 2), wall(thickness_m);
  scene.box(-half, half, grey, true);
  scene.box(-half - wall, half + wall, grey, false);
  scene.quad({-4, -2.5, -4}, {0, 0, 8}, {8, 0, 0}, grey);
  const ImageRgba sky = constantSky(1000);
  Trial::Setup setup{.component = allOf(trial), .sky = &sky};
  setup.settings.lightmap_size = 64;
  const Lit lit = trial.light(scene, setup);
  trial.expectSection(lit, true);
  const auto inside = [&](const atlas::Slot& slot) {
    const Vec3d p_m = Vec3d(slot.position) * lit.metres_per_unit + lit.scene.scene.origin_m;
    return p_m.y > -2 && Vec3d(slot.normal).dot(p_m) < 0;
  };
  // What comes straight from a sky of radiance 1000: π times as much, where nothing is in the way. Virtual lights have what the ground reflects of it.
  const double outside = lit.mostLuminance([&](const atlas::Slot& slot) { return !inside(slot); });
  if (trial.is(Technique::vpl)) trial.expect("light outside", outside > 100, "more than 100", std::to_string(outside));
  else trial.expect("light outside", outside > 3000, "more than 3000", std::to_string(outside));
  trial.expectAtMost("greatest irradiance inside", lit.mostLuminance(inside), 1e-3 * 1000 * std::numbers::pi);
}

/// What comes from infinitely far does not depend on how large a scene is, nor on where.
void placed(Trial& trial, const Placement& placement) {
  ImageRgba sky = constantSky(1);
  for (size_t i = 0; i < sky.pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c) sky.pixels[i][c] += 4 * float(i % size_t(sky.width)) / float(sky.width);  // from one side more than from the other
  GltfDocument scene;
  const uint32_t grey = scene.material({});
  scene.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
  scene.box({-1, 0, -1}, {0, 1.5, 0}, grey, false);
  scene.layOut(1);
  const Trial::Setup setup{.component = allOf(trial), .sky = &sky};
  const Lit here = trial.light(scene, setup);
  scene.place(placement);
  const Lit there = trial.light(scene, setup);
  trial.expectSection(there, true);
  trial.expectSame("the same scene", there, here, 1, 0.1);
}

/// One texel of the map is a sun of radiance 1e9; the floor's irradiance is the sum of both.
void sunInSky(Trial& trial) {
  constexpr int kWidth = 512;
  ImageRgba sky = constantSky(1, kWidth);
  const int x = kWidth * 3 / 4, y = kWidth / 8;  // +z, 45° high
  sky.pixels[size_t(y) * kWidth + size_t(x)] = {1e9f, 1e9f, 1e9f, 1};
  const double step = std::numbers::pi / (kWidth / 2), theta = (y + 0.5) * step;
  const double solid_angle_sr = step * (std::cos(theta - step / 2) - std::cos(theta + step / 2));
  GltfDocument scene;
  scene.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, scene.material({}));
  const Lit lit = trial.light(scene, {.component = allOf(trial), .sky = &sky});
  if (trial.is(Technique::vpl)) return trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);  // nothing is there to receive what the floor reflects
  trial.expectSection(lit, true);
  trial.expectNear("mean irradiance", lit.meanLuminance(), std::numbers::pi + 1e9 * solid_angle_sr * std::cos(theta), 0.02);
}

/// A lobe cos^n about any direction of a sky of radiance 2 holds 4π / (n + 1), about a normal 2π.
void lobes(Trial& trial, uint32_t cells, uint32_t face_cells) {
  const ImageRgba sky = constantSky(2);
  plan::Settings settings = Trial::plainSettings();
  settings.environment_samples = cells, settings.sky_face_cells = face_cells;
  const std::filesystem::path file = trial.bench().bake({.sky = &sky, .technique = Technique::environment, .settings = settings});
  const cli::RuntimeContainer runtime(file);
  const auto environment = runtime.loadEnvironment();
  double worst = 0;
  const std::vector<Vec3> directions = {{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, {0.577f, 0.577f, -0.577f}, {1e-3f, 1, 1e-3f}, {-0.7f, 1e-7f, 0.7f}};
  for (const Vec3& direction : directions) {
    Rgb rgb;
    runtime.check(lw_environment_irradiance(environment.get(), &direction.x, nullptr, &rgb.x));
    worst = std::max(worst, std::abs(double(rgb.x) / (2 * std::numbers::pi) - 1));
    for (const float shininess : {1.0f, 10.0f, 1e3f, 1e5f}) {
      runtime.check(lw_environment_phong(environment.get(), &direction.x, shininess, nullptr, &rgb.x));
      const double error = std::abs(double(rgb.x) * double(shininess + 1) / (4 * std::numbers::pi) - 1);
      worst = error <= worst ? worst : error;  // NaN stays
    }
    for (const float roughness : {0.0f, 0.5f, 1.0f}) {
      runtime.check(lw_environment_ggx(environment.get(), &direction.x, roughness, nullptr, &rgb.x));
      const double error = std::abs(double(rgb.x) / 2 - 1);
      worst = error <= worst ? worst : error;
    }
  }
  trial.expectAtMost("greatest error of a lobe", worst, 0.01);
}

void blackSky(Trial& trial) {
  const ImageRgba sky = constantSky(0);
  const Lit lit = trial.light(plainRoom({}, 0), {.component = allOf(trial), .sky = &sky});
  if (trial.is(Technique::prm)) trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);
  else trial.expectSection(lit, false);
}

}  // namespace

std::vector<Case> skyCases() {
  const std::vector<Technique> environment = {Technique::environment};
  return {
      {"closed-box", "walls of 5 cm under a bright sky: inside at most 0.1 % of outside", kOfSkies, [](Trial& trial) { closedBox(trial, 0.05); }},
      {"closed-box-thin", "walls of two faces in one place under a bright sky: inside at most 0.1 % of outside", kOfSkies, [](Trial& trial) { closedBox(trial, 0); }},
      {"sky-scale-1e-4", "a scene of any size has the same irradiance from the sky", kOfSkies, [](Trial& trial) { placed(trial, {.scale = 1e-4}); }},
      {"sky-scale-1e6", "a scene of any size has the same irradiance from the sky", kOfSkies, [](Trial& trial) { placed(trial, {.scale = 1e6}); }},
      {"sky-far-1e6", "1,000 km from the origin: the same irradiance from the sky", kOfSkies, [](Trial& trial) { placed(trial, {.translation_m = {1e6, -1e6, 1e6}, .by_nodes = true}); }},
      {"sun-in-sky-1e9", "a texel of radiance 1e9 in a sky of 1: the floor has the sum of both", kOfSkies, sunInSky},
      {"black-sky", "nothing received, or the section left out with a reason", kOfSkies, blackSky},
      {"lobes-128", "a constant sky: lobes of shininess 1 to 1e5 and of any roughness are exact", environment, [](Trial& trial) { lobes(trial, 128, 64); }},
      {"lobes-1-cell", "the same with one cell on the coarsest map", environment, [](Trial& trial) { lobes(trial, 1, 16); }},
      {"lobes-4096-cells", "the same with the most cells there are, on the finest map", environment, [](Trial& trial) { lobes(trial, 4096, 256); }},
  };
}

}  // namespace lightwell::stress
