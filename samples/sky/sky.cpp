// lightwell_sky SKY.lwc … -o DIRECTORY
//
// Spheres of several shininess on a plane under each of the given skies (containers with the section "environment"): a picture for each and
// a contact sheet. With --frames, a ball flies over them, and only a few depth maps are drawn in each frame.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "render/container_file.h"
#include "render/egl_context.h"
#include "samples/common/contact_sheet.h"
#include "samples/sky/sphere_view.h"

namespace {

using namespace lightwell;

struct Options {
  std::vector<std::string> skies;
  std::string directory = ".";
  samples::SphereSettings view;
  int frames = 0;
  uint32_t maps_per_frame = 8;
};

struct Release {
  void operator()(lw_gl* gl) const { lw_gl_destroy(gl); }
  void operator()(lw_environment* environment) const { lw_environment_release(environment); }
};

std::unique_ptr<lw_gl, Release> makeGl() {
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  config.message = [](void*, lw_result result, const char* text) { std::fprintf(stderr, "%s: %s\n", lw_result_name(result), text); };
  lw_gl* made = nullptr;
  render::check(lw_gl_create(&config, &made), "OpenGL evaluation");
  return std::unique_ptr<lw_gl, Release>(made);
}

void run(const Options& options) {
  const render::EglContext context;
  const auto gl = makeGl();
  std::filesystem::create_directories(options.directory);
  std::vector<render::Image8> sheet;
  for (const std::string& file : options.skies) {
    const render::ContainerFile container = render::openContainer(file);
    lw_environment* loaded = nullptr;
    render::check(lw_environment_load(container.get(), &loaded), file.c_str());
    const std::unique_ptr<lw_environment, Release> environment(loaded);
    samples::SphereView view(gl.get(), environment.get(), options.view);
    const std::filesystem::path base = std::filesystem::path(options.directory) / std::filesystem::path(file).stem();
    view.refresh(view.cells());
    sheet.push_back(view.draw());
    render::writePng(base.string() + ".png", sheet.back());
    std::printf("%s: %u cells, %s.png\n", file.c_str(), view.cells(), base.c_str());
    for (int frame = 0; frame < options.frames; ++frame) {
      char name[32];
      std::snprintf(name, sizeof name, "_%04d.png", frame);
      view.moveBall(float(frame) / float(options.frames));
      view.refresh(options.maps_per_frame);
      render::writePng(base.string() + name, view.draw());
    }
  }
  if (sheet.size() > 1) render::writePng(std::filesystem::path(options.directory) / "contact_sheet.png", samples::contactSheet(sheet, 1));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Draws spheres of several shininess under skies."};
  const std::map<std::string, uint32_t> techniques{{"share", LW_ENVIRONMENT_SHARE},
                                                   {"sum", LW_ENVIRONMENT_SUM},
                                                   {"paper", LW_ENVIRONMENT_SUM_PAPER},
                                                   {"unshadowed", LW_ENVIRONMENT_UNSHADOWED}};
  const std::map<std::string, samples::Lobe> lobes{{"phong", samples::Lobe::phong}, {"ggx", samples::Lobe::ggx}};
  app.add_option("skies", options.skies, "what `lightwell bake --environment` made (.lwc)")->required();
  app.add_option("-o,--output", options.directory, "folder of the pictures")->capture_default_str();
  app.add_option("--technique", options.view.technique, "how the light is computed: share, sum, paper, unshadowed")
      ->transform(CLI::CheckedTransformer(techniques));
  app.add_option("--lobe", options.view.lobe, "phong or ggx")->transform(CLI::CheckedTransformer(lobes));
  app.add_option("--cells", options.view.cells, "use only so many cells; 0: all")->capture_default_str();
  app.add_option("--map-size", options.view.map_texels, "texels along a side of a depth map")->capture_default_str();
  app.add_option("--sun-map-size", options.view.sun_map_texels, "the same of a sun's")->capture_default_str();
  app.add_option("--width", options.view.width, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--height", options.view.height, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--frames", options.frames, "pictures of the flying ball, for each sky")->check(CLI::Range(0, 9999))->capture_default_str();
  app.add_option("--maps-per-frame", options.maps_per_frame, "depth maps drawn in each of them")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
    return 0;
  } catch (const render::RenderError& error) {
    std::fprintf(stderr, "lightwell_sky: %s\n", error.what());
    return error.containerFault() ? 4 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell_sky: %s\n", error.what());
    return 1;
  }
}
