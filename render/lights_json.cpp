#include "render/lights_json.h"

#include <numbers>

#include "render/error.h"
#include "render/json_fields.h"

namespace lightwell::render {
namespace {

constexpr size_t kMaxLights = 1024;

lw_light parseLight(const JsonFields& fields, const double origin_m[3]) {
  static constexpr uint32_t kTypes[] = {LW_LIGHT_POINT, LW_LIGHT_SPOT, LW_LIGHT_DIRECTIONAL};
  lw_light light{};
  light.type = kTypes[fields.choice("type", {"point", "spot", "directional"}, std::nullopt)];
  const bool has_position = light.type != LW_LIGHT_DIRECTIONAL, has_direction = light.type != LW_LIGHT_POINT;
  const std::array<double, 3> zero{0, 0, 0};
  const auto position = has_position ? fields.vector("position", std::nullopt) : zero;
  const auto direction = has_direction ? fields.direction("direction", std::nullopt) : Float3{0, -1, 0};
  const auto color = fields.vector("color", std::array<double, 3>{1, 1, 1}, 0);
  const double intensity = fields.number("intensity", 1, 0, 1e9);
  for (size_t i = 0; i < 3; ++i) {
    light.position_m[i] = has_position ? float(position[i] - origin_m[i]) : 0;
    light.direction[i] = direction[i];
    light.intensity_rgb[i] = float(color[i] * intensity);
  }
  light.inner_cone_angle_rad = float(fields.number("innerConeAngle", 0, 0, std::numbers::pi / 2));
  light.outer_cone_angle_rad = float(fields.number("outerConeAngle", std::numbers::pi / 4, 0, std::numbers::pi / 2));
  if (light.type == LW_LIGHT_SPOT && !(light.inner_cone_angle_rad < light.outer_cone_angle_rad))
    fields.fail("outerConeAngle", "must be greater than innerConeAngle");
  light.range_m = float(fields.number("range", 0, 0, 1e9));
  return light;
}

}  // namespace

std::vector<lw_light> parseLights(std::string_view text, const std::string& file, const double origin_m[3]) {
  const nlohmann::json json = parseJson(text, file);
  const JsonFields fields(json, file, "", {"lights"});
  const nlohmann::json& list = fields.at("lights");
  if (!list.is_array() || list.size() > kMaxLights) fields.fail("lights", "must be an array of at most " + std::to_string(kMaxLights));
  std::vector<lw_light> lights;
  for (size_t i = 0; i < list.size(); ++i)
    lights.push_back(parseLight(JsonFields(list[i], file, "lights[" + std::to_string(i) + "]",
                                           {"type", "name", "position", "direction", "color", "intensity", "innerConeAngle",
                                            "outerConeAngle", "range"}),
                                origin_m));
  return lights;
}

std::vector<lw_light> readLights(const std::filesystem::path& file, const double origin_m[3]) {
  return parseLights(readSmallFile(file), file.string(), origin_m);
}

}  // namespace lightwell::render
