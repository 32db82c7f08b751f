// The errors that a container carries about its own indirect light: measured with path tracing, for lights that the bake has not seen.
#pragma once
#include <optional>

#include "precompute/bake/context.h"
#include "precompute/transport/prm/prm.h"
#include "precompute/transport/radiosity/bake_radiosity.h"

namespace lightwell::bake {

/// Medians over the test lights of the errors of indirect irradiance (docs/cli.md defines them).
struct MeasuredError {
  double relrmse = 0, texrel = 0, bias = 0;
  std::string against;  // in words
};

/// Adds one task for each of `lights` test lights: its path-traced indirect irradiance at a sample of texels, four times, independently.
/// `context` must have a tracer and outlive the graph.
std::vector<TaskIndex> addReferenceTasks(TaskGraph& graph, const BakeContext& context, uint32_t lights);

/// Compares what was baked with the results of these tasks. Nothing when there are none, or no light reaches the sampled texels.
std::optional<MeasuredError> measurePrm(const BakeContext& context, const transport::PrmResult& prm, std::span<const Blob> references);
std::optional<MeasuredError> measureRadiosity(const BakeContext& context, const transport::RadiosityResult& radiosity, std::span<const Blob> references);

}  // namespace lightwell::bake
