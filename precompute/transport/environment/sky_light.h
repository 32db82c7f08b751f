// A sky as a light source that paths can aim at.
#pragma once
#include <vector>

#include "precompute/transport/environment/sky_grid.h"

namespace lightwell::transport {

/// Piecewise constant radiance on the cells of a latitude-longitude grid, the suns in their texels; directions are picked by luminance,
/// uniformly over the solid angle of a cell.
class SkyLight {
 public:
  explicit SkyLight(const SkyGrid& grid);

  bool isBlack() const { return total_ <= 0; }

  struct Value {
    Rgb radiance_rgb;
    float pdf_solid_angle;  // of sample(), per sr
  };
  /// From a unit direction (world).
  Value at(const Vec3& direction) const;

  struct Sample {
    Vec3 direction;  // unit
    Rgb radiance_rgb;
    float pdf_solid_angle;  // > 0
  };
  /// `u` in [0, 1)². Not for a black sky.
  Sample sample(const Vec2& u) const;

 private:
  float pdf(size_t cell) const;
  double cosineAbove(int row) const;  // of the angle from the zenith of the map to the upper edge of a row

  int width_, height_;
  std::array<Vec3d, 3> frame_;
  std::vector<Rgb> radiance_rgb_;   // [row][column]
  std::vector<double> row_end_;     // sums of luminance flux up to the end of each row
  std::vector<float> column_end_;   // [row][column], as shares of the row
  double total_ = 0;
};

}  // namespace lightwell::transport
