// What environment light costs a frame on OpenGL, by number of cells: shading, and drawing depth maps.
//   environment_frame MAP [--cells 32 64 128 256] [--size 256] [--repeats 9] > frame.csv
// Shading size × size pixels of a plane with a sphere on it, processor time of all threads until glFinish returns (the
// work of a software rasteriser, whatever else the machine does), the least of frames drawn in turn. `ratio` columns divide by the unshadowed frame of the same sky. No window.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>

#include "bench/environment/sphere_scene.h"
#include "precompute/transport/environment/bake_environment.h"
#include "render/egl_context.h"

using namespace lightwell;
using namespace lightwell::transport;

namespace {

std::vector<double> leastTimesInTurn(int repeats, const std::vector<std::function<void()>>& frames) {
  std::vector<std::vector<double>> milliseconds(frames.size());
  for (int i = -2; i < repeats; ++i)  // the first two rounds compile shaders and touch memory
    for (size_t f = 0; f < frames.size(); ++f) {
      const std::clock_t begin = std::clock();
      frames[f]();
      glFinish();
      if (i >= 0) milliseconds[f].push_back(1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC);
    }
  std::vector<double> least;
  for (const auto& times : milliseconds) least.push_back(*std::min_element(times.begin(), times.end()));
  return least;
}

void run(const std::string& file, const std::vector<uint32_t>& cell_counts, int size, int repeats) {
  const render::EglContext context;
  std::fprintf(stderr, "%s\n", context.description().c_str());
  bench::SphereScene scene;
  std::printf("cells,unshadowed_ms,share_ms,share_lobe_ms,paper_ms,share_ratio,share_lobe_ratio,paper_ratio,depth_map_ms\n");
  for (const uint32_t cells : cell_counts) {
    Diagnostics diagnostics;
    EnvironmentMap map(openRowSource(file, diagnostics), file);
    EnvironmentSettings settings;
    settings.decomposition.samples = cells;
    scene.setSky(bakeEnvironment(map, settings, diagnostics, nullptr), 256);
    const uint32_t maps = std::min(16u, cells);
    const auto t = leastTimesInTurn(repeats, {[&] { scene.drawPlane(size, LW_ENVIRONMENT_UNSHADOWED, false); },
                                               [&] { scene.drawPlane(size, LW_ENVIRONMENT_SHARE, false); },
                                               [&] { scene.drawPlane(size, LW_ENVIRONMENT_SHARE, true); },
                                               [&] { scene.drawPlane(size, LW_ENVIRONMENT_SUM_PAPER, false); },
                                               [&] { scene.drawMaps(maps); }});
    std::printf("%u,%.2f,%.2f,%.2f,%.2f,%.1f,%.1f,%.1f,%.3f\n", cells, t[0], t[1], t[2], t[3], t[1] / t[0], t[2] / t[0], t[3] / t[0], t[4] / maps);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string file;
  std::vector<uint32_t> cells{32, 64, 128, 256};
  int size = 256, repeats = 9;
  CLI::App app("Processor milliseconds per frame of environment light on OpenGL: CSV on stdout.", "environment_frame");
  app.add_option("map", file, "Map of the sky (.hdr, .exr)")->required();
  app.add_option("--cells", cells, "Numbers of cells")->capture_default_str();
  app.add_option("--size", size, "Pixels along a side of the picture")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--repeats", repeats, "Frames; the least time is reported")->check(CLI::Range(3, 1000))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(file, cells, size, repeats);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "environment_frame: %s\n", error.what());
    return 1;
  }
}
