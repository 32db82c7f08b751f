// The sky's constant panes of a PRM: what static surfaces receive from it.
#pragma once
#include "precompute/bake/context.h"
#include "precompute/transport/prm/prm.h"

namespace lightwell::bake {

/// Irradiance per value of PrmResult::texel; both empty without a sky.
struct SkyPanes {
  std::vector<Rgb> direct_rgb, indirect_rgb;
};

/// Direct irradiance at the atlas's slots; outputs in range order. `context` must have surfaces and a sky, and outlive the graph.
/// Rays that these tasks trace, about.
uint64_t skyRays(const BakeContext& context, const plan::Settings& settings);

std::vector<TaskIndex> addSkyTasks(TaskGraph& graph, const BakeContext& context, const plan::Settings& settings);

/// The sky is one more light for `prm`: irradiance at its entry points, its transport, irradiance at texels. `direct`: outputs of the tasks.
SkyPanes makeSkyPanes(const BakeContext& context, const plan::Settings& settings, const transport::PrmResult& prm,
                      std::span<const Blob> direct, const CancelFlag& cancel);

}  // namespace lightwell::bake
