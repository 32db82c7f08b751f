#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

// One element for each probe, or two: the first gives the linear part of the irradiance for each channel (normal, 1) and in layer 3 the factors of xx − yy, the second the factors of
// xy, yz, zz, zx. Both gather all of it: harmonics are windowed together.
const char kProbes[] = R"(
uniform usampler2DArray u_link;       // node << 8 | code, direction
uniform usampler2DArray u_probe;      // first run, end run, first link, bits of the scale
uniform usampler2DArray u_run;        // end link, gate set
uniform sampler2DArray u_gate;        // how much links of a set count
uniform sampler2D u_node;             // radiosity
uniform int u_probes, u_groups;
layout(location = 0) out vec4 o_part0;
layout(location = 1) out vec4 o_part1;
layout(location = 2) out vec4 o_part2;
layout(location = 3) out vec4 o_part3;

vec3 direction(uint bits) {
  vec2 p = max(vec2(float(int(bits << 16u) >> 16), float(int(bits) >> 16)) / 32767.0, vec2(-1.0));
  float z = 1.0 - abs(p.x) - abs(p.y), fold = max(-z, 0.0);
  return normalize(vec3(p.x + (p.x >= 0.0 ? -fold : fold), p.y + (p.y >= 0.0 ? -fold : fold), z));
}

// The irradiance of one channel: mean, factors of x, y, z, of xy, yz, 3zz - 1, zx, of xx - yy.
struct Channel { float mean; vec3 linear; vec4 square; float xx_yy; };
float about(Channel e, vec3 n) {
  return e.mean + dot(e.linear, n) + dot(e.square, vec4(n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.x * n.z)) + e.xx_yy * (n.x * n.x - n.y * n.y);
}
// What the bands after the first are scaled with, so that it is nowhere negative: as on the CPU.
float window(Channel e) {
  vec4 q = abs(e.square);
  float curvature = q.x + q.y + 6.0 * q.z + q.w + 2.0 * abs(e.xx_yy);
  if (length(e.linear) + curvature <= e.mean) return 1.0;
  float least = 1e38;
  vec3 best = vec3(0.0);
  for (int k = 0; k < 27; ++k) {
    if (k == 13) continue;
    vec3 n = normalize(vec3(float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1)));
    float value = about(e, n);
    if (value < least) { least = value; best = n; }
  }
  for (int step = 0; step < 8; ++step) {
    vec3 g = e.linear + vec3(e.square.x * best.y + e.square.w * best.z + 2.0 * e.xx_yy * best.x, e.square.x * best.x + e.square.y * best.z - 2.0 * e.xx_yy * best.y,
                             e.square.y * best.y + 6.0 * e.square.z * best.z + e.square.w * best.x);
    vec3 n = curvature * best - g;
    float length2 = dot(n, n);
    if (!(length2 > 0.0)) break;
    best = n * inversesqrt(length2);
  }
  least = min(least, about(e, best));
  if (least >= 0.0) return 1.0;
  return e.mean > 0.0 ? e.mean / (e.mean - 1.001 * least) : 0.0;
}

