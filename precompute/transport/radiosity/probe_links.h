// What probes receive from the patches, as few links: shares of the sphere, from which the runtime makes spherical harmonics. A link's direction need not be stored: it is the
// way to the middle of its node.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/transport/radiosity/gated_hits.h"
#include "precompute/transport/radiosity/links.h"
#include "precompute/transport/radiosity/probes.h"

namespace lightwell::transport {

/// What the rays of probes met: patches, grouped by the gate sets on the way.
struct ProbeHits {
  std::vector<uint32_t> first = {0};  // probes + 1: groups of each
  std::vector<uint32_t> set;          // per group: number in `sets`, ascending within a probe
  std::vector<uint64_t> group_first = {0};  // groups + 1: hits of each
  std::vector<std::array<float, 9>> moments;  // per group: Σ Y over its rays, over the number of a probe's rays
  std::vector<uint32_t> patch;        // ascending within a group
  std::vector<uint32_t> count;
  std::vector<Vec3> direction;        // sum of the rays' unit directions
  GateSets sets;
  uint32_t probes() const { return uint32_t(first.size()) - 1; }
};

/// Traces `rays` rays from each of the probes [begin, end), uniform over the sphere.
ProbeHits countProbeHits(const GatedTracer& tracer, const Probes& probes, uint32_t rays, uint64_t seed, uint32_t begin, uint32_t end);

/// The integral of radiance times Y over the sphere is Σ_l value[l] · 4π · radiosity(node[l]) / π · Y(direction to nodePositions of node[l]).
struct ProbeLinkValues {
  std::vector<uint32_t> first = {0};  // probes + 1
  std::vector<uint32_t> set;          // number in `sets`
  std::vector<uint32_t> node;         // ascending within a probe and set
  std::vector<float> value;           // > 0: share of the sphere; within a probe and set they sum to the share that met patches
  GateSets sets;
  uint32_t probes() const { return uint32_t(first.size()) - 1; }
  void append(const ProbeLinkValues& other);
};

/// The same rounded: value = scale · linkWeight(code); ordered by set within a probe.
struct ProbeLinks {
  std::vector<uint32_t> first = {0};
  std::vector<uint32_t> set;
  GateSets sets;
  std::vector<uint32_t> node;
  std::vector<uint8_t> code;
  std::vector<float> scale;           // per probe; 0 without links
};

struct ProbeLinkOptions {
  /// Neighbours merge up to this error of the irradiance about all normals (rms), over the mean irradiance and a tenth of the scene's.
  float error = 0.015f;
  float uneven = 0.004f;      // as LinkOptions::uneven
  uint32_t most_lights = 16;  // of the training lights that decide
  uint32_t rays = 4096;       // that were traced from each probe
};

/// Means of the patches' positions by area.
std::vector<Vec3> nodePositions(const Patches& patches, const PatchTree& tree);

/// What is known of the nodes, whoever looks at them.
struct ProbeSurroundings {
  const PatchTree& tree;
  std::vector<Vec3> position;   // nodePositions
  std::vector<char> mergeable;  // nodesThatSeeTheSame
};

/// `positions`: of the probes that `hits` is of.
ProbeLinkValues makeProbeLinks(const ProbeHits& hits, std::span<const Vec3> positions, const ProbeSurroundings& surroundings, const RadiosityTraining& training,
                               const ProbeLinkOptions& options);

ProbeLinks quantiseProbeLinks(const ProbeLinkValues& links);

}  // namespace lightwell::transport
