#include "tests/runtime/synthetic_prm.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "format/decode/pixel.h"
#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::test {
namespace {

using format::ElementType;
constexpr uint32_t kNone = 0xffffffffu;

struct Random {
  std::mt19937 engine;
  double uniform() { return double(engine()) / 4294967296.0; }
  uint32_t below(uint32_t n) { return uint32_t(uniform() * n); }
};

/// Writes a chunk as the options damage it.
void add(const SyntheticPrm& prm, format::Writer& writer, std::string_view name, std::vector<uint32_t> values,
         std::initializer_list<uint64_t> shape = {}) {
  prm.options.edit_u32(name, values);
  writer.add(name == "source" ? "atlas" : "prm", name, values, shape);
}
void add(const SyntheticPrm& prm, format::Writer& writer, std::string_view name, std::vector<float> values,
         std::initializer_list<uint64_t> shape = {}) {
  prm.options.edit_f32(name, values);
  writer.add("prm", name, values, shape);
}

/// Some texels covered, some gutters of those, some empty. A few of the covered ones are buried: they have a value, but show another's.
void makeTexels(Random& random, SyntheticPrm& prm, std::vector<uint8_t>& coverage) {
  const uint32_t count = prm.options.width * prm.options.height;
  prm.source.assign(count, kNone);
  coverage.assign(count, 0);
  for (uint32_t i = 0; i < count; ++i)
    if (random.uniform() < 0.4) prm.source[i] = i, coverage[i] = 1, prm.texel.push_back(i);
  const uint32_t shown = uint32_t(prm.texel.size());
  for (uint32_t i = 0; i < count; ++i) {
    if (prm.source[i] != kNone || random.uniform() < 0.5) continue;
    if (random.uniform() < 0.1) coverage[i] = 1, prm.texel.push_back(i);
    prm.source[i] = prm.texel[random.below(shown)];
  }
  std::shuffle(prm.texel.begin(), prm.texel.end(), random.engine);
}

void makeEntries(Random& random, SyntheticPrm& prm, std::vector<int16_t>& oct) {
  prm.cluster_first_entry = {0};
  for (uint32_t c = 0; c < prm.options.clusters; ++c) {
    const uint32_t count = 1 + random.below(5);
    std::vector<double> weights(count);
    for (double& w : weights) w = 0.1 + random.uniform();
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (const double w : weights) {
      prm.entry_weight.push_back(float(w / sum));
      for (int k = 0; k < 3; ++k) prm.entry_position.push_back(float(random.uniform() * 4 - 2));
      const format::Oct16 packed =
          format::packOct({float(random.uniform() - 0.5), float(random.uniform() - 0.5), float(random.uniform() - 0.5)});
      oct.insert(oct.end(), {packed.x, packed.y});
      const format::Float3 n = format::unpackOct(packed);
      prm.entry_normal.insert(prm.entry_normal.end(), {n.x, n.y, n.z});
    }
    prm.cluster_first_entry.push_back(prm.entries());
  }
}

std::vector<uint32_t> makeEmitter(Random& random, const SyntheticPrm& prm, std::vector<double>& values) {
  std::vector<uint32_t> packed;
  for (size_t i = 0; i < prm.texel.size(); ++i) {
    packed.push_back(format::packRgb9e5({float(random.uniform()), float(random.uniform() * 0.5), float(random.uniform() * 2)}));
    const format::Float3 v = format::unpackRgb9e5(packed.back());
    values.insert(values.end(), {v.x, v.y, v.z});
  }
  return packed;
}

void addPanes(Random& random, SyntheticPrm& prm, format::Writer& writer) {
  const uint64_t clusters = prm.options.clusters, texels = prm.texel.size();
  std::vector<uint32_t> packed;
  std::vector<uint16_t> half;
  for (uint64_t c = 0; c < clusters; ++c) {
    const double level = std::exp(4 * random.uniform() - 4);
    for (uint64_t t = 0; t < texels; ++t) {
      const format::Float3 v{float(level * random.uniform()), float(level * random.uniform()), float(level * random.uniform() * 0.3)};
      if (prm.options.layout == Layout::panes_rgb9e5) {
        packed.push_back(format::packRgb9e5(v));
        const format::Float3 stored = format::unpackRgb9e5(packed.back());
        prm.transport.insert(prm.transport.end(), {stored.x, stored.y, stored.z});
      } else {
        for (const float x : {v.x, v.y, v.z}) {
          half.push_back(format::packHalf(x));
          prm.transport.push_back(format::unpackHalf(half.back()));
        }
      }
    }
  }
  if (half.empty()) writer.add("prm", "pane", packed, {clusters, texels}, ElementType::rgb9e5);
  else writer.add("prm", "pane", half, {clusters, texels, 3}, ElementType::f16);
}

/// Blocks differ in size, rank (zero and one among them) and links; some links are missing altogether.
void addLocalBases(Random& random, SyntheticPrm& prm, format::Writer& writer) {
  const uint32_t blocks = prm.options.blocks, texels = uint32_t(prm.texel.size()), clusters = prm.options.clusters;
  const int limit = prm.options.layout == Layout::bases_i8 ? 127 : 32767;
  std::vector<uint32_t> first_texel(blocks + 1), first_link{0}, link;
  std::vector<uint8_t> rank;
  std::vector<int8_t> basis, coefficient8;
  std::vector<int16_t> coefficient16;
  std::vector<float> scale;
  for (uint32_t b = 0; b <= blocks; ++b) first_texel[b] = uint32_t(uint64_t(texels) * b / blocks);
  prm.transport.assign(size_t(clusters) * texels * 3, 0.0);
  for (uint32_t b = 0; b < blocks; ++b) {
    const uint32_t r = b < 2 ? b : b == 2 ? prm.options.max_rank : 1 + random.below(prm.options.max_rank);
    const size_t first_basis = basis.size(), first_scale = scale.size();
    rank.push_back(uint8_t(r));
    for (uint32_t i = 0; i < (first_texel[b + 1] - first_texel[b]) * r; ++i) basis.push_back(int8_t(int(random.below(255)) - 127));
    for (uint32_t i = 0; i < r * 3; ++i) scale.push_back(float((0.2 + random.uniform()) / limit));
    for (uint32_t c = 0; c < clusters; ++c) {
      if (random.uniform() < 0.4) continue;
      link.push_back(c);
      for (uint32_t k = 0; k < r; ++k)
        for (int channel = 0; channel < 3; ++channel) {
          const int value = int(random.below(uint32_t(2 * limit + 1))) - limit / 2;  // mostly positive, so that not all is clamped
          const int stored = std::clamp(value, -limit, limit);
          if (limit == 127) coefficient8.push_back(int8_t(stored));
          else coefficient16.push_back(int16_t(stored));
          for (uint32_t t = first_texel[b]; t < first_texel[b + 1]; ++t)
            prm.transport[(size_t(c) * texels + t) * 3 + channel] +=
                basis[first_basis + size_t(t - first_texel[b]) * r + k] / 127.0 * stored * double(scale[first_scale + k * 3 + channel]);
        }
    }
    first_link.push_back(uint32_t(link.size()));
  }
  add(prm, writer, "block_first_texel", first_texel);
  writer.add("prm", "block_rank", rank);
  writer.add("prm", "basis", basis);
  add(prm, writer, "block_first_link", first_link);
  add(prm, writer, "link_cluster", link);
  add(prm, writer, "coefficient_scale", scale);
  if (limit == 127) writer.add("prm", "coefficient", coefficient8);
  else writer.add("prm", "coefficient", coefficient16);
}

}  // namespace

