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

bool isPanes(Layout layout) { return layout != Layout::local_bases; }

/// Entries around the origin; with local bases each is a rectangle, some of them far smaller than others.
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
      for (int k = 0; k < 3; ++k) prm.entry_normal.push_back(float(random.uniform() - 0.5));
      if (isPanes(prm.options.layout)) continue;
      const double size = std::exp(5 * random.uniform() - 5.5);
      for (const double number : {size * (0.5 + random.uniform()), size, 2 * random.uniform() - 1})
        prm.entry_rectangle.push_back(float(number));
    }
    prm.cluster_first_entry.push_back(prm.entries());
  }
  prm.options.place_entries(prm);
  for (uint32_t e = 0; e < prm.entries(); ++e) {
    float* n = &prm.entry_normal[e * 3];
    const format::Oct16 packed = format::packOct({n[0], n[1], n[2]});
    oct.insert(oct.end(), {packed.x, packed.y});
    const format::Float3 stored = format::unpackOct(packed);
    n[0] = stored.x, n[1] = stored.y, n[2] = stored.z;
  }
  for (float& number : prm.entry_rectangle) number = format::unpackHalf(format::packHalf(number));
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

/// A tree of random splits, and every wavelet as weights of the clusters.
struct RandomTree {
  using Weights = std::vector<double>;  // [clusters]
  std::vector<uint32_t> first_leaves, first_share;
  std::vector<Weights> mean, difference;  // [inner nodes]

  Weights build(Random& random, uint32_t clusters, uint32_t first_leaf, uint32_t leaves) {
    Weights weights(clusters, 0.0);
    if (leaves == 1) {
      weights[first_leaf] = 1;
      return weights;
    }
    const size_t node = first_leaves.size();
    const uint32_t split = 1 + random.below(leaves - 1), share = 1 + random.below(0xffff);
    first_leaves.push_back(split);
    first_share.push_back(share);
    mean.emplace_back(), difference.emplace_back();
    const Weights first = build(random, clusters, first_leaf, split), second = build(random, clusters, first_leaf + split, leaves - split);
    Weights less(clusters);
    for (uint32_t c = 0; c < clusters; ++c) {
      weights[c] = share / 65536.0 * first[c] + (1 - share / 65536.0) * second[c];
      less[c] = first[c] - second[c];
    }
    mean[node] = weights;
    difference[node] = less;
    return weights;
  }
};

template <class T>
void addNarrow(const SyntheticPrm& prm, format::Writer& writer, std::string_view name, std::vector<uint32_t> values) {
  prm.options.edit_u32(name, values);
  writer.add("prm", name, std::vector<T>(values.begin(), values.end()));
}

