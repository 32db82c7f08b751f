#include "cli/bake_options.h"

#include <algorithm>

#include <charconv>
#include <cstdio>

#include "cli/command.h"
#include "precompute/plan/light_paths.h"
#include "precompute/plan/probe_points.h"
#include "precompute/plan/texel_density.h"
#include "precompute/scene/import.h"

namespace lightwell::cli {

void addBakeOptions(CLI::App& command, BakeOptions& options) {
  command.add_option("scene", options.request.source.scene, "glTF 2.0 scene, .glb or .gltf; may be left out when only a sky is baked")
      ->type_name("SCENE");
  command
      .add_option("--techniques", options.techniques, "What to bake: auto (what the scene can use), or a comma-separated list of prm, lightmap, vpl, radiosity, environment")
      ->type_name("LIST")
      ->capture_default_str();
  addSceneSettings(command, options.request.settings);
  command
      .add_flag("--lightmap-size-by-error", options.lightmap_size_by_error,
                "Choose --lightmap-size: the smallest power of two at which indirect light varies inside of texels by at most --target-error, about, as rays tell from how near surfaces are to one another")
      ->excludes("--lightmap-size");
  command.add_option("--quality", options.quality, "draft (seconds), preview, or production")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::qualityNames()))
      ->capture_default_str();
  command
      .add_option("--time-limit", options.request.time_limit_s,
                   "Seconds: keep the best quality, up to --quality, that is done in time; a draft always is")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1e7));
  command.add_option("--target-error", options.request.target_error, "Refine until the measured relrmse is at most this: 0.05 is 5 %")
      ->type_name("E")
      ->check(CLI::Range(1e-4, 10.0));
  command.add_option("--size-limit", options.request.size_limit_bytes, "Coarsen until the container has at most so many bytes")
      ->type_name("BYTES")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 50));
  addLights(command, options.request.source.lights);
  command
      .add_option("--moving-lights", options.moving_lights,
                  "Which lights the game moves or changes: anywhere, ceilings (lamps under them), sun, lamps (those of the scene, where they are), none (then auto bakes a light map), or a "
                  "file of places and paths {\"paths\": [[[x, y, z], ...], ...]}, metres in the scene's own coordinates. Bases fit these best; others still keep their energy")
      ->type_name("NAME|PATHS.json")
      ->capture_default_str();
  command.add_flag("--no-geometry", options.no_geometry, "Leave out the surfaces, for a game that has its own to draw and to cast shadows; evaluate and render need them");
  command.add_flag("--keep-all", options.request.settings.keep_all, "Bake what the plan finds no use for, too: the sky of a closed room");
  command.add_option("--prm-layout", options.prm_layout, "Form of the section prm: local-bases, or the paper's panes, one per cluster")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::prmLayoutNames()))
      ->capture_default_str();
  command.add_option("--prm-estimator", options.prm_estimator,
                      "How panes are estimated: gather (at the texels) or walks (the paper's, from the entry points)")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::prmEstimatorNames()))
      ->capture_default_str();
  command
      .add_option("--prm-entries", options.request.settings.prm_entries,
                   "Entry points in all clusters together, about; without it the quality decides")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostPrmEntries));
  command.add_option("--prm-clusters", options.request.settings.prm_clusters, "Clusters of entry points, about; without it the quality decides")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostPrmClusters));
  command
      .add_option("--radiosity-density", options.request.settings.radiosity_density,
                  "Patches of the section radiosity per light-map texel along a side, 1/64 to 1, rounded to a power of two; without it patches are small where "
                  "things are near each other and large elsewhere")
      ->type_name("D")
      ->check(CLI::Range(plan::kLeastRadiosityDensity, 1.0f));
  command.add_flag("--directional", options.request.settings.directional, "With lightmap: how light changes with the normal too, for normal-mapped surfaces");
  command.add_option("--virtual-light", options.virtual_light, "With vpl: what virtual lights are; auto: by expected error, each of them")
      ->type_name("NAME")
      ->check(CLI::IsMember(plan::virtualLightShapeNames()))
      ->capture_default_str();
  command.add_option("--virtual-lights", options.request.settings.virtual_lights, "With vpl: virtual lights, about; without it the quality decides")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostVirtualLights));
  command.add_option("--virtual-bounces", options.request.settings.virtual_bounces, "With vpl: leave out light that was reflected more often; without it all of it counts")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostVirtualBounces));
  command
      .add_option("--points", options.request.settings.points,
                  "Points on surfaces, for shadow maps of lights that move (docs/many-lights.md): 16384 suit a room; 0: none")
      ->type_name("N")
      ->check(CLI::Range(0u, plan::kMostPoints));
  command
      .add_option("--probe-spacing", options.probe_spacing,
                  "With radiosity: a lattice of probes for moving objects, METRES apart; auto: by the scene's size (up to 2,000 at production, 1,000, 500); 0: none")
      ->type_name("METRES|auto")
      ->capture_default_str();
  command.add_option("--probes", options.probes, "With prm or radiosity: probes for moving objects, at the points of {\"probes\": [[x, y, z], ...]}, metres in the scene's own coordinates")
      ->type_name("PROBES.json");
  command
      .add_option("--portal", options.request.settings.portals,
                  "Node that is a door or a shutter, shut in the file, besides those that its extras mark; may be repeated, and NAME may end in * (docs/radiosity.md)")
      ->type_name("NAME")
      ->allow_extra_args(false);
  addEnvironment(command, options.request.source.environment, options.request.settings.environment);
  command
      .add_option("--environment-samples", options.request.settings.environment_samples,
                  "Cells that the sky is cut into, suns included: so many shadowed directional lights")
      ->type_name("N")
      ->check(CLI::Range(1u, plan::kMostEnvironmentSamples))
      ->capture_default_str();
  command
      .add_option("--environment-resolution", options.request.settings.sky_face_cells,
                  "Cells along a face of the sky's cube, even: 64 resolves lobes of shininess up to 1,300, 128 up to 5,400")
      ->type_name("M")
      ->check(CLI::Range(plan::kFewestSkyFaceCells, plan::kMostSkyFaceCells))
      ->capture_default_str();
  addThreads(command, options.request.threads);
}

