#include "precompute/bake/measured_error.h"

#include <algorithm>
#include <cmath>

#include "precompute/bake/prm_tasks.h"
#include "precompute/core/random.h"
#include "precompute/transport/measured_texels.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/evaluate.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/radiosity/solve.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::bake {
namespace {

constexpr double kSolved = 1e-4;          // residual: far below what is measured
constexpr uint32_t kMeasuredTexels = 1024;  // for each light others, so that lights tell of texels too
constexpr uint64_t kLightSeed = 0x6c69676874ull;  // apart from the lights that bases are fitted to
constexpr uint64_t kRetracedSeed = 0x6d6f7265ull;

transport::PriorLight testLight(const BakeContext& context, uint32_t index) {
  const auto lights = transport::samplePriorLights(context.scene(), context.atlas(), *context.tracer(), lightPrior(context.settings(), context.scene()), index + 1,
                                                   combineKeys(context.settings().seed, kLightSeed));
  return lights[index % lights.size()];  // lamps are at most as many as there are
}

transport::MeasuredTexels texelsFor(const BakeContext& context, uint32_t light) {
  const std::vector<uint32_t> even(context.atlas().slots.size(), 1);
  return transport::chooseTexels(even, kMeasuredTexels, combineKeys(combineKeys(context.settings().seed, kLightSeed), light));
}

/// What emitting surfaces give would hide the error under a moving light: the references see them dark.
std::shared_ptr<const scene::Scene> darkScene(const BakeContext& context) {
  if (!context.facts().has_emitters) return {&context.scene(), [](const scene::Scene*) {}};
  auto copy = std::make_shared<scene::Scene>(context.scene());
  for (auto& material : copy->materials) material.emissive = Rgb(0.0f);
  return copy;
}

std::string lightsText(plan::MovingLights lights) {
  switch (lights) {
    case plan::MovingLights::ceilings: return "point lights under ceilings";
    case plan::MovingLights::sun: return "suns";
    case plan::MovingLights::lamps: return "of the scene's lamps";
    case plan::MovingLights::paths: return "point lights on the given paths";
    default: return "point lights";
  }
}

/// Independent maps of slots under test light `light`; `paths`: times as many as usual.
std::vector<std::vector<Rgb>> traceReferences(const BakeContext& context, const scene::Scene& dark, uint32_t light, std::span<const uint32_t> slots, uint64_t seed, uint32_t paths, int threads,
                                              const CancelFlag& cancel) {
  std::vector<std::vector<Rgb>> maps_rgb;
  for (uint64_t k = 1; k <= transport::kMeasuringReferences; ++k) {
    transport::ReferenceOptions options{.samples = paths * transport::measuringPaths(context.atlas()), .threads = threads, .cancel = &cancel};
    options.seed = combineKeys(combineKeys(combineKeys(context.settings().seed, seed), light), k);
    maps_rgb.push_back(
        transport::referenceIrradianceOf(slots, dark, context.atlas(), *context.tracer(), {testLight(context, light).light}, transport::Component::indirect, options).irradiance_rgb);
  }
  return maps_rgb;
}

/// Indirect irradiance per slot of the atlas, under one light.
using IndirectLight = std::function<std::vector<Rgb>(const scene::Light&)>;

std::optional<MeasuredError> measure(const BakeContext& context, std::span<const Blob> references, const CancelFlag& cancel, const IndirectLight& indirect) {
  const auto dark = darkScene(context);
  std::vector<transport::PooledError> errors;
  std::vector<double> means;  // brightness under these lights
  for (uint32_t i = 0; i < references.size(); ++i) {
    ByteReader reader(*references[i]);
    std::vector<std::vector<Rgb>> reference_rgb(transport::kMeasuringReferences);
    double sum = 0;
    for (auto& values : reference_rgb) {
      values = reader.array<Rgb>();
      for (const Rgb& value : values) sum += luminance(value);
    }
    const std::vector<Rgb> indirect_rgb = indirect(testLight(context, i).light);
    const transport::MeasuredTexels texels = texelsFor(context, i);
    std::vector<Rgb> candidate_rgb;
    for (const uint32_t slot : texels.slot) candidate_rgb.push_back(indirect_rgb[slot]);
    const auto retrace = [&](std::span<const uint32_t> some) {
      std::vector<uint32_t> slots;
      for (const uint32_t texel : some) slots.push_back(texels.slot[texel]);
      return traceReferences(context, *dark, i, slots, kRetracedSeed, transport::kRetracedPaths, context.threads(), cancel);
    };
    const auto error = transport::compareWithReferences(reference_rgb, candidate_rgb, texels.weight, retrace);
    if (error.texels == 0 || !std::isfinite(error.relrmse) || !std::isfinite(error.texrel)) continue;
    errors.push_back(error);
    means.push_back(sum / double(texels.slot.size()));
  }
  if (errors.empty()) return std::nullopt;
  // Lights in sealed pockets say nothing about the scene.
  std::vector<double> in_order = means;
  std::nth_element(in_order.begin(), in_order.begin() + std::ptrdiff_t(in_order.size() / 2), in_order.end());
  const double enough = 0.1 * in_order[in_order.size() / 2];
  std::vector<transport::PooledError> kept;
  for (size_t i = 0; i < errors.size(); ++i)
    if (means[i] >= enough) kept.push_back(errors[i]);
  const auto error = transport::medianError(kept);
  return MeasuredError{error, "medians of " + std::to_string(kept.size()) + " " + lightsText(context.settings().moving_lights) + ", indirect light path-traced at " + std::to_string(error.texels) + " texels each"};
}

}  // namespace

