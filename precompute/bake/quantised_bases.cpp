#include "precompute/bake/quantised_bases.h"

#include <cmath>

#include "precompute/bake/quantise.h"
#include "precompute/transport/prm/evaluate.h"

namespace lightwell::bake {
namespace {

constexpr size_t kProbes = 4;
constexpr float kProbeHeight = 0.1f;  // above an entry point, of the diagonal of all of them

/// Cluster irradiance under a point light above each of a few entry points, spread evenly over them.
std::vector<std::vector<Rgb>> probeIrradiance(const transport::PrmEntries& entries) {
  Box3 bounds;
  for (const auto& position : entries.position) bounds.extendBy(position);
  const float height = kProbeHeight * bounds.size().length();
  std::vector<std::vector<Rgb>> probes;
  for (size_t probe = 0; probe < kProbes; ++probe) {
    const size_t below = probe * entries.position.size() / kProbes;
    const Vec3 light = entries.position[below] + entries.normal[below] * height;
    std::vector<Rgb> irradiance_rgb;
    for (uint32_t c = 0; c < entries.clusterCount(); ++c) {
      float sum = 0;
      for (uint32_t e = entries.cluster_first_entry[c]; e < entries.cluster_first_entry[c + 1]; ++e) {
        const Vec3 to_light = light - entries.position[e];
        const float distance = to_light.length();
        if (distance > 0) sum += entries.weight[e] * std::max(0.0f, to_light.dot(entries.normal[e])) / (distance * distance * distance);
      }
      irradiance_rgb.emplace_back(sum);
    }
    probes.push_back(std::move(irradiance_rgb));
  }
  return probes;
}

std::vector<Rgb> lightMaps(const transport::PrmResult& prm, const std::vector<std::vector<Rgb>>& probes) {
  std::vector<Rgb> maps;
  for (const auto& probe : probes) {
    const auto map = transport::evaluatePrm(prm, probe);
    maps.insert(maps.end(), map.begin(), map.end());
  }
  return maps;
}

double relativeChange(const std::vector<Rgb>& changed, const std::vector<Rgb>& maps) {
  double difference2 = 0, light2 = 0;
  for (size_t i = 0; i < maps.size(); ++i) {
    difference2 += double((changed[i] - maps[i]).length2());
    light2 += double(maps[i].length2());
  }
  return light2 > 0 ? std::sqrt(difference2 / light2) : 0.0;
}

/// Columns (rank, channel) of each block, down its links.
template <class Integer>
std::vector<Integer> quantiseCoefficients(const transport::PrmLocalBases& bases, int most, std::vector<float>& scale,
                                          std::vector<float>& restored) {
  std::vector<Integer> integers(bases.coefficient.size());
  restored.resize(integers.size());
  scale.clear();
  size_t first = 0;
  for (size_t block = 0; block < bases.block_rank.size(); ++block) {
    const size_t columns = size_t(bases.block_rank[block]) * 3;
    const size_t links = bases.block_first_link[block + 1] - bases.block_first_link[block];
    for (size_t column = 0; column < columns; ++column) {
      if (links == 0) {
        scale.push_back(1.0f);
        continue;
      }
      const size_t at = first + column;
      scale.push_back(quantiseKeepingSum(&bases.coefficient[at], links, columns, &integers[at], most));
      for (size_t link = 0; link < links; ++link) restored[at + link * columns] = float(integers[at + link * columns]) * scale.back();
    }
    first += links * columns;
  }
  return integers;
}

}  // namespace

QuantisedBases quantiseBases(const transport::PrmResult& prm) {
  const auto probes = probeIrradiance(prm.entries);
  const std::vector<Rgb> maps = lightMaps(prm, probes);
  QuantisedBases result;
  transport::PrmResult changed = prm;
  result.coefficient_i8 = quantiseCoefficients<int8_t>(prm.bases, INT8_MAX, result.coefficient_scale, changed.bases.coefficient);
  if (const double change = relativeChange(lightMaps(changed, probes), maps); change > kMostCoefficientChange) {
    result.coefficient_i8.clear();
    const double most = std::min(double(INT16_MAX), std::ceil(INT8_MAX * change / kWideCoefficientChange));  // the change is as the step
    result.coefficient_i16 = quantiseCoefficients<int16_t>(prm.bases, int(most), result.coefficient_scale, changed.bases.coefficient);
  }
  return result;
}

}  // namespace lightwell::bake
