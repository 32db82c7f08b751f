// lightwell evaluate: what the runtime makes of a container, as an atlas of irradiance.
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/command.h"
#include "cli/dynamic_evaluator.h"
#include "cli/environment_evaluator.h"
#include "cli/irradiance_image.h"
#include "cli/lightmap_evaluator.h"
#include "cli/portal_options.h"
#include "cli/prm_evaluator.h"
#include "cli/radiosity_evaluator.h"
#include "cli/slot_values.h"
#include "cli/vpl_evaluator.h"
#include "cli/vpl_evaluator_gl.h"
#include "format/encode/atomic_file.h"
#include "format/encode/reader.h"
#include "precompute/bake/container_scene.h"
#include "precompute/plan/settings.h"
#include "precompute/scene/import.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;
using transport::Component;

struct Options {
  fs::path container, output;
  std::string technique, evaluator = "cpu", component = "total";
  std::optional<fs::path> lights;
  std::optional<uint32_t> brightest;
  std::optional<uint32_t> injection;
  std::vector<std::string> portals;
  std::optional<fs::path> probes_out;
  std::optional<std::string> dynamic;
  uint32_t dynamic_lights = 256, dynamic_shadows = 32;
  uint32_t samples = 64;
  double cut_error = 0.1;
  std::optional<float> clamp;
  bool no_restore = false, every_texel = false;
  uint32_t shadow_map_size = 256;
  float pieces = 8;
  render::EnvironmentSettings environment;
  int threads = 0;
};

void checkHas(const std::string& section, const Options& options, const format::Reader& reader) {
  if (reader.has(section)) return;
  std::string why;
  if (reader.has("meta", "header")) {
    const auto meta = reader.meta();  // lives as long as the loop over its field
    for (const auto& omitted : meta.omitted())
      if (omitted.type() == section) why = ": " + omitted.reason();
  }
  throw UsageError("--technique " + options.technique + ": " + reader.file() + " has no section " + section + why);
}

/// Direct irradiance from the lights, path-traced (one segment) in the container's own geometry; one value per slot.
std::vector<Rgb> lightOfLamps(Session& session, const Options& options, const bake::ContainerScene& container,
                              const trace::Tracer& tracer) {
  ProgressMeter meter(session.console, "direct light");
  transport::ReferenceOptions reference{.samples = options.samples, .threads = options.threads, .cancel = &session.interrupt.flag()};
  reference.progress = [&](double fraction) { meter.update(fraction); };
  return transport::referenceIrradiance(container.scene, container.atlas, tracer, container.scene.lights, Component::direct, reference)
      .irradiance_rgb;
}

/// PROBES: schemas/probes.schema.json.
void writeProbes(Session& session, const fs::path& file, const scene::Scene& scene, const ProbeLight& light) {
  nlohmann::json probes = nlohmann::json::array();
  for (size_t i = 0; i < light.position_m.size() / 3; ++i) {
    nlohmann::json position = nlohmann::json::array(), radiance_sh = nlohmann::json::array();
    for (size_t k = 0; k < 3; ++k) position.push_back(scene.origin_m[int(k)] + double(light.position_m[i * 3 + k]));
    for (size_t k = 0; k < 9; ++k) {
      const float* rgb = &light.radiance_sh[(i * 9 + k) * 3];
      radiance_sh.push_back({rgb[0], rgb[1], rgb[2]});
    }
    probes.push_back({{"position", position}, {"radiance_sh", radiance_sh}});
  }
  const std::string text = nlohmann::json{{"probes", probes}}.dump() + "\n";
  writeOutput(session, file, [&] { format::writeFileAtomically(file, std::vector<uint8_t>(text.begin(), text.end())); });
  session.console.line(file.string() + ": light of " + std::to_string(probes.size()) + " probes");
}

