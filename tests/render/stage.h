// A container small enough to know every value: a floor, a plate that floats over it, and a transport of one entry point.
#pragma once
#include <cstdint>
#include <vector>

namespace lightwell::test {

inline constexpr float kFloorHalf = 5, kPlateHalf = 0.5f, kPlateHeight = 1;  // metres; both face up, the plate is double-sided
inline constexpr float kEntry[3] = {3, 0, 0};                               // on the floor
inline constexpr float kTransport = 0.25f;  // every texel's irradiance for unit irradiance at the entry point

/// `origin_m`: where the container says its positions start. `with_transport`: the section "prm". `with_sky`: the section "environment", radiance 1
/// from everywhere.
std::vector<uint8_t> makeStage(bool with_transport, double origin_x_m = 0, bool with_sky = false);

}  // namespace lightwell::test
