#include <algorithm>
#include <cmath>

#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

/// 0: farther than 8 spacings. Else 2^((code − 1) / 32 − 3).
uint8_t nearnessCode(float nearness) {
  if (nearness < 0.125f) return 0;
  return uint8_t(std::clamp(std::lround((std::log2(nearness) + 3) * 32) + 1, 1l, 255l));
}

}  // namespace

void addProbesSection(format::Writer& writer, const transport::ProbeResult& result, double metres_per_unit) {
  const transport::Probes& probes = result.probes;
  const transport::ProbeLinks& links = result.links;
  const uint64_t on_lattice = probes.lattice_point.size(), points = probes.count() - on_lattice;
  v1::ProbesHeader header;
  header.set_lattice_probes(uint32_t(on_lattice));
  header.set_points(uint32_t(points));
  if (probes.lattice.spacing > 0) {
    for (int k = 0; k < 3; ++k) {
      header.add_lattice_count(probes.lattice.count[size_t(k)]);
      header.add_lattice_first(float(probes.lattice.first[k] * metres_per_unit));
    }
    header.set_lattice_spacing(float(probes.lattice.spacing * metres_per_unit));
    header.set_moved(probes.moved);
    header.set_inside(probes.inside);
    header.set_sealed(probes.sealed);
  }
  std::vector<int8_t> offset;
  for (const auto& steps : probes.offset) offset.insert(offset.end(), steps.begin(), steps.end());
  std::vector<uint8_t> nearness;
  for (const float value : probes.nearness) nearness.push_back(nearnessCode(value));
  std::vector<float> position;
  for (size_t i = on_lattice; i < probes.count(); ++i)
    for (int k = 0; k < 3; ++k) position.push_back(float(probes.position[i][k] * metres_per_unit));

  writer.addSection("probes");
  writer.addMessage("probes", "header", header);
  if (probes.lattice.spacing > 0) {
    writer.add("probes", "lattice_point", probes.lattice_point);
    writer.add("probes", "offset", offset, {on_lattice, 3});
    writer.add("probes", "nearness", nearness, {on_lattice, uint64_t(transport::kNearnessNodes)});
  }
  if (points > 0) writer.add("probes", "point_position", position, {points, 3});
  writer.add("probes", "link_first", links.first);
  writer.add("probes", "link_node", links.node);
  writer.add("probes", "link_code", links.code);
  writer.add("probes", "scale", links.scale);
  if (links.sets.count() > 1) {
    writer.add("probes", "link_gates", std::vector<uint16_t>(links.set.begin(), links.set.end()));
    writer.add("probes", "gate_set_first", links.sets.first());
    writer.add("probes", "gate_set", links.sets.entries());
  }
}

}  // namespace lightwell::bake
