// Nothing, one, and as much as there may be.
#include "cli/stress/cases.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

Component componentOf(const Trial& trial) { return trial.is(Technique::lightmap) ? Component::total : Component::indirect; }

void noSurfaces(Trial& trial) {
  GltfDocument nothing;
  nothing.lamp({.position_m = {0, 1, 0}, .intensity = 10});
  Lit lit;
  const GltfDocument* scene = &nothing;
  trial.bench().bake({.scene = scene, .technique = trial.technique(), .settings = Trial::plainSettings()}, &lit);
  trial.expect("sound container", lit.unsound.empty(), "no issue", lit.unsound.empty() ? "none" : lit.unsound.front());
  trial.expectSection(lit, false);
  trial.expectWarning(lit, "no surfaces");
}

/// A tile alone on one texel, under a sun: exact straight, and nothing returns.
void oneTexel(Trial& trial) {
  GltfDocument tile;
  tile.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, tile.material({}));
  tile.lamp({.directional = true, .direction = {0, -1, 0}, .intensity = 100});
  const Component component = componentOf(trial);
  Trial::Setup setup{.component = component};
  setup.settings.lightmap_size = 1;
  const Lit lit = trial.light(tile, setup);
  if (trial.is(Technique::lightmap)) trial.expectNear("irradiance", lit.meanLuminance(), 100, 1e-3);
  else trial.expectAtMost("received lumen", lit.flux_rgb().x, 0);
}

/// The least size is named, and will do.
void tooSmall(Trial& trial) {
  Trial::Setup setup{.component = componentOf(trial)};
  setup.settings.lightmap_size = 2;
  std::string reason;
  const GltfDocument room = plainRoom();
  try {
    trial.bench().bake({.scene = &room, .technique = trial.technique(), .settings = setup.settings});
  } catch (const UsageError& error) {
    reason = error.what();
  } catch (const InputError& error) {
    reason = error.what();
  }
  const std::string words = "the smallest size that would do is ";
  const size_t at = reason.find(words);
  trial.expect("refusal", at != std::string::npos, "names " + words.substr(0, words.size() - 4), reason.empty() ? "none" : reason.substr(reason.rfind('/') + 1));
  if (at == std::string::npos) return;
  setup.settings.lightmap_size = std::stoi(reason.substr(at + words.size()));
  const Lit lit = trial.light(room, setup);
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0.5f), setup.component, 0.15);
}

/// The room keeps to a corner of the atlas; the rest of it is empty.
void largeAtlas(Trial& trial) {
  GltfDocument room = plainRoom();
  room.layOut(1.0 / 64);
  const Component component = componentOf(trial);
  Trial::Setup setup{.component = component, .most_work = 60};
  setup.settings.lightmap_size = plan::kMostLightmapSize;
  const Lit lit = trial.light(room, setup);
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0.5f), component, 0.05);
}

}  // namespace

std::vector<Case> sizeCases() {
  const std::string sum = "all surfaces together absorb what the lamp gives";
  return {
      {"no-surfaces", "a lamp and nothing else: a sound container, sections left out with a reason", kOfLamps, noSurfaces},
      {"one-texel", "a tile alone under a sun: exact straight, nothing returns", kOfLamps, oneTexel},
      {"too-small-atlas", "refused, naming the smallest size that will do; in that, " + sum, kOfLamps, tooSmall},
      {"atlas-8192", "the largest atlas, the room in a corner of it: " + sum, kOfLamps, largeAtlas, true},
  };
}

}  // namespace lightwell::stress
