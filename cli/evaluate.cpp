// lightwell evaluate: what the runtime makes of a container, as an atlas of irradiance.
#include <memory>

#include "cli/command.h"
#include "cli/irradiance_image.h"
#include "cli/prm_evaluator.h"
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
  uint32_t samples = 64;
  int threads = 0;
};

void checkHasPrm(const format::Reader& reader) {
  if (reader.has("prm")) return;
  std::string why;
  if (reader.has("meta", "header")) {
    const auto meta = reader.meta();  // lives as long as the loop over its field
    for (const auto& omitted : meta.omitted())
      if (omitted.type() == "prm") why = ": " + omitted.reason();
  }
  throw UsageError("--technique prm: " + reader.file() + " has no section prm" + why);
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

void run(Session& session, const Options& options) {
  checkWritable(options.output);
  if (options.technique != "prm")
    throw UsageError("--technique: this version cannot evaluate \"" + options.technique + "\" yet; it evaluates prm");
  checkReadable(options.container);
  if (options.lights) checkReadable(*options.lights);
  const format::Reader reader(options.container);
  checkHasPrm(reader);
  Diagnostics diagnostics;
  session.console.progress("open", "open …");
  bake::ContainerScene container = bake::loadContainerScene(reader, diagnostics);
  if (options.lights) scene::replaceLights(container.scene, *options.lights, diagnostics);
  for (const auto& warning : diagnostics.warnings()) session.console.warning(warning);
  const trace::Tracer tracer(container.scene, options.threads);
  session.interrupt.flag().check();

  const Component component = componentNamed(options.component);
  const RuntimeContainer runtime(options.container);
  if (options.brightest && reader.prm().layout() != v1::PRM_LAYOUT_PANES)
    throw UsageError("--brightest: " + reader.file() + " has local bases, which are always summed whole; only panes can be left out");
  PrmEvaluation evaluation{.container = runtime, .scene = container.scene, .tracer = tracer, .lights = {}, .brightest = options.brightest};
  if (component != Component::direct) {
    evaluation.lights = container.scene.lights;
    evaluation.emitters |= LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT;
  }
  if (component != Component::indirect) evaluation.emitters |= LW_EMITTERS_DIRECT | LW_SKY_DIRECT;
  session.console.progress("transport", "transport …");
  const std::vector<float> atlas_rgba = options.evaluator == "gl" ? evaluatePrmOnGl(evaluation) : evaluatePrmOnCpu(evaluation);

  const int size = container.atlas.width;
  std::vector<Rgb> irradiance_rgb(container.atlas.slots.size(), Rgb(0.0f));
  if (component != Component::indirect && !container.scene.lights.empty()) irradiance_rgb = lightOfLamps(session, options, container, tracer);
  for (size_t slot = 0; slot < irradiance_rgb.size(); ++slot)
    for (int i = 0; i < 3; ++i) irradiance_rgb[slot][i] += atlas_rgba[size_t(container.atlas.slots[slot].texel) * 4 + i];
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
  command->add_option("--technique", options->technique, "Section to evaluate; now: prm")
      ->required()
      ->type_name("NAME")
      ->check(CLI::IsMember({"prm", "radiosity", "vpl", "lightmap"}));
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
  addLights(*command, options->lights);
  command->add_option("--samples", options->samples, "Points of each texel at which direct light is sampled")
      ->type_name("N")
      ->check(CLI::Range(1u, 1u << 20))
      ->capture_default_str();
  addThreads(*command, options->threads);
  command->footer(R"(Only the container is needed: shadows are ray-traced in its geometry, also for gl.

Examples:
  lightwell evaluate room.lwc --technique prm --evaluator cpu --component indirect -o indirect.exr
  lightwell evaluate room.lwc --technique prm --evaluator gl --component total --lights lamps.json -o total.exr)");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
