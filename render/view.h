// From where, how and what of the light is drawn.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "render/vector_math.h"

namespace lightwell::render {

/// Which part of the light reaches the picture. `direct`: lights and emitters, straight; `indirect`: after at least one reflection.
enum class LightPart : uint8_t { direct, indirect, full };

struct View {
  std::array<double, 3> eye_m{0, 0, 0};  // glTF world coordinates
  Float3 forward{0, 0, -1};              // unit
  Float3 up{0, 1, 0};                    // not parallel to `forward`
  float vertical_fov_rad = 1.0f;         // (0, π)
  int width = 1280, height = 720;        // pixels
  /// Exposure value at ISO 100: radiance 1.2 · 2^EV reaches the sensor's saturation (Lagarde, de Rousiers: "Moving Frostbite to
  /// Physically Based Rendering", section 5.1). Empty: metered from the picture.
  std::optional<float> exposure_ev;
  LightPart part = LightPart::full;
  bool lighting_only = false;            // every surface with albedo 0.5 instead of its own
  bool show_lamps = false;               // a small glow where each point or spot light is
  Float3 background_radiance_rgb{0, 0, 0};
};

}  // namespace lightwell::render
