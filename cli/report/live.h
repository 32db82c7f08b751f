// Light that a game finds anew in each frame, without a bake of it: the first reflection of lamps (lightwell_dynamic), and a sky's cells with their shadows.
#pragma once
#include "cli/report/laboratory.h"

namespace lightwell::report {

struct LiveBench {
  const bake::BakeContext& context;
  const LaboratoryOptions& options;
  uint32_t samples;  // paths a texel in each of two references
  const CancelFlag& cancel;
};

/// Numbers of virtual lights at shadow maps of kLampShadowSide, and sides of shadow maps at kLampLights.
inline constexpr uint32_t kLampCounts[] = {16, 64, 256, 1024}, kLampShadowSides[] = {0, 8, 16, 64, 128}, kLampLights = 256, kLampShadowSide = 32;
/// Against path tracing that ends after one reflection. Needs lamps and OpenGL. Throws Cancelled.
std::vector<LampAnswer> measureLamps(const LiveBench& bench);

inline constexpr uint32_t kShadowedCells[] = {8, 32, 128, 512};
/// Straight light of the sky on the scene's surfaces against path tracing; models "shadowed, rays" and, with OpenGL, "shadowed, OpenGL". Throws Cancelled.
std::vector<SkyAnswer> measureShadowedSky(const LiveBench& bench);

}  // namespace lightwell::report
