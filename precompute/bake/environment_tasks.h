// The environment's stages as tasks of the graph.
#pragma once
#include "precompute/bake/context.h"
#include "precompute/transport/environment/environment.h"
#include "precompute/transport/pooled_error.h"

namespace lightwell::bake {

struct EnvironmentTasks {
  TaskIndex baked = 0;                 // output: readEnvironment() takes it
  std::optional<TaskIndex> measured;   // output: readEnvironmentErrors() takes it
};

/// `context` must have a sky and outlive the graph. With `measure`, the answers are compared with quadrature over the map.
EnvironmentTasks addEnvironmentTasks(TaskGraph& graph, const BakeContext& context, const plan::Settings& settings, bool measure);

/// The output of the task `baked`. Both throw a std::exception for bytes that no such task wrote.
transport::Environment readEnvironment(const Blob& baked);

/// What is stored is off by this much, unoccluded.
struct EnvironmentError {
  transport::PooledError error;  // of directions in place of texels
  float shininess;               // 1: irradiance
};
std::vector<EnvironmentError> readEnvironmentErrors(const Blob& measured);

}  // namespace lightwell::bake
