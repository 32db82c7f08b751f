// Form factors in float against double and against quadrature, over random configurations that touch, graze, are coplanar, huge and tiny. Run with
// LIGHTWELL_CONFIGURATIONS=1000000 for more of them.
#include "runtime/src/form_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <random>
#include <vector>

namespace lightwell::runtime {
namespace {

constexpr double kEpsilon = 0x1p-23;

struct Double3 {
  double x, y, z;
};
Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Double3 cross(Double3 a, Double3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Double3 wide(Float3 a) { return {a.x, a.y, a.z}; }
double length(Double3 a) { return std::sqrt(dot(a, a)); }

/// Lambert's formula after clipping by the horizon, in double, written for clarity.
double exactFormFactor(const std::vector<Float3>& vertices, Float3 normal) {
  const Double3 n = wide(normal) * (1 / length(wide(normal)));
  std::vector<Double3> above;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Double3 a = wide(vertices[i]), b = wide(vertices[(i + 1) % vertices.size()]);
    const double za = dot(n, a), zb = dot(n, b);
    if (za > 0) above.push_back(a);
    if ((za > 0) != (zb > 0) && za != zb) above.push_back(a + (b - a) * (za / (za - zb)));
  }
  double sum = 0;
  for (size_t i = 0; i < above.size(); ++i) {
    const Double3 a = above[i], b = above[(i + 1) % above.size()], gamma = cross(a, b - a);
    if (length(gamma) > 1e-300) sum += std::atan2(length(gamma), dot(a, b)) * dot(gamma, n) / length(gamma);
  }
  return std::max(0.0, -sum / (2 * M_PI));
}

struct Configuration {
  std::vector<Float3> vertices;
  Float3 normal;
  double distance, radius;  // of the polygon's middle, and around it

  double size() const {
    double size = 0;
    for (const auto& v : vertices) size = std::max(size, length(wide(v)));
    return size;
  }
  /// Distance from the receiver to the edges, and to the plane where the polygon is right before it.
  double nearest() const {
    double nearest = INFINITY;
    Double3 plane{0, 0, 0};
    for (size_t i = 2; i < vertices.size(); ++i) plane = plane + cross(wide(vertices[i - 1]) - wide(vertices[0]), wide(vertices[i]) - wide(vertices[0]));
    bool inside = true;
    for (size_t i = 0; i < vertices.size(); ++i) {
      const Double3 a = wide(vertices[i]), edge = wide(vertices[(i + 1) % vertices.size()]) - a;
      const double t = std::clamp(-dot(a, edge) / std::max(dot(edge, edge), 1e-300), 0.0, 1.0);
      nearest = std::min(nearest, length(a + edge * t));
      inside &= dot(cross(edge, a * -1), plane) > 0;
    }
    return inside ? std::min(nearest, std::abs(dot(plane, wide(vertices[0]))) / std::max(length(plane), 1e-300)) : nearest;
  }
};

/// A convex polygon of 3 to 8 vertices whose front faces the origin or not, at all scales; special ones touch the receiver or lie in its plane.
Configuration randomConfiguration(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
  const auto direction = [&] {
    for (;;) {
      const Double3 d{both(random), both(random), both(random)};
      if (const double l = length(d); l > 0.01 && l < 1) return d * (1 / l);
    }
  };
  Configuration c;
  const double scale = std::pow(10, both(random) * 4);
  c.distance = scale * std::pow(10, both(random) * 3), c.radius = scale;
  const int kind = int(random() % 6);
  Double3 normal = direction(), plane = direction(), middle = direction() * c.distance;
  if (kind == 1) middle = middle - normal * dot(normal, middle);                // on the horizon
  if (kind == 2) plane = normal * (random() % 2 ? 1 : -1);                      // parallel
  if (kind == 3) middle = middle - plane * (dot(plane, middle) * (1 - 1e-5));   // seen from nearly beside it
  Double3 s = cross(plane, std::abs(plane.x) < 0.5 ? Double3{1, 0, 0} : Double3{0, 1, 0});
  s = s * (1 / length(s));
  const Double3 t = cross(plane, s);
  const int count = 3 + int(random() % 6);
  const double turn = unit(random), squash = std::pow(10, -2 * unit(random));
  std::vector<Double3> exact;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * (i + turn) / count;
    exact.push_back(middle + s * (std::cos(angle) * c.radius) + t * (std::sin(angle) * c.radius * squash));
  }
  if (kind == 4) {  // a corner on the receiver
    const Double3 corner = exact[0];
    for (auto& v : exact) v = v - corner;
  }
  if (kind == 5) {  // an edge near or through it
    const Double3 on_edge = (exact[0] + exact[1]) * 0.5 + plane * (c.radius * 1e-4 * unit(random));
    for (auto& v : exact) v = v - on_edge;
  }
  if (random() % 64 == 0) for (auto& v : exact) v = v * 1e12;
  if (random() % 64 == 0) for (auto& v : exact) v = v * 1e-12;
  for (const auto& v : exact) c.vertices.push_back({float(v.x), float(v.y), float(v.z)});
  c.normal = {float(normal.x), float(normal.y), float(normal.z)};
  return c;
}

TEST(FormFactor, InFloatIsThatInDouble) {
  const char* wanted = std::getenv("LIGHTWELL_CONFIGURATIONS");
  const int configurations = wanted ? std::atoi(wanted) : 100000;
  std::mt19937_64 random(1);
  int lit = 0;
  double worst = 0, worst_relative = 0;
  for (int i = 0; i < configurations; ++i) {
    const Configuration c = randomConfiguration(random);
    const float value = polygonFormFactor(c.vertices.data(), unsigned(c.vertices.size()), c.normal);
    ASSERT_TRUE(value >= 0 && value <= 1) << i << ": " << value;
    const double exact = exactFormFactor(c.vertices, c.normal);
    // A rounded coordinate turns an edge or the plane, seen from so near, by so much: no float can do better.
    const double conditioning = kEpsilon * c.size() / std::max(c.nearest(), 1e-300), error = std::abs(value - exact);
    ASSERT_LE(error, 1e-5 + 4 * conditioning) << "configuration " << i << ": " << value << " for " << exact;
    lit += exact > 0.01;
    if (conditioning < 1e-5) worst = std::max(worst, error);
    if (exact < 1e-3 || conditioning > 1e-5) continue;
    worst_relative = std::max(worst_relative, error / exact);
  }
  EXPECT_GT(lit, configurations / 20);
  EXPECT_LT(worst_relative, 5e-4) << "of well-conditioned ones above 0.001";
  std::printf("worst error %.2g, relative above 0.001 %.2g, where an edge is not nearer than 1/80 of the size\n", worst, worst_relative);
}

TEST(FormFactor, IsTheIntegralOverTheHemisphere) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> both(-1, 1);
  for (int i = 0; i < 200; ++i) {
    // A triangle anywhere about the receiver, its front toward it.
    std::vector<Float3> v(3);
    for (auto& p : v) p = {float(both(random) * 2), float(both(random) * 2), float(both(random) * 2)};
    const Float3 normal{0, 0, 1};
    const Float3 plane = cross(v[1] - v[0], v[2] - v[0]);
    if (dot(plane, v[0]) > 0) std::swap(v[1], v[2]);
    if (std::abs(dot(plane, v[0])) < 0.3f) continue;  // quadrature over the area cannot
    const Double3 a = wide(v[0]), s = wide(v[1]) - a, t = wide(v[2]) - a, area = cross(s, t);
    double sum = 0;
    constexpr int kSteps = 400;
    for (int y = 0; y < kSteps; ++y)
      for (int x = 0; x < kSteps; ++x) {
        double p = (x + 0.5) / kSteps, q = (y + 0.5) / kSteps;
        if (p + q > 1) p = 1 - p, q = 1 - q;  // each point twice, in half the area
        const Double3 at = a + s * p + t * q;
        const double d2 = dot(at, at);
        sum += std::max(at.z, 0.0) * std::max(-dot(area, at), 0.0) / (d2 * d2);
      }
    const double expected = sum / (kSteps * kSteps) / 2 / M_PI;
    EXPECT_NEAR(polygonFormFactor(v.data(), 3, normal), expected, 1e-3 + 0.01 * expected) << i;
  }
}

