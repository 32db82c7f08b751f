// Rooms that reflect nearly all light, or none, or of one colour alone: the sum of all bounces is known.
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

/// A light map has the lamps' light, too.
Component componentOf(const Trial& trial) { return trial.is(Technique::lightmap) ? Component::total : Component::indirect; }

void lampIn(Trial& trial, const Rgb& albedo_rgb, double tolerance) {
  const Component component = componentOf(trial);
  const Lit lit = trial.light(plainRoom({.albedo_rgb = albedo_rgb}), {.component = component});
  trial.expectSection(lit, true);
  // A draft has 200 virtual lights, and of paths that hardly end some hundred: both go where most luminance is.
  const bool noisy = trial.is(Technique::vpl) && maxComponent(albedo_rgb) > 0.95f;
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), albedo_rgb, component, noisy ? 5 * tolerance : tolerance);
}

/// All walls shine: the same everywhere.
void furnace(Trial& trial, float albedo, double tolerance) {
  constexpr double kOfTexel = 0.16;  // a draft's noise
  const Lit lit = trial.light(plainRoom({.albedo_rgb = Rgb(albedo), .emitted_radiance_rgb = Rgb(1)}, 0), {.component = Component::total});
  const double expected = std::numbers::pi / (1 - double(albedo));
  trial.expectNear("mean irradiance", lit.meanLuminance(), expected, tolerance);
  trial.expectAtMost("greatest irradiance", lit.mostLuminance(), expected * (1 + kOfTexel));
  double least = HUGE_VAL;
  for (const Rgb& rgb : lit.irradiance_rgb) least = std::min(least, double(luminance(rgb)));
  trial.expect("least irradiance", least >= expected * (1 - kOfTexel), "at least " + std::to_string(expected * (1 - kOfTexel)), std::to_string(least));
}

/// Light has to find its way from one end to the other.
void corridor(Trial& trial) {
  Trial::Setup setup{.component = componentOf(trial)};
  setup.settings.lightmap_size = 128;  // texels of half a metre
  constexpr float kAlbedo = 0.9f;
  GltfDocument scene;
  scene.box({-1, -1.5, -40}, {1, 1.5, 40}, scene.material({.albedo_rgb = Rgb(kAlbedo)}), true);
  scene.lamp({.position_m = {0.25f, 0.5f, -39}, .intensity = 10});
  const Lit lit = trial.light(scene, setup);
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(kAlbedo), setup.component, 0.05);
  const auto nearEnd = [&](bool lit_end) {
    return lit.meanLuminance([&](const atlas::Slot& slot) {
      const double z_m = double(slot.position.z) * lit.metres_per_unit;
      return lit_end ? z_m < -30 : z_m > 30;
    });
  };
  const double dark = nearEnd(false), bright = nearEnd(true);
  // Far from the lamp light falls as that of diffusion does: by more than a decade in 60 m, and not to nothing.
  trial.expect("light at the dark end", dark > 0 && dark < 0.1 * bright, "more than none, less than " + std::to_string(0.1 * bright), std::to_string(dark));
}

}  // namespace

std::vector<Case> reflectionCases() {
  const std::string sum = "all surfaces together absorb what the lamp gives";
  return {
      {"albedo-0", "nothing reflected: no indirect light, the lamp's own exact", kOfLamps,
       [](Trial& trial) {
         const Component component = componentOf(trial);
         const Lit lit = trial.light(plainRoom({.albedo_rgb = Rgb(0)}), {.component = component});
         if (trial.is(Technique::lightmap)) trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0), component, 0.01);
         else if (trial.is(Technique::radiosity)) trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);
         else trial.expectSection(lit, false);
       }},
      {"albedo-0.5", sum, kOfLamps, [](Trial& trial) { lampIn(trial, Rgb(0.5f), 0.02); }},
      {"albedo-0.9", sum, kOfLamps, [](Trial& trial) { lampIn(trial, Rgb(0.9f), 0.02); }},
      {"albedo-0.999", sum + " after 1,000 bounces on the mean", kOfLamps, [](Trial& trial) { lampIn(trial, Rgb(0.999f), 0.05); }},
      {"albedo-0.998", sum + " after 500 bounces on the mean", kOfLamps, [](Trial& trial) { lampIn(trial, Rgb(0.998f), 0.05); }},
      {"albedo-1e-6", sum, kOfLamps, [](Trial& trial) { lampIn(trial, Rgb(1e-6f), 0.05); }},
      {"albedo-coloured", sum + ", in each channel: 0.99, 0.5, 0.01", kOfLamps, [](Trial& trial) { lampIn(trial, {0.99f, 0.5f, 0.01f}, 0.05); }},
      {"furnace-0.5", "walls that all shine have π / (1 − albedo) everywhere", kOfLamps, [](Trial& trial) { furnace(trial, 0.5f, 0.02); }},
      {"furnace-0.999", "walls that all shine have π / (1 − albedo) everywhere", kOfLamps, [](Trial& trial) { furnace(trial, 0.999f, 0.05); }},
      {"corridor", "80 m long, 2 m wide, albedo 0.9, a lamp at one end: " + sum, kOfLamps, corridor},
  };
}

}  // namespace lightwell::stress
