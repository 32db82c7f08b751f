#include "precompute/transport/radiosity/form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

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
  result.set.resize(hits.set.size());
  std::vector<uint64_t> next(result.first.begin(), result.first.end() - 1);
  for (uint32_t row = 0; row < rows; ++row)
    for (uint64_t i = hits.first[row]; i < hits.first[row + 1]; ++i) {
      const uint64_t at = next[hits.patch[i]]++;
      result.patch[at] = row;
      result.count[at] = hits.count[i];
      if (!hits.set.empty()) result.set[at] = hits.set[i];
    }
  return result;
}

using ClassSums = std::array<double, kGateClasses>;

/// Form factors while they are balanced: `set` is that of the exchange. To either end it may be of another class, because a leaf's own gate counts only for the others.
struct Exchanges {
  FormFactors factors;
  std::vector<GateClass> row_class, other_class;  // per entry; empty without portals
  std::vector<ClassSums> target;                  // per row
};

/// Scales exchanges by d_i d_j, d of the class that an exchange has to each end, until the rows' sums are the targets (Sinkhorn and Knopp's balancing in its symmetric form).
template <size_t kClasses>
void balance(Exchanges& exchanges) {
  FormFactors& factors = exchanges.factors;
  const auto rowClass = [&](uint64_t i) { return kClasses == 1 ? size_t(0) : size_t(exchanges.row_class[i]); };
  const auto otherScale = [&](uint64_t i) { return factors.patch[i] * kClasses + (kClasses == 1 ? 0 : size_t(exchanges.other_class[i])); };
  std::vector<double> scale(factors.rows() * kClasses, 1.0);
  const auto sumsOf = [&](uint32_t row) {
    std::array<double, kClasses> sum{};
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) sum[rowClass(i)] += factors.value[i] * scale[otherScale(i)];
    return sum;
  };
  for (int sweep = 0; sweep < kBalanceSweeps; ++sweep) {
    std::vector<double> next = scale;
    for (uint32_t row = 0; row < factors.rows(); ++row) {
      const auto sum = sumsOf(row);
      for (size_t c = 0; c < kClasses; ++c) {
        const double scaled = sum[c] * scale[row * kClasses + c];
        if (scaled > 0) next[row * kClasses + c] = scale[row * kClasses + c] * std::sqrt(exchanges.target[row][c] / scaled);
      }
    }
    scale = std::move(next);
  }
  for (uint32_t row = 0; row < factors.rows(); ++row) {
    // What the sweeps have left, a few parts in ten thousand, goes into the row: sums matter more than the last digit of reciprocity.
    const auto sum = sumsOf(row);
    std::array<double, kClasses> factor{};
    for (size_t c = 0; c < kClasses; ++c) factor[c] = sum[c] > 0 ? exchanges.target[row][c] / sum[c] : 0.0;
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i)
      factors.value[i] = float(factors.value[i] * factor[rowClass(i)] * scale[otherScale(i)]);
  }
}

/// What a row knows of its sums.
struct RowSums {
  ClassSums own{};     // share of its own rays
  ClassSums pooled{};  // from both ends' hits
  ClassSums hits{};    // of both ends
};

/// The sums that a row shall have. With all portals shut, and with all open, they are what its own rays found. What of it is light that portals let pass or stop, which few of a row's rays
/// may have met, is estimated from both ends' hits: once from what ends on leaves, once from what goes on.
ClassSums targetOf(const RowSums& row) {
  const auto at = [](const ClassSums& sums, GateClass c) { return sums[size_t(c)]; };
  const double shut = std::min(at(row.own, GateClass::always) + at(row.own, GateClass::closed), 1.0);
  const double open = std::min(at(row.own, GateClass::always) + at(row.own, GateClass::open), 1.0);
  const double u = at(row.pooled, GateClass::always), c = at(row.pooled, GateClass::closed), o = at(row.pooled, GateClass::open);
  double always;
  if (u == 0) always = 0;
  else if (c == 0 || o == 0) always = c == 0 ? shut : open;
  else {
    const double more = open - shut, by_closed = c * shut / (u + c), by_open = o * open / (u + o);
    const double closed_weight = at(row.hits, GateClass::closed) / std::max(by_closed * by_closed, 1e-30);
    const double open_weight = at(row.hits, GateClass::open) / std::max(by_open * by_open, 1e-30);
    const double closed = (closed_weight * by_closed + open_weight * (by_open - more)) / (closed_weight + open_weight);
    always = shut - std::clamp(closed, std::max(0.0, -more), shut);
  }
  return {always, shut - always, open - always, at(row.pooled, GateClass::mixed)};
}

