// The walker: where the camera stands and looks.
#pragma once
#include "lightwell/lightwell.h"
#include "render/view.h"

namespace lightwell::game {

/// What the player asks for in one frame; each in [-1, 1].
struct Steering {
  float forward = 0, right = 0, up = 0;
  float turn_rad = 0, tilt_rad = 0;  // of the mouse since the last frame
  bool fast = false;
};

class Player {
 public:
  /// Stands at one end of the scene, at eye height, looking along its longer side.
  explicit Player(const lw_scene_info& scene);

  /// Walks for `seconds`, within the scene's bounds.
  void move(const Steering& steering, float seconds);
  /// Stands and looks as a view does.
  void placeAt(const render::View& view);
  /// Writes eye, forward and up.
  void applyTo(render::View& view) const;
  render::Float3 forward() const;
  /// Relative to the container's origin.
  render::Float3 eye_m() const { return eye_m_; }

 private:
  lw_scene_info scene_;
  render::Float3 eye_m_{};
  float yaw_rad_ = 0, pitch_rad_ = 0;  // yaw 0 looks along −z; positive turns left
  float speed_m_per_s_ = 2.5f;
};

}  // namespace lightwell::game
