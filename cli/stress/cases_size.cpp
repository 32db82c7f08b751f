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

template <int size>
void roomOn(Trial& trial) {
  const Component component = componentOf(trial);
  Trial::Setup setup{.component = component};
  setup.settings.lightmap_size = size;
  const Lit lit = trial.light(plainRoom(), setup);
  trial.expectEnergy(lit, Vec3d(10 * kLumenPerCandela), Rgb(0.5f), component, 0.1);
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
      {"atlas-1", "one texel for all: " + sum, kOfLamps, roomOn<1>},
      {"atlas-2", "four texels for all: " + sum, kOfLamps, roomOn<2>},
      {"atlas-8192", "the largest atlas, the room in a corner of it: " + sum, kOfLamps, largeAtlas, true},
  };
}

}  // namespace lightwell::stress
