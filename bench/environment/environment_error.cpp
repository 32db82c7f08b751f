// Error of environment answers against quadrature over the map, by model, shininess and number of cells.
//   environment_error MAP... [--queries N] [--cells N] [--exponent E] > errors.csv
// Columns: map, model, shininess, cells, error (RMS of the difference over RMS of the exact answers, all channels), seconds of the bake.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/exact_environment.h"

using namespace lightwell;
using namespace lightwell::transport;

namespace {

constexpr float kShininess[] = {1, 10, 100, 1000, 10000};

Vec3 uniformDirection(const Vec2& u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

double relativeRms(const std::vector<Rgb>& exact, const std::vector<Rgb>& answer) {
  double difference = 0, power = 0;
  for (size_t i = 0; i < exact.size(); ++i) difference += Vec3d(answer[i] - exact[i]).length2(), power += Vec3d(exact[i]).length2();
  return power > 0 ? std::sqrt(difference / power) : 0;
}

/// Directional lights drawn by power from the map's texels, each with an equal share: what decompositions are to beat.
std::vector<Rgb> monteCarlo(const SkyGrid& grid, const std::vector<EnvironmentQuery>& queries, uint32_t count, uint64_t seed) {
  std::vector<double> cdf;
  double total = 0;
  for (const auto& flux : grid.flux_rgb) cdf.push_back(total += transport::luminance(flux));
  std::vector<Rgb> answers(queries.size(), Rgb(0, 0, 0));
  const Sampler sampler(seed, 0);
  for (uint32_t s = 0; s < count; ++s) {
    const uint64_t key = combineKeys(seed, s);
    const double u = (double(mixBits(key)) + 0.5) * 0x1p-32 * total;
    const size_t i = std::min(size_t(std::upper_bound(cdf.begin(), cdf.end(), u) - cdf.begin()), cdf.size() - 1);
    const double weight = total / transport::luminance(grid.flux_rgb[i]) / count;
    for (size_t q = 0; q < queries.size(); ++q) {
      const double lobe = cosinePower(grid.direction[i], queries[q].axis, queries[q].shininess);
      for (int c = 0; c < 3; ++c) answers[q][c] += float(grid.flux_rgb[i][size_t(c)] * weight * lobe);
    }
  }
  return answers;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  uint32_t count = 1000;
  std::vector<uint32_t> cell_counts = {8, 16, 32, 64, 128, 256, 512, 1024};
  float exponent = -1;
  for (int i = 1; i < argc; ++i) {
    if (!std::strcmp(argv[i], "--queries") && i + 1 < argc)
      count = uint32_t(std::stoul(argv[++i]));
    else if (!std::strcmp(argv[i], "--exponent") && i + 1 < argc)
      exponent = std::stof(argv[++i]);
    else if (!std::strcmp(argv[i], "--cells") && i + 1 < argc)
      cell_counts = {uint32_t(std::stoul(argv[++i]))};
    else
      files.push_back(argv[i]);
  }
  std::printf("map,model,shininess,cells,suns,error,bake_seconds\n");
  for (const std::string& file : files) try {
    Diagnostics diagnostics;
    EnvironmentMap map(openRowSource(file, diagnostics), file);
    const std::string name = std::filesystem::path(file).stem().string();
    std::vector<EnvironmentQuery> queries;
    const Sampler sampler(7, 0);
    for (float n : kShininess)
      for (uint32_t i = 0; i < count; ++i) queries.push_back({uniformDirection(sampler.get2D(i, uint32_t(n))), n});
    const std::vector<Rgb> exact = exactAnswers(map, queries, 0, diagnostics, nullptr);
    const SkyGrid grid = makeSkyGrid(map, 2048, diagnostics, nullptr);
    const auto report = [&](const char* model, uint32_t cells, uint32_t suns, double seconds, const std::vector<Rgb>& answers) {
      for (size_t k = 0; k < std::size(kShininess); ++k) {
        const auto part = [&](const std::vector<Rgb>& all) {
          return std::vector<Rgb>(all.begin() + long(k * count), all.begin() + long((k + 1) * count));
        };
        std::printf("%s,%s,%g,%u,%u,%.6g,%.3f\n", name.c_str(), model, kShininess[k], cells, suns, relativeRms(part(exact), part(answers)),
                    seconds);
      }
      std::fflush(stdout);
    };
    for (uint32_t samples : cell_counts)
      for (bool fast : {false, true}) {
        EnvironmentSettings settings;
        settings.decomposition.samples = samples;
        settings.decomposition.fast = fast;
        if (exponent >= 0) settings.decomposition.density_exponent = exponent;
        const auto start = std::chrono::steady_clock::now();
        const Environment environment = bakeEnvironment(map, settings, diagnostics, nullptr);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const EnvironmentEvaluator evaluator(environment);
        const uint32_t cells = environment.cells.count(), suns = environment.cells.sun_count;
        std::vector<Rgb> answers(queries.size());
        const auto all = [&](const char* model, auto&& answer) {
          for (size_t q = 0; q < queries.size(); ++q) answers[q] = answer(queries[q]);
          report(model, cells, suns, seconds, answers);
        };
        if (fast) {
          all("fast spread", [&](const auto& q) { return evaluator.answerFromCells(q, Reflectivity::spread); });
          continue;
        }
        all("one sample", [&](const auto& q) { return evaluator.answerFromCells(q, Reflectivity::single); });
        all("paper", [&](const auto& q) { return evaluator.answerFromCells(q, Reflectivity::paper); });
        all("vmf", [&](const auto& q) { return evaluator.answerFromCells(q, Reflectivity::vmf); });
        all("spread", [&](const auto& q) { return evaluator.answerFromCells(q, Reflectivity::spread); });
        if (samples == 128) all("sky", [&](const auto& q) { return evaluator.answer(q); });
        std::vector<std::vector<Rgb>> repeats;
        for (uint64_t seed = 1; seed <= 4; ++seed) repeats.push_back(monteCarlo(grid, queries, samples, seed));
        for (size_t k = 0; k < std::size(kShininess); ++k) {
          double squares = 0;
          for (const auto& repeat : repeats) {
            const std::vector<Rgb> truth(exact.begin() + long(k * count), exact.begin() + long((k + 1) * count));
            squares += std::pow(relativeRms(truth, {repeat.begin() + long(k * count), repeat.begin() + long((k + 1) * count)}), 2);
          }
          std::printf("%s,monte carlo,%g,%u,0,%.6g,0\n", name.c_str(), kShininess[k], samples, std::sqrt(squares / double(repeats.size())));
        }
      }
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
}
