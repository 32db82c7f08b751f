// Decoding probes. Everything that evaluation relies on is checked here once.
#include <cmath>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/probes.h"
#include "runtime/src/section_loader.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;

constexpr uint64_t kMostLatticePoints = uint64_t(1) << 22;

/// Decodes the section "probes" chunk by chunk; the first failure stays in `result`.
class Loader : SectionLoader {
 public:
  Loader(const lw_container& container, const lw_radiosity& radiosity, lw_probes& probes) : SectionLoader(container, "probes"), radiosity_(radiosity), p_(probes) {}

  lw_result load() {
    loadHeader();
    loadPlaces();
    loadGateSets();
    loadLinks();
    return result_;
  }

 private:
  void loadHeader() {
    format::ProbesHeader& h = p_.header;
    if ((result_ = readHeader(container_, section_, [&](const Array<uint8_t>& message) { return format::parseProbesHeader(message.data(), message.size(), h); }))) return;
    const uint64_t probes = uint64_t(h.lattice_probes) + h.points;
    require(probes > 0 && probes <= kMostProbes, "header", "its number of probes cannot be");
    p_.patches = radiosity_.patches();
    p_.nodes = radiosity_.nodes();
    p_.gates = radiosity_.gates;
    if (h.lattice_count[0] == 0) return require(h.lattice_probes == 0, "header", "it has probes on a lattice, but no lattice");
    uint64_t points = 1;
    for (int k = 0; k < 3; ++k) {
      const bool possible = h.lattice_count[k] > 0 && h.lattice_count[k] <= kMostLatticePoints && points <= kMostLatticePoints;
      if (!possible || (points *= h.lattice_count[k]) > kMostLatticePoints) return void(bad("header", "its lattice cannot be"));
      p_.brick_count[k] = uint32_t((h.lattice_count[k] + kProbeBrick - 1) / kProbeBrick);
      require(std::abs(h.lattice_first_m[k]) <= 1e30f, "header", "its lattice is nowhere");
    }
    require(h.lattice_spacing_m > 0 && h.lattice_spacing_m <= 1e30f, "header", "its lattice has no spacing");
  }

  void loadPlaces() {
    const format::ProbesHeader& h = p_.header;
    const size_t on_lattice = h.lattice_probes;
    if (!allocate(p_.position_m, size_t(p_.probes()) * 3)) return;
    if (h.points > 0) {
      Array<float> given;
      if (!decode("point_position", ElementType::f32, uint64_t(h.points) * 3, given)) return;
      require(allFinite(given.data(), given.size()), "point_position", "a point is nowhere");
      std::memcpy(&p_.position_m[on_lattice * 3], given.data(), given.bytes());
    }
    if (h.lattice_count[0] == 0) return;
    Array<uint32_t> point;
    Array<int8_t> offset;
    decode("nearness", ElementType::u8, on_lattice * kNearnessNodes, p_.nearness);
    decode("offset", ElementType::i8, on_lattice * 3, offset);
    if (!decode("lattice_point", ElementType::u32, on_lattice, point)) return;
    const auto nx = uint32_t(h.lattice_count[0]), ny = uint32_t(h.lattice_count[1]), nz = uint32_t(h.lattice_count[2]);
    const size_t bricks = size_t(p_.brick_count[0]) * p_.brick_count[1] * p_.brick_count[2];
    if (!allocate(p_.brick, bricks) || !allocate(p_.offset_biased, on_lattice)) return;
    std::memset(p_.brick.data(), 0xff, p_.brick.bytes());
    size_t used = 0;
    for (size_t i = 0; i < on_lattice; ++i) {
      if (point[i] >= uint64_t(nx) * ny * nz || (i > 0 && point[i] <= point[i - 1])) return void(bad("lattice_point", "a point is beyond the lattice, or they do not ascend"));
      uint32_t& brick = p_.brick[brickOf(point[i], nx, ny)];
      if (brick == kNone) brick = uint32_t(used++) * kBrickPoints;
    }
    if (!allocate(p_.brick_probe, used * kBrickPoints)) return;
    std::memset(p_.brick_probe.data(), 0xff, p_.brick_probe.bytes());
    for (size_t i = 0; i < on_lattice; ++i) {
      const uint32_t at[3] = {point[i] % nx, point[i] / nx % ny, point[i] / nx / ny};
      p_.brick_probe[p_.brick[brickOf(point[i], nx, ny)] + (at[0] % 4 + 4 * (at[1] % 4 + 4 * (at[2] % 4)))] = uint32_t(i);
      p_.offset_biased[i] = 0;
      for (int k = 0; k < 3; ++k) {
        p_.offset_biased[i] |= uint32_t(offset[i * 3 + size_t(k)] + 128) << (8 * k);
        p_.position_m[i * 3 + size_t(k)] = h.lattice_first_m[k] + h.lattice_spacing_m * (float(at[k]) + float(offset[i * 3 + size_t(k)]) / 254.0f);
      }
    }
  }
  size_t brickOf(uint32_t point, uint32_t nx, uint32_t ny) const {
    const uint32_t x = point % nx / kProbeBrick, y = point / nx % ny / kProbeBrick, z = point / nx / ny / kProbeBrick;
    return x + size_t(p_.brick_count[0]) * (y + size_t(p_.brick_count[1]) * z);
  }