SyntheticPrm makeSyntheticPrm(const SyntheticOptions& options) {
  SyntheticPrm prm;
  prm.options = options;
  Random random{std::mt19937(options.seed)};
  std::vector<uint8_t> coverage;
  std::vector<int16_t> oct;
  makeTexels(random, prm, coverage);
  makeEntries(random, prm, oct);
  const bool panes = options.layout == Layout::panes_rgb9e5 || options.layout == Layout::panes_half;

  format::Writer writer;
  writer.addSection("atlas");
  v1::AtlasHeader atlas;
  atlas.set_width(options.width);
  atlas.set_height(options.height);
  atlas.set_covered_texels(uint32_t(prm.texel.size()));
  atlas.set_charts(1);
  writer.addMessage("atlas", "header", atlas);
  add(prm, writer, "source", prm.source, {options.height, options.width});
  writer.add("atlas", "coverage", coverage, {options.height, options.width});
  writer.add("atlas", "albedo", std::vector<uint8_t>(size_t(options.width) * options.height * 3, 128), {options.height, options.width, 3});
  writer.addSection("prm");
  v1::PrmHeader header;
  header.set_layout(panes ? v1::PRM_LAYOUT_PANES : v1::PRM_LAYOUT_LOCAL_BASES);
  header.set_entries(prm.entries());
  header.set_clusters(options.clusters);
  header.set_texels(uint32_t(prm.texel.size()));
  header.set_has_emitter(options.emitters);
  if (panes) header.set_brightest(8);
  else {
    header.set_blocks(options.blocks);
    header.set_max_rank(options.max_rank);
  }
  writer.addMessage("prm", "header", header);
  add(prm, writer, "entry_position", prm.entry_position, {prm.entries(), 3});
  writer.add("prm", "entry_normal", oct, {prm.entries(), 2});
  add(prm, writer, "entry_weight", prm.entry_weight);
  add(prm, writer, "cluster_first_entry", prm.cluster_first_entry);
  add(prm, writer, "texel", prm.texel);
  if (panes) addPanes(random, prm, writer);
  else addLocalBases(random, prm, writer);
  if (options.emitters) {
    writer.add("prm", "emitter_direct", makeEmitter(random, prm, prm.emitter_direct), {}, ElementType::rgb9e5);
    writer.add("prm", "emitter_indirect", makeEmitter(random, prm, prm.emitter_indirect), {}, ElementType::rgb9e5);
  }
  prm.container = writer.bytes();
  return prm;
}