void main() {
  int element = lwIndex();
  if (element >= u_probes * u_groups) discard;
  uvec4 row = texelFetch(u_probe, lwAddress(element / u_groups), 0);
  vec3 l0 = vec3(0.0), lx = l0, ly = l0, lz = l0, qxy = l0, qyz = l0, qzz = l0, qzx = l0, qd = l0;
  int l = int(row.z);
  for (int r = int(row.x); r < int(row.y); ++r) {
    uvec2 run = texelFetch(u_run, lwAddress(r), 0).rg;
    float factor = texelFetch(u_gate, lwAddress(int(run.y)), 0).r;
    int end = int(run.x);
    if (factor > 0.0) {
      for (; l < end; ++l) {
        uvec2 link = texelFetch(u_link, lwAddress(l), 0).rg;
        vec3 b = factor * float((16u + (link.r & 15u)) << ((link.r >> 4u) & 15u)) * texelFetch(u_node, lwPixel(int(link.r >> 8u)), 0).rgb;
        vec3 d = direction(link.g);
        l0 += b;
        lx += b * d.x;
        ly += b * d.y;
        lz += b * d.z;
        if (u_groups == 2) {
          qxy += b * (d.x * d.y);
          qyz += b * (d.y * d.z);
          qzz += b * (3.0 * d.z * d.z - 1.0);
          qzx += b * (d.x * d.z);
          qd += b * (d.x * d.x - d.y * d.y);
        }
      }
    }
    l = end;
  }
  // 4 scale turns shares and radiosities into integrals of radiance; squares of the harmonics' constants times pi, 2 pi / 3 and pi / 4 make irradiance of them.
  float scale = 4.0 * uintBitsToFloat(row.w);
  l0 *= scale * 0.25;
  vec3 linear_r = vec3(lx.r, ly.r, lz.r) * (scale * 0.5), linear_g = vec3(lx.g, ly.g, lz.g) * (scale * 0.5), linear_b = vec3(lx.b, ly.b, lz.b) * (scale * 0.5);
  vec4 square_scale = scale * vec4(0.9375, 0.9375, 0.078125, 0.9375);
  vec4 square_r = vec4(qxy.r, qyz.r, qzz.r, qzx.r) * square_scale, square_g = vec4(qxy.g, qyz.g, qzz.g, qzx.g) * square_scale,
       square_b = vec4(qxy.b, qyz.b, qzz.b, qzx.b) * square_scale;
  qd *= scale * 0.234375;
  vec3 w = vec3(window(Channel(l0.r, linear_r, square_r, qd.r)), window(Channel(l0.g, linear_g, square_g, qd.g)), window(Channel(l0.b, linear_b, square_b, qd.b)));
  square_r *= w.r; square_g *= w.g; square_b *= w.b;
  if (u_groups == 2 && element % 2 == 1) {
    o_part0 = square_r * vec4(1.0, 1.0, 3.0, 1.0);
    o_part1 = square_g * vec4(1.0, 1.0, 3.0, 1.0);
    o_part2 = square_b * vec4(1.0, 1.0, 3.0, 1.0);
    o_part3 = vec4(0.0);
  } else {
    o_part0 = vec4(linear_r * w.r, l0.r - square_r.z);
    o_part1 = vec4(linear_g * w.g, l0.g - square_g.z);
    o_part2 = vec4(linear_b * w.b, l0.b - square_b.z);
    o_part3 = vec4(qd * w, 0.0);
  }
}
)";

// Data: which bricks have probes, 64 probes of each of these, offsets of probes from their points, nearness (73 words of four codes a probe).
const char kProbeLight[] = R"(
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
#endif
uniform sampler2DArray lw_probe_light;
uniform usampler2DArray lw_probe_data;
uniform vec4 lw_probe_lattice[4];     // first, spacing; counts, elements of a probe; bricks, first of 64 probes; first offset, first nearness
struct LwProbeLight { vec4 linear_r, linear_g, linear_b, square_r, square_g, square_b; vec3 xx_yy; };

