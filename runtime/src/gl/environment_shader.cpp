#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

// The block mirrors EnvironmentBlock of environment_gl.h. A cell is three vec4: direction and spread; flux and solid angle; covariance
// (xx, xy, yy) on the tangents of lwBasis(direction).
//
// The sky's picture holds mean radiances under normalised Phong lobes, one level for each of a geometric series of shininesses, six faces
// (layers) with nodes at equal angles, corners included: neighbouring faces share their edge's nodes, so a linear filter has no seams.
//
// 1 − cos is formed from the distance of unit vectors and goes through lwLog1p and lwExpm1, so that nothing cancels for sharp lobes and
// small cells.
const char kEnvironment[] = R"(
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp sampler2D;
#endif
#ifndef LW_ENVIRONMENT_CELLS
#define LW_ENVIRONMENT_CELLS 256
#endif
layout(std140) uniform LwEnvironment {
  ivec4 lw_count;          // cells, suns among them, levels of the sky
  ivec4 lw_way;            // technique, taps of the filter
  ivec4 lw_maps[2];        // of suns and of other cells: number in a row, texels of a side, first row of texels
  vec4 lw_scale;           // of all radiance; texels of margin around a map's picture
  vec4 lw_center;          // of the casters' bounds; radiance of a sky texel of 1
  vec4 lw_extent;          // half the bounds' sides; least half side of a map
  vec4 lw_size;            // 1 / size of the depth atlas (xy), 1 / size of a layer of the sky (zw)
  vec4 lw_harmonic[9];     // irradiance of everything, suns included
  vec4 lw_level[16];       // place of the first node (xy), nodes - 1; the last one's w: logarithm of its shininess
  vec4 lw_ggx[38];         // weights of the lobes for roughness 0.075, 0.1 ... 1
  vec4 lw_cell[3 * LW_ENVIRONMENT_CELLS];
};
uniform sampler2DArray lw_sky;
uniform sampler2D lw_depth;

struct LwCell { vec3 direction, flux, covariance; float spread, solid_angle; };
LwCell lwCell(int i) {
  vec4 a = lw_cell[3 * i], b = lw_cell[3 * i + 1];
  return LwCell(a.xyz, b.rgb, lw_cell[3 * i + 2].xyz, a.w, b.a);
}

void lwBasis(vec3 n, out vec3 tangent, out vec3 bitangent) {
  float side = floatBitsToInt(n.z) < 0 ? -1.0 : 1.0, a = -1.0 / (side + n.z), b = n.x * n.y * a;
  tangent = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
  bitangent = vec3(b, side + n.y * n.y * a, -n.y);
}

float lwLog1p(float x) {
  if (abs(x) > 0.25) return log(1.0 + x);
  float s = x / (2.0 + x), q = s * s;
  return 2.0 * s * (1.0 + q * (1.0 / 3.0 + q * (0.2 + q * (1.0 / 7.0 + q / 9.0))));
}
float lwExpm1(float x) {
  if (abs(x) > 0.35) return exp(x) - 1.0;
  return x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0 + x / 720.0)))));
}
float lwOneMinusCosine(vec3 a, vec3 b) { return 0.5 * dot(a - b, a - b); }
float lwCosinePower(float one_minus_cosine, float n) {
  return one_minus_cosine < 1.0 ? exp(n * lwLog1p(-one_minus_cosine)) : 0.0;
}
// The normal distribution's integral up to z (Abramowitz and Stegun, 7.1.26).
float lwNormalIntegral(float z) {
  float x = abs(z) * 0.70710678, t = 1.0 / (1.0 + 0.3275911 * x);
  float upper = 0.5 * t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * exp(-x * x);
  return z < 0.0 ? upper : 1.0 - upper;
}

// ---- The unoccluded sky, without its suns

