// lightwell render: a picture of a container, drawn with OpenGL as a game would.
#include <memory>

#include "cli/command.h"
#include "cli/portal_options.h"
#include "cli/runtime_handles.h"
#include "precompute/core/error.h"
#include "render/camera_json.h"
#include "render/egl_context.h"
#include "render/error.h"
#include "render/lights_json.h"
#include "render/renderer.h"

namespace lightwell::cli {
namespace {
namespace fs = std::filesystem;

struct Options {
  fs::path container, camera, output;
  std::optional<fs::path> lights;
  std::string technique = "auto";
  std::vector<std::string> portals;
  render::RendererOptions renderer;
};

/// Throws UsageError for what this container cannot show.
void checkTechnique(const Options& options, const RuntimeContainer& container) {
  const auto has = [&](const char* section) { return lw_has_section(container.get(), section) != 0; };
  if (has("atlas") && !has("geometry")) throw UsageError(options.container.string() + " has no surfaces to draw: it was baked with --no-geometry");
  if (options.technique != "auto" && !has(options.technique.c_str()))
    throw UsageError("--technique " + options.technique + ": " + options.container.string() + " has no section " + options.technique);
  if (!options.portals.empty() && (!has("radiosity") || (options.technique != "auto" && options.technique != "radiosity")))
    throw UsageError("--portal: only section radiosity, shown by --technique radiosity, knows of portals");
  const bool baked = options.technique == "lightmap" || (options.technique == "auto" && has("lightmap") && !has("prm") && !has("radiosity"));
  if (baked && options.lights) throw UsageError("--lights: a light map holds the lights that it was baked with; bake --lights bakes others");
}

render::Image8 draw(const Options& options, const RuntimeContainer& container, const render::View& view) {
  try {
    const render::EglContext context;
    render::Renderer renderer(container.get(), render::EglContext::load, nullptr, options.renderer);
    if (options.lights) renderer.setLights(render::readLights(*options.lights, renderer.sceneInfo().origin_m));
    return renderer.render(view);
  } catch (const render::RenderError& error) {
    if (error.result == LW_NOT_FOUND) throw UsageError(std::string("--portal: ") + error.what());
    if (error.result >= LW_GL_UNSUPPORTED) throw UsageError(std::string("this machine's OpenGL cannot draw it: ") + error.what());
    container.check(error.result);
    throw;
  }
}

void run(Session& session, const Options& options) {
  checkWritable(options.output);
  for (const fs::path& input : {options.container, options.camera}) checkReadable(input);
  if (options.lights) checkReadable(*options.lights);
  try {
    const render::View view = render::readCamera(options.camera);
    const RuntimeContainer container(options.container);
    checkTechnique(options, container);
    const render::Image8 image = draw(options, container, view);
    writeOutput(session, options.output, [&] { render::writePng(options.output, image); });
    session.console.line(options.output.string() + ": " + std::to_string(image.width) + " x " + std::to_string(image.height));
  } catch (const render::FileError& error) {
    throw InputError(error.file, error.place, error.reason);
  }
}

}  // namespace

void addRender(CLI::App& app, Session& session) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Draw a picture of a container with OpenGL, without a window");
  command->add_option("container", options->container, "Container to draw")->required()->type_name("OUT.lwc");
  command->add_option("--camera", options->camera, "Where to look from (docs/cli.md)")->required()->type_name("CAM.json");
  addLights(*command, options->lights);
  addOutput(*command, options->output, "PNG to write");
  command
      ->add_option("--technique", options->technique,
                   "Where indirect light comes from: prm, radiosity (all bounces of the lamps as they are), lightmap (direct light too), or auto: the first of these that there is")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "prm", "radiosity", "lightmap"}))
      ->capture_default_str();
  addPortalStates(*command, options->portals, "Radiosity only: how far the portal of that name is open");
  addEnvironmentLight(*command, options->renderer.environment);
  command->footer(R"(The camera is a file such as
  {"eye": [0, 1.7, 4], "target": [0, 1, 0], "vertical_fov_deg": 60, "width": 1280, "height": 720, "exposure": "auto", "mode": "full"}

Example:
  lightwell render room.lwc --camera cam.json --lights lamps.json -o room.png)");
  command->callback([&session, options] {
    using render::Technique;
    options->renderer.technique = options->technique == "prm"         ? Technique::prm
                                  : options->technique == "radiosity" ? Technique::radiosity
                                  : options->technique == "lightmap"  ? Technique::lightmap
                                                                      : Technique::automatic;
    for (const auto& [name, open] : parsePortalStates(options->portals)) options->renderer.portals.push_back({name, open});
    run(session, *options);
  });
}

}  // namespace lightwell::cli
