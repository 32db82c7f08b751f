#include "precompute/transport/prm/unreached.h"

#include <algorithm>

#include "precompute/core/parallel.h"
#include "precompute/transport/prm/entry_irradiance.h"

namespace lightwell::transport {
namespace {

constexpr size_t kLightsAtOnce = 32;  // most clusters are lit by one of the first

class Reach {
 public:
  Reach(const PrmEntries& entries, const trace::Tracer& tracer) : entries_(entries), tracer_(tracer) {}

  bool byAnyOf(std::span<const PriorLight> lights, uint32_t cluster) {
    rays_.clear();
    for (const PriorLight& prior : lights)
      for (uint32_t i = entries_.cluster_first_entry[cluster]; i < entries_.cluster_first_entry[cluster + 1]; ++i) {
        Vec3 to_light;
        float distance;
        if (maxComponent(scene::lightIrradiance(prior.light, entries_.position[i], entries_.normal[i], to_light, distance)) <= 0) continue;
        rays_.push_back(shadowRay(entries_, i, to_light, distance));
      }
    transmittance_.assign(rays_.size(), 0);
    tracer_.transmittance(rays_, transmittance_);
    return std::any_of(transmittance_.begin(), transmittance_.end(), [](float t) { return t > 0; });
  }

 private:
  const PrmEntries& entries_;
  const trace::Tracer& tracer_;
  std::vector<trace::Ray> rays_;
  std::vector<float> transmittance_;
};

}  // namespace

std::vector<char> unreachedClusters(const PrmEntries& entries, const trace::Tracer& tracer, std::span<const PriorLight> lights, int threads, const CancelFlag* cancel) {
  std::vector<char> unreached(entries.clusterCount(), !lights.empty());
  parallelFor(unreached.size(), 64, threads, cancel, [&](size_t begin, size_t end) {
    Reach reach(entries, tracer);
    for (size_t c = begin; c < end; ++c)
      for (size_t first = 0; unreached[c] && first < lights.size(); first += kLightsAtOnce)
        unreached[c] = !reach.byAnyOf(lights.subspan(first, std::min(kLightsAtOnce, lights.size() - first)), uint32_t(c));
  });
  return unreached;
}

}  // namespace lightwell::transport
