// Entries that are one rectangle and its four quarters, lights close to them, and what those give in closed form.
#pragma once
#include <random>

#include "format/decode/pixel.h"
#include "tests/runtime/synthetic_prm.h"

namespace lightwell::test {

/// Entry 0 is the whole rectangle, entries 1 to 4 are its quarters. All in double, from the numbers that a container holds.
struct RectangleEntries {
  using Vector = std::array<double, 3>;
  static constexpr double kHalfU_m = 0.5, kHalfV_m = 0.25, kTurn = 0.375;  // exact as halfs

  Vector middle_m{0.5, -0.25, 1}, normal{}, along_u{}, along_v{};

  explicit RectangleEntries(Vector toward) {
    const format::Float3 n = format::unpackOct(format::packOct({float(toward[0]), float(toward[1]), float(toward[2])}));
    normal = {n.x, n.y, n.z};
    // docs/format.md: Tangents of section environment, turned by kTurn half turns.
    const double g = std::signbit(n.z) ? -1 : 1, a = -1 / (g + n.z), turn = kTurn * 3.14159265358979;
    const Vector t{1 + g * n.x * n.x * a, g * n.x * n.y * a, -g * n.x}, b{n.x * n.y * a, g + n.y * n.y * a, -n.y};
    for (size_t k = 0; k < 3; ++k) {
      along_u[k] = std::cos(turn) * t[k] + std::sin(turn) * b[k];
      along_v[k] = std::cos(turn) * b[k] - std::sin(turn) * t[k];
    }
  }

  SyntheticOptions options() const {
    SyntheticOptions options;
    options.layout = Layout::local_bases;
    options.place_entries = [self = *this](SyntheticPrm& prm) {
      for (size_t e = 0; e < 5; ++e) {
        const double half = e ? 0.5 : 1, u = e ? (e % 2 ? 0.5 : -0.5) : 0, v = e ? (e > 2 ? 0.5 : -0.5) : 0;
        const auto middle = self.at(u * kHalfU_m, v * kHalfV_m, 0);
        for (size_t k = 0; k < 3; ++k) {
          prm.entry_position[e * 3 + k] = middle[k];
          prm.entry_normal[e * 3 + k] = float(self.normal[k]);
          prm.entry_rectangle[e * 3 + k] = float(std::array{half * kHalfU_m, half * kHalfV_m, kTurn}[k]);
        }
      }
    };
    return options;
  }

  /// So far along the sides and above the rectangle.
  std::array<float, 3> at(double u_m, double v_m, double height_m) const {
    std::array<float, 3> p;
    for (size_t k = 0; k < 3; ++k) p[k] = float(middle_m[k] + u_m * along_u[k] + v_m * along_v[k] + height_m * normal[k]);
    return p;
  }

  /// Mean irradiance on the whole under one candela there: solid angle over area.
  static double meanIrradiance(double u_m, double v_m, double height_m) {
    const auto corner = [&](double x, double y) { return std::atan(x * y / (height_m * std::sqrt(x * x + y * y + height_m * height_m))); };
    const double solid_angle_sr = corner(kHalfU_m - u_m, kHalfV_m - v_m) + corner(kHalfU_m + u_m, kHalfV_m - v_m) +
                                  corner(kHalfU_m - u_m, kHalfV_m + v_m) + corner(kHalfU_m + u_m, kHalfV_m + v_m);
    return solid_angle_sr / (4 * kHalfU_m * kHalfV_m);
  }

  /// Lights above and beside the rectangle, from a millimetre to a few metres off its plane: u, v, height in metres.
  static std::vector<Vector> lightPlaces(size_t count) {
    std::mt19937 engine(7);
    const auto uniform = [&] { return double(engine()) / 4294967296.0; };
    std::vector<Vector> places;
    for (size_t i = 0; i < count; ++i) {
      const double u = 4 * kHalfU_m * (uniform() - 0.5), v = 4 * kHalfV_m * (uniform() - 0.5);
      places.push_back({u, v, std::exp(-7 + 8.5 * uniform())});
    }
    return places;
  }
};

/// Along axes, where frames are special, and between them.
inline const RectangleEntries::Vector kRectangleNormals[] = {{0, 0, 1},  {0, 0, -1},       {0, 1, 0},
                                                              {-1, 0, 0}, {0.3, 0.5, -0.8}, {-0.7, 0.2, 0.1}};

}  // namespace lightwell::test
