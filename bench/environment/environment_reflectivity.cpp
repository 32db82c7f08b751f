// Average reflectivity of an evenly lit cap by the formulas, over quadrature: the ratios behind figures 5 and 6 of Barsi et al.
//   environment_reflectivity > reflectivity.csv
// figure 5: psi = 0, radius 0 to π/2; figure 6: radius π/8, psi from 0 to the radius. Values: mean of cos^n over the cap.
#include <cstdio>

#include "precompute/transport/environment/reflectivity.h"

using namespace lightwell;
using namespace lightwell::transport;

namespace {

constexpr double kPiD = std::numbers::pi;

double quadrature(double radius, double psi, double n) {
  const int rings = 500, sectors = 250;
  double sum = 0, area = 0;
  for (int i = 0; i < rings; ++i) {
    const double r = radius * (i + 0.5) / rings, weight = std::sin(r);
    for (int j = 0; j < sectors; ++j) {
      const double cosine = std::cos(r) * std::cos(psi) + std::sin(r) * std::sin(psi) * std::cos((j + 0.5) / sectors * 2 * kPiD);
      sum += weight * (cosine > 0 ? std::pow(cosine, n) : 0);
      area += weight;
    }
  }
  return sum / area;
}

void print(const char* figure, double radius, double psi, float n) {
  const double depth = 2 * std::pow(std::sin(radius / 2), 2), c = 1 - depth, variance = 0.5 * (1 - (1 + c + c * c) / 3);
  const CellShape cap{Vec3(0, 0, 1), float(2 * kPiD * depth), float(depth / 2), {float(variance), 0, float(variance)}};
  const Vec3 mirror{float(std::sin(psi)), 0, float(std::cos(psi))};
  const auto average = [&](Reflectivity model) { return averageCosinePower(model, cap, mirror, n); };
  std::printf("%s,%g,%.4f,%.4f,%.6g,%.6g,%.6g,%.6g,%.6g\n", figure, n, radius, psi, quadrature(radius, psi, n),
              average(Reflectivity::single), average(Reflectivity::paper), average(Reflectivity::vmf), average(Reflectivity::spread));
}

}  // namespace

int main() {
  std::printf("figure,shininess,radius_rad,psi_rad,exact,one sample,paper,vmf,spread\n");
  for (float n : {1.0f, 5.0f, 10.0f, 100.0f, 1000.0f}) {
    for (int i = 1; i <= 15; ++i) print("5", kPiD / 2 * i / 15, 0, n);
    for (int i = 0; i <= 12; ++i) print("6", kPiD / 8, kPiD / 8 * i / 12, n);
  }
}
