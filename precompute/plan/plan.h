// What a bake of this scene contains, and what it leaves out and why.
#pragma once
#include <string>
#include <vector>

#include "precompute/plan/settings.h"

namespace lightwell::plan {

/// What the decision depends on.
struct SceneFacts {
  bool has_scene = true;       // not only a sky
  bool has_surfaces = false;   // at least one texel of the atlas is covered
  bool has_emitters = false;   // some texel emits
  bool has_lamps = false;      // punctual lights
  bool has_reflection = false; // some texel's albedo is not black
  bool has_portals = false;    // doors or shutters
  bool sees_sky = true;        // some ray from the surfaces ends on no other
  uint32_t probing_rays = 0;   // that sees_sky was decided by
  bool has_environment = false; // a map was given
  bool has_sky_light = false;   // and it is not black
};

struct Omitted {
  std::string type;            // of a section, or a part of one: "prm.emitter"
  std::string reason;          // a sentence fragment for people
  uint64_t decoded_bytes = 0;  // that it would have had, where that is known
  uint64_t rays = 0;           // that it would have cost, about
};

struct Plan {
  bool atlas = false;
  bool geometry = false;
  bool prm = false;
  bool prm_emitter = false;       // the constant panes of the scene's own emitters
  bool prm_sky = false;           // the constant panes of the sky
  bool prm_probes = false;        // for moving objects, at points that were asked for
  bool lightmap = false;
  bool vpl = false;
  bool points = false;            // on surfaces, for shadow maps of lights that move
  bool radiosity = false;
  bool probes = false;            // for moving objects, lit by the patches of radiosity
  bool environment = false;
  std::vector<Omitted> omitted;
};

/// Throws UsageError for choices of the section prm that exclude each other.
void checkPrm(const Settings& settings);

/// Throws UsageError for a density that no light map can be divided by, and for probes without radiosity.
void checkRadiosity(const Settings& settings);
/// Throws UsageError for a directional light map without --techniques lightmap.
void checkLightmap(const Settings& settings);
/// Throws UsageError for virtual lights without --techniques vpl.
void checkVirtualLights(const Settings& settings);
/// Throws UsageError for lights that no file or scene gives places to, and for sections that need surfaces to draw.
void checkMovingLights(const Settings& settings);
/// Throws UsageError for numbers of samples and cells that no environment can have.
void checkEnvironment(const Settings& settings);

/// Pure. Throws as the checks.
Plan makePlan(const SceneFacts& facts, const Settings& settings);

}  // namespace lightwell::plan