/// What the section "prm" adds, one value per slot. `sky`: LW_SKY_… bits that it may add.
std::vector<Rgb> lightOfTransport(Session& session, const Options& options, Component component, uint32_t sky, const RuntimeContainer& runtime,
                                  const bake::ContainerScene& container, const trace::Tracer& tracer) {
  PrmEvaluation evaluation{.container = runtime, .scene = container.scene, .tracer = tracer, .lights = {}, .brightest = options.brightest};
  if (component != Component::direct) {
    evaluation.lights = container.scene.lights;
    evaluation.emitters |= LW_EMITTERS_INDIRECT | (sky & LW_SKY_INDIRECT);
  }
  if (component != Component::indirect) evaluation.emitters |= LW_EMITTERS_DIRECT | (sky & LW_SKY_DIRECT);
  session.console.progress("transport", "transport …");
  const std::vector<float> atlas_rgba = options.evaluator == "gl" ? evaluatePrmOnGl(evaluation) : evaluatePrmOnCpu(evaluation);
  if (options.probes_out) {
    const CpuPrm prm(runtime);
    writeProbes(session, *options.probes_out, container.scene,
                prm.evaluateProbes(prm.clusterIrradiance(container.scene, tracer, evaluation.lights), component != Component::indirect));
  }
  return valuesOfSlots(container.atlas, atlas_rgba);
}

/// What the section "radiosity" adds, one value per slot.
std::vector<Rgb> lightOfRadiosity(Session& session, const Options& options, Component component, const RuntimeContainer& runtime,
                                  const bake::ContainerScene& container, const std::vector<float>& portal_open, const trace::Tracer& tracer) {
  session.console.progress("radiosity", "radiosity …");
  RadiosityEvaluation evaluation{.container = runtime, .scene = container, .tracer = tracer, .light = 0, .samples = options.samples,
                                 .portal_open = portal_open, .injection = options.injection, .threads = options.threads, .cancel = &session.interrupt.flag()};
  if (component != Component::direct) evaluation.light |= LW_RADIOSITY_INDIRECT;
  if (component != Component::indirect) evaluation.light |= LW_RADIOSITY_EMITTERS;
  ProbeLight probes;
  if (options.probes_out) evaluation.probes = &probes;
  const std::vector<float> atlas_rgba = options.evaluator == "gl" ? evaluateRadiosityOnGl(evaluation) : evaluateRadiosityOnCpu(evaluation);
  if (options.probes_out) writeProbes(session, *options.probes_out, container.scene, probes);
  return valuesOfSlots(container.atlas, atlas_rgba);
}

/// What the section "lightmap" holds, one value per slot: all of it was baked.
std::vector<Rgb> lightOfLightmap(const Options& options, Component component, const RuntimeContainer& runtime, const bake::ContainerScene& container) {
  uint32_t light = 0;
  if (component != Component::indirect) light |= LW_LIGHTMAP_DIRECT;
  if (component != Component::direct) light |= LW_LIGHTMAP_INDIRECT;
  return valuesOfSlots(container.atlas, options.evaluator == "gl" ? evaluateLightmapOnGl(runtime, light) : evaluateLightmapOnCpu(runtime, light));
}

/// What the section "vpl" adds, one value per slot.
std::vector<Rgb> lightOfVirtualLights(Session& session, const Options& options, Component component, const RuntimeContainer& runtime,
                                      const bake::ContainerScene& container, const trace::Tracer& tracer) {
  VplEvaluated light;
  {
    ProgressMeter meter(session.console, "virtual lights");
    light = evaluateVplOnCpu({.container = runtime, .scene = container, .tracer = tracer, .component = component, .samples = options.samples,
                              .cut_error = options.cut_error, .clamp = options.clamp, .interpolate = !options.every_texel, .restore = !options.no_restore, .threads = options.threads,
                              .cancel = &session.interrupt.flag(), .progress = [&](double fraction) { meter.update(fraction); }});
  }
  char text[200];
  std::snprintf(text, sizeof text, "%u virtual lights, %.0f of them for each point of %zu texels, %.3g rays", light.lights, light.lights_a_point, light.texels, double(light.rays));
  session.console.line(text);
  if (light.removed > 0) {
    std::snprintf(text, sizeof text, "clamped away: %.2f %% of the light; restored: %.2f %%", 100 * light.removed, 100 * light.restored);
    session.console.line(text);
  }
  return light.irradiance_rgb;
}

