// The nodes of a sky on grids of falling resolution: a lobe is integrated on the coarsest grid that resolves it.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// What the nodes weigh, [6][m + 1][m + 1][3], from halfs in the same order. False when there is no memory.
bool nodeMasses(const Host& host, const format::EnvironmentHeader& header, const Array<uint16_t>& node_half, Array<double>& mass_rgb);

/// Mass on one direction, less what a sky of the mean radiance has there: that part is answered in closed form.
struct SkyNode {
  float direction[3];
  float mass_rgb[3];
};

/// Nodes that lie close together.
struct SkyTile {
  float center[3];  // unit
  uint32_t first;   // its nodes end where those of the next tile begin
};

struct SkyLevel {
  float spacing_rad = 0;
  float cos_tile = 1, sin_tile = 0;  // of the angle within which all nodes of a tile lie about its centre
  Array<SkyNode> nodes;
  Array<SkyTile> tiles;              // and one more that only ends the last
};

class SkyLevels {
 public:
  /// Node spacing in deviations of the lobe that the finest level is trusted with: 0.5 % of a real sky's light.
  static constexpr float kFinestRatio = 0.9f;
  /// Node values [6][m + 1][m + 1][3] as halfs, finite. False when there is no memory.
  bool build(const Host& host, const format::EnvironmentHeader& header, const Array<uint16_t>& node_half);

  /// ∫ L max(0, cos)^shininess dω about the unit vector `axis`; shininess in [1, 1e5]. Adds to `sum_rgb`, possibly a little below 0.
  /// `node_ratio`: how far apart nodes may lie, in deviations 1/√shininess of the lobe; up to kFinestRatio.
  void addIntegral(const float* axis, float shininess, double* sum_rgb, float node_ratio = 0.5f) const;
  float maxShininess() const;

 private:
  static constexpr uint32_t kMostLevels = 8;
  const SkyLevel& levelFor(float shininess, float node_ratio) const;

  SkyLevel levels_[kMostLevels];  // finest first
  uint32_t level_count_ = 0;
  double mean_radiance_rgb_[3] = {};
};

}  // namespace lightwell::runtime
