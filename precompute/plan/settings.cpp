#include "precompute/plan/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace lightwell::plan {
namespace {

using nlohmann::json;

template <class T, size_t n>
using Names = std::array<std::pair<T, std::string_view>, n>;

constexpr Names<Technique, 5> kTechniques{{{Technique::prm, "prm"},
                                           {Technique::lightmap, "lightmap"},
                                           {Technique::vpl, "vpl"},
                                           {Technique::radiosity, "radiosity"},
                                           {Technique::environment, "environment"}}};
constexpr Names<Quality, 3> kQualities{
    {{Quality::draft, "draft"}, {Quality::preview, "preview"}, {Quality::production, "production"}}};
constexpr Names<scene::LightUnits, 3> kLightUnits{
    {{scene::LightUnits::spec, "spec"}, {scene::LightUnits::unitless, "unitless"}, {scene::LightUnits::raw, "raw"}}};
constexpr Names<PrmLayout, 2> kPrmLayouts{{{PrmLayout::local_bases, "local-bases"}, {PrmLayout::panes, "panes"}}};
constexpr Names<PrmEstimator, 2> kPrmEstimators{{{PrmEstimator::gather, "gather"}, {PrmEstimator::walks, "walks"}}};

constexpr Names<VirtualLightShape, 5> kVirtualLightShapes{{{VirtualLightShape::automatic, "auto"},
                                                           {VirtualLightShape::point, "point"},
                                                           {VirtualLightShape::disk, "disk"},
                                                           {VirtualLightShape::sphere, "sphere"},
                                                           {VirtualLightShape::polygon, "polygon"}}};

constexpr Names<MovingLights, 6> kMovingLights{{{MovingLights::anywhere, "anywhere"},
                                               {MovingLights::ceilings, "ceilings"},
                                               {MovingLights::sun, "sun"},
                                               {MovingLights::lamps, "lamps"},
                                               {MovingLights::none, "none"},
                                               {MovingLights::paths, "paths"}}};

template <class T, size_t n>
std::string_view nameIn(const Names<T, n>& names, T value) {
  return std::find_if(names.begin(), names.end(), [&](const auto& pair) { return pair.first == value; })->second;
}
template <class T, size_t n>
std::optional<T> valueIn(const Names<T, n>& names, std::string_view name) {
  for (const auto& [value, known] : names)
    if (known == name) return value;
  return std::nullopt;
}
template <class T, size_t n>
std::vector<std::string> allNames(const Names<T, n>& names) {
  std::vector<std::string> result;
  for (const auto& pair : names) result.emplace_back(pair.second);
  return result;
}

std::string joined(const std::vector<std::string>& words) {
  std::string result;
  for (const auto& word : words) result += (result.empty() ? "" : ", ") + word;
  return result;
}

template <class T, size_t n>
T required(const Names<T, n>& names, const std::string& key, const json& value) {
  const auto found = value.is_string() ? valueIn(names, value.get<std::string>()) : std::nullopt;
  if (!found) throw UsageError("settings: \"" + key + "\" must be one of " + joined(allNames(names)));
  return *found;
}

uint32_t requiredCount(const std::string& key, const json& value, uint32_t most) {
  if (!value.is_number_unsigned() || value > most)
    throw UsageError("settings: \"" + key + "\" must be a whole number from 0 to " + std::to_string(most));
  return value.get<uint32_t>();
}

float requiredNumber(const std::string& key, const json& value, double least, double most) {
  if (!value.is_number() || !(value >= least && value <= most))
    throw UsageError("settings: \"" + key + "\" must be a number from " + json(least).dump() + " to " + json(most).dump());
  return value.get<float>();
}

float requiredSpacing(const std::string& key, const json& value) {
  if (value == "auto") return kAutomaticProbeSpacing;
  return requiredNumber(key, value, 0, kMostProbeSpacing_m);
}

std::vector<std::array<double, 3>> requiredPoints(const std::string& key, const json& value) {
  if (!value.is_array() || value.size() > kMostProbePoints)
    throw UsageError("settings: \"" + key + "\" must be an array of at most " + std::to_string(kMostProbePoints) + " points");
  std::vector<std::array<double, 3>> points;
  for (size_t i = 0; i < value.size(); ++i) {
    const json& point = value[i];
    if (!point.is_array() || point.size() != 3) throw UsageError("settings: \"" + key + "\"[" + std::to_string(i) + "] must be three numbers");
    std::array<double, 3>& place = points.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      if (!point[k].is_number() || !(std::abs(point[k].get<double>()) <= 1e9))
        throw UsageError("settings: \"" + key + "\"[" + std::to_string(i) + "] must be three numbers of at most 1e9 m");
      place[k] = point[k].get<double>();
    }
  }
  return points;
}