std::vector<double> SyntheticPrm::evaluate(const std::vector<float>& cluster_irradiance, uint32_t emitters, uint32_t brightest,
                                           bool keep_energy, bool fill) const {
  const size_t clusters = options.clusters, texels = texel.size();
  std::vector<std::array<double, 3>> energy(clusters);
  for (size_t c = 0; c < clusters; ++c)
    for (size_t i = 0; i < texels * 3; ++i) energy[c][i % 3] += transport[c * texels * 3 + i] * cluster_irradiance[c * 3 + i % 3];
  std::vector<size_t> order(clusters);
  std::iota(order.begin(), order.end(), size_t(0));
  double scale[3] = {1, 1, 1};
  if (brightest && brightest < clusters) {
    const auto brightness = [&](size_t c) { return 0.2126 * energy[c][0] + 0.7152 * energy[c][1] + 0.0722 * energy[c][2]; };
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return brightness(a) > brightness(b); });
    for (int k = 0; keep_energy && k < 3; ++k) {
      double all = 0, kept = 0;
      for (size_t i = 0; i < clusters; ++i) all += energy[order[i]][k], kept += i < brightest ? energy[order[i]][k] : 0.0;
      scale[k] = all / kept;
    }
    order.resize(brightest);
  }
  std::vector<double> atlas(size_t(options.width) * options.height * 4, 0.0);
  for (size_t t = 0; t < texels; ++t) {
    for (size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (const size_t c : order) sum += transport[(c * texels + t) * 3 + k] * cluster_irradiance[c * 3 + k];
      sum = std::max(sum * scale[k], 0.0);
      if (!emitter_direct.empty() && (emitters & LW_EMITTERS_DIRECT)) sum += emitter_direct[t * 3 + k];
      if (!emitter_indirect.empty() && (emitters & LW_EMITTERS_INDIRECT)) sum += emitter_indirect[t * 3 + k];
      atlas[size_t(texel[t]) * 4 + k] = sum;
    }
    atlas[size_t(texel[t]) * 4 + 3] = 1;
  }
  for (size_t i = 0; fill && i < source.size(); ++i)
    if (source[i] != kNone) std::copy_n(&atlas[size_t(source[i]) * 4], 4, &atlas[i * 4]);
  return atlas;
}

std::vector<float> randomIrradiance(uint32_t clusters, uint32_t seed) {
  Random random{std::mt19937(seed)};
  std::vector<float> irradiance(size_t(clusters) * 3, 0.0f);
  for (uint32_t c = 0; c < clusters; ++c)
    if (random.uniform() > 0.33)
      for (int k = 0; k < 3; ++k) irradiance[c * 3 + k] = float(std::exp(5 * random.uniform() - 2));
  return irradiance;
}

}  // namespace lightwell::test
