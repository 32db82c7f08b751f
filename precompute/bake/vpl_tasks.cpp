#include "precompute/bake/vpl_tasks.h"

#include <algorithm>
#include <cmath>

#include "precompute/bake/stage_tasks.h"
#include "precompute/core/random.h"
#include "precompute/transport/many_lights/virtual_light_irradiance.h"
#include "precompute/transport/measured_texels.h"
#include "precompute/transport/reference/reference.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::bake {
namespace {

constexpr uint32_t kPathsPerTask = 16384;
constexpr uint32_t kMeasuredTexels = 512, kMeasuredPerTask = 64;
constexpr uint64_t kReferenceSeed = 0x76706cull, kLookSeed = 0x6c6f6f6bull, kRetracedSeed = 0x6d6f7265ull;  // apart from all other seeds
constexpr uint32_t kPathsPerLight = 100, kFewestPaths = 20000, kMostPaths = 1u << 22;

uint32_t lightsFor(plan::Quality quality) {
  switch (quality) {
    case plan::Quality::draft:
      return 200;
    case plan::Quality::preview:
      return 500;
    case plan::Quality::production:
      return 1500;
  }
  return 0;
}

std::optional<transport::VirtualLightType> typeOf(plan::VirtualLightShape shape) {
  switch (shape) {
    case plan::VirtualLightShape::automatic:
      return std::nullopt;
    case plan::VirtualLightShape::point:
      return transport::VirtualLightType::point;
    case plan::VirtualLightShape::disk:
      return transport::VirtualLightType::disk;
    case plan::VirtualLightShape::sphere:
      return transport::VirtualLightType::sphere;
    case plan::VirtualLightShape::polygon:
      return transport::VirtualLightType::polygon;
  }
  return std::nullopt;
}

transport::MeasuredTexels texelsFor(const BakeContext& context) {
  const std::vector<uint32_t> even(context.atlas().slots.size(), 1);
  return transport::chooseTexels(even, kMeasuredTexels, combineKeys(context.settings().seed, kReferenceSeed));
}

/// Independent maps of all that was reflected, and of emitters' own light: what lamps and the sky give straight is not in the lights. `paths`: times as many as usual.
std::vector<std::vector<Rgb>> traceReferences(const BakeContext& context, uint32_t bounces, std::span<const uint32_t> slots, uint64_t seed, uint32_t paths, int threads, const CancelFlag& cancel) {
  const scene::Scene& scene = context.scene();
  std::vector<std::vector<Rgb>> maps_rgb;
  for (uint64_t k = 1; k <= transport::kMeasuringReferences; ++k) {
    transport::ReferenceOptions options{.samples = paths * transport::measuringPaths(context.atlas()), .threads = threads, .sky = context.skyLight(), .cancel = &cancel};
    options.seed = combineKeys(combineKeys(context.settings().seed, seed), k);
    if (bounces) options.most_bounces = bounces;
    auto& light_rgb = maps_rgb.emplace_back(
        transport::referenceIrradianceOf(slots, scene, context.atlas(), *context.tracer(), scene.lights, transport::Component::indirect, options).irradiance_rgb);
    if (!context.facts().has_emitters) continue;
    options.sky = nullptr;
    const auto direct = transport::referenceIrradianceOf(slots, scene, context.atlas(), *context.tracer(), {}, transport::Component::direct, options).irradiance_rgb;
    for (size_t i = 0; i < light_rgb.size(); ++i) light_rgb[i] += direct[i];
  }
  return maps_rgb;
}

/// Twice, independently.
Bytes irradiance(const BakeContext& context, std::span<const transport::VirtualLight> lights, uint32_t first, uint32_t end, const CancelFlag& cancel) {
  const transport::MeasuredTexels texels = texelsFor(context);
  const transport::VirtualLightSampler sampler(context.scene(), context.atlas(), *context.tracer(), lights);
  ByteWriter writer;
  for (const uint64_t half : {1u, 2u})
    writer.array(sampler.irradiance(std::span(texels.slot).subspan(first, end - first), combineKeys(combineKeys(context.settings().seed, kLookSeed), half), cancel));
  return writer.take();
}

}  // namespace

VplSettings vplSettings(const plan::Settings& settings) {
  VplSettings vpl;
  // A step halves the error: four times the lights.
  const double lights =
      settings.virtual_lights ? settings.virtual_lights : lightsFor(settings.quality) * std::exp2(2.0 * settings.refinement);
  vpl.clusters.lights = uint32_t(std::clamp(lights, 1.0, double(plan::kMostVirtualLights)));
  vpl.paths.bounces = settings.virtual_bounces;
  vpl.clusters.type = typeOf(settings.virtual_light);
  vpl.clusters.seed = vpl.paths.seed = settings.seed;
  vpl.paths.paths = std::clamp(vpl.clusters.lights * kPathsPerLight, kFewestPaths, kMostPaths);
  return vpl;
}