/// Leaves a leaf's own gate out of its rows, and puts rows into the order of sets and patches.
void sortRows(const PortalZones& zones, const Patches& patches, FormFactors& factors) {
  FormFactors sorted;
  sorted.sets = factors.sets;
  std::vector<uint64_t> order;
  std::vector<uint32_t> row_set(factors.patch.size());
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) row_set[i] = withoutOwnGate(zones, patches.zone[row], factors.set[i], sorted.sets);
  sorted.sets = sortSets(sorted.sets, row_set);
  for (uint32_t row = 0; row < factors.rows(); ++row) {
    order.resize(factors.first[row + 1] - factors.first[row]);
    std::iota(order.begin(), order.end(), factors.first[row]);
    std::stable_sort(order.begin(), order.end(), [&](uint64_t a, uint64_t b) {
      return row_set[a] != row_set[b] ? row_set[a] < row_set[b] : factors.patch[a] < factors.patch[b];
    });
    const size_t begin = sorted.patch.size();
    for (const uint64_t i : order) {
      if (!(factors.value[i] > 0)) continue;
      if (sorted.patch.size() > begin && sorted.patch.back() == factors.patch[i] && sorted.set.back() == row_set[i]) {
        sorted.value.back() += factors.value[i];
        continue;
      }
      sorted.patch.push_back(factors.patch[i]);
      sorted.set.push_back(row_set[i]);
      sorted.value.push_back(factors.value[i]);
    }
    sorted.first.push_back(sorted.patch.size());
  }
  factors = std::move(sorted);
}

}  // namespace

void HitCounts::append(const HitCounts& other) {
  const uint64_t base = patch.size();
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(base + other.first[row]);
  patch.insert(patch.end(), other.patch.begin(), other.patch.end());
  count.insert(count.end(), other.count.begin(), other.count.end());
  const std::vector<uint32_t> number = addSets(other.sets, sets);
  for (const uint32_t s : other.set) set.push_back(number[s]);
}

void HitCounts::sort() {
  if (set.empty()) return;
  sets = sortSets(sets, set);
  std::vector<std::pair<uint32_t, uint32_t>> group;
  for (size_t row = 0; row + 1 < first.size(); ++row)
    for (uint64_t begin = first[row], end = begin; begin < first[row + 1]; begin = end) {
      group.clear();
      for (; end < first[row + 1] && patch[end] == patch[begin]; ++end) group.emplace_back(set[end], count[end]);
      std::sort(group.begin(), group.end());
      for (size_t i = 0; i < group.size(); ++i) std::tie(set[begin + i], count[begin + i]) = group[i];
    }
}

HitCounts countHits(const scene::Scene& scene, const atlas::Atlas& atlas, const GatedTracer& tracer, const Sides& sides, const Patches& patches, uint32_t rays,
                    uint64_t seed, uint32_t begin, uint32_t end) {
  HitCounts counts;
  std::vector<GatedHit> hits;
  std::vector<std::pair<uint32_t, uint32_t>> met;  // patch, set
  for (uint32_t patch = begin; patch < end; ++patch) {
    const auto list = cosineRays(scene.mesh, atlas, sides, patches.sidesOf(patch), rays, seed, kPatchStream + patch);
    tracer.trace(list, patch, counts.sets, hits);
    met.clear();
    for (const GatedHit& hit : hits) met.emplace_back(hit.patch, hit.set);
    std::sort(met.begin(), met.end());
    for (size_t i = 0; i < met.size(); ++i) {
      if (i == 0 || met[i] != met[i - 1]) {
        counts.patch.push_back(met[i].first);
        counts.count.push_back(0);
        if (!patches.zone.empty()) counts.set.push_back(met[i].second);
      }
      ++counts.count.back();
    }
    counts.first.push_back(counts.patch.size());
  }
  return counts;
}