vec3 lwSkyLevel(int level, vec3 d) {
  vec3 size = abs(d);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  vec3 turned = axis == 0 ? d : axis == 1 ? d.yzx : d.zxy;
  vec2 angle = atan(turned.yz / abs(turned.x));
  vec2 node = lw_level[level].xy + 0.5 + clamp(angle * 0.63661977 + 0.5, 0.0, 1.0) * lw_level[level].z;
  return textureLod(lw_sky, vec3(node * lw_size.zw, float(2 * axis + (turned.x < 0.0 ? 1 : 0))), 0.0).rgb * lw_center.w;
}

// Mean radiance under the lobe (n + 1) / 2pi cos^n: cubic in log n between four levels.
vec3 lwSkyMean(vec3 axis, float n) {
  int last = lw_count.z - 1;
  float at = clamp(log(n) / lw_level[last].w, 0.0, 1.0) * float(last);
  int first = clamp(int(at) - 1, 0, max(last - 3, 0));
  float t = at - float(first);
  vec4 weight = vec4(-(t - 1.0) * (t - 2.0) * (t - 3.0), 3.0 * t * (t - 2.0) * (t - 3.0), -3.0 * t * (t - 1.0) * (t - 3.0),
                     t * (t - 1.0) * (t - 2.0)) / 6.0;
  return max(weight.x * lwSkyLevel(first, axis) + weight.y * lwSkyLevel(first + 1, axis) + weight.z * lwSkyLevel(first + 2, axis) +
             weight.w * lwSkyLevel(first + 3, axis), vec3(0.0));
}

// ---- The average of a lobe over a cell's light

// Barsi, Szirmay-Kalos, Szecsi, "Image-Based Illumination on the GPU", section 2.3.
float lwPaperAverage(LwCell cell, vec3 mirror, float n) {
  float to_center = lwOneMinusCosine(cell.direction, mirror), to_rim = max(cell.solid_angle * 0.15915494, 1e-30);
  float single = lwCosinePower(to_center, n);
  if (to_center >= to_rim) return single;
  float missed = to_rim < 1.0 ? -lwExpm1((n + 1.0) * lwLog1p(-to_rim)) : 1.0;
  return mix(min(1.0, missed / ((n + 1.0) * to_rim)), single, to_center / to_rim);
}

// The power as a Gaussian with the cell's covariance, folded with the lobe. `offset`: of the mirror direction in the tangent plane.
float lwSpreadAverage(vec3 covariance, vec2 offset, float cosine, float n) {
  float k = (n - 1.0) / (cosine * cosine);
  float a = 1.0 + k * covariance.x, b = k * covariance.y, d = 1.0 + k * covariance.z;
  float form = max(0.0, (d * offset.x * offset.x - 2.0 * b * offset.x * offset.y + a * offset.y * offset.y) / max(1.0, a * d - b * b));
  float widening =
      max(1.0, (1.0 + n * covariance.x) * (1.0 + n * covariance.z) - n * n * covariance.y * covariance.y);
  return exp(-0.5 * n * lwLog1p(form)) * inversesqrt(widening);
}

// Sum of weight * average of cos^shininess over four lobes; weight 0: not computed.
float lwAverageLobes(LwCell cell, vec3 tangent, vec3 bitangent, vec3 mirror, vec4 shininess, vec4 weight) {
  float sum = 0.0;
  if (lw_way.x == 2) {
    for (int l = 0; l < 4; ++l)
      if (weight[l] > 0.0) sum += weight[l] * lwPaperAverage(cell, mirror, shininess[l]);
    return sum;
  }
  float cosine = dot(cell.direction, mirror);
  if (cosine <= 1e-4) return 0.0;
  vec3 difference = mirror - cell.direction;  // no cancellation: the tangents are orthogonal to the direction
  vec2 offset = vec2(dot(difference, tangent), dot(difference, bitangent)) / cosine;
  for (int l = 0; l < 4; ++l)
    if (weight[l] > 0.0) sum += weight[l] * lwSpreadAverage(cell.covariance, offset, cosine, shininess[l]);
  return sum;
}

