// From a scene to a container.
#pragma once
#include <string>
#include <vector>

#include "format/encode/reader.h"
#include "precompute/bake/context.h"
#include "precompute/bake/executor.h"

namespace lightwell::bake {

/// "0.1.0"; part of every task's key.
const char* productVersion();

/// The graph of a bake, and its one goal: the task whose result is the container's bytes. The same context gives the same graph in any
/// process. Functions of the tasks refer to the context, which must outlive the graph.
struct BakeGraph {
  TaskGraph graph;
  TaskIndex container = 0;
  std::vector<plan::Omitted> omitted;
};
struct GraphOptions {
  plan::Settings settings;       // techniques, quality and refinement may differ from the context's
  std::vector<Warning> warnings; // stored in the container's provenance
  uint32_t test_lights = 0;      // errors are measured, those of indirect light with so many lights; 0: not
  bool time_limited = false;     // stored: the quality was chosen by the clock
};
/// `tasks` runs what the graph's form depends on.
BakeGraph makeBakeGraph(const BakeContext& context, const GraphOptions& options, TaskRunner& tasks);

struct SectionSize {
  std::string type;
  uint64_t stored_bytes = 0, raw_bytes = 0;  // in the file, and decoded
};
/// Sizes of the sections of a container, in its order.
std::vector<SectionSize> sectionSizes(const format::Reader& container);

}  // namespace lightwell::bake
