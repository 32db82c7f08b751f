#include "precompute/bake/vpl_tasks.h"

#include <algorithm>
#include <cmath>

#include "precompute/bake/stage_tasks.h"
#include "precompute/transport/stage_bytes.h"

namespace lightwell::bake {
namespace {

constexpr uint32_t kPathsPerTask = 16384;
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

TaskIndex addVplTasks(TaskGraph& graph, const BakeContext& context, const VplSettings& settings) {
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
  return graph.add({"vpl/clusters", "virtual lights", "vpl/clusters",
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
}

VplResult readVplResult(ByteView bytes) {
  ByteReader reader(bytes);
  const auto points = reader.array<uint64_t>();
  const auto lights = reader.array<uint8_t>();
  transport::require(points.size() == 1 && reader.empty());
  return {points[0], transport::readVirtualLights(lights)};
}

}  // namespace lightwell::bake