TEST(FormFactor, OfFacingSquaresIsKnown) {
  // A unit square at height 1 right above: 4 / (2 pi) * (a / sqrt(1 + a²)) * atan(a / sqrt(1 + a²)) * 2 with a = 1/2 (Hottel).
  const Float3 above[4] = {{-0.5f, -0.5f, 1}, {-0.5f, 0.5f, 1}, {0.5f, 0.5f, 1}, {0.5f, -0.5f, 1}};  // front downward
  const double a = 0.5 / std::sqrt(1.25), exact = 4 / (2 * M_PI) * (2 * a * std::atan(a));
  EXPECT_NEAR(polygonFormFactor(above, 4, {0, 0, 1}), exact, 1e-6);
  EXPECT_EQ(polygonFormFactor(above, 4, {0, 0, -1}), 0);
  const Float3 sky[4] = {{-1e6f, -1e6f, 1}, {-1e6f, 1e6f, 1}, {1e6f, 1e6f, 1}, {1e6f, -1e6f, 1}};
  EXPECT_NEAR(polygonFormFactor(sky, 4, {0, 0, 1}), 1, 1e-5);
  EXPECT_NEAR(polygonFormFactor(sky, 4, {1, 0, 0}), 0.5, 1e-5);
}

TEST(ConeIrradiance, IsTheIntegralOverTheCone) {
  for (const double cosine : {1.0, 0.9, 0.5, 0.1, 0.0, -0.2, -0.7, -1.0})
    for (const double sine : {0.05, 0.3, 0.7, 0.999, 1.0}) {
      double sum = 0;
      constexpr int kSteps = 600;
      const double low = std::sqrt(std::max(0.0, 1 - sine * sine)), normal_sine = std::sqrt(1 - cosine * cosine);
      for (int y = 0; y < kSteps; ++y)
        for (int x = 0; x < kSteps; ++x) {
          const double z = low + (1 - low) * (y + 0.5) / kSteps, phi = 2 * M_PI * (x + 0.5) / kSteps;
          sum += std::max(0.0, z * cosine + std::sqrt(1 - z * z) * std::cos(phi) * normal_sine);
        }
      sum *= 2 * M_PI * (1 - low) / (kSteps * kSteps);
      EXPECT_NEAR(coneIrradiance(float(cosine), float(sine)), sum, 2e-4 + 1e-3 * sum) << cosine << " " << sine;
    }
}

}  // namespace
}  // namespace lightwell::runtime
