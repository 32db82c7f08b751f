// lightwell reference: path-traced irradiance, the truth that other maps are compared with.
#include <atomic>
#include <memory>

#include "cli/command.h"
#include "cli/irradiance_image.h"
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
  uint32_t samples = 256;
  int threads = 0;
};

void run(Session& session, Options& options) {
  checkWritable(options.output);
  if (options.standard_error) checkWritable(*options.standard_error);
  checkReadable(options.source.scene);
  if (options.source.lights) checkReadable(*options.source.lights);
  if (options.source.environment) checkReadable(*options.source.environment);
  Diagnostics diagnostics;
  const bake::BakeContext context(options.source, options.settings, options.threads, diagnostics, session.interrupt.flag(),
                                  [&](const std::string& stage) { session.console.progress(stage, stage + " …"); });
  for (const auto& warning : diagnostics.warnings()) session.console.warning(warning);

  transport::IrradianceMap map;
  if (context.tracer()) {
    transport::ReferenceOptions reference{.samples = options.samples, .seed = options.settings.seed, .threads = options.threads,
                                          .sky = context.skyLight(), .cancel = &session.interrupt.flag()};
    ProgressMeter meter(session.console, "path tracing");
    reference.progress = [&](double fraction) { meter.update(fraction); };
    map = transport::referenceIrradiance(context.scene(), context.atlas(), *context.tracer(), context.scene().lights,
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
  command->add_option("--standard-error", options->standard_error, "Also write the standard error of each texel")->type_name("SE.exr");
  addLights(*command, options->source.lights);
  addEnvironment(*command, options->source.environment, options->settings.environment);
  addThreads(*command, options->threads);
  command->footer("Example:\n  lightwell reference room.glb --component indirect --lightmap-size 256 --samples 1024 -o reference.exr");
  command->callback([&session, options] { run(session, *options); });
}

}  // namespace lightwell::cli
