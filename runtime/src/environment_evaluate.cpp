// What arrives from an environment. The formulas and their errors: docs/environment.md.
#include <algorithm>
#include <cmath>

#include "runtime/src/environment.h"
#include "runtime/src/ggx_weights.h"
#include "runtime/src/light.h"

namespace lightwell::runtime {
namespace {

constexpr float kLeastShininess = 1, kMostShininess = 1e5f;

/// A direction in a cell's own frame: cosine to the cell's direction, and tangential parts.
struct Local {
  float cosine, x, y;
};
Local localOf(const lw_environment& e, uint32_t cell, const float* v) {
  const float *d = &e.direction[cell * 3], *t = &e.tangent[cell * 3];
  const float b[3] = {d[1] * t[2] - d[2] * t[1], d[2] * t[0] - d[0] * t[2], d[0] * t[1] - d[1] * t[0]};
  Local local{d[0] * v[0] + d[1] * v[1] + d[2] * v[2], 0, 0};
  for (int k = 0; k < 3; ++k) {  // of the difference: no cancellation where v is close to d
    const float offset = v[k] - d[k];
    local.x += offset * t[k];
    local.y += offset * b[k];
  }
  return local;
}

/// Mean of max(0, cos)^n over a cell's light, n > 1: the power as a Gaussian with the cell's covariance, folded with the lobe.
float averageCosinePower(const Local& local, const float* covariance, float n) {
  if (local.cosine <= 1e-4f) return 0;
  const float x = local.x / local.cosine, y = local.y / local.cosine, k = (n - 1) / (local.cosine * local.cosine);
  const float a = 1 + k * covariance[0], b = k * covariance[1], d = 1 + k * covariance[2];
  const float form = std::max(0.0f, (d * x * x - 2 * b * x * y + a * y * y) / std::max(1.0f, a * d - b * b));
  const float widening = std::max(1.0f, (1 + n * covariance[0]) * (1 + n * covariance[2]) - n * n * covariance[1] * covariance[1]);
  return std::exp(-0.5f * n * std::log1p(form)) / std::sqrt(widening);
}

/// The same for n = 1; across the horizon the light is a Gaussian in height.
float averageCosine(const Local& local, float spread, const float* covariance) {
  const float mean = (1 - spread) * local.cosine;
  const float variance = covariance[0] * local.x * local.x + 2 * covariance[1] * local.x * local.y + covariance[2] * local.y * local.y;
  if (!(variance > 1e-12f)) return std::max(0.0f, mean);
  const float deviation = std::sqrt(variance), z = mean / deviation;
  return std::max(0.0f, 0.5f * mean * std::erfc(-z * 0.70710678f) + deviation * 0.39894228f * std::exp(-0.5f * z * z));
}

bool normalized(const float* given, float* unit) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += double(given[k]) * given[k];
  if (!(square > 0) || !std::isfinite(square)) return false;
  const double length = std::sqrt(square);
  for (int k = 0; k < 3; ++k) unit[k] = float(given[k] / length);
  return true;
}

/// Null, or what is wrong.
const char* visibilityFault(const lw_environment& e, const float* visibility) {
  for (uint32_t i = 0; visibility && i < e.header.cells; ++i)
    if (!(visibility[i] >= 0 && visibility[i] <= 1)) return "a visibility is not between 0 and 1";
  return nullptr;
}

/// Adds weight · ∫ L max(0, cos)^n dω.
void addLobe(const lw_environment& e, const float* axis, float n, const float* visibility, double weight, double* sum_rgb) {
  double sky_rgb[3] = {}, suns_rgb[3] = {}, all_rgb[3] = {}, hidden_rgb[3] = {};
  e.sky.addIntegral(axis, n, sky_rgb);
  for (uint32_t i = 0; i < (visibility ? e.header.cells : e.header.suns); ++i) {
    const Local local = localOf(e, i, axis);
    const bool is_sun = i < e.header.suns;
    // About a normal: a cell whose centre is below the horizon says nothing about its light above it.
    if (!is_sun && n == 1 && local.cosine <= 0) continue;
    const float visible = visibility ? visibility[i] : 1.0f;
    const float average = n == 1 ? averageCosine(local, e.spread[i], &e.covariance[i * 3]) : averageCosinePower(local, &e.covariance[i * 3], n);
    for (uint32_t c = 0; c < 3; ++c) {
      const double light = double(e.flux_rgb[i * 3 + c]) * average;
      if (is_sun) suns_rgb[c] += light * visible;
      else all_rgb[c] += light, hidden_rgb[c] += light * (1 - visible);
    }
  }
  for (int c = 0; c < 3; ++c) {
    const double share = all_rgb[c] > 0 ? std::clamp(1 - hidden_rgb[c] / all_rgb[c], 0.0, 1.0) : 1.0;
    sum_rgb[c] += weight * (std::max(0.0, sky_rgb[c]) * share + suns_rgb[c]);
  }
}

lw_result answer(const double* sum_rgb, float* out_rgb) {
  for (int c = 0; c < 3; ++c) out_rgb[c] = float(std::min(sum_rgb[c], double(kMaxIrradiance)));
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_environment_irradiance(const lw_environment* environment, const float normal[3], const float* visibility,
                                    float irradiance_rgb[3]) {
  return lw_environment_phong(environment, normal, 1, visibility, irradiance_rgb);
}

lw_result lw_environment_phong(const lw_environment* environment, const float mirror[3], float shininess, const float* visibility,
                               float integral_rgb[3]) {
  if (!environment || !mirror || !integral_rgb) return LW_INVALID_ARGUMENT;
  float axis[3];
  if (!normalized(mirror, axis)) return environment->host.fail(LW_INVALID_ARGUMENT, "the direction is zero or not finite");
  if (!(shininess >= kLeastShininess && shininess <= kMostShininess))
    return environment->host.fail(LW_INVALID_ARGUMENT, "the shininess is not between 1 and 100000");
  if (const char* fault = visibilityFault(*environment, visibility)) return environment->host.fail(LW_INVALID_ARGUMENT, "%s", fault);
  double sum_rgb[3] = {};
  addLobe(*environment, axis, shininess, visibility, 1, sum_rgb);
  return answer(sum_rgb, integral_rgb);
}

lw_result lw_environment_ggx(const lw_environment* environment, const float mirror[3], float roughness, const float* visibility,
                             float radiance_rgb[3]) {
  if (!environment || !mirror || !radiance_rgb) return LW_INVALID_ARGUMENT;
  float axis[3];
  if (!normalized(mirror, axis)) return environment->host.fail(LW_INVALID_ARGUMENT, "the direction is zero or not finite");
  if (const char* fault = visibilityFault(*environment, visibility)) return environment->host.fail(LW_INVALID_ARGUMENT, "%s", fault);
  lw_phong_lobe lobes[4];
  if (lw_ggx_lobes(roughness, lobes)) return environment->host.fail(LW_INVALID_ARGUMENT, "the roughness is not between 0 and 1");
  double sum_rgb[3] = {};
  for (const lw_phong_lobe& lobe : lobes)
    if (lobe.weight > 0)
      addLobe(*environment, axis, lobe.shininess, visibility, lobe.weight * (double(lobe.shininess) + 1) * 0.15915494309189535, sum_rgb);
  return answer(sum_rgb, radiance_rgb);
}

lw_result lw_ggx_lobes(float roughness, lw_phong_lobe lobes[4]) {
  if (!lobes || !(roughness >= 0 && roughness <= 1)) return LW_INVALID_ARGUMENT;
  const float r = std::max(roughness, kGgxLeastRoughness), position = (r - kGgxLeastRoughness) / kGgxStep;
  const int row = std::clamp(int(position), 0, kGgxRows - 2);
  const float t = std::min(position - float(row), 1.0f), alpha2 = r * r * r * r;
  for (int i = 0; i < 4; ++i)
    lobes[i] = {kGgxWeight[row][i] * (1 - t) + kGgxWeight[row + 1][i] * t, 1 + kGgxMixture[i] * (1 - alpha2) / (2 * alpha2)};
  return LW_OK;
}

lw_result lw_sh_irradiance(const float radiance_sh[9][3], const float normal[3], float irradiance_rgb[3]) {
  float d[3];
  if (!radiance_sh || !normal || !irradiance_rgb || !normalized(normal, d)) return LW_INVALID_ARGUMENT;
  constexpr float pi = 3.14159265f;
  const float basis[9] = {0.28209479f * pi,
                          0.48860251f * 2 * pi / 3 * d[1],
                          0.48860251f * 2 * pi / 3 * d[2],
                          0.48860251f * 2 * pi / 3 * d[0],
                          1.09254843f * pi / 4 * d[0] * d[1],
                          1.09254843f * pi / 4 * d[1] * d[2],
                          0.31539157f * pi / 4 * (3 * d[2] * d[2] - 1),
                          1.09254843f * pi / 4 * d[0] * d[2],
                          0.54627422f * pi / 4 * (d[0] * d[0] - d[1] * d[1])};
  for (int c = 0; c < 3; ++c) {
    float sum = 0;
    for (int i = 0; i < 9; ++i) sum += radiance_sh[i][c] * basis[i];
    irradiance_rgb[c] = std::max(0.0f, sum);
  }
  return LW_OK;
}
