#include "cli/report/sky.h"

#include <chrono>
#include <cmath>

#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/evaluate_environment.h"
#include "precompute/transport/environment/exact_environment.h"
#include "precompute/transport/environment/reflectivity.h"

namespace lightwell::report {
namespace {

using namespace transport;

constexpr uint32_t kDirections = 500, kShininess[] = {1, 100};
constexpr uint64_t kSeed = 7;

Vec3 uniformDirection(const Vec2& u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace

std::vector<SkyAnswer> measureSky(const bake::SceneSource& source, const plan::Settings& settings, int threads, const CancelFlag& cancel) {
  Diagnostics diagnostics;
  EnvironmentMap map = bake::openPlacedMap(*source.environment, source.environment->string(), settings.environment, diagnostics);
  const Sampler sampler(kSeed, 0);
  std::vector<EnvironmentQuery> queries;
  for (const uint32_t shininess : kShininess)
    for (uint32_t i = 0; i < kDirections; ++i) queries.push_back({uniformDirection(sampler.get2D(i, shininess)), float(shininess)});
  const std::vector<Rgb> exact = exactAnswers(map, queries, threads, diagnostics, &cancel);
  std::vector<SkyAnswer> answers;
  for (const uint32_t cells : kSkyCells) {
    EnvironmentSettings environment_settings;
    environment_settings.decomposition.samples = cells;
    environment_settings.decomposition.threads = threads;
    environment_settings.sky_face_cells = settings.sky_face_cells;
    const auto begin = std::chrono::steady_clock::now();
    const Environment environment = bakeEnvironment(map, environment_settings, diagnostics, &cancel);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const EnvironmentEvaluator evaluator(environment);
    const auto add = [&](const char* model, auto&& answer) {
      for (size_t k = 0; k < std::size(kShininess); ++k) {
        double difference = 0, power = 0;
        for (size_t q = k * kDirections; q < (k + 1) * kDirections; ++q) difference += Vec3d(answer(queries[q]) - exact[q]).length2(), power += Vec3d(exact[q]).length2();
        answers.push_back({model, kShininess[k], environment.cells.count(), seconds, power > 0 ? std::sqrt(difference / power) : 0});
      }
    };
    add("sky", [&](const EnvironmentQuery& q) { return evaluator.answer(q); });
    add("spread", [&](const EnvironmentQuery& q) { return evaluator.answerFromCells(q, Reflectivity::spread); });
    add("paper", [&](const EnvironmentQuery& q) { return evaluator.answerFromCells(q, Reflectivity::paper); });
    add("one sample", [&](const EnvironmentQuery& q) { return evaluator.answerFromCells(q, Reflectivity::single); });
    cancel.check();
  }
  return answers;
}

}  // namespace lightwell::report