std::vector<std::vector<std::array<double, 3>>> requiredPaths(const std::string& key, const json& value) {
  if (!value.is_array()) throw UsageError("settings: \"" + key + "\" must be an array of arrays of points");
  std::vector<std::vector<std::array<double, 3>>> paths;
  size_t points = 0;
  for (size_t i = 0; i < value.size(); ++i) {
    paths.push_back(requiredPoints(key + "[" + std::to_string(i) + "]", value[i]));
    points += paths.back().size();
    if (paths.back().empty() || points > kMostLightPathPoints)
      throw UsageError("settings: \"" + key + "\" must have 1 to " + std::to_string(kMostLightPathPoints) + " points, at least one in each path");
  }
  return paths;
}

bool requiredFlag(const std::string& key, const json& value) {
  if (!value.is_boolean()) throw UsageError("settings: \"" + key + "\" must be true or false");
  return value.get<bool>();
}

std::vector<std::string> requiredNames(const std::string& key, const json& value) {
  const bool good = value.is_array() && value.size() <= kMostPortalNames && std::all_of(value.begin(), value.end(), [](const json& name) { return name.is_string(); });
  if (!good) throw UsageError("settings: \"" + key + "\" must be a list of at most " + std::to_string(kMostPortalNames) + " names");
  return value.get<std::vector<std::string>>();
}

std::optional<std::array<float, 3>> requiredGround(const std::string& key, const json& value) {
  if (value.is_null()) return std::nullopt;
  if (!value.is_array() || value.size() != 3) throw UsageError("settings: \"" + key + "\" must be null or three numbers");
  std::array<float, 3> radiance_rgb;
  for (size_t i = 0; i < 3; ++i) radiance_rgb[i] = requiredNumber(key, value[i], 0, kMostRadiance);
  return radiance_rgb;
}

}  // namespace

std::string_view name(Technique technique) { return nameIn(kTechniques, technique); }
std::string_view name(Quality quality) { return nameIn(kQualities, quality); }
std::string_view name(scene::LightUnits units) { return nameIn(kLightUnits, units); }
std::string_view name(PrmLayout layout) { return nameIn(kPrmLayouts, layout); }
std::string_view name(PrmEstimator estimator) { return nameIn(kPrmEstimators, estimator); }
std::string_view name(VirtualLightShape shape) { return nameIn(kVirtualLightShapes, shape); }
std::string_view name(MovingLights lights) { return nameIn(kMovingLights, lights); }
std::optional<Technique> techniqueNamed(std::string_view name) { return valueIn(kTechniques, name); }
std::optional<Quality> qualityNamed(std::string_view name) { return valueIn(kQualities, name); }
std::optional<scene::LightUnits> lightUnitsNamed(std::string_view name) { return valueIn(kLightUnits, name); }
std::optional<PrmLayout> prmLayoutNamed(std::string_view name) { return valueIn(kPrmLayouts, name); }
std::optional<PrmEstimator> prmEstimatorNamed(std::string_view name) { return valueIn(kPrmEstimators, name); }
std::optional<VirtualLightShape> virtualLightShapeNamed(std::string_view name) { return valueIn(kVirtualLightShapes, name); }
std::optional<MovingLights> movingLightsNamed(std::string_view name) {
  const auto lights = valueIn(kMovingLights, name);
  return lights == MovingLights::paths ? std::nullopt : lights;
}
std::vector<std::string> techniqueNames() { return allNames(kTechniques); }
std::vector<std::string> qualityNames() { return allNames(kQualities); }
std::vector<std::string> lightUnitsNames() { return allNames(kLightUnits); }
std::vector<std::string> prmLayoutNames() { return allNames(kPrmLayouts); }
std::vector<std::string> prmEstimatorNames() { return allNames(kPrmEstimators); }
std::vector<std::string> virtualLightShapeNames() { return allNames(kVirtualLightShapes); }

std::vector<Technique> parseTechniques(std::string_view list) {
  std::vector<Technique> techniques;
  if (list == "auto") return techniques;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    const std::string_view word = list.substr(begin, end - begin);
    const auto technique = techniqueNamed(word);
    if (!technique)
      throw UsageError("--techniques: \"" + std::string(word) + "\" is none of auto, " + joined(techniqueNames()));
    if (std::find(techniques.begin(), techniques.end(), *technique) == techniques.end()) techniques.push_back(*technique);
    begin = end + 1;
  }
  std::sort(techniques.begin(), techniques.end());
  return techniques;
}

std::string canonicalJson(const Settings& settings) {
  json techniques = "auto";
  if (!settings.techniques.empty()) {
    techniques = json::array();
    for (const Technique technique : settings.techniques) techniques.push_back(name(technique));
  }
  const json spacing = settings.probe_spacing_m == kAutomaticProbeSpacing ? json("auto") : json(settings.probe_spacing_m);
  const auto& ground_rgb = settings.environment.ground_radiance_rgb;
  const json ground = ground_rgb ? json(*ground_rgb) : json(nullptr);
  return json{{"techniques", techniques},
              {"lightmap_size", settings.lightmap_size},
              {"quality", name(settings.quality)},
              {"refinement", settings.refinement},
              {"seed", settings.seed},
              {"light_units", name(settings.light_units)},
              {"prm_layout", name(settings.prm_layout)},
              {"prm_estimator", name(settings.prm_estimator)},
              {"prm_entries", settings.prm_entries},
              {"prm_clusters", settings.prm_clusters},
              {"radiosity_density", settings.radiosity_density},
              {"moving_lights", name(settings.moving_lights)},
              {"light_paths_m", settings.light_paths_m},
              {"geometry", settings.geometry},
              {"keep_all", settings.keep_all},
              {"directional", settings.directional},
              {"virtual_light", name(settings.virtual_light)},
              {"virtual_lights", settings.virtual_lights},
              {"virtual_bounces", settings.virtual_bounces},
              {"points", settings.points},
              {"probe_spacing_m", spacing},
              {"probe_points_m", settings.probe_points_m},
              {"environment_samples", settings.environment_samples},
              {"sky_face_cells", settings.sky_face_cells},
              {"environment_rotation_deg", settings.environment.rotation_deg},
              {"environment_intensity", settings.environment.intensity},
              {"environment_ground", ground},
              {"portals", settings.portals}}
      .dump();
}

