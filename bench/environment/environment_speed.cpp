// Times of the decomposition: the fast path for skies that change, the best path for skies that do not.
//   environment_speed --benchmark_filter=...
#include <benchmark/benchmark.h>

#include <numbers>

#include "precompute/transport/environment/bake_environment.h"

using namespace lightwell;
using namespace lightwell::transport;

namespace {

/// A gradient with a sun and a few lamps, width × width / 2.
EnvironmentMap makeSky(int width) {
  std::vector<Rgb> pixels;
  for (int y = 0; y < width / 2; ++y)
    for (int x = 0; x < width; ++x) {
      const float theta = (float(y) + 0.5f) / float(width / 2) * kPi, phi = (float(x) / float(width) - 0.5f) * 2 * kPi;
      const float lamp = std::max(0.0f, std::sin(3 * theta) * std::sin(5 * phi)),
                  sun = std::hypot(theta - 0.8f, phi - 1) < 0.008f ? 40000.0f : 0.0f;
      pixels.push_back(Rgb(0.3f, 0.5f, 1) * (1.2f + std::cos(theta)) + Rgb(30, 20, 10) * std::pow(lamp, 60.0f) + Rgb(sun));
    }
  return EnvironmentMap(memoryRowSource(width, width / 2, std::move(pixels)), "sky");
}

/// From rows in memory to cells, one thread.
void fastDecomposition(benchmark::State& state) {
  EnvironmentMap map = makeSky(int(state.range(0)));
  DecompositionSettings settings;
  settings.samples = uint32_t(state.range(1));
  settings.fast = true;
  settings.threads = 1;
  Diagnostics diagnostics;
  for (auto _ : state) {
    const SkyGrid grid = makeSkyGrid(map, 2048, diagnostics, nullptr);
    benchmark::DoNotOptimize(decompose(grid, settings, nullptr));
  }
}
BENCHMARK(fastDecomposition)->Args({512, 128})->Args({1024, 64})->Args({1024, 128})->Args({1024, 256})->Unit(benchmark::kMillisecond);

/// Everything a container holds, all threads.
void bestEnvironment(benchmark::State& state) {
  EnvironmentMap map = makeSky(int(state.range(0)));
  EnvironmentSettings settings;
  settings.decomposition.samples = uint32_t(state.range(1));
  Diagnostics diagnostics;
  for (auto _ : state) benchmark::DoNotOptimize(bakeEnvironment(map, settings, diagnostics, nullptr));
}
BENCHMARK(bestEnvironment)->Args({1024, 128})->Args({4096, 256})->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
