#include "precompute/plan/plan.h"

#include <algorithm>

namespace lightwell::plan {
namespace {

/// Why a technique that can be baked has no use here; empty when it has one.
std::string uselessness(Technique technique, const SceneFacts& facts) {
  if (technique == Technique::environment) {
    if (!facts.has_environment) return "no environment map was given";
    if (!facts.has_sky_light) return "the environment map is black";
    return "";
  }
  if (!facts.has_scene) return "no scene was given";
  if (!facts.has_surfaces) return "the scene has no surfaces";
  if (technique == Technique::radiosity) return "";  // what neither reflects nor emits may do so later
  if (technique == Technique::lightmap) return facts.has_lamps || facts.has_emitters || facts.has_sky_light ? "" : "nothing shines: no lamp, no emitter, no sky";
  if (technique == Technique::vpl) {
    if (!facts.has_lamps && !facts.has_emitters && !facts.has_sky_light) return "nothing shines: no lamp, no emitter, no sky";
    return facts.has_reflection || facts.has_emitters ? "" : "no surface reflects or emits light";
  }
  if (!facts.has_reflection && !facts.has_emitters && !facts.has_sky_light) return "no surface reflects or emits light";
  return "";
}

bool& chosen(Plan& plan, Technique technique) {
  switch (technique) {
    case Technique::lightmap: return plan.lightmap;
    case Technique::vpl: return plan.vpl;
    case Technique::radiosity: return plan.radiosity;
    case Technique::environment: return plan.environment;
    default: return plan.prm;
  }
}

bool wantsProbes(const Settings& settings) { return settings.probe_spacing_m != 0 || !settings.probe_points_m.empty(); }

bool wants(const Settings& settings, Technique technique) {
  return std::find(settings.techniques.begin(), settings.techniques.end(), technique) != settings.techniques.end();
}

/// Why nothing of the sky can be seen in the scene; empty when something is, or when the plan may not leave anything out.
std::string shutOff(const SceneFacts& facts, const Settings& settings) {
  if (facts.sees_sky || settings.keep_all || !facts.has_surfaces) return "";
  return "no surface sees the sky: " + std::to_string(facts.probing_rays) + " rays from the surfaces all ended on others";
}

}  // namespace

void checkPrm(const Settings& settings) {
  const bool panes = settings.prm_layout == PrmLayout::panes;
  if (settings.prm_estimator == PrmEstimator::walks && !panes)
    throw UsageError("--prm-estimator walks: only --prm-layout panes can be estimated by walks");
  if (panes && settings.prm_clusters > kMostPrmPanes)
    throw UsageError("--prm-clusters: at most " + std::to_string(kMostPrmPanes) + " clusters can have a pane each");
  if (panes && !settings.probe_points_m.empty() && !wants(settings, Technique::radiosity)) throw UsageError("--probes: panes light no probes: --prm-layout local-bases");
  if (settings.prm_entries && settings.prm_entries < settings.prm_clusters)
    throw UsageError("--prm-entries: " + std::to_string(settings.prm_entries) + " entry points are too few for " +
                     std::to_string(settings.prm_clusters) + " clusters");
}

void checkRadiosity(const Settings& settings) {
  if (settings.radiosity_density != 0 && !(settings.radiosity_density >= kLeastRadiosityDensity && settings.radiosity_density <= 1))
    throw UsageError("--radiosity-density: from 1/64 to 1 patch per light-map texel along a side");
  const bool radiosity = wants(settings, Technique::radiosity);
  if (settings.probe_spacing_m != 0 && !radiosity) throw UsageError("--probe-spacing: a lattice of probes is lit by radiosity: --techniques radiosity");
  if (!settings.probe_points_m.empty() && !settings.techniques.empty() && !radiosity && !wants(settings, Technique::prm))
    throw UsageError("--probes: probes are lit by prm or radiosity: --techniques prm");
}

void checkLightmap(const Settings& settings) {
  if (settings.directional && std::find(settings.techniques.begin(), settings.techniques.end(), Technique::lightmap) == settings.techniques.end())
    throw UsageError("--directional: light maps are baked with --techniques lightmap");
}

void checkVirtualLights(const Settings& settings) {
  const char* asked = settings.virtual_lights != 0 ? "--virtual-lights" : settings.virtual_bounces != 0 ? "--virtual-bounces"
                      : settings.virtual_light != VirtualLightShape::automatic ? "--virtual-light" : nullptr;
  if (asked && std::find(settings.techniques.begin(), settings.techniques.end(), Technique::vpl) == settings.techniques.end())
    throw UsageError(std::string(asked) + ": virtual lights are baked with --techniques vpl");
}

void checkMovingLights(const Settings& settings) {
  if (settings.moving_lights == MovingLights::paths && settings.light_paths_m.empty()) throw UsageError("--moving-lights: paths come from a file: --moving-lights PATHS.json");
  if (!settings.geometry && wants(settings, Technique::vpl)) throw UsageError("--no-geometry: virtual lights cast shadows from it: --techniques vpl needs it");
}

void checkEnvironment(const Settings& settings) {
  if (settings.environment_samples < 1 || settings.environment_samples > kMostEnvironmentSamples)
    throw UsageError("--environment-samples: an environment takes 1 to " + std::to_string(kMostEnvironmentSamples) + " samples");
  if (settings.sky_face_cells < kFewestSkyFaceCells || settings.sky_face_cells > kMostSkyFaceCells || settings.sky_face_cells % 2 != 0)
    throw UsageError("--environment-resolution: a face of the sky takes an even number of cells from " +
                     std::to_string(kFewestSkyFaceCells) + " to " + std::to_string(kMostSkyFaceCells));
}

Plan makePlan(const SceneFacts& facts, const Settings& settings) {
  checkPrm(settings);
  checkRadiosity(settings);
  checkLightmap(settings);
  checkVirtualLights(settings);
  checkMovingLights(settings);
  checkEnvironment(settings);
  const bool automatic = settings.techniques.empty(), nothing_moves = settings.moving_lights == MovingLights::none;
  const std::string shut_off = shutOff(facts, settings);
  Plan plan;
  plan.atlas = facts.has_surfaces;
  plan.geometry = facts.has_surfaces && settings.geometry;
  if (!facts.has_scene) plan.omitted.push_back({"scene", "no scene was given"});
  const char* no_surfaces = facts.has_scene ? "the scene has no surfaces" : "no scene was given";
  if (!plan.geometry) plan.omitted.push_back({"geometry", facts.has_surfaces ? "not asked for: the game has its own" : no_surfaces});
  if (!plan.atlas) plan.omitted.push_back({"atlas", no_surfaces});
  for (int i = 0; i <= int(Technique::environment); ++i) {
    const auto technique = Technique(i);
    const std::string type(name(technique)), useless = uselessness(technique, facts);
    if (!automatic && !wants(settings, technique))
      plan.omitted.push_back({type, "not asked for"});
    else if (!useless.empty())
      plan.omitted.push_back({type, useless});
    else if (automatic && technique == Technique::environment && !shut_off.empty())
      plan.omitted.push_back({type, shut_off});
    else if (automatic && technique == Technique::radiosity && !facts.has_portals)
      plan.omitted.push_back({type, "not asked for: without doors, and as long as albedo and emission stay, the other sections have the scene's light"});
    else if (automatic && technique == Technique::prm && nothing_moves)
      plan.omitted.push_back({type, "no light moves: section lightmap has the light of those that there are"});
    else if (automatic && technique == Technique::lightmap && !nothing_moves)
      plan.omitted.push_back({type, "not asked for: section prm has the light of lamps that may move"});
    else if (automatic && technique == Technique::vpl)
      plan.omitted.push_back({type, std::string("not asked for: section ") + (nothing_moves ? "lightmap has the light of lamps that stay" : "prm has the light of lamps that may move")});
    else
      chosen(plan, technique) = true;
  }
  plan.probes = plan.radiosity && wantsProbes(settings);
  if (plan.radiosity && !plan.probes) plan.omitted.push_back({"probes", "not asked for: what moves in the scene is the game's to know"});
  plan.prm_probes = plan.prm && settings.prm_layout == PrmLayout::local_bases && !settings.probe_points_m.empty();
  if (plan.prm && !plan.prm_probes)
    plan.omitted.push_back({"prm_probes", settings.probe_points_m.empty() ? "not asked for: what moves in the scene is the game's to know" : "panes light no probes"});
  plan.points = settings.points > 0 && facts.has_surfaces;
  if (!plan.points) plan.omitted.push_back({"points", settings.points == 0 ? "not asked for" : facts.has_scene ? "the scene has no surfaces" : "no scene was given"});
  plan.prm_emitter = plan.prm && facts.has_emitters;
  plan.prm_sky = plan.prm && facts.has_sky_light && shut_off.empty();
  if (plan.prm && !facts.has_emitters) plan.omitted.push_back({"prm.emitter", "no surface emits light"});
  if (plan.prm && !plan.prm_sky)
    plan.omitted.push_back({"prm.sky", facts.has_sky_light ? shut_off : facts.has_environment ? "the environment map is black" : "no environment map was given"});
  return plan;
}

}  // namespace lightwell::plan
