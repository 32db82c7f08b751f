// How steady indirect light is while a lamp moves slowly: see bench/README.md.
//   prm_motion SCENE.glb --container A.lwc [--container B.lwc …] [--lamps 12] [--step 0.01] > table.csv
// Each lamp moves along a line of 24 steps. `change`: root mean square of the difference of consecutive frames, relative to the frames'; `jerk`: of their second
// difference, which is zero for light that changes evenly. Medians (and 90th percentiles) over the lamps; `worst_texel`: greatest second difference of a texel relative to its
// light plus a tenth of the mean. A lamp's line may cross a surface to its side: that shows in the worst, which are left out.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cli/prm_evaluator.h"
#include "precompute/bake/context.h"
#include "precompute/core/random.h"
#include "precompute/transport/prm/light_prior.h"

using namespace lightwell;

namespace {

constexpr int kFrames = 24;
constexpr uint64_t kLampKey = 0x6d6f74696f6eull;

struct Options {
  std::filesystem::path scene;
  std::vector<std::filesystem::path> containers;
  uint32_t lamps = 12;
  int size = 256;
  float step_m = 0.01f;
  std::vector<float> tolerances{0.0003f};
};

struct Steadiness {
  double change = 0, jerk = 0, worst_texel = 0;
};

Steadiness measure(const std::vector<std::vector<float>>& frame_rgba) {
  Steadiness result;
  double change = 0, jerk = 0, all = 0;
  for (int f = 1; f + 1 < kFrames; ++f) {
    const auto &last = frame_rgba[size_t(f - 1)], &now = frame_rgba[size_t(f)], &next = frame_rgba[size_t(f + 1)];
    double mean = 0, texels = 0;
    for (size_t i = 0; i < now.size(); i += 4) mean += now[i + 1], texels += now[i + 3] > 0;
    mean /= std::max(1.0, texels);
    for (size_t i = 0; i < now.size(); i += 4) {
      if (!(now[i + 3] > 0)) continue;
      const double first = next[i + 1] - now[i + 1], second = next[i + 1] - 2.0 * now[i + 1] + last[i + 1];
      change += first * first, jerk += second * second, all += double(now[i + 1]) * now[i + 1];
      result.worst_texel = std::max(result.worst_texel, std::abs(second) / (now[i + 1] + 0.1 * mean));
    }
  }
  if (all > 0) result.change = std::sqrt(change / all), result.jerk = std::sqrt(jerk / all);
  return result;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[size_t(q * double(values.size() - 1))];
}

void run(const Options& options) {
  plan::Settings settings;
  settings.lightmap_size = options.size;
  Diagnostics diagnostics;
  const CancelFlag cancel;
  const bake::BakeContext context({options.scene, {}}, settings, 0, diagnostics, cancel);
  const scene::Scene& scene = context.scene();
  // Lamps whose line stays clear of the surface below them.
  auto lamps = transport::samplePriorLights(scene, context.atlas(), *context.tracer(), 16 * options.lamps, combineKeys(1, kLampKey));
  std::erase_if(lamps, [&](const transport::PriorLight& lamp) { return lamp.surface_distance_m < 0.3f + options.step_m * kFrames / 2; });
  lamps.resize(std::min<size_t>(lamps.size(), options.lamps));
  if (lamps.empty()) throw std::runtime_error("no room for a lamp to move in");
  std::printf("container,tolerance,lamps,step_m,change_percent,jerk_percent,jerk_p90_percent,worst_texel_percent\n");
  for (const auto& file : options.containers) {
    const cli::RuntimeContainer container(file);
    const cli::CpuPrm prm(container);
    for (const float tolerance : options.tolerances) {
      std::vector<double> changes, jerks, worst_texels;
      for (uint32_t l = 0; l < lamps.size(); ++l) {
        const float turn = 2.39996f * float(l);  // another way for each
        const Vec3 step = Vec3(std::cos(turn), 0.3f * std::sin(3 * turn), std::sin(turn)).normalized() * float(options.step_m / scene.metres_per_unit);
        std::vector<std::vector<float>> frames;
        for (int f = 0; f < kFrames; ++f) {
          scene::Light lamp = lamps[l].light;
          lamp.position = lamp.position + step * float(f - kFrames / 2);
          lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
          evaluate.emitters = LW_EMITTERS_OFF, evaluate.fill = 0, evaluate.tolerance = tolerance;
          frames.push_back(prm.evaluate(prm.clusterIrradiance(scene, *context.tracer(), {&lamp, 1}), evaluate));
        }
        const Steadiness s = measure(frames);
        changes.push_back(s.change), jerks.push_back(s.jerk), worst_texels.push_back(s.worst_texel);
      }
      std::printf("%s,%g,%zu,%g,%.3f,%.3f,%.3f,%.1f\n", file.filename().c_str(), double(tolerance), lamps.size(), double(options.step_m), 100 * quantile(changes, 0.5), 100 * quantile(jerks, 0.5),
                  100 * quantile(jerks, 0.9), 100 * quantile(worst_texels, 0.5));
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Steadiness of radiance maps under a lamp that moves slowly: CSV on stdout.", "prm_motion");
  app.add_option("scene", options.scene, "Scene of the containers")->required();
  app.add_option("--container", options.containers, "Containers; may be given several times")->required();
  app.add_option("--lamps", options.lamps, "Lamps, one after the other")->check(CLI::Range(1u, 1000u))->capture_default_str();
  app.add_option("--lightmap-size", options.size, "As the containers were baked")->check(CLI::Range(1, 8192))->capture_default_str();
  app.add_option("--step", options.step_m, "Metres from frame to frame")->check(CLI::Range(1e-6f, 100.0f))->capture_default_str();
  app.add_option("--tolerance", options.tolerances, "lw_prm_options.tolerance; may be given several times")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "prm_motion: %s\n", error.what());
    return 1;
  }
}