  void loadGateSets() {
    if (result_ || !container_.view.findChunk("probes", "link_gates")) return;
    gated_ = true;
    SectionLoader::loadGateSets(p_.gates, p_.gate_sets, p_.gate_set_first, p_.gate_set);
  }

  /// Means of the patches' positions by area.
  bool makeNodePositions(Array<float>& position) {
    if (!allocate(position, size_t(p_.nodes) * 3)) return false;
    std::memcpy(position.data(), radiosity_.patch_position_m.data(), radiosity_.patch_position_m.bytes());
    for (uint32_t level = 1; level < radiosity_.levels; ++level) {
      uint32_t child = radiosity_.level_first[level - 1];
      for (uint32_t i = radiosity_.level_first[level]; i < radiosity_.level_first[level + 1]; ++i) {
        float mean[3] = {};
        for (uint32_t n = 0; n < kRadiosityBranching && child < radiosity_.level_first[level]; ++n, ++child)
          for (int k = 0; k < 3; ++k) mean[k] += radiosity_.node_share[child] * position[size_t(child) * 3 + size_t(k)];
        std::memcpy(&position[size_t(i) * 3], mean, sizeof mean);
      }
    }
    return true;
  }

  void loadLinks() {
    const size_t probes = p_.probes(), links = size_t(elementsOf("link_node"));
    Array<uint32_t> first, node;
    Array<uint8_t> code;
    Array<uint16_t> gates;
    Array<float> position;
    decode("link_first", ElementType::u32, probes + 1, first);
    decode("link_node", ElementType::u32, links, node);
    decode("scale", ElementType::f32, probes, p_.scale);
    if (gated_) decode("link_gates", ElementType::u16, links, gates);
    if (!decode("link_code", ElementType::u8, links, code)) return;
    require(areOffsets(first, links), "link_first", "it does not split the links");
    bool good = true;
    for (const float s : p_.scale) good &= s >= 0 && s <= 1.001f / 16;
    require(good, "scale", "a value is out of range");
    for (const uint32_t n : node) good &= n < p_.nodes;
    require(good, "link_node", "a link is to no patch or node");
    for (const uint16_t set : gates) good &= set < p_.gate_sets;
    require(good, "link_gates", "a value is no gate set");
    if (!makeNodePositions(position) || !allocate(p_.link, links) || !allocate(p_.first_run, probes + 1)) return;
    size_t runs = 0;
    const auto walk = [&](auto add) {
      for (size_t probe = 0; probe < probes; ++probe)
        for (uint32_t l = first[probe], end = first[probe + 1], begin = l; l < end; begin = l) {
          while (l < end && (!gated_ || gates[l] == gates[begin])) ++l;
          add(probe, LinkRun{l, gated_ ? gates[begin] : 0u});
        }
    };
    walk([&](size_t, LinkRun) { ++runs; });
    if (!allocate(p_.run, runs)) return;
    std::memset(p_.first_run.data(), 0, p_.first_run.bytes());
    runs = 0;
    walk([&](size_t probe, LinkRun run) {
      p_.run[runs++] = run;
      p_.first_run[probe + 1] = uint32_t(runs);
    });
    for (size_t probe = 0; probe < probes; ++probe) {
      if (p_.first_run[probe + 1] < p_.first_run[probe]) p_.first_run[probe + 1] = p_.first_run[probe];
      for (uint32_t l = first[probe]; l < first[probe + 1]; ++l) {
        const float *to = &position[size_t(node[l]) * 3], *from = &p_.position_m[probe * 3];
        const format::Oct16 way = format::packOct({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
        p_.link[l] = {node[l] << 8 | code[l], uint32_t(uint16_t(way.x)) | uint32_t(uint16_t(way.y)) << 16};
      }
    }
  }

  const lw_radiosity& radiosity_;
  lw_probes& p_;
  bool gated_ = false;
};

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_probes_load(const lw_container* container, const lw_radiosity* radiosity, lw_probes** out) {
  if (!container || !radiosity || !out) return LW_INVALID_ARGUMENT;
  lw_probes* probes = createHandle<lw_probes>(container->host);
  if (!probes) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the probes");
  if (const lw_result result = Loader(*container, *radiosity, *probes).load()) {
    destroyHandle(probes);
    return result;
  }
  *out = probes;
  return LW_OK;
}

void lw_probes_release(lw_probes* probes) { destroyHandle(probes); }

lw_result lw_probes_get_info(const lw_probes* probes, lw_probes_info* info) {
  if (!probes || !info) return LW_INVALID_ARGUMENT;
  const auto& h = probes->header;
  *info = {probes->probes(), h.lattice_probes, uint32_t(probes->link.size()), {uint32_t(h.lattice_count[0]), uint32_t(h.lattice_count[1]), uint32_t(h.lattice_count[2])},
           {h.lattice_first_m[0], h.lattice_first_m[1], h.lattice_first_m[2]}, h.lattice_spacing_m, probes->position_m.data()};
  return LW_OK;
}
