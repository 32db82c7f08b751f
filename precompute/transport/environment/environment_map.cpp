#include "precompute/transport/environment/environment_map.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include "precompute/transport/environment/openexr_rows.h"
#include "precompute/transport/environment/radiance_rows.h"

namespace lightwell::transport {
namespace {

constexpr float kRepairedInfinity = 65504.0f;
constexpr double kPiD = std::numbers::pi;

class MemoryRows : public RowSource {
 public:
  MemoryRows(int width, int height, std::vector<Rgb> pixels) : width_(width), height_(height), pixels_(std::move(pixels)) {}
  int width() const override { return width_; }
  int height() const override { return height_; }
  void visitRows(const RowVisitor& visit) override {
    for (int row = 0; row < height_; ++row) visit(row, std::span(pixels_).subspan(size_t(row) * size_t(width_), size_t(width_)));
  }

 private:
  int width_, height_;
  std::vector<Rgb> pixels_;
};

struct RepairCounts {
  uint64_t nan = 0, negative = 0, too_bright = 0;

  float repair(float v) {
    if (std::isnan(v)) return ++nan, 0.0f;
    if (v < 0.0f) return ++negative, 0.0f;
    if (v > kMaxRadiance) return ++too_bright, kRepairedInfinity;
    return v;
  }
  void report(const std::string& name, Diagnostics& diagnostics) const {
    const auto warn = [&](uint64_t count, const char* what) {
      if (count > 0) diagnostics.warn(name, std::to_string(count) + what);
    };
    warn(nan, " values are not numbers; set to 0");
    warn(negative, " values are negative; set to 0");
    warn(too_bright, " values are infinite or beyond any light; set to 65504");
  }
};

bool isRotation(const Imath::M33d& m) {
  const Imath::M33d product = m * m.transposed();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(product[i][j] - (i == j)) < 1e-6)) return false;
  return m.determinant() > 0;
}

}  // namespace

bool isUsableMapSize(int64_t width, int64_t height) {
  constexpr int64_t max_side = 65536, max_texels = int64_t{1} << 28;
  return width >= 1 && height >= 1 && width <= max_side && height <= max_side && width * height <= max_texels;
}

std::unique_ptr<RowSource> openRowSource(const std::filesystem::path& file, Diagnostics& diagnostics) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 4> magic{};
  if (!std::filesystem::is_regular_file(file) || !in) throw InputError(file.string(), "", "cannot be read");
  in.read(magic.data(), magic.size());
  if (in && std::string_view(magic.data(), 4) == "\x76\x2f\x31\x01") return openOpenExrRows(file, diagnostics);
  if (in && std::string_view(magic.data(), 2) == "#?") return openRadianceRows(file, diagnostics);
  throw InputError(file.string(), "", "neither a Radiance (.hdr) nor an OpenEXR (.exr) file");
}

std::unique_ptr<RowSource> memoryRowSource(int width, int height, std::vector<Rgb> radiance_rgb) {
  if (!isUsableMapSize(width, height) || radiance_rgb.size() != size_t(width) * size_t(height))
    throw UsageError("an environment map of " + std::to_string(width) + " x " + std::to_string(height) + " with " +
                     std::to_string(radiance_rgb.size()) + " texels");
  return std::make_unique<MemoryRows>(width, height, std::move(radiance_rgb));
}

Imath::M33d rotationAboutY(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c, 0, s, 0, 1, 0, -s, 0, c};
}

EnvironmentMap::EnvironmentMap(std::unique_ptr<RowSource> source, std::string name, const MapPlacement& placement)
    : source_(std::move(source)), name_(std::move(name)), placement_(placement) {
  if (!isRotation(placement.world_from_map)) throw UsageError(name_ + ": the orientation of the map is not a rotation");
  if (!(placement.intensity >= 0 && placement.intensity <= kMaxRadiance))
    throw UsageError(name_ + ": the intensity must be finite and not negative");
  if (const auto& ground = placement.ground_radiance_rgb)
    for (int c = 0; c < 3; ++c)
      if (!((*ground)[c] >= 0 && (*ground)[c] <= kMaxRadiance))
        throw UsageError(name_ + ": the ground's radiance must be finite and not negative");
}

void EnvironmentMap::visitRows(Diagnostics& diagnostics, const CancelFlag* cancel, const RowVisitor& visit) {
  RepairCounts counts;
  std::vector<Rgb> repaired(static_cast<size_t>(width()));
  source_->visitRows([&](int row, std::span<const Rgb> stored) {
    if (cancel) cancel->check();
    for (size_t x = 0; x < repaired.size(); ++x) {
      Rgb value;
      for (int c = 0; c < 3; ++c) value[c] = counts.repair(stored[x][c]);
      if (placement_.ground_radiance_rgb && direction(double(x) + 0.5, row + 0.5).y < 0) value = *placement_.ground_radiance_rgb;
      for (int c = 0; c < 3; ++c) repaired[x][c] = std::min(value[c] * placement_.intensity, kMaxRadiance);
    }
    visit(row, repaired);
  });
  counts.report(name_, diagnostics);
}

Vec3d EnvironmentMap::direction(double column, double row) const {
  const double theta = row / height() * kPiD, phi = (column / width() - 0.5) * 2 * kPiD;
  const Vec3d d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  const Imath::M33d& m = placement_.world_from_map;
  return {m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z, m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
          m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z};
}

double EnvironmentMap::texelSolidAngle(int row) const {
  // cos a - cos b as a product of sines: no cancellation in rows near the poles.
  const double d_theta = kPiD / height();
  return 2 * kPiD / width() * 2 * std::sin((row + 0.5) * d_theta) * std::sin(0.5 * d_theta);
}

}  // namespace lightwell::transport