float lwAverageCosine(LwCell cell, vec3 tangent, vec3 bitangent, vec3 normal) {
  float cosine = dot(cell.direction, normal);
  if (lw_way.x == 2) return max(0.0, cosine);
  vec2 slope = vec2(dot(normal, tangent), dot(normal, bitangent));
  float mean = (1.0 - cell.spread) * cosine;
  float variance = dot(cell.covariance, vec3(slope.x * slope.x, 2.0 * slope.x * slope.y, slope.y * slope.y));
  if (!(variance > 1e-12)) return max(0.0, mean);
  float deviation = sqrt(variance), z = mean / deviation;
  return max(0.0, mean * lwNormalIntegral(z) + deviation * 0.39894228 * exp(-0.5 * z * z));
}

// ---- Shadows

// What the depth map of a cell lets through to a point; `facing`: unit normal of the surface as it is, on the side that is lit. Each texel
// is compared with the depth of the surface's own plane there, so that it neither shadows itself nor has to be moved off.
float lwCellVisibility(int i, vec3 direction, vec3 tangent, vec3 bitangent, vec3 position, vec3 facing) {
  ivec4 maps = lw_maps[i < lw_count.y ? 0 : 1];
  int place = i < lw_count.y ? i : i - lw_count.y;
  float side = float(maps.y), inner = side - 2.0 * lw_scale.a;
  vec3 half_side = max(vec3(dot(abs(tangent), lw_extent.xyz), dot(abs(bitangent), lw_extent.xyz), dot(abs(direction), lw_extent.xyz)),
                       vec3(lw_extent.w));
  vec3 offset = position - lw_center.xyz;
  vec3 at = vec3(dot(offset, tangent), dot(offset, bitangent), -dot(offset, direction)) / half_side;
  float steep = 1.0 / (max(dot(facing, direction), 0.02) * half_side.z * inner);
  vec2 slope = vec2(dot(facing, tangent) * half_side.x, dot(facing, bitangent) * half_side.y) * steep;  // depth for a texel
  float bias = 0.04 * (abs(slope.x) + abs(slope.y)) + 0.01 * max(half_side.x, half_side.y) / (half_side.z * inner) + 2e-5;  // rounding alone
  vec2 texel = (at.xy * inner + side) * 0.5 - 0.5;
  ivec2 corner = ivec2(place % maps.x * maps.y, place / maps.x * maps.y + maps.z);
  float depth = at.z * 0.5 + 0.5 - bias, lit = 0.0;
  for (int tap = 0; tap < lw_way.y; ++tap) {
    vec2 moved = texel + (lw_way.y == 1 ? vec2(0.0) : vec2(ivec2(tap & 1, tap >> 1)) - 0.5);
    vec2 first = clamp(floor(moved), vec2(0.0), vec2(side - 2.0)), part = clamp(moved - first, 0.0, 1.0);
    ivec2 here = corner + ivec2(first);
    vec4 stored = vec4(texelFetch(lw_depth, here, 0).r, texelFetch(lw_depth, here + ivec2(1, 0), 0).r,
                       texelFetch(lw_depth, here + ivec2(0, 1), 0).r, texelFetch(lw_depth, here + ivec2(1, 1), 0).r);
    vec4 free = step(depth + dot(slope, first - texel) + vec4(0.0, slope.x, slope.y, slope.x + slope.y), stored);
    vec2 row = mix(free.xz, free.yw, part.x);
    lit += mix(row.x, row.y, part.y);
  }
  return lw_way.y == 1 ? lit : 0.25 * lit;
}

vec3 lwVisibleShare(vec3 hidden, vec3 all) { return clamp(1.0 - hidden / max(all, vec3(1e-30)), 0.0, 1.0); }

// ---- Without shadow

// Irradiance from nine spherical harmonics, suns included: for what is small or far away. May be a little off opposite a strong light.
vec3 lwEnvironmentHarmonicIrradiance(vec3 n) {
  vec3 sum = lw_harmonic[0].rgb + lw_harmonic[1].rgb * n.y + lw_harmonic[2].rgb * n.z + lw_harmonic[3].rgb * n.x;
  sum += lw_harmonic[4].rgb * (n.x * n.y) + lw_harmonic[5].rgb * (n.y * n.z) + lw_harmonic[6].rgb * (3.0 * n.z * n.z - 1.0);
  sum += lw_harmonic[7].rgb * (n.x * n.z) + lw_harmonic[8].rgb * (n.x * n.x - n.y * n.y);
  return max(sum, vec3(0.0)) * lw_scale.rgb;
}

