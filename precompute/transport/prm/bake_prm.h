// The stages of a PRM bake as pure functions from bytes to bytes, so that any executor can run, cache and resume them.
//
//   oneBounce(group range) ─┐
//   trainingDirect(lights) ─┼─▶ solve ─▶ fit(block range) ─▶ assemble
//   emitterDirect(sides)   ─┘         └─▶ fitProbes(probe range) ─▶ assembleProbes
//
// PrmBaker holds what every stage derives from scene and settings alone; its construction is deterministic and cheap beside the stages.
#pragma once
#include <memory>
#include <string>

#include "precompute/core/bytes.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/prm/local_bases.h"

namespace lightwell::transport {

enum class PrmLayoutKind { local_bases, panes };
enum class PaneEstimator { gather, walks };

struct PrmSettings {
  PrmLayoutKind layout = PrmLayoutKind::local_bases;
  PaneEstimator estimator = PaneEstimator::gather;  // panes only
  EntryOptions entries;
  LocalBasesOptions bases;
  uint32_t cluster_rays = 128;      // per fine cluster, for all bounces but the last
  uint32_t training_lights = 768;   // local bases only
  LightPrior prior;                 // local bases only: where these are
  bool merge_unreached = true;      // local bases only: clusters that no such light reaches are one where they are neighbours
  uint32_t emitter_samples = 64;    // per texel
  std::vector<Vec3> probes;         // points in the air, internal units; local bases only
  uint32_t probe_rays = 8192;       // from each
  uint32_t walks_per_entry = 1;     // panes by walks
  uint64_t seed = 1;
};

/// Whether light may be missing on some surfaces for good: not where lights may be anywhere.
bool mergesUnreached(const PrmSettings& settings);

/// Clusters of entry points for these settings. `threads`: 0 for all of the machine; the result does not depend on it. Throws Cancelled; `cancel` may be null.
EntryClusters makePrmEntries(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings, int threads = 0,
                             const CancelFlag* cancel = nullptr);

class PrmBaker {
 public:
  /// What many calls read, and the first one of them decodes for all.
  using SharedBytes = std::shared_ptr<const Bytes>;

  /// `scene`, `atlas` and `tracer` must outlive the baker.
  PrmBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings);
  /// The same with the clusters that makePrmEntries() gives for these settings.
  PrmBaker(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const PrmSettings& settings,
           EntryClusters clusters);
  ~PrmBaker();

  uint32_t groupCount() const;
  const EntryClusters& clusters() const;
  uint32_t trainingLightCount() const;  // 0 for panes
  uint32_t sideCount() const;
  uint32_t blockCount() const;
  uint32_t probeCount() const;
  bool hasEmitters() const;

  /// What the fine clusters of groups [first, end) receive from groups.
  Bytes oneBounce(uint32_t first, uint32_t end) const;
  /// Direct irradiance on fine clusters under training lights [first, end).
  Bytes trainingDirect(uint32_t first, uint32_t end) const;
  /// Direct irradiance from the scene's emitters on sides [first, end); only when hasEmitters().
  Bytes emitterDirect(uint32_t first, uint32_t end) const;

  /// Joins the outputs of the stages above (each list in range order; `emitter` empty without emitters): all further bounces.
  Bytes solve(std::span<const ByteView> one_bounce, std::span<const ByteView> training, std::span<const ByteView> emitter) const;

  /// Blocks [first, end): traced and, for local bases, fitted.
  Bytes fit(uint32_t first, uint32_t end, const SharedBytes& solved) const;

  /// Probes [first, end): traced and fitted.
  Bytes fitProbes(uint32_t first, uint32_t end, const SharedBytes& solved) const;
  /// The finished probes from the outputs of fitProbes in range order.
  PrmProbes assembleProbes(std::span<const ByteView> probes) const;

  /// The finished map, but for its probes, from the outputs of fit and of emitterDirect (each in range order).
  PrmResult assemble(std::span<const ByteView> blocks, std::span<const ByteView> emitter) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell::transport
