// Shadowed environment light on OpenGL against the truth: irradiance on a plane with a sphere on it, by technique and number of cells.
//   environment_shadow MAP... [--cells 32 64 128 256] [--map-size 256] > shadow.csv
// The truth is quadrature over the map with the sphere's exact occlusion: no noise. Columns: map, technique, cells, relrmse, texrel, bias,
// of all texels of the plane and colours (docs/cli.md).
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/environment/sphere_scene.h"
#include "precompute/core/parallel.h"
#include "precompute/transport/environment/bake_environment.h"
#include "render/egl_context.h"

using namespace lightwell;
using namespace lightwell::transport;

namespace {

constexpr int kSide = 64;            // texels of the plane along an edge, where light is compared
constexpr int kTruthColumns = 1024;  // of the sky, when the map has more

/// Irradiance on the plane, [kSide²].
std::vector<Rgb> exactIrradiance(const SkyGrid& grid) {
  std::vector<Rgb> irradiance(size_t(kSide) * kSide);
  parallelFor(irradiance.size(), 16, 0, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto coordinate = [](size_t k) { return ((float(k) + 0.5f) / kSide * 2 - 1) * bench::kPlaneHalf_m; };
      const Vec3 to_center(-coordinate(i % kSide), bench::kSphereRadius_m, -coordinate(i / kSide));
      const float outside2 = to_center.length2() - bench::kSphereRadius_m * bench::kSphereRadius_m;
      double sum[3] = {};
      for (size_t t = 0; t < grid.size(); ++t) {
        const Vec3& d = grid.direction[t];
        if (d.y <= 0) continue;
        const float along = d.dot(to_center);
        if (along > 0 && along * along > outside2) continue;
        for (size_t c = 0; c < 3; ++c) sum[c] += grid.flux_rgb[t][c] * double(d.y);
      }
      irradiance[i] = Rgb(float(sum[0]), float(sum[1]), float(sum[2]));
    }
  });
  return irradiance;
}

struct Errors {
  double relrmse, texrel, bias;
};
Errors compare(const std::vector<Rgb>& truth, const std::vector<float>& rgba) {
  double mean[3] = {}, square = 0, difference2 = 0, relative2 = 0, sum = 0, candidate = 0;
  for (const Rgb& e : truth)
    for (int c = 0; c < 3; ++c) mean[c] += double(e[c]) / double(truth.size());
  for (size_t i = 0; i < truth.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double exact = double(truth[i][c]), error = double(rgba[i * 4 + size_t(c)]) - exact;
      square += exact * exact;
      difference2 += error * error;
      const double floor = exact + 0.1 * mean[c];
      relative2 += floor > 0 ? error * error / (floor * floor) : 0;
      sum += exact;
      candidate += exact + error;
    }
  return {std::sqrt(difference2 / square), std::sqrt(relative2 / (3.0 * double(truth.size()))), candidate / sum - 1};
}

void run(const std::vector<std::string>& files, const std::vector<uint32_t>& cell_counts, uint32_t map_texels) {
  const render::EglContext context;
  bench::SphereScene scene;
  const std::pair<const char*, uint32_t> techniques[] = {{"share", LW_ENVIRONMENT_SHARE}, {"sum", LW_ENVIRONMENT_SUM}, {"paper", LW_ENVIRONMENT_SUM_PAPER}};
  std::printf("map,technique,cells,relrmse,texrel,bias\n");
  for (const std::string& file : files) {
    Diagnostics diagnostics;
    EnvironmentMap map(openRowSource(file, diagnostics), file);
    const std::vector<Rgb> truth = exactIrradiance(makeSkyGrid(map, kTruthColumns, diagnostics, nullptr));
    for (const uint32_t cells : cell_counts) {
      EnvironmentMap again(openRowSource(file, diagnostics), file);
      EnvironmentSettings settings;
      settings.decomposition.samples = cells;
      scene.setSky(bakeEnvironment(again, settings, diagnostics, nullptr), map_texels);
      for (const auto& [name, technique] : techniques) {
        const Errors e = compare(truth, scene.planeIrradiance(kSide, technique));
        std::printf("%s,%s,%u,%.5f,%.5f,%.5f\n", std::filesystem::path(file).stem().c_str(), name, cells, e.relrmse, e.texrel, e.bias);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::vector<uint32_t> cells{32, 64, 128, 256};
  uint32_t map_texels = 256;
  CLI::App app("Errors of shadowed environment light on OpenGL: CSV on stdout.", "environment_shadow");
  app.add_option("map", files, "Maps of the sky (.hdr, .exr)")->required();
  app.add_option("--cells", cells, "Numbers of cells")->capture_default_str();
  app.add_option("--map-size", map_texels, "Texels along a side of a cell's depth map")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(files, cells, map_texels);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "environment_shadow: %s\n", error.what());
    return 1;
  }
}
