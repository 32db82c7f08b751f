#include "precompute/bake/sky_tasks.h"

#include <algorithm>

#include "precompute/transport/prm/evaluate.h"
#include "precompute/transport/reference/sky_irradiance.h"

namespace lightwell::bake {
namespace {

constexpr size_t kSlotsPerTask = 1024;  // a few tenths of a second

uint32_t samplesOf(plan::Quality quality) {
  return quality == plan::Quality::draft ? 32 : quality == plan::Quality::preview ? 64 : 256;
}

transport::SkyScene skyScene(const BakeContext& context, const plan::Settings& settings) {
  return {context.scene().mesh, context.atlas(), *context.tracer(), *context.skyLight(), samplesOf(settings.quality), settings.seed};
}

}  // namespace

uint64_t skyRays(const BakeContext& context, const plan::Settings& settings) { return 2ull * samplesOf(settings.quality) * context.atlas().slots.size(); }

std::vector<TaskIndex> addSkyTasks(TaskGraph& graph, const BakeContext& context, const plan::Settings& settings) {
  const size_t slots = context.atlas().slots.size();
  const uint32_t samples = samplesOf(settings.quality);
  std::vector<TaskIndex> tasks;
  for (size_t first = 0; first < slots; first += kSlotsPerTask) {
    const size_t end = std::min(slots, first + kSlotsPerTask);
    tasks.push_back(graph.add({"prm/sky/" + std::to_string(first / kSlotsPerTask),
                               "sky",
                               "prm/sky",
                               context.keys().geometry.hex() + context.skyKey().hex() + " " + std::to_string(samples) + " " +
                                   std::to_string(settings.seed) + " [" + std::to_string(first) + ", " + std::to_string(end) + ")",
                               {},
                               2.0 * samples * double(end - first),
                               [&context, settings, first, end](const TaskInputs&) {
                                 ByteWriter writer;
                                 writer.array(transport::skyOnSlots(skyScene(context, settings), first, end));
                                 return writer.take();
                               }}));
  }
  return tasks;
}

SkyPanes makeSkyPanes(const BakeContext& context, const plan::Settings& settings, const transport::PrmResult& prm,
                      std::span<const Blob> direct, const CancelFlag& cancel) {
  std::vector<Rgb> slot_rgb;
  for (const Blob& part : direct) {
    const auto values = ByteReader(*part).array<Rgb>();
    slot_rgb.insert(slot_rgb.end(), values.begin(), values.end());
  }
  SkyPanes panes;
  for (const uint32_t texel : prm.texel) panes.direct_rgb.push_back(slot_rgb.at(context.atlas().texel_slot[texel]));

  const transport::PrmEntries& entries = prm.entries;
  const auto entry_rgb =
      transport::skyAtPoints(skyScene(context, settings), entries.position, entries.normal, context.threads(), &cancel);
  std::vector<Rgb> cluster_rgb(entries.clusterCount(), Rgb(0.0f));
  for (uint32_t cluster = 0; cluster < entries.clusterCount(); ++cluster)
    for (uint32_t i = entries.cluster_first_entry[cluster]; i < entries.cluster_first_entry[cluster + 1]; ++i)
      cluster_rgb[cluster] += entry_rgb[i] * entries.weight[i];
  panes.indirect_rgb = transport::evaluatePrm(prm, cluster_rgb);
  return panes;
}

}  // namespace lightwell::bake
