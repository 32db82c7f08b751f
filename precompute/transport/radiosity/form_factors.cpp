#include "precompute/transport/radiosity/form_factors.h"

#include <algorithm>
#include <cmath>

#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kPatchStream = 3ull << 40;  // owners of random streams never meet
constexpr int kBalanceSweeps = 24;

/// The transpose of the hits: per patch, who met it.
HitCounts transposed(const HitCounts& hits) {
  const size_t rows = hits.first.size() - 1;
  HitCounts result;
  result.first.assign(rows + 1, 0);
  for (const uint32_t patch : hits.patch) ++result.first[patch + 1];
  for (size_t i = 0; i < rows; ++i) result.first[i + 1] += result.first[i];
  result.patch.resize(hits.patch.size());
  result.count.resize(hits.patch.size());
  std::vector<uint64_t> next(result.first.begin(), result.first.end() - 1);
  for (uint32_t row = 0; row < rows; ++row)
    for (uint64_t i = hits.first[row]; i < hits.first[row + 1]; ++i) {
      const uint64_t at = next[hits.patch[i]]++;
      result.patch[at] = row;
      result.count[at] = hits.count[i];
    }
  return result;
}

/// Scales exchanges by d_i d_j until the rows' sums are the shares of rays that met patches (Sinkhorn and Knopp's balancing in its symmetric form).
void balance(const std::vector<double>& share, FormFactors& factors) {
  std::vector<double> scale(factors.rows(), 1.0);
  for (int sweep = 0; sweep < kBalanceSweeps; ++sweep) {
    std::vector<double> next = scale;
    for (uint32_t row = 0; row < factors.rows(); ++row) {
      double sum = 0;
      for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) sum += factors.value[i] * scale[factors.patch[i]];
      sum *= scale[row];
      if (sum > 0) next[row] = scale[row] * std::sqrt(share[row] / sum);
    }
    scale = std::move(next);
  }
  for (uint32_t row = 0; row < factors.rows(); ++row) {
    // What the sweeps have left, a few parts in ten thousand, goes into the row: sums matter more than the last digit of reciprocity.
    double sum = 0;
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) sum += factors.value[i] * scale[factors.patch[i]];
    const double factor = sum > 0 ? share[row] / sum : 0.0;
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) factors.value[i] = float(factors.value[i] * factor * scale[factors.patch[i]]);
  }
}

}  // namespace

void HitCounts::append(const HitCounts& other) {
  const uint64_t base = patch.size();
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(base + other.first[row]);
  patch.insert(patch.end(), other.patch.begin(), other.patch.end());
  count.insert(count.end(), other.count.begin(), other.count.end());
}

HitCounts countHits(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                    uint32_t rays, uint64_t seed, uint32_t begin, uint32_t end) {
  HitCounts counts;
  std::vector<trace::Hit> hits;
  std::vector<uint32_t> met;
  for (uint32_t patch = begin; patch < end; ++patch) {
    const auto list = cosineRays(scene.mesh, atlas, sides, patches.sidesOf(patch), rays, seed, kPatchStream + patch);
    hits.resize(list.size());
    tracer.closest(list, hits);
    met.clear();
    for (const auto& hit : hits) {
      if (hit.triangle == kNone) continue;
      const uint32_t side = sides.met(atlas.slotAt(scene.mesh, hit.triangle, hit.u, hit.v), hit.front);
      if (side != kNone && patches.patch_of_side[side] != kNone) met.push_back(patches.patch_of_side[side]);
    }
    std::sort(met.begin(), met.end());
    for (const uint32_t other : met) {
      if (counts.patch.size() == counts.first.back() || counts.patch.back() != other) {
        counts.patch.push_back(other);
        counts.count.push_back(0);
      }
      ++counts.count.back();
    }
    counts.first.push_back(counts.patch.size());
  }
  return counts;
}

FormFactors makeFormFactors(const Patches& patches, const HitCounts& hits, uint32_t rays) {
  FormFactors factors;
  // Rays from hidden points count for nothing.
  const auto exposedRays = [&](uint32_t patch) { return double(rays) * patches.exposed_share[patch]; };
  const HitCounts met_by = transposed(hits);
  std::vector<double> share(patches.count(), 0.0);
  for (uint32_t row = 0; row < patches.count(); ++row) {
    // Both lists ascend: merged, each pair has what row sent and what row was sent.
    uint64_t out = hits.first[row], in = met_by.first[row];
    const uint64_t out_end = hits.first[row + 1], in_end = met_by.first[row + 1];
    while (out < out_end || in < in_end) {
      const uint32_t to = out < out_end ? hits.patch[out] : kNone, from = in < in_end ? met_by.patch[in] : kNone;
      const uint32_t other = std::min(to, from);
      double both = 0;
      if (to == other) {
        share[row] += hits.count[out] / exposedRays(row);
        both += hits.count[out++];
      }
      if (from == other) both += met_by.count[in++];
      // Hits are Poisson with mean rays G / A at either end: the likeliest exchange G of the pair.
      const double exchange = both / (exposedRays(row) / patches.area[row] + exposedRays(other) / patches.area[other]);
      factors.patch.push_back(other);
      factors.value.push_back(float(exchange / patches.area[row]));
    }
    factors.first.push_back(factors.patch.size());
    share[row] = std::min(share[row], 1.0);
  }
  balance(share, factors);
  return factors;
}

}  // namespace lightwell::transport
