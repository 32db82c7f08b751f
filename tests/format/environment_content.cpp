#include "tests/format/environment_content.h"

#include <cmath>
#include <numbers>

#include "format/decode/pixel.h"

namespace lightwell::format {
namespace {

constexpr uint64_t kFaceCells = 4, kSide = kFaceCells + 1, kNodes = 6 * kSide * kSide;

}  // namespace

EnvironmentContent environmentContent() {
  constexpr float kFourPi = float(4 * std::numbers::pi), kSunSolidAngle = 6.0e-5f;
  EnvironmentContent c;
  c.header.set_cells(3);
  c.header.set_suns(1);
  c.header.set_face_cells(uint32_t(kFaceCells));
  c.header.set_intensity(1);
  c.direction = {0.6f, 0.8f, 0, 0, 1, 0, 0, -1, 0};
  c.solid_angle = {kSunSolidAngle, kFourPi / 2 - kSunSolidAngle, kFourPi / 2};
  c.spread = {4.0e-6f, 0.5f, 0.5f};
  c.covariance = {4.0e-6f, 1.0e-6f, 4.0e-6f, 0.33f, 0, 0.33f, 0.33f, 0, 0.33f};
  // Nodes of equal value: mass = scale · (4π / 6m²) · value, which is not an even sky, but a sound one.
  c.header.set_node_scale(0.25f);
  c.node.assign(kNodes * 3, 0);
  const double unit = 0.25 * 4 * std::numbers::pi / (6.0 * kFaceCells * kFaceCells);
  const float value[3] = {1, 2, 4};
  c.flux = {30, 25, 20};
  for (size_t channel = 0; channel < 3; ++channel) {
    for (size_t i = channel; i < c.node.size(); i += 3) c.node[i] = packHalf(value[channel]);
    c.header.add_sky_flux(float(unit * double(kNodes) * double(value[channel])));
  }
  for (const float share : {0.75f, 0.25f})
    for (int channel = 0; channel < 3; ++channel) c.flux.push_back(share * c.header.sky_flux(channel));
  for (int k = 0; k < 9; ++k)
    for (int channel = 0; channel < 3; ++channel)
      c.header.add_radiance_sh(k == 0 ? c.header.sky_flux(channel) / std::sqrt(kFourPi) : k == 1 ? 0.2f * c.header.sky_flux(channel) : 0.0f);
  return c;
}

Writer toWriter(const EnvironmentContent& c) {
  Writer writer;
  const auto wanted = [&](const char* name) { return !c.left_out.contains(name); };
  const auto add = [&]<class T>(const char* name, const std::vector<T>& values, std::initializer_list<uint64_t> shape = {},
                                ElementType element = detail::elementTypeOf<T>()) {
    if (wanted(name)) writer.add("environment", name, values, shape, element);
  };
  writer.addSection("environment");
  if (wanted("header")) writer.addMessage("environment", "header", c.header);
  add("cell_direction", c.direction, {c.direction.size() / 3, 3});
  add("cell_flux", c.flux, {c.flux.size() / 3, 3});
  add("cell_solid_angle", c.solid_angle);
  add("cell_spread", c.spread);
  add("cell_covariance", c.covariance, {c.covariance.size() / 3, 3});
  add("node", c.node, {6, kSide, kSide, 3}, ElementType::f16);
  return writer;
}

}  // namespace lightwell::format