FormFactors makeFormFactors(const PortalZones& zones, const Patches& patches, const HitCounts& hits, uint32_t rays) {
  Exchanges exchanges;
  FormFactors& factors = exchanges.factors;
  const bool gated = !hits.set.empty();
  factors.sets = hits.sets;
  GateSets row_sets = hits.sets;
  const auto classTo = [&](uint32_t patch, uint32_t set) { return row_sets.classOf(withoutOwnGate(zones, patches.zone[patch], set, row_sets)); };
  // Rays from hidden points count for nothing.
  const auto exposedRays = [&](uint32_t patch) { return double(rays) * patches.exposed_share[patch]; };
  const HitCounts met_by = transposed(hits);
  const auto setOf = [&](const HitCounts& counts, uint64_t i) { return gated ? counts.set[i] : 0; };
  constexpr std::pair<uint32_t, uint32_t> kEnd{kNone, kNone};
  for (uint32_t row = 0; row < patches.count(); ++row) {
    // Both lists ascend: merged, each pair has what row sent and what row was sent.
    uint64_t out = hits.first[row], in = met_by.first[row];
    const uint64_t out_end = hits.first[row + 1], in_end = met_by.first[row + 1];
    RowSums sums;
    while (out < out_end || in < in_end) {
      const auto to = out < out_end ? std::pair(hits.patch[out], setOf(hits, out)) : kEnd;
      const auto from = in < in_end ? std::pair(met_by.patch[in], setOf(met_by, in)) : kEnd;
      const auto [other, set] = std::min(to, from);
      const GateClass row_class = gated ? classTo(row, set) : GateClass::always;
      double both = 0;
      if (to == std::pair(other, set)) {
        sums.own[size_t(row_class)] += hits.count[out] / exposedRays(row);
        both += hits.count[out++];
      }
      if (from == std::pair(other, set)) both += met_by.count[in++];
      // Hits are Poisson with mean rays G / A at either end: the likeliest exchange G of the pair.
      const double exchange = both / (exposedRays(row) / patches.area[row] + exposedRays(other) / patches.area[other]);
      factors.patch.push_back(other);
      factors.value.push_back(float(exchange / patches.area[row]));
      sums.pooled[size_t(row_class)] += exchange / patches.area[row];
      sums.hits[size_t(row_class)] += both;
      if (!gated) continue;
      factors.set.push_back(set);
      exchanges.row_class.push_back(row_class);
      exchanges.other_class.push_back(classTo(other, set));
    }
    factors.first.push_back(factors.patch.size());
    exchanges.target.push_back(targetOf(sums));
  }
  if (!gated) {
    balance<1>(exchanges);
  } else {
    balance<kGateClasses>(exchanges);
    sortRows(zones, patches, factors);
  }
  factors.own_gate = ownGates(zones, patches);
  return std::move(factors);
}

std::vector<GateEntry> ownGates(const PortalZones& zones, const Patches& patches) {
  std::vector<GateEntry> gates;
  for (const PortalZone& zone : patches.zone)
    gates.push_back(zone.kind == PortalZone::leaf        ? closedGate(zones.firstGate(zone.portal) + zone.strip)
                    : zone.kind == PortalZone::threshold ? openGate(zones.firstGate(zone.portal))
                                                         : kNoEntry);
  return gates;
}

uint32_t withoutOwnGate(const PortalZones& zones, const PortalZone& zone, uint32_t set, GateSets& sets) {
  if (zone.kind != PortalZone::leaf || set == 0) return set;
  // The gate is that of a point, which may be the next strip's to that of the patch; with two gates of one leaf it is the nearer one.
  const int own = int(zones.firstGate(zone.portal)) + zone.strip;
  std::vector<GateEntry> rest(sets[set].begin(), sets[set].end());
  auto nearest = rest.end();
  for (auto e = rest.begin(); e != rest.end(); ++e)
    if (isClosed(*e) && zones.portalOf(*e / 2) == zone.portal && (nearest == rest.end() || std::abs(*e / 2 - own) < std::abs(*nearest / 2 - own))) nearest = e;
  if (nearest == rest.end()) return set;
  rest.erase(nearest);
  return sets.number(rest);
}

}  // namespace lightwell::transport
