#include "precompute/transport/reference/reference.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <numeric>

#include "precompute/core/error.h"
#include "precompute/core/parallel.h"
#include "precompute/transport/reference/path_batch.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kBatchPaths = 4096;  // a piece of work; few enough for the caches and for a prompt cancellation
constexpr uint32_t kMaxGroups = 8;

/// Samples of a texel are split into independently scrambled groups: points of one low-discrepancy set are not independent, so only the
/// scatter of the groups' means tells the error of the whole.
uint32_t groupCount(uint32_t samples) { return samples >= 64 ? kMaxGroups : std::min(samples, 4u); }

/// Sums of one texel's samples.
struct TexelSums {
  std::array<Vec3d, kMaxGroups> sum{};
  std::array<uint32_t, kMaxGroups> count{};

  void finish(uint32_t groups, Rgb& mean_rgb, Rgb& standard_error_rgb) const {
    Vec3d total(0.0), scatter(0.0);
    double samples = 0;
    for (uint32_t g = 0; g < groups; ++g) total += sum[g], samples += count[g];
    const Vec3d mean = total / samples;
    for (uint32_t g = 0; g < groups; ++g) {
      const Vec3d deviation = sum[g] / double(count[g]) - mean;
      scatter += deviation * deviation * double(count[g]);
    }
    mean_rgb = Rgb(mean);
    // From one group nothing is known of the error: infinity.
    for (int c = 0; c < 3; ++c)
      standard_error_rgb[c] =
          groups > 1 ? float(std::sqrt(scatter[c] / ((groups - 1) * samples))) : std::numeric_limits<float>::infinity();
  }
};

}  // namespace

IrradianceMap referenceIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer,
                                  const std::vector<scene::Light>& lights, Component component, const ReferenceOptions& options) {
  return referenceIrradianceRange(scene, atlas, tracer, lights, component, options, 0, atlas.slots.size());
}

IrradianceMap referenceIrradianceRange(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer,
                                       const std::vector<scene::Light>& lights, Component component, const ReferenceOptions& options,
                                       size_t first_slot, size_t end_slot) {
  if (first_slot > end_slot || end_slot > atlas.slots.size()) throw std::logic_error("referenceIrradianceRange: no such slots");
  std::vector<uint32_t> slots(end_slot - first_slot);
  std::iota(slots.begin(), slots.end(), uint32_t(first_slot));
  return referenceIrradianceOf(slots, scene, atlas, tracer, lights, component, options);
}

IrradianceMap referenceIrradianceOf(std::span<const uint32_t> slots, const scene::Scene& scene, const atlas::Atlas& atlas,
                                    const trace::Tracer& tracer, const std::vector<scene::Light>& lights, Component component,
                                    const ReferenceOptions& options) {
  if (options.samples == 0) throw UsageError("the reference needs at least one sample per texel");
  const size_t slot_count = slots.size();
  IrradianceMap map;
  map.irradiance_rgb.resize(slot_count);
  map.standard_error_rgb.resize(slot_count);

  const Emitters emitters(scene);
  const PunctualLights punctual(lights);
  const SkyLight* sky = options.sky && !options.sky->isBlack() ? options.sky : nullptr;
  const PathContext context{scene, atlas, tracer, emitters, punctual, sky, component, options.cancel, options.most_bounces};
  const uint32_t groups = groupCount(options.samples);
  std::mutex progress_mutex;
  size_t finished_slots = 0;

  parallelFor(slot_count, std::max(1u, kBatchPaths / options.samples), options.threads, options.cancel, [&](size_t begin, size_t end) {
    PathBatch batch(context);
    std::vector<PathStart> starts;
    std::vector<Rgb> irradiance_rgb;
    std::vector<TexelSums> sums(end - begin);
    // Paths are numbered slot by slot, sample by sample; a texel of many samples takes several batches.
    const uint64_t path_count = uint64_t(end - begin) * options.samples;
    for (uint64_t first = 0; first < path_count; first += kBatchPaths) {
      starts.clear();
      for (uint64_t i = first; i < std::min(first + kBatchPaths, path_count); ++i) {
        const uint32_t slot = slots[begin + i / options.samples], sample = uint32_t(i % options.samples);
        const uint64_t texel = atlas.slots[slot].texel;
        starts.push_back({slot, sample / groups, Sampler(options.seed, combineKeys(texel, sample % groups)),
                          combineKeys(combineKeys(options.seed, texel), sample)});
      }
      batch.trace(starts, irradiance_rgb);
      for (size_t i = 0; i < starts.size(); ++i) {
        TexelSums& texel = sums[(first + i) / options.samples];
        const uint32_t group = uint32_t((first + i) % options.samples) % groups;
        texel.sum[group] += Vec3d(irradiance_rgb[i]);
        ++texel.count[group];
      }
    }
    for (size_t i = begin; i < end; ++i) sums[i - begin].finish(groups, map.irradiance_rgb[i], map.standard_error_rgb[i]);
    if (options.progress) {
      std::lock_guard lock(progress_mutex);
      finished_slots += end - begin;
      options.progress(double(finished_slots) / double(slot_count));
    }
  });
  return map;
}

}  // namespace lightwell::transport
