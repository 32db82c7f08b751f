// Containers with a section "radiosity" made from form factors that a test knows, and their plain solution in double precision.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/format/radiosity_content.h"

namespace lightwell::test {

using Point = std::array<double, 3>;

/// A rectangle cut into cells × cells patches: p(u, v) = corner + u · a + v · b, u and v from 0 to 1, lit on the side of cross(a, b).
struct Wall {
  Point corner, a, b;
  uint32_t cells = 4;
  double albedo = 0.5, emission = 0;
  uint16_t material = 0;
};
/// The inside of a box.
std::vector<Wall> boxWalls(Point low, Point high, uint32_t cells, double albedo, double emission);

struct RoomOptions {
  std::vector<Wall> walls;
  uint32_t materials = 1;
  /// Factor on the form factor between two patches, by wall; empty: 1.
  std::function<double(uint32_t receiving_wall, uint32_t sending_wall)> visible;
  /// The gate set of their links; empty: 0.
  std::function<uint16_t(uint32_t receiving_wall, uint32_t sending_wall)> gate_set;
  uint32_t strips = 0;                            // of one portal, "door"
  uint32_t leaf_wall = 0;                         // its leaf, which opens along the wall's a; 0: it has none
  std::vector<std::vector<uint16_t>> gate_sets;   // set 0 must be empty
  bool merge = false;                             // eight patches of a wall to a link
};

/// What went into the container. Rows sum to 1, links with gates included: closed rooms.
struct SyntheticRadiosity {
  format::RadiosityContent content;
  struct Link {
    uint32_t node;
    uint16_t gate_set;
    double weight;  // quantised, times the row's scale
  };
  std::vector<std::vector<Link>> row;
  std::vector<uint32_t> wall_of_patch;
  uint32_t patches() const { return uint32_t(row.size()); }
  std::vector<uint8_t> bytes() const { return format::toWriter(content).bytes(); }

  /// Irradiance of one channel in equilibrium, by Gaussian elimination: E = F (ρ (E + direct) + π emission). `set_factor` is empty: all 1.
  std::vector<double> solve(const std::vector<double>& albedo, const std::vector<double>& direct, const std::vector<double>& emission,
                            const std::vector<double>& set_factor = {}) const;
};

/// With geometry, and an atlas of one texel for each patch.
SyntheticRadiosity makeRoom(const RoomOptions& options);

}  // namespace lightwell::test
