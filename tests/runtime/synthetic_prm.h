// Random but sound containers with a precomputed radiance map, and their plain evaluation in double precision, written down from docs/format.md.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell::test {

enum class Layout { panes_rgb9e5, panes_half, local_bases };

struct SyntheticPrm;

struct SyntheticOptions {
  Layout layout = Layout::panes_rgb9e5;
  uint32_t width = 24, height = 20;
  uint32_t clusters = 40;
  uint32_t blocks = 7, max_rank = 6;
  bool emitters = true;
  uint32_t seed = 1;
  /// Called with each chunk's name and values before they are written, to damage them. Checksums stay right.
  std::function<void(std::string_view, std::vector<uint32_t>&)> edit_u32 = [](std::string_view, std::vector<uint32_t>&) {};
  std::function<void(std::string_view, std::vector<float>&)> edit_f32 = [](std::string_view, std::vector<float>&) {};
  /// Called when the entries are made, to place them (entry_position, entry_normal, entry_rectangle) before they are rounded.
  std::function<void(SyntheticPrm&)> place_entries = [](SyntheticPrm&) {};
};

/// Everything that went into the container, decoded.
struct SyntheticPrm {
  SyntheticOptions options;
  std::vector<uint8_t> container;
  std::vector<uint32_t> source, texel;
  std::vector<float> entry_position, entry_normal, entry_weight;
  std::vector<float> entry_rectangle;    // [entries][3]: half sides, turn in half turns; empty for panes
  std::vector<uint32_t> cluster_first_entry;
  std::vector<double> transport;         // [cluster][texel][3]
  std::vector<double> emitter_direct, emitter_indirect;  // [texel][3]

  uint32_t entries() const { return uint32_t(entry_weight.size()); }
  /// The atlas [height][width][4] that the runtime promises.
  std::vector<double> evaluate(const std::vector<float>& cluster_irradiance, uint32_t emitters = LW_EMITTERS_INDIRECT,
                               uint32_t brightest = 0, bool keep_energy = true, bool fill = true) const;
};

SyntheticPrm makeSyntheticPrm(const SyntheticOptions& options);

/// Local bases at their limits: one cluster, no rank at all, the highest rank.
std::vector<SyntheticOptions> extremeLocalBases();

/// [clusters][3]; about a third of the clusters is dark.
std::vector<float> randomIrradiance(uint32_t clusters, uint32_t seed);

/// rms(a − b) / rms(b).
template <class A, class B>
double relrmse(const A& a, const B& b) {
  double difference = 0, sum = 0;
  for (size_t i = 0; i < b.size(); ++i) {
    difference += (double(a[i]) - double(b[i])) * (double(a[i]) - double(b[i]));
    sum += double(b[i]) * double(b[i]);
  }
  return std::sqrt(difference / sum);
}

}  // namespace lightwell::test
