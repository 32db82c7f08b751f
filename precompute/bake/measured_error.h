// The errors that a container carries about its own indirect light: measured with path tracing, for lights that the bake has not seen.
#pragma once
#include <optional>

#include "lightwell/v1/container.pb.h"
#include "precompute/bake/context.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/prm/prm.h"
#include "precompute/transport/radiosity/bake_radiosity.h"

namespace lightwell::bake {

struct MeasuredError {
  transport::PooledError error;  // medians over the test lights, of indirect irradiance
  std::string against;           // in words
};

/// Adds it to what the container says of its sections, unless nothing was lit.
void addMeasuredError(v1::MetaHeader& meta, const char* section, const MeasuredError& measured);

/// Adds one task for each of `lights` test lights: its path-traced indirect irradiance at a sample of texels, several times, independently.
/// `context` must have a tracer and outlive the graph.
std::vector<TaskIndex> addReferenceTasks(TaskGraph& graph, const BakeContext& context, uint32_t lights);

/// Compares what was baked with the results of these tasks. Nothing when there are none, or no light reaches the sampled texels. Traces a few texels again. Throw Cancelled.
std::optional<MeasuredError> measurePrm(const BakeContext& context, const transport::PrmResult& prm, std::span<const Blob> references, const CancelFlag& cancel);
std::optional<MeasuredError> measureRadiosity(const BakeContext& context, const transport::RadiosityResult& radiosity, std::span<const Blob> references,
                                              const CancelFlag& cancel);

}  // namespace lightwell::bake
