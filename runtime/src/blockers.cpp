#include "runtime/src/blockers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/radiosity.h"
#include "runtime/src/frame.h"

namespace lightwell::runtime {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kNear = 4;  // sides of a patch: blockers that are nearer than that (beyond their radius) are looked at from four points of it

/// Light that a patch keeps, as a mean over its area, taken for a square.
void keptByPatch(const lw_radiosity& r, size_t patch, const lw_blocker* blockers, uint32_t count, float* kept_rgb) {
  const float *position = &r.patch_position_m[patch * 3], *n = &r.patch_normal[patch * 3];
  const float side = std::sqrt(r.patch_area_m2[patch]);
  bool near = false;
  for (uint32_t i = 0; i < count && !near; ++i) {
    float square = 0;
    for (int k = 0; k < 3; ++k) square += (blockers[i].position_m[k] - position[k]) * (blockers[i].position_m[k] - position[k]);
    near = std::sqrt(square) < blockers[i].radius_m + kNear * side;
  }
  if (!near) return keptLight(blockers, count, position, n, kept_rgb);
  float tangent[3], bitangent[3];
  frameAbout(n, tangent, bitangent);
  float sum[3] = {};
  for (int corner = 0; corner < 4; ++corner) {
    const float u = corner & 1 ? 0.25f : -0.25f, v = corner & 2 ? 0.25f : -0.25f;
    float point[3], kept[3];
    for (int k = 0; k < 3; ++k) point[k] = position[k] + side * (u * tangent[k] + v * bitangent[k]);
    keptLight(blockers, count, point, n, kept);
    for (int k = 0; k < 3; ++k) sum[k] += 0.25f * kept[k];
  }
  std::memcpy(kept_rgb, sum, sizeof sum);
}

}  // namespace

/// Form factor of a sphere as an element of surface sees it, clipped by its horizon: Hamilton, Morgan, "Radiant-Interchange Configuration Factors" (NACA TN 2836, 1952);
/// in this form Snyder, "Area Light Sources for Real-Time Graphics" (1996).
float blockedShare(const lw_blocker& blocker, const float* position_m, const float* normal) {
  float square = 0, cosine = 0;
  for (int k = 0; k < 3; ++k) {
    const float d = blocker.position_m[k] - position_m[k];
    square += d * d, cosine += d * normal[k];
  }
  const float radius2 = blocker.radius_m * blocker.radius_m;
  if (square <= radius2) return blocker.radius_m > 0 ? 1.0f : 0.0f;
  cosine = std::clamp(cosine / std::sqrt(square), -1.0f, 1.0f);
  const float h2 = square / radius2, clipped = 1 - h2 * cosine * cosine;
  if (!(h2 < 1e12f)) return 0;
  if (clipped <= 0) return cosine > 0 ? cosine / h2 : 0.0f;
  const float beyond = h2 - 1, angle = std::acos(std::clamp(-cosine * std::sqrt(beyond / (1 - cosine * cosine)), -1.0f, 1.0f));
  const float share = ((cosine * angle - std::sqrt(clipped * beyond)) / h2 + std::atan2(std::sqrt(clipped), std::sqrt(beyond))) / kPi;
  return std::clamp(share, 0.0f, 1.0f);
}

void keptLight(const lw_blocker* blockers, uint32_t count, const float* position_m, const float* normal, float* kept_rgb) {
  float free = 1, shares = 0, reflected[3] = {};
  for (uint32_t i = 0; i < count; ++i) {
    const float share = blockedShare(blockers[i], position_m, normal);
    free *= 1 - share;
    shares += share;
    for (int k = 0; k < 3; ++k) reflected[k] += share * blockers[i].albedo_rgb[k];
  }
  for (int k = 0; k < 3; ++k) kept_rgb[k] = free + (shares > 0 ? (1 - free) * reflected[k] / shares : 0.0f);
}

const char* checkBlocker(const lw_blocker& blocker) {
  if (!allFinite(blocker.position_m, 3)) return "its position is not finite";
  if (!(blocker.radius_m >= 0 && blocker.radius_m <= 1e12f)) return "its radius is negative, too large or not finite";
  for (const float albedo : blocker.albedo_rgb)
    if (!(albedo >= 0 && albedo <= 1)) return "its albedo is not between 0 and 1";
  return nullptr;
}

}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_blockers_kept(const lw_blocker* blockers, uint32_t count, const float position_m[3], const float normal[3], float kept_rgb[3]) {
  if ((!blockers && count > 0) || !position_m || !normal || !kept_rgb || !allFinite(position_m, 3) || !allFinite(normal, 3)) return LW_INVALID_ARGUMENT;
  for (uint32_t i = 0; i < count; ++i)
    if (checkBlocker(blockers[i])) return LW_INVALID_ARGUMENT;
  keptLight(blockers, count, position_m, normal, kept_rgb);
  return LW_OK;
}

lw_result lw_radiosity_set_blockers(lw_radiosity_state* state, const lw_blocker* blockers, uint32_t count) {
  if (!state || (!blockers && count > 0)) return LW_INVALID_ARGUMENT;
  for (uint32_t i = 0; i < count; ++i)
    if (const char* wrong = checkBlocker(blockers[i])) return state->host.fail(LW_INVALID_ARGUMENT, "blocker %u: %s", i, wrong);
  for (size_t patch = 0; patch < state->kept.size(); ++patch) keptByPatch(*state->radiosity, patch, blockers, count, state->kept[patch].v);
  return LW_OK;
}
