#include "precompute/scene/gltf/lights.h"

#include <algorithm>
#include <cmath>

#include "precompute/scene/gltf/limits.h"
#include "precompute/scene/light_checks.h"

namespace lightwell::scene::gltf {
namespace {

constexpr double kLumensPerWatt = 683;  // at 555 nm, where the candela is defined

LightType lightType(const JsonValue& type) {
  const std::string& name = type.string();
  if (name == "point") return LightType::point;
  if (name == "spot") return LightType::spot;
  if (name == "directional") return LightType::directional;
  type.fail("is \"" + name + "\", which is no type of light");
}

/// Range as the file has it, 0 when infinite.
double readRange(const JsonValue& json, Diagnostics& diagnostics) {
  const auto range = json.find("range");
  if (!range) return 0;
  const double value = range->number();
  if (value > 0) return std::min(value, kMaxCoordinateM);
  diagnostics.warn(range->path(), "is not positive; the light has no end");
  return 0;
}

}  // namespace

double photometricFactor(LightType type, LightUnits units) {
  switch (units) {
    case LightUnits::spec: return 1;
    case LightUnits::unitless: return kLumensPerWatt;
    case LightUnits::raw: return type == LightType::directional ? kLumensPerWatt : kLumensPerWatt / (4 * std::numbers::pi);
  }
  return 1;
}

std::vector<PlacedLight> readLights(Document& document, const std::vector<Placement>& placements, LightUnits units,
                                    Diagnostics& diagnostics) {
  std::vector<PlacedLight> lights;
  if (placements.empty()) return lights;
  const JsonValue definitions = document.root().extension("KHR_lights_punctual")->at("lights");
  for (const Placement& placement : placements) {
    const JsonValue json = definitions[placement.target];
    PlacedLight placed;
    Light& light = placed.light;
    light.type = lightType(json.at("type"));
    light.name = json.stringOr("name", placement.name);
    const auto color = json.numbersOr<3>("color", {1, 1, 1});
    setIntensity(light, {color[0], color[1], color[2]}, json.numberOr("intensity", 1) * photometricFactor(light.type, units), json.path(),
                 diagnostics);
    if (light.type != LightType::directional) light.range = float(readRange(json, diagnostics));
    if (light.type == LightType::spot) {
      const JsonValue spot = json.at("spot");
      setCone(light, spot.numberOr("innerConeAngle", 0), spot.numberOr("outerConeAngle", std::numbers::pi / 4), spot.path(), diagnostics);
    }
    const Matrix& world = placement.world;
    placed.position_m = {world[3][0], world[3][1], world[3][2]};
    Vec3d direction(-world[2][0], -world[2][1], -world[2][2]);  // a light shines along −Z of its node
    const double length = direction.length();
    const bool aimed = length > 0 && std::isfinite(length);
    if (aimed) light.direction = Vec3(direction / length);
    if (!aimed && light.type != LightType::point) {
      diagnostics.warn(placement.path, "the transform leaves the light no direction; the light is left out");
      continue;
    }
    if (!(placed.position_m.length() <= kMaxCoordinateM)) {
      diagnostics.warn(placement.path, "the light is absurdly far away; it is left out");
      continue;
    }
    lights.push_back(placed);
  }
  return lights;
}

}  // namespace lightwell::scene::gltf
