// LIGHTS.json: punctual lights in metres, candela and lux, that replace those of a scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/scene/gltf/files.h"
#include "precompute/scene/gltf/limits.h"
#include "precompute/scene/import.h"
#include "precompute/scene/json_value.h"
#include "precompute/scene/light_checks.h"

namespace lightwell::scene {
namespace {

constexpr uint64_t kMaxLightsJsonBytes = 64ull << 20;

void warnUnknownKeys(const JsonValue& object, std::initializer_list<std::string_view> known, Diagnostics& diagnostics) {
  for (const std::string& key : object.keys())
    if (std::find(known.begin(), known.end(), key) == known.end())
      diagnostics.warn(object.path().empty() ? key : object.path() + "." + key, "is not a key of LIGHTS.json and means nothing");
}

LightType lightType(const JsonValue& type) {
  const std::string& name = type.string();
  if (name == "point") return LightType::point;
  if (name == "spot") return LightType::spot;
  if (name == "directional") return LightType::directional;
  type.fail("is \"" + name + "\"; a light is \"point\", \"spot\" or \"directional\"");
}

Vec3d vector(const JsonValue& json) {
  const auto n = json.numbers<3>();
  return {n[0], n[1], n[2]};
}

Light readLight(const Scene& scene, const JsonValue& json, Diagnostics& diagnostics) {
  warnUnknownKeys(json, {"type", "position", "direction", "color", "intensity", "innerConeAngle", "outerConeAngle"}, diagnostics);
  Light light;
  light.type = lightType(json.at("type"));
  Vec3d position_m(0);
  if (light.type != LightType::directional) {
    position_m = vector(json.at("position"));
    if (!(position_m.length() <= gltf::kMaxCoordinateM)) json.at("position").fail("is absurdly far away");
  }
  if (light.type != LightType::point) {
    const Vec3d direction = vector(json.at("direction"));
    if (!(direction.length() > 0) || !std::isfinite(direction.length())) json.at("direction").fail("has no direction");
    light.direction = Vec3(direction.normalized());
  }
  const auto intensity = json.at("intensity");
  if (intensity.number() < 0) intensity.fail("is negative");
  const auto color = json.find("color");
  const Vec3d color_rgb = color ? vector(*color) : Vec3d(1);
  if (color && std::min({color_rgb.x, color_rgb.y, color_rgb.z}) < 0) color->fail("is negative");
  setIntensity(light, color_rgb, intensity.number(), json.path(), diagnostics);
  if (light.type == LightType::spot)
    setCone(light, json.numberOr("innerConeAngle", 0), json.numberOr("outerConeAngle", std::numbers::pi / 4), json.path(), diagnostics);
  return toInternal(scene, light, position_m);
}

}  // namespace

void replaceLights(Scene& scene, const std::filesystem::path& lights_json, Diagnostics& diagnostics, const FileTable* files) {
  const std::string file = lights_json.string();
  const std::vector<uint8_t> bytes = gltf::readFile(lights_json, kMaxLightsJsonBytes, files);
  const nlohmann::json document = parseJson(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const JsonValue root(file, document);
  warnUnknownKeys(root, {"lights"}, diagnostics);
  const JsonValue json = root.at("lights");
  std::vector<Light> lights;
  for (size_t i = 0; i < json.size(); ++i) lights.push_back(readLight(scene, json[i], diagnostics));
  scene.lights = std::move(lights);
}

}  // namespace lightwell::scene