/// What lightwell_dynamic adds: one reflection of lamps that nothing was baked for.
std::vector<Rgb> lightOfDynamicLamps(const Options& options, Component component, const RuntimeContainer& runtime, const bake::ContainerScene& container) {
  if (component == Component::direct) return std::vector<Rgb>(container.atlas.slots.size(), Rgb(0.0f));  // path-traced, as everywhere
  return valuesOfSlots(container.atlas, evaluateDynamicOnGl({.container = runtime, .scene = container.scene, .incremental = options.dynamic == "iir",
                                                             .lights = options.dynamic_lights, .shadow_side = options.dynamic_shadows}));
}

/// The same as a game draws it.
std::vector<Rgb> lightOfVirtualLightsOnGl(Session& session, const Options& options, Component component, const RuntimeContainer& runtime,
                                          const bake::ContainerScene& container) {
  VplGlResult light;
  {
    ProgressMeter meter(session.console, "virtual lights");
    light = evaluateVplOnGl({.container = runtime, .component = component, .shadow_map_side = options.shadow_map_size, .pieces = options.pieces,
                             .progress = [&](double fraction) { meter.update(fraction); }});
  }
  char text[160];
  std::snprintf(text, sizeof text, "%u virtual lights and parts of them in %.0f ms (%.2f ms each), after %.0f ms of setup", light.lights, light.draw_ms,
                light.lights ? light.draw_ms / light.lights : 0.0, light.setup_ms);
  session.console.line(text);
  return valuesOfSlots(container.atlas, light.atlas_rgba);
}

std::vector<Rgb> lightOfSky(Session& session, const Options& options, const RuntimeContainer& runtime, const bake::ContainerScene& container,
                            const trace::Tracer& tracer) {
  ProgressMeter meter(session.console, "sky");
  const EnvironmentEvaluation evaluation{.container = runtime, .scene = container, .tracer = tracer, .samples = options.samples,
                                         .settings = options.environment, .threads = options.threads, .cancel = &session.interrupt.flag(),
                                         .progress = [&](double fraction) { meter.update(fraction); }};
  return options.evaluator == "gl" ? evaluateEnvironmentOnGl(evaluation) : evaluateEnvironmentOnCpu(evaluation);
}

