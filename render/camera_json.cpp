#include "render/camera_json.h"

#include <numbers>

#include "render/json_fields.h"

namespace lightwell::render {
namespace {

constexpr int kMaxPixels = 8192;  // per side

Float3 forwardOf(const JsonFields& fields, const std::array<double, 3>& eye) {
  if (fields.has("target") == fields.has("direction")) fields.fail("target", "give either target or direction");
  if (fields.has("direction")) return fields.direction("direction", std::nullopt);
  const auto target = fields.vector("target", std::nullopt);
  const std::array<double, 3> toward{target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
  const double size = std::hypot(toward[0], toward[1], toward[2]);
  if (!(size > 1e-9)) fields.fail("target", "is where the eye is");
  return {float(toward[0] / size), float(toward[1] / size), float(toward[2] / size)};
}

}  // namespace

const char* partName(LightPart part) {
  switch (part) {
    case LightPart::direct: return "direct";
    case LightPart::indirect: return "indirect";
    case LightPart::full: break;
  }
  return "full";
}

View parseCamera(std::string_view text, const std::string& file) {
  const nlohmann::json json = parseJson(text, file);
  const JsonFields fields(json, file, "", {"eye", "target", "direction", "up", "vertical_fov_deg", "width", "height", "exposure", "mode",
                                           "surface", "background", "lamps"});
  View view;
  view.eye_m = fields.vector("eye", std::nullopt);
  view.forward = forwardOf(fields, view.eye_m);
  view.up = fields.direction("up", std::array<double, 3>{0, 1, 0});
  if (length(cross(view.forward, view.up)) < 1e-3f) fields.fail("up", "is parallel to the viewing direction");
  view.vertical_fov_rad = float(fields.number("vertical_fov_deg", 60, 1, 170) * std::numbers::pi / 180);
  view.width = fields.integer("width", 1280, 1, kMaxPixels);
  view.height = fields.integer("height", 720, 1, kMaxPixels);
  if (fields.has("exposure") && fields.at("exposure") != "auto") view.exposure_ev = float(fields.number("exposure", std::nullopt, -30, 40));
  view.part = LightPart(fields.choice("mode", {"direct", "indirect", "full"}, "full"));
  view.lighting_only = fields.choice("surface", {"textured", "lighting"}, "textured") == 1;
  const auto background = fields.vector("background", std::array<double, 3>{0, 0, 0}, 0);
  for (size_t i = 0; i < 3; ++i) view.background_radiance_rgb[i] = float(background[i]);
  view.show_lamps = fields.boolean("lamps", false);
  return view;
}

View readCamera(const std::filesystem::path& file) { return parseCamera(readSmallFile(file), file.string()); }

}  // namespace lightwell::render
