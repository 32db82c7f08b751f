// Probes in a synthetic room, with owners.
#pragma once
#include <cmath>
#include <functional>

#include "tests/format/probes_content.h"
#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {

struct ProbeLink {
  uint32_t node;
  double share;  // of the sphere
};

struct RoomWithProbes {
  SyntheticRadiosity room;
  format::ProbesContent probes;  // its `base` is not used
};

/// A box of 3 × 2 × 4 m, one wall of which emits, with 3 × 2 × 4 probes. Without `links` every probe sees all patches, as large as solid angles of points are.
inline RoomWithProbes probesInRoom(const std::function<std::vector<ProbeLink>(uint32_t probe)>& links = {}) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {3, 2, 4}, 4, 0.5, 0);
  options.walls[1].emission = 1, options.walls[2].albedo = 0.8;
  for (uint32_t w = 0; w < 6; ++w) options.walls[w].material = uint16_t(w % 2);
  options.materials = 2;
  RoomWithProbes made{makeRoom(options), {}};
  if (links)
    for (size_t i = 0; i < made.room.content.patch_emission.size(); ++i) made.room.content.patch_emission[i] = made.room.content.patch_emission[16];
  format::ProbesContent& c = made.probes;
  const uint32_t counts[3] = {3, 2, 4};
  for (int k = 0; k < 3; ++k) c.header.add_lattice_count(counts[k]), c.header.add_lattice_first(0.5f);
  c.header.set_lattice_spacing(1);
  c.link_first = {0};
  for (uint32_t i = 0; i < 24; ++i) {
    c.lattice_point.push_back(i);
    c.offset.insert(c.offset.end(), {0, 0, 0});
    c.nearness.insert(c.nearness.end(), 289, uint8_t(0));
    const double at[3] = {0.5 + i % 3, 0.5 + i / 3 % 2, 0.5 + i / 6};
    std::vector<ProbeLink> row;
    if (links) row = links(i);
    else
      for (uint32_t patch = 0; patch < made.room.patches(); ++patch) {
        double r2 = 0, cosine = 0;
        for (size_t k = 0; k < 3; ++k) {
          const double d = double(made.room.content.patch_position[patch * 3 + k]) - at[k];
          r2 += d * d, cosine += std::abs(d) * (patch / 32 == k ? 1 : 0);
        }
        row.push_back({patch, double(made.room.content.patch_area[patch]) * cosine / (r2 * std::sqrt(r2)) / (4 * 3.14159265)});
      }
    double largest = 0, sum = 0, codes = 0;
    for (const ProbeLink& link : row) largest = std::max(largest, link.share), sum += link.share;
    for (const ProbeLink& link : row) {
      // The nearest of the small floats, as far as tests need it.
      const double weight = std::max(16.0, link.share / largest * 1e6);
      const int exponent = std::min(15, int(std::log2(weight)) - 4);
      const int mantissa = std::clamp(int(weight / std::exp2(exponent) + 0.5) - 16, 0, 15);
      c.link_node.push_back(link.node);
      c.link_code.push_back(uint8_t(exponent << 4 | mantissa));
      codes += std::ldexp(16.0 + mantissa, exponent);
    }
    c.scale.push_back(float(std::min(sum, 1.0) / codes));
    c.link_first.push_back(uint32_t(c.link_node.size()));
  }
  c.header.set_lattice_probes(24);
  return made;
}

inline std::vector<uint8_t> bytesOf(const RoomWithProbes& made) {
  format::Writer writer = toWriter(made.room.content);
  format::addProbes(writer, made.probes);
  return writer.bytes();
}

struct LoadedProbes {
  explicit LoadedProbes(RoomWithProbes made) : bytes(bytesOf(made)), container(openMemory(bytes)), room(std::move(made.room)) {
    EXPECT_EQ(lw_probes_load(container.get(), room.radiosity, &probes), LW_OK);
    EXPECT_EQ(lw_probes_get_info(probes, &info), LW_OK);
  }
  ~LoadedProbes() { lw_probes_release(probes); }
  LoadedProbes(const LoadedProbes&) = delete;
  LoadedProbes& operator=(const LoadedProbes&) = delete;

  /// [probes][9][3].
  std::vector<float> evaluate(uint32_t coefficients, uint32_t light = LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS) {
    std::vector<float> sh(size_t(info.probes) * 27);
    lw_probes_evaluation evaluation = LW_PROBES_EVALUATION_INIT;
    evaluation.coefficients = coefficients, evaluation.light = light;
    EXPECT_EQ(lw_probes_evaluate(probes, room.state, &evaluation, sh.data()), LW_OK);
    return sh;
  }

  std::vector<uint8_t> bytes;
  Container container;
  LoadedRoom room;
  lw_probes* probes = nullptr;
  lw_probes_info info{};
};

}  // namespace lightwell::test
