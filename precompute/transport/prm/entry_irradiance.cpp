#include "precompute/transport/prm/entry_irradiance.h"

namespace lightwell::transport {

std::vector<Rgb> clusterIrradiance(const PrmEntries& entries, const trace::Tracer& tracer, const scene::Light& light) {
  std::vector<Rgb> result(entries.clusterCount(), Rgb(0.0f));
  std::vector<trace::Ray> rays;
  std::vector<std::pair<uint32_t, Rgb>> unshadowed;  // cluster, weighted irradiance
  for (uint32_t cluster = 0; cluster < entries.clusterCount(); ++cluster)
    for (uint32_t i = entries.cluster_first_entry[cluster]; i < entries.cluster_first_entry[cluster + 1]; ++i) {
      Vec3 to_light;
      float distance;
      const Rgb irradiance_rgb = scene::lightIrradiance(light, entries.position[i], entries.normal[i], to_light, distance);
      if (maxComponent(irradiance_rgb) <= 0.0f) continue;
      rays.push_back({.origin = trace::Tracer::offsetOrigin(entries.position[i], entries.normal[i], to_light), .direction = to_light,
                      .t_max = distance * (1.0f - 1e-4f), .key = i});
      unshadowed.emplace_back(cluster, irradiance_rgb * entries.weight[i]);
    }
  std::vector<float> visibility(rays.size());
  tracer.transmittance(rays, visibility);
  for (size_t i = 0; i < rays.size(); ++i) result[unshadowed[i].first] += unshadowed[i].second * visibility[i];
  return result;
}

}  // namespace lightwell::transport