void addMeasuredError(v1::MetaHeader& meta, const char* section, const MeasuredError& measured) {
  const transport::PooledError& e = measured.error;
  if (e.texels == 0 || !std::isfinite(e.relrmse) || !std::isfinite(e.texrel)) return;
  v1::MeasuredError& error = *meta.add_errors();
  error.set_section(section);
  const auto root = [](double value) { return std::max(0.0, value); };  // below zero: lost in noise
  error.set_relrmse(root(e.relrmse)), error.set_relrmse_low(root(e.relrmse_95.low)), error.set_relrmse_high(root(e.relrmse_95.high));
  error.set_texrel(root(e.texrel)), error.set_texrel_low(root(e.texrel_95.low)), error.set_texrel_high(root(e.texrel_95.high));
  error.set_bias(e.bias), error.set_bias_low(std::max(-1.0, e.bias_95.low)), error.set_bias_high(std::max(-1.0, e.bias_95.high));
  error.set_maximum(e.maximum), error.set_maximum_low(e.maximum_95.low), error.set_maximum_high(e.maximum_95.high);
  error.set_texels(uint32_t(e.texels));
  error.set_against(measured.against);
}

std::vector<TaskIndex> addReferenceTasks(TaskGraph& graph, const BakeContext& context, uint32_t lights) {
  std::vector<TaskIndex> tasks;
  if (lights == 0) return tasks;
  const auto dark = darkScene(context);
  const uint32_t paths = transport::measuringPaths(context.atlas());
  const double rays = double(std::min<size_t>(context.atlas().slots.size(), kMeasuredTexels)) * transport::kMeasuringReferences * paths * transport::raysPerPath(context.atlas());
  for (uint32_t i = 0; i < lights; ++i)
    tasks.push_back(graph.add({"measure/" + std::to_string(i),
                               "measure",
                               "measure",
                               context.keys().reflection.hex() + " " + std::to_string(context.settings().seed) + " " + priorKey(lightPrior(context.settings(), context.scene()), context.keys()).hex() + " " + std::to_string(i),
                               {},
                               rays,
                               [&context, dark, i](const TaskInputs& in) {
                                 ByteWriter writer;
                                 for (const auto& map_rgb : traceReferences(context, *dark, i, texelsFor(context, i).slot, kLightSeed, 1, 1, in.cancel)) writer.array(map_rgb);
                                 return writer.take();
                               }}));
  return tasks;
}

std::optional<MeasuredError> measurePrm(const BakeContext& context, const transport::PrmResult& prm, std::span<const Blob> references, const CancelFlag& cancel) {
  const atlas::Atlas& atlas = context.atlas();
  return measure(context, references, cancel, [&](const scene::Light& light) {
    const auto values_rgb = transport::evaluatePrm(prm, transport::clusterIrradiance(prm.entries, *context.tracer(), light));
    std::vector<Rgb> indirect_rgb(atlas.slots.size(), Rgb(0.0f));
    for (size_t i = 0; i < prm.texel.size(); ++i) indirect_rgb[atlas.texel_slot[prm.texel[i]]] = values_rgb[i];
    return indirect_rgb;
  });
}

std::optional<MeasuredError> measureRadiosity(const BakeContext& context, const transport::RadiosityResult& radiosity, std::span<const Blob> references,
                                              const CancelFlag& cancel) {
  const atlas::Atlas& atlas = context.atlas();
  const transport::Sides sides = transport::surfaceSides(atlas);
  const std::vector<Rgb> dark(radiosity.patches.count(), Rgb(0.0f));
  return measure(context, references, cancel, [&](const scene::Light& light) {
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
