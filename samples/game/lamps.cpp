#include "samples/game/lamps.h"

#include <algorithm>
#include <utility>

namespace lightwell::game {
namespace {

using render::Float3;

// Linear: warm white, white, cool white, red, green, blue, violet.
constexpr Float3 kColors[] = {{1, 0.78f, 0.55f}, {1, 1, 1},         {0.7f, 0.85f, 1}, {1, 0.1f, 0.06f},
                              {0.12f, 1, 0.2f},  {0.1f, 0.25f, 1}, {0.7f, 0.15f, 1}};

float brightness(const lw_light& light) {
  return std::max({light.intensity_rgb[0], light.intensity_rgb[1], light.intensity_rgb[2]});
}

void setColor(lw_light& light, const Float3& color, float intensity) {
  for (size_t i = 0; i < 3; ++i) light.intensity_rgb[i] = color[i] * intensity;
}

Float3 extent(const lw_scene_info& scene) {
  Float3 size;
  for (size_t i = 0; i < 3; ++i) size[i] = scene.bounds_max_m[i] - scene.bounds_min_m[i];
  return size;
}

Float3 middle(const lw_scene_info& scene) {
  return Float3{scene.bounds_min_m[0], scene.bounds_min_m[1], scene.bounds_min_m[2]} + extent(scene) * 0.5f;
}

}  // namespace

Lamps::Lamps(std::vector<lw_light> lights, const lw_scene_info& scene) : scene_(scene) {
  for (const lw_light& light : lights) lamps_.push_back({light});
  if (lamps_.empty()) add(middle(scene));
  // A lamp that can be carried is more fun to start with than the sun.
  const auto movable = std::find_if(lamps_.begin(), lamps_.end(), [](const Lamp& lamp) { return lamp.light.type != LW_LIGHT_DIRECTIONAL; });
  selected_ = movable != lamps_.end() ? size_t(movable - lamps_.begin()) : 0;
}

void Lamps::selectNext() { selected_ = (selected_ + 1) % lamps_.size(); }

void Lamps::add(const Float3& position_m) {
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  light.direction[1] = -1;
  light.outer_cone_angle_rad = 0.785f;
  // As bright as the others, or so that the far side of the scene gets about one lux.
  const float size = render::length(extent(scene_));
  setColor(light, kColors[0], lamps_.empty() ? size * size / 4 : brightness(lamps_[selected_].light));
  std::copy(position_m.begin(), position_m.end(), light.position_m);
  lamps_.push_back({light});
  selected_ = lamps_.size() - 1;
  changed_ = true;
}

void Lamps::removeSelected() {
  if (lamps_.size() == 1) return;
  lamps_.erase(lamps_.begin() + long(selected_));
  selected_ = std::min(selected_, lamps_.size() - 1);
  changed_ = true;
}

void Lamps::toggleSelected() {
  current().on = !current().on;
  changed_ = true;
}

void Lamps::scaleIntensity(float factor) {
  for (float& value : current().light.intensity_rgb) value *= factor;
  changed_ = true;
}

void Lamps::cycleColor() {
  current().color = (current().color + 1) % std::size(kColors);
  setColor(current().light, kColors[current().color], brightness(current().light));
  changed_ = true;
}

void Lamps::moveSelected(const Float3& offset_m) {
  lw_light& light = current().light;
  if (light.type == LW_LIGHT_DIRECTIONAL) {
    const float size = render::length(extent(scene_));
    const Float3 turned = Float3{light.direction[0], light.direction[1], light.direction[2]} + offset_m * (2 / size);
    if (render::length(turned) < 0.1f) return;
    const Float3 unit = render::normalized(turned);
    std::copy(unit.begin(), unit.end(), light.direction);
  } else {
    for (size_t i = 0; i < 3; ++i)
      light.position_m[i] = std::clamp(light.position_m[i] + offset_m[i], scene_.bounds_min_m[i], scene_.bounds_max_m[i]);
  }
  changed_ = true;
}

void Lamps::carryTo(const Float3& position_m) {
  const float* from = current().light.position_m;
  moveSelected(position_m - Float3{from[0], from[1], from[2]});
}

void Lamps::followPath(float phase) {
  const float angle = 6.2831853f * phase;
  const Float3 size = extent(scene_);
  const Float3 offset{0.3f * size[0] * std::sin(angle), -0.1f * size[1] * std::cos(2 * angle), 0.3f * size[2] * std::cos(angle)};
  carryTo(middle(scene_) + offset);
}

bool Lamps::takeChanged() { return std::exchange(changed_, false); }

std::vector<lw_light> Lamps::lit() const {
  std::vector<lw_light> lights;
  for (const Lamp& lamp : lamps_)
    if (lamp.on) lights.push_back(lamp.light);
  return lights;
}

}  // namespace lightwell::game
