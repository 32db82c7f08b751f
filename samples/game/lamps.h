// The lamps of the game: which is selected, carried, lit; and the path that the scripted run takes.
#pragma once
#include <vector>

#include "lightwell/lightwell.h"
#include "render/vector_math.h"

namespace lightwell::game {

class Lamps {
 public:
  /// Starts with the scene's own lights; with one in the middle when it has none.
  Lamps(std::vector<lw_light> lights, const lw_scene_info& scene);

  void selectNext();
  void add(const render::Float3& position_m);
  void removeSelected();
  void toggleSelected();
  void scaleIntensity(float factor);
  void cycleColor();
  /// Moves the selected lamp; a directional light turns instead.
  void moveSelected(const render::Float3& offset_m);
  /// Carries the selected lamp `distance_m` before the eye while held.
  void carryTo(const render::Float3& position_m);
  /// Scripted: the selected lamp goes once around the scene's middle while `phase` goes from 0 to 1.
  void followPath(float phase);

  /// True once after each change.
  bool takeChanged();
  std::vector<lw_light> lit() const;
  size_t selected() const { return selected_; }
  size_t count() const { return lamps_.size(); }
  const lw_light& selectedLight() const { return lamps_[selected_].light; }

 private:
  struct Lamp {
    lw_light light;
    bool on = true;
    size_t color = 0;
  };
  Lamp& current() { return lamps_[selected_]; }
  lw_scene_info scene_;
  std::vector<Lamp> lamps_;
  size_t selected_ = 0;
  bool changed_ = true;
};

}  // namespace lightwell::game