void run(Session& session, const Options& options) {
  checkWritable(options.output);
  if (options.probes_out) checkWritable(*options.probes_out);
  const bool by_cells = options.technique == "environment", by_patches = options.technique == "radiosity", baked = options.technique == "lightmap";
  const bool by_virtual_lights = options.technique == "vpl";
  if (options.dynamic && (!by_virtual_lights || options.evaluator != "gl")) throw UsageError("--dynamic: only --technique vpl --evaluator gl finds virtual lights of lamps that move");
  if (by_virtual_lights && options.lights && !options.dynamic) throw UsageError("--lights: virtual lights come from the lights that they were baked with; bake --lights bakes others");
  if (baked && options.lights) throw UsageError("--lights: a light map holds the lights that it was baked with; bake --lights bakes others");
  checkReadable(options.container);
  if (options.lights) checkReadable(*options.lights);
  const Component component = componentNamed(options.component);
  const format::Reader reader(options.container);
  if (!options.dynamic) checkHas(options.technique, options, reader);
  else if (options.dynamic_shadows) checkHas("points", options, reader);
  checkHas("geometry", options, reader);
  if (options.probes_out && !by_patches && options.technique != "prm") throw UsageError("--probes-out: only --technique prm and radiosity light probes");
  if (options.probes_out) checkHas(by_patches ? "probes" : "prm_probes", options, reader);
  if (component == Component::indirect && !by_patches && !baked && !by_virtual_lights) checkHas("prm", options, reader);
  Diagnostics diagnostics;
  session.console.progress("open", "open …");
  bake::ContainerScene container = bake::loadContainerScene(reader, diagnostics);
  if (options.lights) scene::replaceLights(container.scene, *options.lights, diagnostics);
  for (const auto& warning : diagnostics.warnings()) session.console.warning(warning);
  const std::vector<PortalState> portals = parsePortalStates(options.portals);
  if (!portals.empty() && !by_patches) throw UsageError("--portal: only --technique radiosity knows of portals; the others have them shut");
  const std::vector<float> portal_open = portalsOpen(portals, container.scene.portals);
  const trace::Tracer tracer(container.scene, options.threads, portal_open);
  session.interrupt.flag().check();

  const RuntimeContainer runtime(options.container);
  if (options.injection && !by_patches) throw UsageError("--injection: only --technique radiosity injects light into patches");
  if (options.brightest && reader.has("prm") && reader.prm().layout() != v1::PRM_LAYOUT_PANES)
    throw UsageError("--brightest: " + reader.file() + " has local bases, which are always summed whole; only panes can be left out");

  const int size = container.atlas.width;
  std::vector<Rgb> irradiance_rgb(container.atlas.slots.size(), Rgb(0.0f));
  const auto add = [&](const std::vector<Rgb>& part_rgb) {
    for (size_t slot = 0; slot < irradiance_rgb.size(); ++slot) irradiance_rgb[slot] += part_rgb[slot];
  };
  if (!baked && component != Component::indirect && !container.scene.lights.empty()) add(lightOfLamps(session, options, container, tracer));
  // Virtual lights hold what of a sky's light has been reflected; straight it comes through its cells.
  if ((by_cells || (by_virtual_lights && reader.has("environment"))) && component != Component::indirect) add(lightOfSky(session, options, runtime, container, tracer));
  const uint32_t sky = by_cells ? LW_SKY_INDIRECT : LW_SKY_INDIRECT | LW_SKY_DIRECT;
  if (baked) add(lightOfLightmap(options, component, runtime, container));
  else if (options.dynamic) add(lightOfDynamicLamps(options, component, runtime, container));
  else if (by_virtual_lights && options.evaluator == "gl") add(lightOfVirtualLightsOnGl(session, options, component, runtime, container));
  else if (by_virtual_lights) add(lightOfVirtualLights(session, options, component, runtime, container, tracer));
  else if (by_patches) add(lightOfRadiosity(session, options, component, runtime, container, portal_open, tracer));
  else if (reader.has("prm")) add(lightOfTransport(session, options, component, sky, runtime, container, tracer));
  const ImageRgba image = imageOfSlots(container.scene.mesh, container.atlas, size, irradiance_rgb);
  writeOutput(session, options.output, [&] { writeExr(options.output, image); });
  session.console.line(options.output.string() + ": " + options.component + " irradiance of " +
                       std::to_string(container.atlas.slots.size()) + " texels");
}

}  // namespace