// Irradiance about a unit normal.
vec3 lwEnvironmentIrradiance(vec3 normal) {
  vec3 sum = 3.14159265 * lwSkyLevel(0, normal), tangent, bitangent;
  for (int i = 0; i < lw_count.y; ++i) {
    LwCell sun = lwCell(i);
    lwBasis(sun.direction, tangent, bitangent);
    sum += sun.flux * lwAverageCosine(sun, tangent, bitangent, normal);
  }
  return sum * lw_scale.rgb;
}

vec3 lwEnvironmentLobes(vec3 mirror, vec4 shininess, vec4 weight) {
  vec3 sum = vec3(0.0), tangent, bitangent;
  for (int l = 0; l < 4; ++l)
    if (weight[l] > 0.0) sum += lwSkyMean(mirror, shininess[l]) * (weight[l] * 6.2831853 / (shininess[l] + 1.0));
  for (int i = 0; i < lw_count.y; ++i) {
    LwCell sun = lwCell(i);
    lwBasis(sun.direction, tangent, bitangent);
    sum += sun.flux * lwAverageLobes(sun, tangent, bitangent, mirror, shininess, weight);
  }
  return sum * lw_scale.rgb;
}
// Integral of radiance times max(0, cos)^shininess about a unit mirror direction; shininess 1 to 1e5.
vec3 lwEnvironmentLobe(vec3 mirror, float shininess) {
  return lwEnvironmentLobes(mirror, vec4(shininess, vec3(1.0)), vec4(1.0, vec3(0.0)));
}

// The GGX filter of a perceptual roughness as four Phong lobes.
void lwGgxLobes(float roughness, out vec4 shininess, out vec4 weight) {
  float r = clamp(roughness, 0.075, 1.0), alpha2 = r * r * r * r, at = (r - 0.075) * 40.0;
  int i = min(int(at), 36);
  shininess = 1.0 + vec4(0.08, 0.4, 1.5, 5.0) * ((1.0 - alpha2) / (2.0 * alpha2));
  weight = mix(lw_ggx[i], lw_ggx[i + 1], at - float(i)) * (shininess + 1.0) * 0.15915494;
}
// Mean radiance under the GGX filter about a unit mirror direction; roughness 0 to 1.
vec3 lwEnvironmentGgx(vec3 mirror, float roughness) {
  vec4 shininess, weight;
  lwGgxLobes(roughness, shininess, weight);
  return lwEnvironmentLobes(mirror, shininess, weight);
}

// Radiance from a unit direction, as sharp as the sky's picture; suns are discs.
vec3 lwEnvironmentRadiance(vec3 direction) {
  vec3 sum = lwSkyLevel(lw_count.z - 1, direction);
  for (int i = 0; i < lw_count.y; ++i) {
    LwCell sun = lwCell(i);
    float area = max(sun.solid_angle, 1e-12), edge = distance(sun.direction, direction) * inversesqrt(area * 0.31830989);
    sum += sun.flux / area * clamp((1.0 - edge) / max(fwidth(edge), 1e-4) + 0.5, 0.0, 1.0);
  }
  return sum * lw_scale.rgb;
}

// ---- With shadow

struct LwEnvironmentLight { vec3 irradiance, lobe; };