Settings settingsFromJson(std::string_view text) {
  const json document = json::parse(text, nullptr, false);
  if (!document.is_object()) throw UsageError("settings: not a JSON object");
  Settings settings;
  for (const auto& [key, value] : document.items()) {
    if (key == "techniques") {
      std::string list;
      if (value.is_array())
        for (const auto& word : value) {
          if (!list.empty()) list += ',';
          list += word.is_string() ? word.get<std::string>() : word.dump();
        }
      else if (value.is_string())
        list = value.get<std::string>();
      settings.techniques = parseTechniques(list);
    } else if (key == "lightmap_size") {
      if (!value.is_number_integer() || value < 1 || value > kMostLightmapSize)
        throw UsageError("settings: \"lightmap_size\" must be a whole number from 1 to " + std::to_string(kMostLightmapSize));
      settings.lightmap_size = value.get<int>();
    } else if (key == "quality") {
      settings.quality = required(kQualities, key, value);
    } else if (key == "refinement") {
      if (!value.is_number_integer() || value < kCoarsestRefinement || value > kFinestRefinement)
        throw UsageError("settings: \"refinement\" must be a whole number from " + std::to_string(kCoarsestRefinement) + " to " +
                         std::to_string(kFinestRefinement));
      settings.refinement = value.get<int>();
    } else if (key == "seed") {
      if (!value.is_number_unsigned()) throw UsageError("settings: \"seed\" must be a whole number that is not negative");
      settings.seed = value.get<uint64_t>();
    } else if (key == "light_units") {
      settings.light_units = required(kLightUnits, key, value);
    } else if (key == "prm_layout") {
      settings.prm_layout = required(kPrmLayouts, key, value);
    } else if (key == "prm_estimator") {
      settings.prm_estimator = required(kPrmEstimators, key, value);
    } else if (key == "prm_entries") {
      settings.prm_entries = requiredCount(key, value, kMostPrmEntries);
    } else if (key == "prm_clusters") {
      settings.prm_clusters = requiredCount(key, value, kMostPrmClusters);
    } else if (key == "radiosity_density") {
      settings.radiosity_density = requiredNumber(key, value, 0, 1);
    } else if (key == "directional") {
      settings.directional = requiredFlag(key, value);
    } else if (key == "geometry") {
      settings.geometry = requiredFlag(key, value);
    } else if (key == "keep_all") {
      settings.keep_all = requiredFlag(key, value);
    } else if (key == "moving_lights") {
      settings.moving_lights = required(kMovingLights, key, value);
    } else if (key == "light_paths_m") {
      settings.light_paths_m = requiredPaths(key, value);
    } else if (key == "virtual_light") {
      settings.virtual_light = required(kVirtualLightShapes, key, value);
    } else if (key == "virtual_lights") {
      settings.virtual_lights = requiredCount(key, value, kMostVirtualLights);
    } else if (key == "virtual_bounces") {
      settings.virtual_bounces = requiredCount(key, value, kMostVirtualBounces);
    } else if (key == "points") {
      settings.points = requiredCount(key, value, kMostPoints);
    } else if (key == "probe_spacing_m") {
      settings.probe_spacing_m = requiredSpacing(key, value);
    } else if (key == "probe_points_m") {
      settings.probe_points_m = requiredPoints(key, value);
    } else if (key == "environment_samples") {
      settings.environment_samples = requiredCount(key, value, kMostEnvironmentSamples);
    } else if (key == "sky_face_cells") {
      settings.sky_face_cells = requiredCount(key, value, kMostSkyFaceCells);
    } else if (key == "environment_rotation_deg") {
      settings.environment.rotation_deg = requiredNumber(key, value, -360, 360);
    } else if (key == "environment_intensity") {
      settings.environment.intensity = requiredNumber(key, value, 0, kMostEnvironmentIntensity);
    } else if (key == "portals") {
      settings.portals = requiredNames(key, value);
    } else if (key == "environment_ground") {
      settings.environment.ground_radiance_rgb = requiredGround(key, value);
    } else {
      throw UsageError("settings: unknown key \"" + key + "\"");
    }
  }
  return settings;
}

}  // namespace lightwell::plan
