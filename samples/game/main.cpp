// lightwell_game CONTAINER.lwc: walk through a baked scene and move its lamps.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "render/container_file.h"
#include "samples/game/options.h"

int main(int argc, char** argv) {
  using namespace lightwell;
  game::Options options;
  std::string size = "1280x720", mode;
  CLI::App app{"Walk through a baked scene; its lamps move, and the bounced light follows."};
  app.add_option("container", options.container, "what `lightwell bake` made (.lwc)")->required();
  app.add_option("--camera", options.camera, "CAM.json to start from");
  app.add_option("--lights", options.lights, "LIGHTS.json instead of the scene's own lights");
  app.add_option("--mode", mode, "direct, indirect or full")->check(CLI::IsMember({"direct", "indirect", "full"}));
  app.add_option("--size", size, "WIDTHxHEIGHT of the window or the pictures")->capture_default_str();
  app.add_option("--frames", options.frames, "stop after so many; 0: when the window closes (one picture without a window)")
      ->check(CLI::Range(0, 100000));
  app.add_flag("--headless", options.headless, "no window: a PNG per frame while a lamp goes once around");
  app.add_flag("--es", options.es, "without a window: draw on OpenGL ES 3.0")->needs("--headless");
  app.add_option("-o,--output", options.output_prefix, "prefix of the pictures' names")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (std::sscanf(size.c_str(), "%dx%d", &options.width, &options.height) != 2 || options.width < 1 || options.height < 1 ||
      options.width > 8192 || options.height > 8192) {
    std::fprintf(stderr, "--size: write WIDTHxHEIGHT, each from 1 to 8192\n");
    return 2;
  }
  if (!mode.empty())
    options.part = mode == "direct"     ? render::LightPart::direct
                   : mode == "indirect" ? render::LightPart::indirect
                                        : render::LightPart::full;
  try {
    const auto container = render::openContainer(options.container.string());
    return options.headless ? game::runHeadless(options, container.get()) : game::runWindowed(options, container.get());
  } catch (const render::RenderError& error) {
    std::fprintf(stderr, "lightwell_game: %s\n", error.what());
    return error.containerFault() ? 4 : 1;
  } catch (const render::FileError& error) {
    std::fprintf(stderr, "lightwell_game: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell_game: %s\n", error.what());
    return 1;
  }
}
