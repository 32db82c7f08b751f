// Between probes: trilinear, without those that do not see the position.
#include <algorithm>
#include <cmath>

#include "runtime/src/container.h"
#include "runtime/src/probes.h"

namespace lightwell::runtime {
namespace {

constexpr float kFade = 0.2f;     // of the distance to a wall, on its near side, over which a probe comes into view
constexpr float kUnseen = 1.01f;  // where no probe sees a position (in a wall), those that come within so much of the one that comes nearest to it
constexpr float kFaint = 1e-4f;   // weight of corners at the far end of the cell, should they be the only ones in view

float decodeNearness(uint32_t code) { return code ? std::exp2(float(code - 1) * (1.0f / 32) - 3) : 0.0f; }

float sign(float v) { return v >= 0 ? 1.0f : -1.0f; }

/// How far it is to a position at `d` from a probe, over the way to the first surface in that direction: beyond 1 it is hidden. Interpolated over the triangles of the octahedral grid, with
/// distances |x| + |y| + |z|, which is exact for planes.
float hiddenness(const uint8_t* nearness, const float* d, float spacing) {
  const float length = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
  if (!(length > 0)) return 0;
  float u = d[0] / length, v = d[1] / length;
  if (d[2] < 0) {
    const float folded = (1 - std::abs(v)) * sign(u);
    v = (1 - std::abs(u)) * sign(v);
    u = folded;
  }
  const bool falling = (u >= 0) == (v >= 0);  // which way the octahedron's edges run here
  const float x = (u + 1) * (kNearnessCells / 2.0f), y = (v + 1) * (kNearnessCells / 2.0f);
  const uint32_t i = std::min(uint32_t(x), kNearnessCells - 1), j = std::min(uint32_t(y), kNearnessCells - 1);
  const float f = x - float(i), g = y - float(j);
  const uint8_t* node = nearness + j * (kNearnessCells + 1) + i;
  const auto at = [&](uint32_t a, uint32_t b) { return decodeNearness(node[b * (kNearnessCells + 1) + a]); };
  float value;
  if (falling) value = f + g <= 1 ? at(0, 0) * (1 - f - g) + at(1, 0) * f + at(0, 1) * g : at(1, 1) * (f + g - 1) + at(1, 0) * (1 - g) + at(0, 1) * (1 - f);
  else value = f >= g ? at(0, 0) * (1 - f) + at(1, 0) * (f - g) + at(1, 1) * g : at(0, 0) * (1 - g) + at(0, 1) * (g - f) + at(1, 1) * f;
  return value * length / spacing;
}

}  // namespace

ProbeCorners probeCorners(const lw_probes& p, const float* position_m) {
  ProbeCorners corners;
  const auto& h = p.header;
  if (h.lattice_count[0] == 0) return corners;
  uint32_t low[3];
  float f[3];
  for (int k = 0; k < 3; ++k) {
    const float last = float(h.lattice_count[k] - 1), t = std::clamp((position_m[k] - h.lattice_first_m[k]) / h.lattice_spacing_m, 0.0f, last);
    low[k] = std::min(uint32_t(t), uint32_t(h.lattice_count[k] >= 2 ? h.lattice_count[k] - 2 : 0));
    f[k] = t - float(low[k]);
  }
  float hidden[kProbeCorners], least = INFINITY;
  for (uint32_t corner = 0; corner < kProbeCorners; ++corner) {
    uint32_t at[3];
    float weight = 1;
    bool inside = true;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t bit = corner >> k & 1;
      at[k] = low[k] + bit;
      weight *= bit ? f[k] : 1 - f[k];
      inside &= at[k] < h.lattice_count[k];
    }
    if (!inside) continue;
    const uint32_t brick = p.brick[at[0] / 4 + size_t(p.brick_count[0]) * (at[1] / 4 + size_t(p.brick_count[1]) * (at[2] / 4))];
    if (brick == kNone) continue;
    const uint32_t probe = p.brick_probe[brick + (at[0] % 4 + 4 * (at[1] % 4 + 4 * (at[2] % 4)))];
    if (probe == kNone) continue;
    float d[3];
    for (size_t k = 0; k < 3; ++k) d[k] = position_m[k] - p.position_m[size_t(probe) * 3 + k];
    hidden[corners.count] = hiddenness(&p.nearness[size_t(probe) * kNearnessNodes], d, h.lattice_spacing_m);
    least = std::min(least, hidden[corners.count]);
    corners.probe[corners.count] = probe;
    corners.weight[corners.count++] = weight + kFaint;
  }
  const float limit = std::max(1.0f, kUnseen * least);
  float sum = 0;
  for (uint32_t i = 0; i < corners.count; ++i) sum += corners.weight[i] *= std::clamp((limit - hidden[i]) / (kFade * limit), 0.0f, 1.0f);
  for (uint32_t i = 0; i < corners.count; ++i) corners.weight[i] = sum > 0 ? corners.weight[i] / sum : 0.0f;
  return corners;
}

}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_probes_find(const lw_probes* probes, const float position_m[3], lw_probes_around* around) {
  if (!probes || !position_m || !around) return LW_INVALID_ARGUMENT;
  if (!allFinite(position_m, 3)) return probes->host.fail(LW_INVALID_ARGUMENT, "the position is not finite");
  const ProbeCorners corners = probeCorners(*probes, position_m);
  *around = {};
  for (uint32_t i = 0; i < corners.count; ++i)
    if (corners.weight[i] > 0) {
      around->probe[around->count] = corners.probe[i];
      around->weight[around->count++] = corners.weight[i];
    }
  return LW_OK;
}

lw_result lw_probes_sample(const lw_probes* probes, const float* probe_radiance_sh, const float position_m[3], float radiance_sh[9][3]) {
  lw_probes_around around;
  if (!probe_radiance_sh || !radiance_sh) return LW_INVALID_ARGUMENT;
  if (const lw_result result = lw_probes_find(probes, position_m, &around)) return result;
  for (int k = 0; k < 9; ++k)
    for (int c = 0; c < 3; ++c) {
      radiance_sh[k][c] = 0;
      for (uint32_t i = 0; i < around.count; ++i) radiance_sh[k][c] += around.weight[i] * probe_radiance_sh[(size_t(around.probe[i]) * 9 + size_t(k)) * 3 + size_t(c)];
    }
  return LW_OK;
}