/// Blocks differ in size, rank (zero and one among them) and links; some wavelets are linked several times, others by no block.
void addLocalBases(Random& random, SyntheticPrm& prm, format::Writer& writer) {
  const uint32_t blocks = prm.options.blocks, texels = uint32_t(prm.texel.size()), clusters = prm.options.clusters;
  RandomTree tree;
  tree.build(random, clusters, 0, clusters);
  std::vector<RandomTree::Weights> wavelet(clusters, RandomTree::Weights(clusters, 0.0));
  for (uint32_t c = 0; c < clusters; ++c) wavelet[c][c] = 1;
  for (const auto* kind : {&tree.mean, &tree.difference}) wavelet.insert(wavelet.end(), kind->begin(), kind->end());
  std::vector<uint32_t> unit;
  for (size_t w = 0; w < wavelet.size(); ++w) unit.push_back(140 + random.below(41));

  std::vector<uint32_t> first_texel(blocks + 1), first_link{0}, link;
  std::vector<uint8_t> rank;
  std::vector<int8_t> basis, coefficient;
  std::vector<float> scale;
  for (uint32_t b = 0; b <= blocks; ++b) first_texel[b] = uint32_t(uint64_t(texels) * b / blocks);
  prm.transport.assign(size_t(clusters) * texels * 3, 0.0);
  for (uint32_t b = 0; b < blocks; ++b) {
    const uint32_t r = b < 2 ? b : b == 2 ? prm.options.max_rank : 1 + random.below(prm.options.max_rank);
    const size_t first_basis = basis.size(), first_coefficient = coefficient.size();
    rank.push_back(uint8_t(r));
    for (uint32_t i = 0; i < (first_texel[b + 1] - first_texel[b]) * r; ++i) basis.push_back(int8_t(int(random.below(255)) - 127));
    for (uint32_t w = 0; w < wavelet.size(); ++w)
      for (double chance = 0.6; random.uniform() < chance; chance = 0.2) link.push_back(w);
    const uint32_t links = uint32_t(link.size()) - first_link.back();
    coefficient.resize(coefficient.size() + size_t(links) * r * 3);
    for (uint32_t k = 0; k < r; ++k) {
      for (int channel = 0; channel < 3; ++channel) scale.push_back(float((0.2 + random.uniform()) / 127));
      const float* scale_rgb = &scale[scale.size() - 3];
      for (uint32_t l = 0; l < links; ++l) {
        const uint32_t w = link[first_link.back() + l];
        // What is even is mostly positive, so that not all is clamped.
        const bool even = w < 2 * clusters - 1;
        int rgb[3];
        for (int& c : rgb) c = even ? std::min(int(random.below(256)) - 64, 127) : int(random.below(65)) - 32;
        if (random.below(30) == 0) rgb[random.below(3)] = -128;
        int8_t* stored = &coefficient[first_coefficient + size_t(k) * 3 * links + l];
        stored[0] = int8_t(rgb[1]);
        stored[links] = int8_t(uint8_t(rgb[0] - rgb[1]));
        stored[2 * links] = int8_t(uint8_t(rgb[2] - rgb[1]));
        for (uint32_t c = 0; c < clusters; ++c) {
          const double each = wavelet[w][c] / std::exp2((int(unit[w]) - 160) / 8.0);
          for (uint32_t t = first_texel[b]; each != 0 && t < first_texel[b + 1]; ++t)
            for (size_t channel = 0; channel < 3; ++channel)
              prm.transport[(size_t(c) * texels + t) * 3 + channel] +=
                  basis[first_basis + size_t(t - first_texel[b]) * r + k] / 127.0 * rgb[channel] * double(scale_rgb[channel]) * each;
        }
      }
    }
    first_link.push_back(uint32_t(link.size()));
  }
  std::vector<float> rectangle = prm.entry_rectangle;
  prm.options.edit_f32("entry_rectangle", rectangle);
  std::vector<uint16_t> half;
  for (const float number : rectangle) half.push_back(format::packHalf(number));
  writer.add("prm", "entry_rectangle", half, {prm.entries(), 3}, ElementType::f16);
  add(prm, writer, "tree_first_leaves", tree.first_leaves);
  addNarrow<uint16_t>(prm, writer, "tree_first_share", tree.first_share);
  addNarrow<uint8_t>(prm, writer, "wavelet_unit", unit);
  add(prm, writer, "block_first_texel", first_texel);
  writer.add("prm", "block_rank", rank);
  writer.add("prm", "basis", basis);
  add(prm, writer, "block_first_link", first_link);
  add(prm, writer, "link_wavelet", link);
  add(prm, writer, "coefficient_scale", scale);
  writer.add("prm", "coefficient", coefficient);
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
  const bool panes = isPanes(options.layout);

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

std::vector<SyntheticOptions> extremeLocalBases() {
  std::vector<SyntheticOptions> all;
  for (const uint32_t clusters : {1u, 2u, 3u})
    for (const auto& [blocks, max_rank] : {std::pair(1u, 1u), std::pair(2u, 1u), std::pair(3u, 255u)}) {
      SyntheticOptions& options = all.emplace_back();
      options.layout = Layout::local_bases;
      options.clusters = clusters, options.blocks = blocks, options.max_rank = max_rank;
    }
  return all;
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
