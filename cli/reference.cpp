// lightwell reference: path-traced irradiance, the truth that other maps are compared with.
#include <atomic>
#include <memory>

#include "cli/command.h"
#include "cli/irradiance_image.h"
#include "cli/portal_options.h"
#include "precompute/bake/context.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;

struct Options {
  bake::SceneSource source;
  fs::path output;
  std::optional<fs::path> standard_error;
  std::string component = "total";
  plan::Settings settings;
  uint32_t samples = 256, bounces = 0;
  std::vector<std::string> portals;
  int threads = 0;
};

/// Emitters are sampled as they are in the file.
void warnOfEmittingLeaves(Session& session, const bake::BakeContext& context, const std::vector<float>& portal_open) {
  const scene::Scene& scene = context.scene();
  for (size_t i = 0; i < scene.portals.size(); ++i) {
    bool emits = false;
    for (uint32_t t = 0; t < scene.portals[i].triangle_count; ++t)
      emits |= maxComponent(scene.materials[scene.mesh.triangle_material[scene.portals[i].first_triangle + t]].emissive) > 0;
    if (emits && portal_open[i] > 0) session.console.warning({scene.portals[i].gltf_path, "the leaf emits light: what of it has opened shines on"});
  }
}

void run(Session& session, Options& options) {
  checkWritable(options.output);
  if (options.standard_error) checkWritable(*options.standard_error);
  checkReadable(options.source.scene);
  if (options.source.lights) checkReadable(*options.source.lights);
  if (options.source.environment) checkReadable(*options.source.environment);
  const std::vector<PortalState> portals = parsePortalStates(options.portals);
  for (const auto& [name, open] : portals) options.settings.portals.push_back(name);
  Diagnostics diagnostics;
  const bake::BakeContext context(options.source, options.settings, options.threads, diagnostics, session.interrupt.flag(),
                                  [&](const std::string& stage) { session.console.progress(stage, stage + " …"); });
  for (const auto& warning : diagnostics.warnings()) session.console.warning(warning);

  transport::IrradianceMap map;
  if (context.tracer()) {
    transport::ReferenceOptions reference{.samples = options.samples, .seed = options.settings.seed, .threads = options.threads,
                                          .sky = context.skyLight(), .cancel = &session.interrupt.flag()};
    if (options.bounces) reference.most_bounces = options.bounces;
    ProgressMeter meter(session.console, "path tracing");
    reference.progress = [&](double fraction) { meter.update(fraction); };
    const std::vector<float> portal_open = portalsOpen(portals, context.scene().portals);
    warnOfEmittingLeaves(session, context, portal_open);
    std::optional<trace::Tracer> open_tracer;
    if (!portals.empty()) open_tracer.emplace(context.scene(), options.threads, portal_open);
    map = transport::referenceIrradiance(context.scene(), context.atlas(), open_tracer ? *open_tracer : *context.tracer(), context.scene().lights,
                                         componentNamed(options.component), reference);
  }
  const int size = options.settings.lightmap_size;
  const auto write = [&](const fs::path& file, const std::vector<Rgb>& slot_rgb) {
    const ImageRgba image = imageOfSlots(context.scene().mesh, context.atlas(), size, slot_rgb);
    writeOutput(session, file, [&] { writeExr(file, image); });
  };
  write(options.output, map.irradiance_rgb);
  if (options.standard_error) write(*options.standard_error, map.standard_error_rgb);
  session.console.line(options.output.string() + ": " + std::to_string(context.atlas().slots.size()) + " texels, " +
                       std::to_string(options.samples) + " samples each");
}

}  // namespace

void addReference(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reference", "Path-trace the irradiance of every texel, without bias: the truth to compare with");
  command->add_option("scene", options->source.scene, "glTF 2.0 scene, .glb or .gltf")->required()->type_name("SCENE");
  addOutput(*command, options->output, "EXR to write: RGB irradiance, A = 1 where a texel is covered (half of it, or a sliver's)");
  addComponent(*command, options->component);
  addSceneSettings(*command, options->settings);
  command->add_option("--samples", options->samples, "Paths for each texel")
      ->type_name("N")
      ->check(CLI::Range(1u, 1u << 24))
      ->capture_default_str();
  command->add_option("--bounces", options->bounces, "Leave out light that was reflected more often; without it all of it counts")->type_name("N")->check(CLI::Range(1u, 1u << 16));
  command->add_option("--standard-error", options->standard_error, "Also write the standard error of each texel")->type_name("SE.exr");
  addLights(*command, options->source.lights);
  addEnvironment(*command, options->source.environment, options->settings.environment);
  addPortalStates(*command, options->portals, "How far the node of that name, a portal, is open");
  addThreads(*command, options->threads);
  command->footer("Example:\n  lightwell reference room.glb --component indirect --lightmap-size 256 --samples 1024 -o reference.exr");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