VplTasks addVplTasks(TaskGraph& graph, const BakeContext& context, const VplSettings& settings, bool measure) {
  VplTasks tasks;
  const auto paths = std::make_shared<const transport::LightPaths>(context.scene(), context.atlas(), *context.tracer(),
                                                                   context.scene().lights, context.skyLight(), settings.paths);
  const Parameters light = Parameters(context.keys().surfaces).add(context.keys().lights).add(context.skyKey()).add(settings.paths.paths, settings.paths.bounces, settings.paths.seed);
  const auto traced = addRange(graph, "vpl", "light paths", light, paths->count(), kPathsPerTask, 3, {},
                               [paths](uint32_t first, uint32_t end, const TaskInputs& in) {
                                 ByteWriter writer;
                                 writer.array(paths->trace(first, end, &in.cancel));
                                 return writer.take();
                               });
  const transport::ClusterOptions& c = settings.clusters;
  tasks.lights = graph.add({"vpl/clusters", "virtual lights", "vpl/clusters",
                    Parameters(light).add(c.lights, c.type ? int(*c.type) : 0, c.seed).text(), traced, 2.0 * paths->count(),
                    [&context, c](const TaskInputs& in) {
                      std::vector<transport::VirtualPoint> points;
                      for (const auto& bytes : in.inputs) {
                        ByteReader reader(*bytes);
                        const auto some = reader.array<transport::VirtualPoint>();
                        points.insert(points.end(), some.begin(), some.end());
                      }
                      const float radius = 0.5f * context.scene().bounds.size().length();
                      const Bytes lights = transport::toBytes(transport::clusterPoints(points, radius, c, &in.cancel));
                      ByteWriter writer;
                      writer.array(std::vector<uint64_t>{points.size()});
                      writer.array(lights);
                      return writer.take();
                    }});
  if (!measure) return tasks;
  const uint32_t texels = uint32_t(texelsFor(context).slot.size());
  const double rays = transport::kMeasuringReferences * transport::measuringPaths(context.atlas()) * transport::raysPerPath(context.atlas());
  tasks.references = addRange(graph, "vpl", "measure", Parameters(context.keys().surfaces).add(context.keys().lights).add(context.skyKey()).add(settings.paths.bounces, settings.paths.seed), texels,
                              kMeasuredPerTask, rays, {}, [&context, bounces = settings.paths.bounces](uint32_t first, uint32_t end, const TaskInputs& in) {
                                const transport::MeasuredTexels chosen = texelsFor(context);
                                ByteWriter writer;
                                for (const auto& map_rgb : traceReferences(context, bounces, std::span(chosen.slot).subspan(first, end - first), kReferenceSeed, 1, 1, in.cancel))
                                  writer.array(map_rgb);
                                return writer.take();
                              });
  tasks.irradiance = addRange(graph, "vpl", "measure lights", Parameters(light).add(c.lights, c.type ? int(*c.type) : 0, c.seed), texels, kMeasuredPerTask, rays, {tasks.lights},
                              [&context](uint32_t first, uint32_t end, const TaskInputs& in) { return irradiance(context, readVplResult(*in.inputs[0]).lights, first, end, in.cancel); });
  return tasks;
}

MeasuredError measureVpl(const BakeContext& context, const VplSettings& settings, std::span<const Blob> references, std::span<const Blob> irradiance, const CancelFlag& cancel) {
  const transport::MeasuredTexels texels = texelsFor(context);
  const auto joined = [&](std::span<const Blob> parts, size_t maps) {
    std::vector<std::vector<Rgb>> joined_rgb(maps);
    for (const Blob& part : parts) {
      ByteReader reader(*part);
      for (auto& values : joined_rgb) {
        const auto some = reader.array<Rgb>();
        values.insert(values.end(), some.begin(), some.end());
      }
    }
    for (const auto& values : joined_rgb) transport::require(values.size() == texels.slot.size());
    return joined_rgb;
  };
  const auto lights_rgb = joined(irradiance, 2);
  const auto retrace = [&](std::span<const uint32_t> some) {
    std::vector<uint32_t> slots;
    for (const uint32_t texel : some) slots.push_back(texels.slot[texel]);
    return traceReferences(context, settings.paths.bounces, slots, kRetracedSeed, transport::kRetracedPaths, context.threads(), cancel);
  };
  const auto error = transport::compareWithReferences(joined(references, transport::kMeasuringReferences), {lights_rgb[0], lights_rgb[1]}, texels.weight, retrace);
  const std::string reflected = settings.paths.bounces ? "light reflected up to " + std::to_string(settings.paths.bounces) + " times" : "reflected light";
  return {error, (context.facts().has_emitters ? "emitters' and " : "") + reflected + ", path-traced at " + std::to_string(error.texels) + " texels"};
}

VplResult readVplResult(ByteView bytes) {
  ByteReader reader(bytes);
  const auto points = reader.array<uint64_t>();
  const auto lights = reader.array<uint8_t>();
  transport::require(points.size() == 1 && reader.empty());
  return {points[0], transport::readVirtualLights(lights)};
}

}  // namespace lightwell::bake
