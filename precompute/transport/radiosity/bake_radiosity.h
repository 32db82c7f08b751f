// The stages of a radiosity bake as pure functions from bytes to bytes, so that any executor can run, cache and resume them.
//
//   hits(patch range)   ─┐
//   direct(light range) ─┴▶ train ─▶ links(patch range) ─▶ assemble
//
// Which patches there are is a result too (makePatchBytes), known before the others are planned. Form factors know nothing of colours: hits and
// patches outlast any change of albedo or emission.
#pragma once
#include <memory>

#include "precompute/core/bytes.h"
#include "precompute/transport/radiosity/radiosity.h"

namespace lightwell::transport {

struct RadiositySettings {
  PatchOptions patches;
  LinkOptions links;
  uint32_t rays = 2048;            // per patch
  uint32_t training_lights = 64;
  uint64_t seed = 1;
};

/// The patches, without their colours.
Bytes makePatchBytes(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiositySettings& settings, int threads,
                     const CancelFlag* cancel);

inline constexpr uint32_t kMostGateSets = 65536;

/// What is known before rows are compressed.
struct TrainedFactors {
  FormFactors factors;
  RadiosityTraining training;
};

class RadiosityBaker {
 public:
  /// `scene`, `atlas` and `tracer` must outlive the baker. `patches` is makePatchBytes of the same arguments; throws std::runtime_error when it cannot be.
  RadiosityBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const RadiositySettings& settings, ByteView patches);
  ~RadiosityBaker();

  uint32_t patchCount() const;
  uint32_t trainingLightCount() const;
  const Sides& sides() const;
  const Patches& patches() const;
  const PatchTree& tree() const;
  /// Rays through the scene's portals.
  const GatedTracer& tracer() const;

  /// What the rays of patches [first, end) meet.
  Bytes hits(uint32_t first, uint32_t end) const;
  /// Direct irradiance on the patches under training lights [first, end).
  Bytes direct(uint32_t first, uint32_t end) const;
  /// Form factors, and radiosities under the training lights. Inputs in range order.
  Bytes train(std::span<const ByteView> hits, std::span<const ByteView> direct) const;
  /// The result of train.
  TrainedFactors readTrained(ByteView trained) const;
  /// The compressed rows of patches [first, end).
  Bytes links(uint32_t first, uint32_t end, ByteView trained) const;
  /// Joins, balances and rounds the links (in range order). This and the stages before throw std::runtime_error for inputs that no stage wrote.
  RadiosityResult assemble(std::span<const ByteView> links, int threads, const CancelFlag* cancel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell::transport
