#include "precompute/bake/measured_error.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/random.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/evaluate.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/radiosity/solve.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::bake {
namespace {

constexpr double kSolved = 1e-4;       // residual: far below what is measured
constexpr uint64_t kReferences = 4;    // independent: a pair of them gives an error, the others its weight
constexpr uint32_t kMostSamples = 64;  // paths per texel in each reference
constexpr uint32_t kLeastSamples = 4;
constexpr double kMostRays = 6 * kMostSamples;  // for a texel, about: where albedo is near 1, paths are long and there are fewer of them
constexpr uint64_t kLightSeed = 0x6c69676874ull;  // apart from the lights that bases are fitted to
constexpr size_t kRuns = 32, kRunSlots = 32;      // the sample: runs of neighbouring texels, spread evenly over the atlas

transport::PriorLight testLight(const BakeContext& context, uint32_t index) {
  return transport::samplePriorLights(context.scene(), context.atlas(), *context.tracer(), index + 1,
                                      combineKeys(context.settings().seed, kLightSeed))
      .back();
}

/// Segments of a path, about: the geometric series of the mean albedo.
double raysPerPath(const atlas::Atlas& atlas) {
  double reflected = 0, area = 0;
  for (const auto& slot : atlas.slots) {
    reflected += double(luminance(slot.albedo_rgb)) * slot.area;
    area += slot.area;
  }
  return 2 / (1 - std::min(0.999, area > 0 ? reflected / area : 0.0));  // each with its shadow ray
}

/// Half-open ranges of slots.
std::vector<std::pair<size_t, size_t>> sampledRuns(size_t slots) {
  if (slots <= kRuns * kRunSlots) return {{0, slots}};
  std::vector<std::pair<size_t, size_t>> runs;
  for (size_t i = 0; i < kRuns; ++i) {
    const size_t first = i * (slots - kRunSlots) / (kRuns - 1);
    runs.emplace_back(std::max(first, runs.empty() ? 0 : runs.back().second), first + kRunSlots);
  }
  return runs;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

/// Indirect irradiance per slot of the atlas, under one light.
using IndirectLight = std::function<std::vector<Rgb>(const scene::Light&)>;

std::optional<MeasuredError> measure(const BakeContext& context, std::span<const Blob> references, const IndirectLight& indirect) {
  struct Measured {
    double mean, relrmse, texrel, bias;
  };
  std::vector<Measured> lights;
  size_t texels = 0;
  for (uint32_t i = 0; i < references.size(); ++i) {
    ByteReader reader(*references[i]);
    std::vector<std::vector<Rgb>> reference_rgb(kReferences);
    for (auto& values : reference_rgb) values = reader.array<Rgb>();
    const std::vector<Rgb> indirect_rgb = indirect(testLight(context, i).light);
    std::vector<Rgb> candidate_rgb;
    for (const auto& [first, end] : sampledRuns(indirect_rgb.size()))
      candidate_rgb.insert(candidate_rgb.end(), indirect_rgb.begin() + std::ptrdiff_t(first), indirect_rgb.begin() + std::ptrdiff_t(end));
    const auto error = transport::compareWithReferences(reference_rgb, candidate_rgb);
    double mean = 0;
    for (const auto& values : reference_rgb)
      for (const auto& value : values) mean += luminance(value);
    if (error.texels == 0 || !std::isfinite(error.relrmse) || !std::isfinite(error.texrel)) continue;
    lights.push_back({mean, error.relrmse, error.texrel, error.bias});
    texels = std::max(texels, error.texels);
  }
  if (lights.empty()) return std::nullopt;
  const auto medianOf = [&](double Measured::*field) {
    std::vector<double> values;
    for (const auto& light : lights) values.push_back(light.*field);
    return median(values);
  };
  // Lights in sealed pockets say nothing about the scene.
  const double enough = 0.1 * medianOf(&Measured::mean);
  std::erase_if(lights, [&](const Measured& light) { return light.mean < enough; });
  return MeasuredError{
      std::max(0.0, medianOf(&Measured::relrmse)), std::max(0.0, medianOf(&Measured::texrel)),  // below zero: lost in noise
      medianOf(&Measured::bias),
      "median of " + std::to_string(lights.size()) + " point lights, indirect light path-traced at " + std::to_string(texels) + " texels"};
}

}  // namespace

std::vector<TaskIndex> addReferenceTasks(TaskGraph& graph, const BakeContext& context, uint32_t lights) {
  std::vector<TaskIndex> tasks;
  if (lights == 0) return tasks;
  // What emitting surfaces give would hide the error under a moving light: the references see them dark.
  std::shared_ptr<const scene::Scene> dark(&context.scene(), [](const scene::Scene*) {});
  if (context.facts().has_emitters) {
    auto copy = std::make_shared<scene::Scene>(context.scene());
    for (auto& material : copy->materials) material.emissive = Rgb(0.0f);
    dark = copy;
  }
  const double rays_per_path = raysPerPath(context.atlas());
  const auto samples = uint32_t(std::clamp(kMostRays / rays_per_path, double(kLeastSamples), double(kMostSamples)));
  const double rays = double(std::min(context.atlas().slots.size(), kRuns * kRunSlots)) * double(kReferences) * samples * rays_per_path;
  for (uint32_t i = 0; i < lights; ++i)
    tasks.push_back(graph.add({"measure/" + std::to_string(i),
                               "measure",
                               "measure",
                               context.keys().reflection.hex() + " " + std::to_string(context.settings().seed) + " " + std::to_string(i),
                               {},
                               rays,
                               [&context, dark, samples, i](const TaskInputs& in) {
                                 const scene::Light light = testLight(context, i).light;
                                 ByteWriter writer;
                                 for (uint64_t k = 1; k <= kReferences; ++k) {
                                   transport::ReferenceOptions options{.samples = samples, .threads = 1, .cancel = &in.cancel};
                                   options.seed = combineKeys(combineKeys(context.settings().seed, kLightSeed), k);
                                   std::vector<Rgb> irradiance_rgb;
                                   for (const auto& [first, end] : sampledRuns(context.atlas().slots.size())) {
                                     const auto run =
                                         transport::referenceIrradianceRange(*dark, context.atlas(), *context.tracer(), {light},
                                                                             transport::Component::indirect, options, first, end);
                                     irradiance_rgb.insert(irradiance_rgb.end(), run.irradiance_rgb.begin(), run.irradiance_rgb.end());
                                   }
                                   writer.array(irradiance_rgb);
                                 }
                                 return writer.take();
                               }}));
  return tasks;
}

std::optional<MeasuredError> measurePrm(const BakeContext& context, const transport::PrmResult& prm, std::span<const Blob> references) {
  const atlas::Atlas& atlas = context.atlas();
  return measure(context, references, [&](const scene::Light& light) {
    const auto values_rgb = transport::evaluatePrm(prm, transport::clusterIrradiance(prm.entries, *context.tracer(), light));
    std::vector<Rgb> indirect_rgb(atlas.slots.size(), Rgb(0.0f));
    for (size_t i = 0; i < prm.texel.size(); ++i) indirect_rgb[atlas.texel_slot[prm.texel[i]]] = values_rgb[i];
    return indirect_rgb;
  });
}

std::optional<MeasuredError> measureRadiosity(const BakeContext& context, const transport::RadiosityResult& radiosity, std::span<const Blob> references) {
  const atlas::Atlas& atlas = context.atlas();
  const transport::Sides sides = transport::surfaceSides(atlas);
  const std::vector<Rgb> dark(radiosity.patches.count(), Rgb(0.0f));
  return measure(context, references, [&](const scene::Light& light) {
    std::vector<Rgb> direct_rgb;
    for (const float irradiance :
         transport::patchIrradiance(context.scene(), atlas, *context.tracer(), sides, radiosity.patches, light, context.settings().seed))
      direct_rgb.emplace_back(irradiance);
    const auto solution = transport::solveRadiosity(radiosity.links, radiosity.tree, radiosity.patches.albedo_rgb, direct_rgb, dark, kSolved);
    std::vector<Rgb> indirect_rgb(atlas.slots.size(), Rgb(0.0f));
    for (size_t i = 0; i < radiosity.texel.size(); ++i)
      for (size_t k = 0; k < 4; ++k)
        if (const uint32_t patch = radiosity.texel_patch[i][k]; patch != kNone)
          indirect_rgb[atlas.texel_slot[radiosity.texel[i]]] += solution.irradiance_rgb[patch] * (radiosity.texel_weight[i][k] * radiosity.texel_exposed[i]);
    return indirect_rgb;
  });
}

}  // namespace lightwell::bake
