#include "precompute/bake/environment_tasks.h"

#include <bit>

#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/evaluate_environment.h"

namespace lightwell::bake {
namespace {

constexpr std::array kMeasuredShininess = {1.0f, 100.0f};
constexpr uint32_t kMeasuredDirections = 64;
constexpr uint64_t kDirectionSeed = 0x736b79ull;

Bytes toBytes(const transport::Environment& environment) {
  const transport::EnvironmentCells& cells = environment.cells;
  const transport::EnvironmentSky& sky = environment.sky;
  const std::array numbers = {cells.sun_count, sky.face_cells, std::bit_cast<uint32_t>(sky.scale)};
  ByteWriter writer;
  writer.array(std::span<const uint32_t>(numbers));
  writer.array(cells.direction);
  writer.array(cells.flux_rgb);
  writer.array(cells.solid_angle_sr);
  writer.array(cells.cos_radius);
  writer.array(cells.spread);
  writer.array(cells.covariance);
  writer.array(sky.value);
  writer.array(std::span<const Rgb>(&sky.flux_rgb, 1));
  writer.array(std::span<const Rgb>(sky.radiance_sh));
  return writer.take();
}

/// Quadrature over the cells of the grid: they are small against the lobes that are measured.
Rgb exactAnswer(const transport::SkyGrid& grid, const transport::EnvironmentQuery& query) {
  std::array<double, 3> sum{};
  for (size_t i = 0; i < grid.size(); ++i) {
    const float cosine = grid.direction[i].dot(query.axis);
    if (cosine <= 0) continue;
    const double lobe = query.shininess == 1 ? cosine : std::pow(double(cosine), double(query.shininess));
    for (size_t c = 0; c < 3; ++c) sum[c] += grid.flux_rgb[i][c] * lobe;
  }
  return {float(sum[0]), float(sum[1]), float(sum[2])};
}

EnvironmentError measure(const transport::SkyGrid& grid, const transport::Environment& environment, float shininess, int threads,
                         const CancelFlag& cancel) {
  const transport::EnvironmentEvaluator evaluator(environment);
  const Sampler sampler(kDirectionSeed, 0);
  std::vector<Rgb> exact(kMeasuredDirections), answer(kMeasuredDirections);
  parallelFor(kMeasuredDirections, 1, threads, &cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec2 u = sampler.get2D(uint32_t(i), 0);
      const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
      const transport::EnvironmentQuery query{Vec3(r * std::cos(phi), z, r * std::sin(phi)), shininess};
      exact[i] = exactAnswer(grid, query);
      answer[i] = evaluator.answer(query);
    }
  });
  return {transport::compareWithReferences(std::vector(3, exact), answer), shininess};  // free of noise: each is like the other
}

}  // namespace

EnvironmentTasks addEnvironmentTasks(TaskGraph& graph, const BakeContext& context, const plan::Settings& settings, bool measured) {
  const std::string parameters = context.skyKey().hex() + " " + std::to_string(settings.environment_samples) + " " +
                                 std::to_string(settings.sky_face_cells) + " " + std::to_string(settings.seed) + " " +
                                 (settings.quality == plan::Quality::draft ? "fast" : "best");
  const transport::SkyGrid& grid = *context.skyGrid();
  EnvironmentTasks tasks;
  tasks.baked = graph.add({"environment", "environment", "environment", parameters, {}, double(grid.size()) * 4,
                           [&context, settings](const TaskInputs& in) {
                             transport::EnvironmentSettings options;
                             options.decomposition.samples = settings.environment_samples;
                             options.decomposition.seed = settings.seed;
                             options.decomposition.fast = settings.quality == plan::Quality::draft;
                             options.decomposition.threads = context.threads();
                             options.sky_face_cells = settings.sky_face_cells;
                             return toBytes(transport::bakeEnvironment(*context.skyGrid(), options, &in.cancel));
                           }});
  if (measured)
    tasks.measured = graph.add({"environment/measure", "measure", "environment/measure", parameters, {tasks.baked},
                                double(grid.size()) * kMeasuredDirections * 0.05, [&context](const TaskInputs& in) {
                                  const transport::Environment environment = readEnvironment(in.inputs[0]);
                                  std::vector<EnvironmentError> errors;
                                  for (const float shininess : kMeasuredShininess)
                                    errors.push_back(measure(*context.skyGrid(), environment, shininess, context.threads(), in.cancel));
                                  ByteWriter writer;
                                  writer.array(errors);
                                  return writer.take();
                                }});
  return tasks;
}

transport::Environment readEnvironment(const Blob& baked) {
  ByteReader reader(*baked);
  transport::Environment environment;
  transport::EnvironmentCells& cells = environment.cells;
  transport::EnvironmentSky& sky = environment.sky;
  const auto numbers = reader.array<uint32_t>();
  cells.sun_count = numbers.at(0);
  sky.face_cells = numbers.at(1);
  sky.scale = std::bit_cast<float>(numbers.at(2));
  cells.direction = reader.array<Vec3>();
  cells.flux_rgb = reader.array<Rgb>();
  cells.solid_angle_sr = reader.array<float>();
  cells.cos_radius = reader.array<float>();
  cells.spread = reader.array<float>();
  cells.covariance = reader.array<std::array<float, 3>>();
  sky.value = reader.array<uint16_t>();
  sky.flux_rgb = reader.array<Rgb>().at(0);
  const auto harmonics = reader.array<Rgb>();
  for (size_t i = 0; i < sky.radiance_sh.size(); ++i) sky.radiance_sh[i] = harmonics.at(i);
  return environment;
}

std::vector<EnvironmentError> readEnvironmentErrors(const Blob& measured) {
  return ByteReader(*measured).array<EnvironmentError>();
}

}  // namespace lightwell::bake
