#include "precompute/transport/radiosity/training.h"

#include <algorithm>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kTrainingStream = 5ull << 40;
constexpr uint32_t kPointsPerPatch = 4;
constexpr int kBounces = 6;             // what is left then is spread so evenly that it decides nothing
constexpr float kSealedPocket = 0.02f;  // of the median light's mean irradiance

using Matrix = RadiosityTraining::Matrix;

Matrix gather(const FormFactors& factors, const std::vector<char>& open, const Matrix& radiosity) {
  Matrix irradiance = Matrix::Zero(factors.rows(), radiosity.cols());
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) {
      const GateClass gates = factors.sets.classOf(factors.setOf(i));
      if (gates == GateClass::always) {
        irradiance.row(row) += factors.value[i] * radiosity.row(factors.patch[i]);
      } else if (gates != GateClass::mixed) {
        for (Eigen::Index light = 0; light < radiosity.cols(); ++light)
          if (bool(open[size_t(light)]) == (gates == GateClass::open)) irradiance(row, light) += factors.value[i] * radiosity(factors.patch[i], light);
      }
    }
  return irradiance;
}

}  // namespace

Eigen::RowVectorXf RadiosityTraining::counts(GateClass c) const {
  Eigen::RowVectorXf result = Eigen::RowVectorXf::Ones(lights());
  for (size_t light = 0; c != GateClass::always && light < open.size(); ++light) result[Eigen::Index(light)] = bool(open[light]) == (c != GateClass::closed);
  return result;
}

std::vector<float> patchIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                                   const Patches& patches, const scene::Light& light, uint64_t seed) {
  std::vector<trace::Ray> rays;
  std::vector<std::pair<uint32_t, float>> unshadowed;  // patch, irradiance over the number of points
  for (uint32_t patch = 0; patch < patches.count(); ++patch) {
    const auto members = patches.sidesOf(patch);
    const Sampler sampler(seed, kTrainingStream + patch);
    const float share = 1.0f / (kPointsPerPatch * patches.exposed_share[patch]);
    float area = 0;
    for (const uint32_t side : members) area += atlas.slots[sides.slot[side]].area;
    size_t member = 0;
    float passed = atlas.slots[sides.slot[members[0]]].area;
    for (uint32_t i = 0; i < kPointsPerPatch; ++i) {
      const float target = area * (float(i) + sampler.get1D(i, 2)) / kPointsPerPatch;
      while (passed < target && member + 1 < members.size()) passed += atlas.slots[sides.slot[members[++member]]].area;
      const uint32_t side = members[member];
      const auto point = sampleSide(scene.mesh, atlas, sides, side, sampler.get1D(i, 0), sampler.get2D(i, 1));
      Vec3 to_light;
      float distance;
      const float irradiance = luminance(scene::lightIrradiance(light, point.position, point.normal, to_light, distance));
      if (irradiance <= 0 || to_light.dot(point.geometric_normal) <= 0) continue;
      rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, to_light), .direction = to_light,
                      .t_max = distance * (1.0f - 1e-4f), .key = uint32_t(rays.size())});
      unshadowed.emplace_back(patch, irradiance * share);
    }
  }
  std::vector<float> visibility(rays.size());
  tracer.transmittance(rays, visibility);
  std::vector<float> result(patches.count(), 0.0f);
  for (size_t i = 0; i < rays.size(); ++i) result[unshadowed[i].first] += unshadowed[i].second * visibility[i];
  return result;
}

RadiosityTraining trainRadiosity(const Patches& patches, const FormFactors& factors, std::span<const std::vector<float>> direct) {
  Matrix first(patches.count(), direct.size());
  Eigen::VectorXf albedo(patches.count());
  Eigen::VectorXd area(patches.count());
  for (uint32_t patch = 0; patch < patches.count(); ++patch) {
    albedo[patch] = luminance(patches.albedo_rgb[patch]);
    area[patch] = patches.area[patch];
    for (size_t light = 0; light < direct.size(); ++light) first(patch, Eigen::Index(light)) = direct[light][patch];
  }
  std::vector<char> open;
  for (uint32_t light = 0; !patches.zone.empty() && light < direct.size(); ++light) open.push_back(isTrainedOpen(light));
  Matrix radiosity = albedo.asDiagonal() * first, irradiance;
  for (int bounce = 0; bounce < kBounces; ++bounce) {
    irradiance = gather(factors, open, radiosity);
    radiosity = albedo.asDiagonal() * (first + irradiance);
  }
  const Eigen::VectorXd mean = (irradiance.cast<double>().transpose() * area) / std::max(area.sum(), 1e-30);
  std::vector<double> sorted(mean.data(), mean.data() + mean.size());
  std::sort(sorted.begin(), sorted.end());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index light = 0; light < mean.size(); ++light)
    if (mean[light] > 0 && mean[light] >= kSealedPocket * sorted[sorted.size() / 2]) kept.push_back(light);
  RadiosityTraining training;
  if (kept.empty()) {
    training.radiosity = Matrix::Ones(patches.count(), patches.zone.empty() ? 1 : 2);
    if (!patches.zone.empty()) training.open = {0, 1};
    training.irradiance = gather(factors, training.open, training.radiosity);
    return training;
  }
  training.radiosity.resize(patches.count(), Eigen::Index(kept.size()));
  training.irradiance.resize(patches.count(), Eigen::Index(kept.size()));
  for (size_t i = 0; i < kept.size(); ++i) {
    const float scale = float(1.0 / mean[kept[i]]);
    training.radiosity.col(Eigen::Index(i)) = radiosity.col(kept[i]) * scale;
    training.irradiance.col(Eigen::Index(i)) = irradiance.col(kept[i]) * scale;
    if (!open.empty()) training.open.push_back(open[size_t(kept[i])]);
  }
  return training;
}

}  // namespace lightwell::transport
