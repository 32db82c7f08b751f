#include "precompute/transport/prm/probe_basis.h"

#include <algorithm>

#include "precompute/transport/environment/sky_harmonics.h"

namespace lightwell::transport {
namespace {

/// The cosine lobe around a normal, bands 0 to 2: π/4π + (2π/3) 3/4π c + (π/4) 5/4π (3c² − 1) / 2.
float lobe(float cosine) { return 0.25f + 0.5f * cosine + 0.15625f * (3 * cosine * cosine - 1); }

/// What arrives at a point: as a block of kProbeValues "texels", and what emitters give.
BlockTransport gatherProbe(const Vec3& point, uint32_t rays, uint64_t owner, const Gatherer& gatherer, const EmitterLight& emitters, std::array<Rgb, 9>& emitter_radiance_sh) {
  const auto met = gatherer.around(point, rays, owner);
  BlockTransport transport;
  for (const auto& m : met) transport.cluster.push_back(m.cluster);
  std::sort(transport.cluster.begin(), transport.cluster.end());
  transport.cluster.erase(std::unique(transport.cluster.begin(), transport.cluster.end()), transport.cluster.end());
  for (auto& matrix : transport.from_cluster) matrix.setZero(kProbeValues, Eigen::Index(transport.cluster.size()));
  emitter_radiance_sh.fill(Rgb(0.0f));
  const auto normals = probeNormals();
  const float steradians = 4 * kPi / float(rays);
  for (const auto& m : met) {
    const auto column = std::lower_bound(transport.cluster.begin(), transport.cluster.end(), m.cluster) - transport.cluster.begin();
    const Rgb per_irradiance_rgb = m.albedo_rgb * (steradians / kPi);
    for (uint32_t i = 0; i < kProbeValues; ++i) {
      const float weight = lobe(normals[i].dot(m.direction));
      for (int channel = 0; channel < 3; ++channel) transport.from_cluster[channel](i, column) += weight * per_irradiance_rgb[channel];
    }
    if (emitters.cluster_rgb.empty()) continue;
    const Rgb radiance_rgb = m.emitted_radiance_rgb * steradians + per_irradiance_rgb * emitters.cluster_rgb[m.cluster];
    const auto y = sphericalHarmonics(Vec3d(m.direction));
    for (size_t k = 0; k < 9; ++k) emitter_radiance_sh[k] += radiance_rgb * float(y[k]);
  }
  return transport;
}

}  // namespace

std::array<Vec3, kProbeValues> probeNormals() {
  const float golden = 1.618033988749895f, length = std::sqrt(1 + golden * golden);
  std::array<Vec3, kProbeValues> normals;
  for (int i = 0; i < int(kProbeValues); ++i) {
    const int axis = i / 4;
    normals[size_t(i)][axis] = 0;
    normals[size_t(i)][(axis + 1) % 3] = (i & 2 ? -1.0f : 1.0f) / length;
    normals[size_t(i)][(axis + 2) % 3] = (i & 1 ? -golden : golden) / length;
  }
  return normals;
}

std::vector<ProbeBasis> fitProbes(std::span<const Vec3> points, uint64_t first_owner, const Gatherer& gatherer, const EntryClusters& clusters, const WaveletIndex& wavelets,
                                  const MultiBounce& multi_bounce, const TrainingLights& training, const EmitterLight& emitters, const LocalBasesOptions& options) {
  std::vector<ProbeBasis> probes(points.size());
  std::vector<BlockTransport> transports;
  for (size_t i = 0; i < points.size(); ++i) transports.push_back(gatherProbe(points[i], options.rays, first_owner + i, gatherer, emitters, probes[i].emitter_radiance_sh));
  auto blocks = fitWhole(transports, std::vector<float>(kProbeValues, 1.0f), clusters, wavelets, multi_bounce, training, options);
  for (size_t i = 0; i < points.size(); ++i) probes[i].block = std::move(blocks[i]);
  return probes;
}

}  // namespace lightwell::transport
