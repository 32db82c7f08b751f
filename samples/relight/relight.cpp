// lightwell_relight CONTAINER.lwc --camera CAM.json --lights A.json B.json … -o DIRECTORY
//
// The shortest use of the renderer: one baked scene under several lights, direct light only beside all of it, and a contact sheet
// (upper row direct, lower row full; one column per lights file). One exposure for all pictures, so that they compare.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "render/camera_json.h"
#include "render/container_file.h"
#include "render/egl_context.h"
#include "render/lights_json.h"
#include "render/renderer.h"
#include "samples/common/contact_sheet.h"

namespace {

using namespace lightwell;
using render::Image8;
using samples::contactSheet;
using samples::reduced;

void relight(const std::string& container_file, const std::string& camera_file, const std::vector<std::string>& light_files,
             const std::filesystem::path& directory, int reduction) {
  const render::ContainerFile container = render::openContainer(container_file);
  const render::EglContext context;
  render::Renderer renderer(container.get(), render::EglContext::load, nullptr);
  render::View view = render::readCamera(camera_file);
  std::filesystem::create_directories(directory);
  std::printf("%s, %d x %d\n", context.description().c_str(), view.width, view.height);
  std::printf("%-12s %-10s %12s %12s %12s\n", "lights", "mode", "shadows ms", "transport ms", "shading ms");
  renderer.measureTimes(true);
  std::vector<Image8> direct_row, full_row;
  for (const std::string& file : light_files) {
    const auto lights = render::readLights(file, renderer.sceneInfo().origin_m);
    const std::string name = std::filesystem::path(file).stem().string();
    renderer.setLights(lights);
    view.part = render::LightPart::full;
    if (!view.exposure_ev) view.exposure_ev = renderer.meterExposure(view);
    for (const render::LightPart part : {render::LightPart::full, render::LightPart::direct}) {
      view.part = part;
      renderer.setLights({});  // so that the shadow maps are part of what is measured
      renderer.render(view);
      renderer.setLights(lights);
      const Image8 image = renderer.render(view);
      const render::FrameTimes& times = renderer.times();
      std::printf("%-12s %-10s %12.1f %12.1f %12.1f\n", name.c_str(), render::partName(part), times.shadows_ms, times.transport_ms,
                  times.shading_ms);
      render::writePng(directory / (name + "_" + render::partName(part) + ".png"), image);
      (part == render::LightPart::full ? full_row : direct_row).push_back(reduced(image, reduction));
    }
  }
  const int columns = int(direct_row.size());
  direct_row.insert(direct_row.end(), full_row.begin(), full_row.end());
  render::writePng(directory / "contact_sheet.png", contactSheet(direct_row, columns));
}

}  // namespace

int main(int argc, char** argv) {
  std::string container, camera, directory = ".";
  std::vector<std::string> lights;
  int reduction = 3;
  CLI::App app{"Draws a baked scene under several lights: direct light only, and all of it."};
  app.add_option("container", container, "what `lightwell bake` made (.lwc)")->required();
  app.add_option("--camera", camera, "CAM.json")->required();
  app.add_option("--lights", lights, "one or more LIGHTS.json")->required()->expected(1, 64);
  app.add_option("-o,--output", directory, "folder of the pictures")->capture_default_str();
  app.add_option("--reduction", reduction, "how many times smaller the contact sheet's pictures are")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    relight(container, camera, lights, directory, reduction);
    return 0;
  } catch (const render::RenderError& error) {
    std::fprintf(stderr, "lightwell_relight: %s\n", error.what());
    return error.containerFault() ? 4 : 1;
  } catch (const render::FileError& error) {
    std::fprintf(stderr, "lightwell_relight: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell_relight: %s\n", error.what());
    return 1;
  }
}
