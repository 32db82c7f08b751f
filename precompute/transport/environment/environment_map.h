// Environment maps in the equirectangular projection, read row by row so that a 16k x 8k map needs the memory of a few rows.
//
// Convention: u = 1/2 + atan2(z, x) / 2 pi, v from the top = acos(y) / pi. Radiance is linear Rec. 709, constant over a texel.
#pragma once
#include <ImathMatrix.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/core/math.h"

namespace lightwell::transport {

/// Receives each row of a map exactly once, in the file's own order; row 0 is the zenith. The span dies with the call.
using RowVisitor = std::function<void(int row, std::span<const Rgb> radiance_rgb)>;

/// Rows of radiance, as they are stored: possibly with NaN, negative or infinite values.
class RowSource {
 public:
  virtual ~RowSource() = default;
  virtual int width() const = 0;
  virtual int height() const = 0;
  /// May be called again; each call reads from the start. Throws InputError when the file ends early or is damaged.
  virtual void visitRows(const RowVisitor& visit) = 0;
};

/// Radiance RGBE (.hdr: old and new run lengths, flat; 32-bit_rle_rgbe and _xyze; EXPOSURE and COLORCORR undone; rows in any
/// direction) or OpenEXR (.exr: scan lines, tiles, parts; half, float, uint; R G B of any layer, or Y alone; the display window is the map,
/// what the data window leaves out is black). Told apart by content. Throws InputError naming file, place and reason.
std::unique_ptr<RowSource> openRowSource(const std::filesystem::path& file, Diagnostics& diagnostics);
/// A map in memory, `radiance_rgb[row * width + column]`; moved in.
std::unique_ptr<RowSource> memoryRowSource(int width, int height, std::vector<Rgb> radiance_rgb);

/// Up to 65536 on a side and 2^28 texels.
bool isUsableMapSize(int64_t width, int64_t height);
/// Brighter radiance than this is taken for damage: 600 times the sun's disc in cd/m².
inline constexpr float kMaxRadiance = 1e12f;

struct MapPlacement {
  Imath::M33d world_from_map;  // a rotation, for column vectors; the identity leaves the convention above
  float intensity = 1;         // factor on radiance, ≥ 0
  std::optional<Rgb> ground_radiance_rgb;  // when set: what is seen below the horizon (world y < 0), times intensity
};

/// The rotation by `angle_rad` about +Y, for MapPlacement.
Imath::M33d rotationAboutY(double angle_rad);

/// A map placed in the world: finite non-negative radiance, and where each texel lies.
class EnvironmentMap {
 public:
  /// `name` is for messages. Throws UsageError when `placement` is not a rotation or not finite.
  EnvironmentMap(std::unique_ptr<RowSource> source, std::string name, const MapPlacement& placement = {});

  int width() const { return source_->width(); }
  int height() const { return source_->height(); }
  /// Repaired rows: NaN and negative radiance is 0, infinite or beyond kMaxRadiance is 65504 (the largest half). Counts go to
  /// `diagnostics`.
  void visitRows(Diagnostics& diagnostics, const CancelFlag* cancel, const RowVisitor& visit);

  /// Unit direction (world) of a point of the map; texel centres are at (column + 0.5, row + 0.5).
  Vec3d direction(double column, double row) const;
  /// Solid angle in sr of one texel of `row`: the exact integral over the texel. All texels together: 4 pi.
  double texelSolidAngle(int row) const;

 private:
  std::unique_ptr<RowSource> source_;
  std::string name_;
  MapPlacement placement_;
};

}  // namespace lightwell::transport
