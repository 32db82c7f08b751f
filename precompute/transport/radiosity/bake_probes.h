// The stages of baking probes as pure functions from bytes to bytes.
//
//   places ─▶ hits(probe range) ─┐
//   RadiosityBaker's train ──────┴▶ links(probe range) ─▶ assemble
#pragma once
#include <memory>

#include "precompute/transport/radiosity/bake_radiosity.h"
#include "precompute/transport/radiosity/probe_links.h"

namespace lightwell::transport {

struct ProbeSettings {
  ProbeOptions places;
  ProbeLinkOptions links;  // with the number of rays from each probe
};

struct ProbeResult {
  Probes probes;
  ProbeLinks links;
};

/// Where probes are.
Bytes makeProbeBytes(const scene::Scene& scene, const trace::Tracer& tracer, const RadiosityBaker& radiosity, const ProbeSettings& settings, int threads,
                     const CancelFlag* cancel);

class ProbeBaker {
 public:
  /// `radiosity` must outlive the baker. `places` is makeProbeBytes of it and the same settings; throws std::runtime_error when it cannot be.
  ProbeBaker(const RadiosityBaker& radiosity, const ProbeSettings& settings, ByteView places);

  const Probes& probes() const { return probes_; }

  /// What the rays of probes [first, end) meet.
  Bytes hits(uint32_t first, uint32_t end) const;
  /// The links of the probes from `first` on that `hits` is of.
  Bytes links(uint32_t first, ByteView hits, ByteView trained) const;
  /// Joins and rounds the links (in range order). This and the stage before throw std::runtime_error for inputs that no stage wrote.
  ProbeResult assemble(std::span<const ByteView> links) const;

 private:
  const RadiosityBaker& radiosity_;
  ProbeSettings settings_;
  Probes probes_;
};

}  // namespace lightwell::transport