namespace {

float probeSpacing(const std::string& text) {
  if (text == "auto") return plan::kAutomaticProbeSpacing;
  float spacing = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), spacing);
  if (error != std::errc() || end != text.data() + text.size() || !(spacing >= 0 && spacing <= plan::kMostProbeSpacing_m))
    throw UsageError("--probe-spacing: \"" + text + "\" is neither auto nor a number of metres from 0 to 1e6");
  return spacing;
}

}  // namespace

void resolve(BakeOptions& options) {
  plan::Settings& settings = options.request.settings;
  settings.techniques = plan::parseTechniques(options.techniques);
  std::sort(settings.portals.begin(), settings.portals.end());
  settings.portals.erase(std::unique(settings.portals.begin(), settings.portals.end()), settings.portals.end());
  settings.quality = *plan::qualityNamed(options.quality);
  settings.prm_layout = *plan::prmLayoutNamed(options.prm_layout);
  settings.geometry = !options.no_geometry;
  if (const auto named = plan::movingLightsNamed(options.moving_lights)) {
    settings.moving_lights = *named;
  } else {
    checkReadable(options.moving_lights);
    settings.moving_lights = plan::MovingLights::paths;
    settings.light_paths_m = plan::readLightPaths(options.moving_lights);
  }
  settings.virtual_light = *plan::virtualLightShapeNamed(options.virtual_light);
  settings.prm_estimator = *plan::prmEstimatorNamed(options.prm_estimator);
  settings.probe_spacing_m = probeSpacing(options.probe_spacing);
  if (options.probes) {
    checkReadable(*options.probes);
    settings.probe_points_m = plan::readProbePoints(*options.probes);
  }
  if (options.lightmap_size_by_error && options.request.source.scene.empty()) throw UsageError("--lightmap-size-by-error: there is no scene");
  if (options.lightmap_size_by_error && !options.request.target_error) throw UsageError("--lightmap-size-by-error: which error? --target-error says it");
  plan::checkPrm(settings);
  plan::checkRadiosity(settings);
  plan::checkLightmap(settings);
  plan::checkVirtualLights(settings);
  plan::checkMovingLights(settings);
  plan::checkEnvironment(settings);
  const bake::SceneSource& source = options.request.source;
  bake::checkSource(source, settings);
  if (!source.scene.empty()) checkReadable(source.scene);
  if (source.lights) checkReadable(*source.lights);
  if (source.environment) checkReadable(*source.environment);
}

void chooseLightmapSize(Session& session, BakeOptions& options) {
  const bake::SceneSource& source = options.request.source;
  if (!options.lightmap_size_by_error) return;
  plan::Settings& settings = options.request.settings;
  session.console.progress("texels", "size of texels …");
  Diagnostics told_by_the_bake;
  const scene::Scene scene = scene::importGltf(source.scene, {.light_units = settings.light_units, .portals = settings.portals}, told_by_the_bake);
  const double target = *options.request.target_error;
  const plan::ChosenSize chosen = plan::chooseLightmapSize(scene, target, settings.seed, options.request.threads, &session.interrupt.flag());
  settings.lightmap_size = chosen.size;
  char text[160];
  std::snprintf(text, sizeof text, "light map of %d x %d texels: inside of them indirect light varies by %.2g %% on the mean, at most", chosen.size, chosen.size, 100 * chosen.variation);
  session.console.line(text);
  if (chosen.variation > target)
    session.console.warning({"", "no light map of up to " + std::to_string(plan::kMostChosenSize) + " x " + std::to_string(plan::kMostChosenSize) + " texels keeps that below --target-error; --lightmap-size makes larger ones"});
}

}  // namespace lightwell::cli
