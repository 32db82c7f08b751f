#include "render/camera_json.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "render/error.h"

namespace lightwell::render {
namespace {

using Json = nlohmann::json;
constexpr size_t kMaxFileBytes = 1 << 20;
constexpr int kMaxPixels = 8192;  // per side

class CameraParser {
 public:
  CameraParser(const Json& json, const std::string& file) : json_(json), file_(file) {}

  View parse() {
    if (!json_.is_object()) fail("", "must be an object");
    for (const auto& [key, value] : json_.items())
      if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys)) fail(key, "is not a key of a camera");
    View view;
    view.eye_m = vector("eye", std::nullopt);
    view.forward = forward(view.eye_m);
    const auto up = vector("up", std::array<double, 3>{0, 1, 0});
    view.up = unit("up", up);
    if (length(cross(view.forward, view.up)) < 1e-3f) fail("up", "is parallel to the viewing direction");
    view.vertical_fov_rad = float(number("vertical_fov_deg", 60, 1, 170) * std::numbers::pi / 180);
    view.width = int(integer("width", 1280, 1, kMaxPixels));
    view.height = int(integer("height", 720, 1, kMaxPixels));
    view.exposure_ev = exposure();
    view.part = LightPart(choice("mode", {"direct", "indirect", "full"}, "full"));
    view.lighting_only = choice("surface", {"textured", "lighting"}, "textured") == 1;
    const auto background = vector("background", std::array<double, 3>{0, 0, 0});
    for (size_t i = 0; i < 3; ++i) {
      if (background[i] < 0) fail("background", "must not be negative");
      view.background_radiance_rgb[i] = float(background[i]);
    }
    if (json_.contains("lamps") && !json_["lamps"].is_boolean()) fail("lamps", "must be true or false");
    view.show_lamps = json_.value("lamps", false);
    return view;
  }

 private:
  static constexpr const char* kKeys[] = {"eye", "target", "direction", "up", "vertical_fov_deg", "width", "height",
                                          "exposure", "mode", "surface", "background", "lamps"};

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const { throw CameraError(file_, key, reason); }

  double finite(const std::string& key, const Json& value) const {
    if (!value.is_number()) fail(key, "must be a number");
    const double number = value.get<double>();
    if (!(std::abs(number) <= 1e9)) fail(key, "must be within ±1e9");
    return number;
  }
  std::array<double, 3> vector(const std::string& key, const std::optional<std::array<double, 3>>& fallback) const {
    if (!json_.contains(key)) {
      if (!fallback) fail(key, "is missing");
      return *fallback;
    }
    const Json& value = json_[key];
    if (!value.is_array() || value.size() != 3) fail(key, "must be an array of three numbers");
    return {finite(key, value[0]), finite(key, value[1]), finite(key, value[2])};
  }
  Float3 unit(const std::string& key, const std::array<double, 3>& v) const {
    const double size = std::hypot(v[0], v[1], v[2]);
    if (!(size > 1e-9)) fail(key, "has no direction");
    return {float(v[0] / size), float(v[1] / size), float(v[2] / size)};
  }
  Float3 forward(const std::array<double, 3>& eye) const {
    if (json_.contains("target") == json_.contains("direction")) fail("target", "give either target or direction");
    if (json_.contains("direction")) return unit("direction", vector("direction", std::nullopt));
    const auto target = vector("target", std::nullopt);
    return unit("target", {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]});
  }
  double number(const std::string& key, double fallback, double low, double high) const {
    if (!json_.contains(key)) return fallback;
    const double value = finite(key, json_[key]);
    if (value < low || value > high) fail(key, "must lie in [" + Json(low).dump() + ", " + Json(high).dump() + "]");
    return value;
  }
  double integer(const std::string& key, double fallback, double low, double high) const {
    const double value = number(key, fallback, low, high);
    if (value != std::floor(value)) fail(key, "must be a whole number");
    return value;
  }
  std::optional<float> exposure() const {
    if (!json_.contains("exposure") || json_["exposure"] == "auto") return std::nullopt;
    if (!json_["exposure"].is_number()) fail("exposure", "must be \"auto\" or an exposure value");
    return float(number("exposure", 0, -30, 40));
  }
  size_t choice(const std::string& key, const std::vector<std::string>& names, const std::string& fallback) const {
    if (json_.contains(key) && !json_[key].is_string()) fail(key, "must be a string");
    const std::string value = json_.value(key, fallback);
    for (size_t i = 0; i < names.size(); ++i)
      if (names[i] == value) return i;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    fail(key, "must be one of " + all);
  }

  const Json& json_;
  const std::string& file_;
};

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
  // A flat object needs no depth; the callback stops hostile nesting before the parser's stack does.
  const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > 4) throw CameraError(file, "", "is nested too deeply");
    return true;
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end(), shallow);
  } catch (const Json::exception& error) {
    throw CameraError(file, "", std::string("is not JSON: ") + error.what());
  }
  return CameraParser(json, file).parse();
}

View readCamera(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw CameraError(file.string(), "", "cannot be read");
  std::string text(kMaxFileBytes + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(size_t(in.gcount()));
  if (text.size() > kMaxFileBytes) throw CameraError(file.string(), "", "is larger than 1 MiB");
  return parseCamera(text, file.string());
}

}  // namespace lightwell::render
