// What the runtime has of a container, for comparison with another reader: decoded_values FILE writes arrays to stdout, each as a line "NAME KIND COUNT" (KIND as Python's struct has it)
// and its numbers in the machine's byte order. First every chunk as it was decoded, then what the handles of the sections hold where no public function shows it.
#include <cstdio>
#include <string>
#include <type_traits>
#include <vector>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"
#include "runtime/src/environment.h"
#include "runtime/src/lightmap.h"
#include "runtime/src/prm_probes.h"
#include "runtime/src/probes.h"
#include "runtime/src/radiosity.h"

namespace lightwell::runtime {
namespace {

template <class T>
constexpr char kindOf() {
  if constexpr (std::is_same_v<T, double>) return 'd';
  else if constexpr (std::is_same_v<T, float>) return 'f';
  else return (std::is_signed_v<T> ? "bhi" : "BHI")[sizeof(T) / 2];
}

template <class T>
void put(const std::string& name, const T* values, size_t count) {
  std::printf("%s %c %zu\n", name.c_str(), kindOf<T>(), count);
  if (count) std::fwrite(values, sizeof(T), count, stdout);
}
template <class Values>
void put(const std::string& name, const Values& values) {
  put(name, values.data(), values.size());
}

void putColours(const std::string& name, const Array<uint32_t>& packed, float scale = 1) {
  std::vector<float> rgb;
  for (const uint32_t p : packed) {
    const format::Float3 v = format::unpackRgb9e5(p);
    rgb.insert(rgb.end(), {v.x * scale, v.y * scale, v.z * scale});
  }
  put(name, rgb);
}

/// Links of rows whose runs are [first_run[row], first_run[row + 1]); `node_code`: node << 8 | code of each.
void putLinks(const std::string& section, const Array<uint32_t>& first_run, const Array<LinkRun>& runs, const std::vector<uint32_t>& node_code) {
  std::vector<uint32_t> first, node, gates;
  std::vector<float> weight;
  for (const uint32_t run : first_run) first.push_back(run ? runs[run - 1].end_link : 0);
  for (const LinkRun& run : runs) gates.resize(run.end_link, run.gate_set);
  for (const uint32_t link : node_code) {
    node.push_back(link >> 8);
    weight.push_back(linkWeight(link & 0xff));
  }
  put(section + ".link_first", first);
  put(section + ".link_node", node);
  put(section + ".link_weight", weight);
  put(section + ".link_gates", gates);
}

void putPrm(const lw_prm& prm) {
  put("prm.source", prm.source);
  put("prm.texel", prm.texel);
  putColours("prm.emitter_direct", prm.emitter_direct_rgb9e5);
  putColours("prm.emitter_indirect", prm.emitter_indirect_rgb9e5);
  putColours("prm.sky_direct", prm.sky_direct_rgb9e5, prm.header.sky_scale);
  putColours("prm.sky_indirect", prm.sky_indirect_rgb9e5, prm.header.sky_scale);
  if (prm.header.layout == format::PrmLayout::panes) {
    std::vector<float> half;
    for (const uint16_t v : prm.pane_half) half.push_back(format::unpackHalf(v));
    prm.pane_half.empty() ? putColours("prm.pane", prm.pane_rgb9e5) : put("prm.pane", half);
    return;
  }
  put("prm.entry_rectangle", prm.entry_rectangle);
  put("prm.block_first_texel", prm.block_first_texel);
  put("prm.block_rank", prm.block_rank);
  put("prm.basis", prm.basis);
  std::vector<float> scale, light(prm.header.clusters * size_t(3)), wavelets;
  for (size_t b = 0; b < prm.links.blocks(); ++b) scale.insert(scale.end(), prm.links.scale(b), prm.links.scale(b) + prm.block_rank[b] * 3);
  put("prm.coefficient_scale", scale);
  // What each cluster's light is in wavelets, and what each wavelet adds to the sums of the blocks.
  const size_t count = prm.tree.wavelets(), stride = prm.links.stride();
  for (size_t c = 0; c < prm.header.clusters; ++c) {
    std::vector<float> rgb(count * 3);
    light.assign(light.size(), 0);
    light[c * 3] = light[c * 3 + 1] = light[c * 3 + 2] = 1;
    prm.tree.transform(light.data(), rgb.data());
    for (size_t w = 0; w < count; ++w) wavelets.push_back(rgb[w * 3]);
  }
  put("prm.wavelets_of_clusters", wavelets);
  std::vector<float> sums_of_wavelets;
  for (size_t w = 0; w < count; ++w) {
    std::vector<float> scratch(runtime::SumMemory::floats(prm));
    const runtime::SumMemory memory(prm, scratch.data());
    for (size_t k = 0; k < 3; ++k) memory.wavelet_rgb[w * 3 + k] = 1;
    prm.links.update(memory.change(), 0);
    for (size_t b = 0; b < prm.links.blocks(); ++b)
      sums_of_wavelets.insert(sums_of_wavelets.end(), memory.sums + b * stride, memory.sums + b * stride + prm.block_rank[b] * 3);
  }
  put("prm.sums_of_wavelets", sums_of_wavelets);
}

/// Coefficients as [link][rank][R, G, B], with 8 bits.
void putPrmProbes(const lw_prm_probes& p) {
  put("prm_probes.position", p.position_m);
  put("prm_probes.block_rank", p.rank);
  put("prm_probes.basis", p.basis);
  put("prm_probes.coefficient_scale", p.scale);
  put("prm_probes.block_first_link", p.first_link);
  put("prm_probes.link_wavelet", p.wavelet);
  std::vector<float> emitter;
  for (const uint16_t v : p.emitter) emitter.push_back(format::unpackHalf(v));
  put("prm_probes.emitter", emitter);
  std::vector<int8_t> rgb;
  for (uint32_t i = 0; i < p.header.probes; ++i) {
    const uint32_t links = p.first_link[i + 1] - p.first_link[i];
    for (uint32_t l = 0; l < links; ++l)
      for (uint32_t k = 0; k < p.rank[i]; ++k) {
        const PrmProbeCoefficient c = coefficientOf(p, i, k, l);
        rgb.insert(rgb.end(), {c.red, c.green, c.blue});
      }
  }
  put("prm_probes.coefficient", rgb);
}

void putEnvironment(const lw_environment& environment, const Array<uint16_t>& node) {
  const format::EnvironmentHeader& h = environment.header;
  const uint32_t counts[] = {h.cells, h.suns, h.face_cells};
  put("environment.counts", counts, 3);
  put("environment.sky_flux", h.sky_flux_rgb, 3);
  put("environment.radiance_sh", h.radiance_sh_rgb, 27);
  put("environment.cos_radius", environment.cos_radius);
  put("environment.tangent", environment.tangent);
  Array<double> mass;
  if (nodeMasses(environment.host, h, node, mass)) put("environment.mass", mass);
}

void putRadiosity(const lw_radiosity& r) {
  put("radiosity.source", r.source);
  put("radiosity.level_first", r.level_first, r.levels + 1);
  put("radiosity.node_share", r.node_share);
  putLinks("radiosity", r.row_first_run, r.run, {r.link.begin(), r.link.end()});
  put("radiosity.row_scale", r.row_scale);
  put("radiosity.gate_set_first", r.gate_set_first);
  put("radiosity.gate_set", r.gate_set);
}

void putProbes(const lw_probes& p) {
  put("probes.nearness", p.nearness);
  put("probes.scale", p.scale);
  std::vector<uint32_t> node_code, at_point;
  for (const ProbeLink& link : p.link) node_code.push_back(link.node_code);
  putLinks("probes", p.first_run, p.run, node_code);
  put("probes.gate_set_first", p.gate_set_first);
  put("probes.gate_set", p.gate_set);
  std::vector<int32_t> offset;
  for (const uint32_t biased : p.offset_biased)
    for (int k = 0; k < 3; ++k) offset.push_back(int32_t(biased >> (8 * k) & 0xff) - 128);
  put("probes.offset", offset);
  const auto& count = p.header.lattice_count;
  for (uint32_t z = 0; z < count[2]; ++z)
    for (uint32_t y = 0; y < count[1]; ++y)
      for (uint32_t x = 0; x < count[0]; ++x) {
        const uint32_t brick = p.brick[x / kProbeBrick + size_t(p.brick_count[0]) * (y / kProbeBrick + size_t(p.brick_count[1]) * (z / kProbeBrick))];
        at_point.push_back(brick == kNone ? kNone : p.brick_probe[brick + x % kProbeBrick + kProbeBrick * (y % kProbeBrick + kProbeBrick * (z % kProbeBrick))]);
      }
  put("probes.at_point", at_point);
}

void putLightmap(const lw_lightmap& map) {
  put("lightmap.source", map.source);
  put("lightmap.texel", map.texel);
}

/// Chunks that cannot be decoded are left out.
void putChunks(const lw_container& container) {
  for (const format::ChunkInfo& chunk : container.view.chunks()) {
    if (!chunk.decodable) continue;
    std::vector<uint8_t> bytes(chunk.raw_bytes);
    if (!container.view.decode(chunk, bytes.data(), bytes.size())) put(std::string(chunk.section) + "/" + std::string(chunk.name), bytes);
  }
}

void putAll(const lw_container& container) {
  putChunks(container);
  if (lw_prm* prm = nullptr; lw_prm_load(&container, &prm) == LW_OK) {
    putPrm(*prm);
    if (lw_prm_probes* probes = nullptr; container.view.findSection("prm_probes") && lw_prm_probes_load(&container, prm, &probes) == LW_OK) {
      putPrmProbes(*probes);
      lw_prm_probes_release(probes);
    }
    lw_prm_release(prm);
  }
  Array<uint16_t> node;
  const format::ChunkInfo* chunk = container.view.findChunk("environment", "node");
  if (lw_environment* environment = nullptr; chunk && lw_environment_load(&container, &environment) == LW_OK) {
    if (decodeChunk(container, *chunk, node) == LW_OK) putEnvironment(*environment, node);
    lw_environment_release(environment);
  }
  if (lw_lightmap* map = nullptr; lw_lightmap_load(&container, &map) == LW_OK) {
    putLightmap(*map);
    lw_lightmap_release(map);
  }
  if (lw_radiosity* radiosity = nullptr; lw_radiosity_load(&container, &radiosity) == LW_OK) {
    putRadiosity(*radiosity);
    if (lw_probes* probes = nullptr; lw_probes_load(&container, radiosity, &probes) == LW_OK) {
      putProbes(*probes);
      lw_probes_release(probes);
    }
    lw_radiosity_release(radiosity);
  }
}

}  // namespace
}  // namespace lightwell::runtime

int main(int count, char** arguments) {
  if (count != 2) return 2;
  lw_container* container = nullptr;
  if (lw_open_file(arguments[1], nullptr, &container) != LW_OK) return 4;
  lightwell::runtime::putAll(*container);
  lw_close(container);
  return std::fflush(stdout) == 0 ? 0 : 1;
}