uint lwProbeData(int i) { return texelFetch(lw_probe_data, ivec3(i & 2047, (i >> 11) & 2047, i >> 22), 0).r; }
float lwProbeNearness(int probe, int x, int y) {
  int k = y * 17 + x;
  uint code = (lwProbeData(int(lw_probe_lattice[3].y) + probe * 73 + (k >> 2)) >> uint(8 * (k & 3))) & 255u;
  return code == 0u ? 0.0 : exp2(float(int(code) - 1) / 32.0 - 3.0);
}
float lwProbeSign(float v) { return v >= 0.0 ? 1.0 : -1.0; }
// How far d is, over the way to the first surface in that direction.
float lwProbeHidden(int probe, vec3 d) {
  float size = abs(d.x) + abs(d.y) + abs(d.z);
  if (!(size > 0.0)) return 0.0;
  vec2 p = d.xy / size;
  if (d.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(lwProbeSign(p.x), lwProbeSign(p.y));
  bool falling = (p.x >= 0.0) == (p.y >= 0.0);
  vec2 at = (p + 1.0) * 8.0;
  int i = min(int(at.x), 15), j = min(int(at.y), 15);
  vec2 f = at - vec2(float(i), float(j));
  float value;
  if (falling) {
    float one = lwProbeNearness(probe, i + 1, j), other = lwProbeNearness(probe, i, j + 1);
    value = f.x + f.y <= 1.0 ? lwProbeNearness(probe, i, j) * (1.0 - f.x - f.y) + one * f.x + other * f.y
                             : lwProbeNearness(probe, i + 1, j + 1) * (f.x + f.y - 1.0) + one * (1.0 - f.y) + other * (1.0 - f.x);
  } else {
    float low = lwProbeNearness(probe, i, j), high = lwProbeNearness(probe, i + 1, j + 1);
    value = f.x >= f.y ? low * (1.0 - f.x) + lwProbeNearness(probe, i + 1, j) * (f.x - f.y) + high * f.y
                       : low * (1.0 - f.y) + lwProbeNearness(probe, i, j + 1) * (f.y - f.x) + high * f.x;
  }
  return value * size / lw_probe_lattice[0].w;
}
// What arrives at a position, from the probes around that see it.
LwProbeLight lwProbeLight(vec3 position_m) {
  LwProbeLight light = LwProbeLight(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec3(0.0));
  vec3 count = lw_probe_lattice[1].xyz;
  if (count.x < 1.0) return light;
  vec3 t = clamp((position_m - lw_probe_lattice[0].xyz) / lw_probe_lattice[0].w, vec3(0.0), count - 1.0);
  vec3 low = min(floor(t), max(count - 2.0, vec3(0.0)));
  vec3 f = t - low;
  int probe[8];
  float weight[8], hidden[8], least = 1e30;
  for (int corner = 0; corner < 8; ++corner) {
    vec3 bit = vec3(float(corner & 1), float((corner >> 1) & 1), float(corner >> 2));
    ivec3 at = ivec3(low + bit), brick = at / 4, inside = at - brick * 4;
    probe[corner] = -1;
    if (any(greaterThanEqual(at, ivec3(count)))) continue;
    uint block = lwProbeData(brick.x + int(lw_probe_lattice[2].x) * (brick.y + int(lw_probe_lattice[2].y) * brick.z));
    if (block == 0xffffffffu) continue;
    uint found = lwProbeData(int(lw_probe_lattice[2].w) + int(block) + inside.x + 4 * (inside.y + 4 * inside.z));
    if (found == 0xffffffffu) continue;
    probe[corner] = int(found);
    uint offset = lwProbeData(int(lw_probe_lattice[3].x) + int(found));
    vec3 moved = vec3(float(offset & 255u), float((offset >> 8u) & 255u), float((offset >> 16u) & 255u)) - 128.0;
    vec3 place = lw_probe_lattice[0].xyz + lw_probe_lattice[0].w * (vec3(at) + moved / 254.0);
    vec3 w = mix(1.0 - f, f, bit);
    weight[corner] = w.x * w.y * w.z + 1e-4;
    hidden[corner] = lwProbeHidden(int(found), position_m - place);
    least = min(least, hidden[corner]);
  }
  float limit = max(1.0, 1.01 * least), sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    if (probe[corner] < 0) continue;
    weight[corner] *= clamp((limit - hidden[corner]) / (0.2 * limit), 0.0, 1.0);
    sum += weight[corner];
  }
  int groups = int(lw_probe_lattice[1].w);
  for (int corner = 0; corner < 8; ++corner) {
    if (probe[corner] < 0 || !(weight[corner] > 0.0)) continue;
    float w = weight[corner] / sum;
    int e = probe[corner] * groups;
    ivec2 at = ivec2(e & 2047, e >> 11);
    light.linear_r += w * texelFetch(lw_probe_light, ivec3(at, 0), 0);
    light.linear_g += w * texelFetch(lw_probe_light, ivec3(at, 1), 0);
    light.linear_b += w * texelFetch(lw_probe_light, ivec3(at, 2), 0);
    if (groups < 2) continue;
    light.xx_yy += w * texelFetch(lw_probe_light, ivec3(at, 3), 0).rgb;
    at.x += 1;  // elements of a probe share a row
    light.square_r += w * texelFetch(lw_probe_light, ivec3(at, 0), 0);
    light.square_g += w * texelFetch(lw_probe_light, ivec3(at, 1), 0);
    light.square_b += w * texelFetch(lw_probe_light, ivec3(at, 2), 0);
  }
  return light;
}
vec3 lwProbeIrradiance(LwProbeLight light, vec3 n) {
  vec4 l = vec4(n, 1.0), q = vec4(n.x * n.y, n.y * n.z, n.z * n.z, n.z * n.x);
  vec3 e = vec3(dot(light.linear_r, l) + dot(light.square_r, q), dot(light.linear_g, l) + dot(light.square_g, q), dot(light.linear_b, l) + dot(light.square_b, q));
  return max(e + light.xx_yy * (n.x * n.x - n.y * n.y), vec3(0.0));
}
vec3 lwProbesIrradiance(vec3 position_m, vec3 normal) { return lwProbeIrradiance(lwProbeLight(position_m), normal); }
)";

}  // namespace lightwell::runtime::gl::glsl