void addEvaluate(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("evaluate", "What the runtime makes of a container, as an atlas of irradiance");
  command->add_option("container", options->container, "Container to evaluate")->required()->type_name("OUT.lwc");
  addOutput(*command, options->output, "EXR to write: RGB irradiance, A = 1 where a texel is covered (half of it, or a sliver's)");
  command->add_option("--technique", options->technique, "prm: transport of lamps, and what it holds of a sky; lightmap: what was baked for lights that do not move; vpl: their virtual lights, each shadowed by rays on the CPU, by shadow maps on OpenGL; radiosity: form factors, all bounces; environment: the same, but a sky lights straight "
                   "through its cells, shadowed one by one")
      ->required()
      ->type_name("NAME")
      ->check(CLI::IsMember({"prm", "environment", "radiosity", "vpl", "lightmap"}));
  command->add_option("--evaluator", options->evaluator, "cpu, or gl (OpenGL 3.3 without a window)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"cpu", "gl"}))
      ->capture_default_str();
  addComponent(*command, options->component);
  command
      ->add_option("--brightest", options->brightest,
                   "Panes only: sum the K that give most light, scaled to keep the energy of all; 0: all")
      ->type_name("K")
      ->check(CLI::Range(0u, 1u << 20));
  command
      ->add_option("--injection", options->injection,
                   "Radiosity only: lamps' light on the patches as a game finds it, from pictures of patch numbers with N x N pixels (each of six faces of a point light), "
                   "instead of from rays")
      ->type_name("N")
      ->check(CLI::Range(8u, 4096u));
  command->add_option("--probes-out", options->probes_out, "With prm or radiosity: write what the container's probes receive as spherical harmonics (schemas/probes.schema.json)")
      ->type_name("FILE.json");
  addPortalStates(*command, options->portals, "Radiosity only: how far the portal of that name is open");
  addLights(*command, options->lights);
  command->add_option("--samples", options->samples, "Points of each texel at which light of lamps and cells is sampled")
      ->type_name("N")
      ->check(CLI::Range(1u, 1u << 20))
      ->capture_default_str();
  command
      ->add_option("--cut-error", options->cut_error,
                   "Virtual lights on the CPU only: what a group of them that is looked at through one may be wrong by at most, of a texel's irradiance; 0: each light for itself")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--clamp", options->clamp,
                   "Virtual points on the CPU only: the most irradiance that a lumen gives, 1/m²; 0: no clamp; default: what it gives at most if the point is as large as its share of "
                   "all surfaces")
      ->type_name("MOST")
      ->check(CLI::Range(0.0f, 1e12f));
  command->add_flag("--every-texel", options->every_texel, "Virtual lights on the CPU only: interpolate no texel from those around it, however smooth the light is");
  command->add_flag("--no-restore", options->no_restore, "Virtual points on the CPU only: do not restore the light that the clamp takes away");
  command->add_option("--dynamic", options->dynamic, "With vpl on OpenGL: one reflection of lamps that nothing was baked for (--lights), by virtual lights drawn by flux from reflective shadow maps (rsm), or "
                      "kept from frame to frame (iir)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"rsm", "iir"}));
  command->add_option("--dynamic-lights", options->dynamic_lights, "With --dynamic: virtual lights of each lamp")->type_name("N")->check(CLI::Range(16u, 1024u))->capture_default_str();
  command->add_option("--dynamic-shadows", options->dynamic_shadows, "With --dynamic: texels along a virtual light's shadow map, a power of two; 0: no shadows (bake --points is not needed then)")
      ->type_name("N")
      ->check(CLI::IsMember(std::set<uint32_t>{0, 8, 16, 32, 64, 128}))
      ->capture_default_str();
  command->add_option("--shadow-map-size", options->shadow_map_size, "Virtual lights on OpenGL only: pixels along the middle face of each light's half cube of depths, even; 0: no shadows")
      ->type_name("N")
      ->check(CLI::Range(0u, 2048u))
      ->capture_default_str();
  command->add_option("--pieces", options->pieces, "Virtual lights on OpenGL only: large polygons are cut until there are so many pieces for each light on average, each with a shadow map of its own")
      ->type_name("F")
      ->check(CLI::Range(1.0f, 16.0f))
      ->capture_default_str();
  addEnvironmentLight(*command, options->environment);
  addThreads(*command, options->threads);
  command->footer(R"(Only the container is needed: shadows are ray-traced in its geometry, also for gl, except those of a sky's cells: these are rays on the CPU
and depth maps on OpenGL, where --environment-technique and the rest apply.

Examples:
  lightwell evaluate room.lwc --technique prm --evaluator cpu --component indirect -o indirect.exr
  lightwell evaluate room.lwc --technique prm --evaluator gl --component total --lights lamps.json -o total.exr
  lightwell evaluate room.lwc --technique vpl --evaluator gl --dynamic iir --component indirect --lights lamps.json -o first_bounce.exr)");
  command->callback([&session, options, command] {
    for (const char* option : {"--environment-technique", "--environment-cells", "--environment-map-size", "--environment-sun-map-size"})
      if (command->count(option) > 0 && (options->technique != "environment" || options->evaluator != "gl"))
        throw UsageError(std::string(option) + ": only --technique environment --evaluator gl draws a sky's shadows in maps");
    for (const char* option : {"--cut-error", "--clamp", "--every-texel", "--no-restore"})
      if (command->count(option) > 0 && (options->technique != "vpl" || options->evaluator != "cpu"))
        throw UsageError(std::string(option) + ": only --technique vpl --evaluator cpu picks and clamps virtual lights");
    for (const char* option : {"--shadow-map-size", "--pieces"})
      if (command->count(option) > 0 && (options->technique != "vpl" || options->evaluator != "gl"))
        throw UsageError(std::string(option) + ": only --technique vpl --evaluator gl draws shadow maps of virtual lights");
    run(session, *options);
  });
}

}  // namespace lightwell::cli