LwEnvironmentLight lwEnvironmentShadowed(vec3 position, vec3 facing, vec3 normal, vec3 mirror, vec4 shininess, vec4 weight) {
  bool glossy = any(greaterThan(weight, vec4(0.0))), by_share = lw_way.x == 0;
  vec3 irradiance = vec3(0.0), lobe = vec3(0.0), all_irradiance = vec3(0.0), all_lobe = vec3(0.0);
  vec3 hidden_irradiance = vec3(0.0), hidden_lobe = vec3(0.0), tangent, bitangent;
  for (int i = 0; ; ++i) {
    // Cells whose centre is below the surface are hidden by it and need no depth map. About a normal such a cell says nothing of its light
    // above: that is hidden as much as the rest is.
    for (; i < lw_count.x && dot(facing, lw_cell[3 * i].xyz) <= 0.0; ++i)
      if (glossy && by_share && i >= lw_count.y) {
        LwCell below = lwCell(i);
        lwBasis(below.direction, tangent, bitangent);
        vec3 light = below.flux * lwAverageLobes(below, tangent, bitangent, mirror, shininess, weight);
        all_lobe += light;
        hidden_lobe += light;
      }
    if (i >= lw_count.x) break;
    LwCell cell = lwCell(i);
    lwBasis(cell.direction, tangent, bitangent);
    float cosine = lwAverageCosine(cell, tangent, bitangent, normal);
    float average = glossy ? lwAverageLobes(cell, tangent, bitangent, mirror, shininess, weight) : 0.0;
    if (cosine + average <= 0.0) continue;
    float visible = lwCellVisibility(i, cell.direction, tangent, bitangent, position, facing);
    if (!by_share || i < lw_count.y) {
      irradiance += cell.flux * (cosine * visible);
      lobe += cell.flux * (average * visible);
      continue;
    }
    all_irradiance += cell.flux * cosine;
    hidden_irradiance += cell.flux * (cosine * (1.0 - visible));
    all_lobe += cell.flux * average;
    hidden_lobe += cell.flux * (average * (1.0 - visible));
  }
  if (by_share) {
    irradiance += 3.14159265 * lwSkyLevel(0, normal) * lwVisibleShare(hidden_irradiance, all_irradiance);
    vec3 sky = vec3(0.0);
    for (int l = 0; l < 4; ++l)
      if (weight[l] > 0.0) sky += lwSkyMean(mirror, shininess[l]) * (weight[l] * 6.2831853 / (shininess[l] + 1.0));
    lobe += sky * lwVisibleShare(hidden_lobe, all_lobe);
  }
  return LwEnvironmentLight(irradiance * lw_scale.rgb, lobe * lw_scale.rgb);
}
LwEnvironmentLight lwEnvironmentUnshadowed(vec3 normal, vec3 mirror, vec4 shininess, vec4 weight) {
  return LwEnvironmentLight(lwEnvironmentIrradiance(normal), lwEnvironmentLobes(mirror, shininess, weight));
}

// Irradiance about `normal`, and the integral of radiance times cos^shininess about `mirror`, as far as the depth maps let light through to
// `position`.
LwEnvironmentLight lwEnvironmentPhong(vec3 position, vec3 facing, vec3 normal, vec3 mirror, float shininess) {
  vec4 n = vec4(shininess, vec3(1.0)), weight = vec4(1.0, vec3(0.0));
  if (lw_way.x == 3) return lwEnvironmentUnshadowed(normal, mirror, n, weight);
  return lwEnvironmentShadowed(position, facing, normal, mirror, n, weight);
}
// The same with the mean radiance under the GGX filter for `lobe`.
LwEnvironmentLight lwEnvironmentRough(vec3 position, vec3 facing, vec3 normal, vec3 mirror, float roughness) {
  vec4 n, weight;
  lwGgxLobes(roughness, n, weight);
  if (lw_way.x == 3) return lwEnvironmentUnshadowed(normal, mirror, n, weight);
  return lwEnvironmentShadowed(position, facing, normal, mirror, n, weight);
}
vec3 lwEnvironmentDiffuse(vec3 position, vec3 facing, vec3 normal) {
  if (lw_way.x == 3) return lwEnvironmentIrradiance(normal);
  return lwEnvironmentShadowed(position, facing, normal, normal, vec4(1.0), vec4(0.0)).irradiance;
}
)";

}  // namespace lightwell::runtime::gl::glsl
