#include "samples/game/player.h"

#include <algorithm>

namespace lightwell::game {
namespace {

constexpr float kEyeHeight = 1.7f, kLargestPitch = 1.5f;

}  // namespace

Player::Player(const lw_scene_info& scene) : scene_(scene) {
  const bool along_z = scene.bounds_max_m[2] - scene.bounds_min_m[2] >= scene.bounds_max_m[0] - scene.bounds_min_m[0];
  const size_t axis = along_z ? 2 : 0;
  for (size_t i = 0; i < 3; ++i) eye_m_[i] = (scene.bounds_min_m[i] + scene.bounds_max_m[i]) / 2;
  const float height = scene.bounds_max_m[1] - scene.bounds_min_m[1];
  eye_m_[1] = scene.bounds_min_m[1] + std::min(kEyeHeight, height / 2);
  eye_m_[axis] += 0.42f * (scene.bounds_max_m[axis] - scene.bounds_min_m[axis]);
  yaw_rad_ = along_z ? 0 : 1.5707963f;
  // A walk across any scene takes about ten seconds, but a person does not run through a room.
  speed_m_per_s_ = std::max(2.5f, (scene.bounds_max_m[axis] - scene.bounds_min_m[axis]) / 10);
  if (height < 1) speed_m_per_s_ = height;
}

render::Float3 Player::forward() const {
  return {-std::sin(yaw_rad_) * std::cos(pitch_rad_), std::sin(pitch_rad_), -std::cos(yaw_rad_) * std::cos(pitch_rad_)};
}

void Player::move(const Steering& steering, float seconds) {
  using namespace render;
  yaw_rad_ = std::remainder(yaw_rad_ - steering.turn_rad, 6.2831853f);
  pitch_rad_ = std::clamp(pitch_rad_ + steering.tilt_rad, -kLargestPitch, kLargestPitch);
  const Float3 ahead{-std::sin(yaw_rad_), 0, -std::cos(yaw_rad_)}, right{std::cos(yaw_rad_), 0, -std::sin(yaw_rad_)};
  const float step = speed_m_per_s_ * (steering.fast ? 3.0f : 1.0f) * seconds;
  eye_m_ = eye_m_ + (ahead * steering.forward + right * steering.right + Float3{0, steering.up, 0}) * step;
  for (size_t i = 0; i < 3; ++i) {
    const float margin = 0.02f * (scene_.bounds_max_m[i] - scene_.bounds_min_m[i]);
    eye_m_[i] = std::clamp(eye_m_[i], scene_.bounds_min_m[i] + margin, scene_.bounds_max_m[i] - margin);
  }
}

void Player::placeAt(const render::View& view) {
  for (size_t i = 0; i < 3; ++i) eye_m_[i] = float(view.eye_m[i] - scene_.origin_m[i]);
  yaw_rad_ = std::atan2(-view.forward[0], -view.forward[2]);
  pitch_rad_ = std::clamp(std::asin(std::clamp(view.forward[1], -1.0f, 1.0f)), -kLargestPitch, kLargestPitch);
}

void Player::applyTo(render::View& view) const {
  for (size_t i = 0; i < 3; ++i) view.eye_m[i] = scene_.origin_m[i] + double(eye_m_[i]);
  view.forward = forward();
  view.up = {0, 1, 0};
}

}  // namespace lightwell::game
