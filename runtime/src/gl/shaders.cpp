#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

const char kVersionDesktop[] = "#version 330 core\n";
const char kVersionEmbedded[] = R"(#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp sampler2DShadow;
precision highp samplerCubeShadow;
precision highp isampler2DArray;
precision highp usampler2D;
precision highp usampler2DArray;
)";

const char kAddress[] = R"(
ivec3 lwAddress(int i) { return ivec3(i & 2047, (i >> 11) & 2047, i >> 22); }
ivec2 lwPixel(int i) { return ivec2(i & 2047, i >> 11); }
#define lwIndex() (int(gl_FragCoord.y) * 2048 + int(gl_FragCoord.x))
)";

const char kVertex[] = R"(
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

const char kLight[] = R"(
#ifdef GL_ES
precision highp float;
#endif
struct LwLight { vec4 position_range, direction_type, intensity, spot; };
vec3 lwLightIrradiance(LwLight light, vec3 position, vec3 normal) {
  vec3 to_light = -light.direction_type.xyz;
  float attenuation = 1.0;
  if (light.direction_type.w < 2.5) {
    to_light = light.position_range.xyz - position;
    float square = dot(to_light, to_light);
    if (!(square > 1e-36)) return vec3(0.0);
    to_light /= sqrt(square);
    attenuation = 1.0 / square;
    if (light.position_range.w > 0.0) {
      float fourth = square / (light.position_range.w * light.position_range.w);
      attenuation *= clamp(1.0 - fourth * fourth, 0.0, 1.0);
    }
  }
  if (light.direction_type.w > 1.5 && light.direction_type.w < 2.5) {
    float edge = clamp(-dot(to_light, light.direction_type.xyz) * light.spot.x + light.spot.y, 0.0, 1.0);
    attenuation *= edge * edge;
  }
  attenuation *= max(dot(to_light, normal), 0.0);
  return min(light.intensity.rgb * attenuation, vec3(1e30));
}
)";

const char kAtlas[] = R"(
#ifdef GL_ES
precision highp float;
precision highp sampler2D;
#endif
vec3 lwAtlasIrradiance(sampler2D atlas, vec2 lightmap_uv) {
  vec4 value = texture(atlas, lightmap_uv);
  return value.a > 0.0 ? value.rgb / value.a : vec3(0.0);
}
vec3 lwDiffuseRadiance(vec3 albedo, vec3 irradiance) { return albedo * irradiance * 0.31830988618; }
)";

// The amounts of the ranks 4 q to 4 q + 3 of a block lie at index block * lw_quads + q, those of red in layer 0, green in 1, blue in 2; layer 3 has 1 in its red at q = 0 where they are those
// of the last reconstruction. The map holds, per atlas texel, the address of its basis (four ranks in each RGBA), and its block (22 bits), its own number of fours (7), and in the
// highest bit whether it shows another's.
const char kLocalBases[] = R"(
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2DArray;
#endif
uniform usampler2D lw_texel_map;
uniform sampler2DArray lw_basis;
uniform sampler2DArray lw_amount;
uniform int lw_quads;
vec4 lwLocalBasesEntry(uvec2 entry) {
  if (entry.r == 0xffffffffu) return vec4(0.0);
  int address = int(entry.r), pixel = int(entry.g & 0x3fffffu) * lw_quads, quads = int((entry.g >> 22) & 0x7fu);
  vec3 sum = vec3(0.0);
  for (int q = 0; q < quads; ++q) {
    int basis_at = address + q, amount_at = pixel + q;
    ivec2 at = ivec2(amount_at & 2047, amount_at >> 11);
    vec4 b = texelFetch(lw_basis, ivec3(basis_at & 2047, (basis_at >> 11) & 2047, basis_at >> 22), 0);
    sum += vec3(dot(b, texelFetch(lw_amount, ivec3(at, 0), 0)), dot(b, texelFetch(lw_amount, ivec3(at, 1), 0)), dot(b, texelFetch(lw_amount, ivec3(at, 2), 0)));
  }
  return vec4(max(sum, vec3(0.0)), 1.0);
}
vec4 lwLocalBasesTexel(ivec2 texel) { return lwLocalBasesEntry(texelFetch(lw_texel_map, texel, 0).rg); }
vec3 lwLocalBasesIrradiance(vec2 lightmap_uv) {
  ivec2 size = textureSize(lw_texel_map, 0), last = size - ivec2(1);
  vec2 position = lightmap_uv * vec2(size) - vec2(0.5);
  ivec2 corner = ivec2(floor(position));
  vec2 f = position - vec2(corner);
  ivec2 low = clamp(corner, ivec2(0), last), high = clamp(corner + ivec2(1), ivec2(0), last);
  vec4 value = mix(mix(lwLocalBasesTexel(low), lwLocalBasesTexel(ivec2(high.x, low.y)), f.x),
                   mix(lwLocalBasesTexel(ivec2(low.x, high.y)), lwLocalBasesTexel(high), f.x), f.y);
  return value.a > 0.0 ? value.rgb / value.a : vec3(0.0);
}
)";

// LW_SHADOW: the lights' kind of shadow, as LW_GL_SHADOW_… has them; code of other kinds is not there.
const char kEntries[] = R"(
uniform sampler2DArray u_position;
uniform sampler2DArray u_normal;      // w: the longer half side of the entry's rectangle; 0: a point
uniform sampler2DArray u_rectangle;   // half of one side, and how many times as long the other is
uniform sampler2D u_previous;
uniform int u_entries, u_light_count, u_accumulate, u_reversed;
uniform vec4 u_light[64];  // 16 LwLights
uniform vec4 u_shadow_numbers;  // near, far, depth bias, normal offset
out vec4 o_irradiance;

#if LW_SHADOW == 1
uniform sampler2DShadow u_shadow_2d;
uniform mat4 u_shadow_matrix;
float shadow(int i, vec3 p) {
  vec4 clip = u_shadow_matrix * vec4(p, 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec3 at = clip.xyz / clip.w;
  at.xy = at.xy * 0.5 + 0.5;
  if (u_reversed == 0) at.z = at.z * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  at.z += u_reversed == 0 ? -u_shadow_numbers.z : u_shadow_numbers.z;
  return textureLod(u_shadow_2d, at, 0.0);
}
#elif LW_SHADOW == 2
uniform samplerCubeShadow u_shadow_cube;
float shadow(int i, vec3 p) {
  vec3 offset = p - u_light[0].xyz;
  float z = max(max(abs(offset.x), abs(offset.y)), abs(offset.z));
  float near = u_shadow_numbers.x, far = u_shadow_numbers.y;
  if (z >= far) return 1.0;
  float depth = far / (far - near) * (1.0 - near / max(z, near));
  depth = u_reversed == 0 ? depth - u_shadow_numbers.z : 1.0 - depth + u_shadow_numbers.z;
  return textureGrad(u_shadow_cube, vec4(offset, depth), vec3(0.0), vec3(0.0));  // neighbours may not be here
}
#elif LW_SHADOW == 3
uniform sampler2DArray u_visibility;
float shadow(int i, vec3 p) { return texelFetch(u_visibility, lwAddress(i), 0).r; }
#endif

// Half the solid angle of a triangle is the argument of this complex number.
vec2 solidAngle(vec3 a, vec3 b, vec3 c, float la, float lb, float lc) {
  return vec2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb, abs(dot(a, cross(b, c))));
}

// rectangleGain() of the CPU.
float rectangleGain(int i, vec3 to_light, vec3 n, float half_side) {
  float square = dot(to_light, to_light), height = dot(to_light, n);
  if (!(square < 1225.0 * half_side * half_side) || !(height > 0.0)) return 1.0;
  vec4 rectangle = texelFetch(u_rectangle, lwAddress(i), 0);
  // In units that keep sixth powers of lengths in range.
  float per_length = 1.0 / max(sqrt(square), half_side), square_there = square * per_length * per_length;
  vec3 away = to_light * per_length, u = rectangle.xyz * per_length, v = cross(n, u) * rectangle.w;
  vec3 c0 = -u - v - away, c1 = u - v - away, c2 = u + v - away, c3 = v - u - away;
  float l0 = length(c0), l2 = length(c2);
  vec2 one = solidAngle(c0, c1, c2, l0, length(c1), l2), other = solidAngle(c0, c2, c3, l0, l2, length(c3));
  float angle = 2.0 * atan(one.x * other.y + one.y * other.x, one.x * other.x - one.y * other.y);
  return angle * square_there * sqrt(square_there) / (4.0 * dot(u, u) * rectangle.w * (height * per_length));
}

vec3 irradianceOf(int l, int i, vec3 position, vec3 normal, float half_side) {
  LwLight light = LwLight(u_light[l * 4], u_light[l * 4 + 1], u_light[l * 4 + 2], u_light[l * 4 + 3]);
  vec3 irradiance = lwLightIrradiance(light, position, normal);
  if (irradiance == vec3(0.0)) return irradiance;
#if LW_SHADOW != 0
  irradiance *= shadow(i, position + normal * u_shadow_numbers.w);
  if (irradiance == vec3(0.0)) return irradiance;
#endif
  if (light.direction_type.w < 2.5) irradiance *= rectangleGain(i, light.position_range.xyz - position, normal, half_side);
  return min(irradiance, vec3(1e30));
}

void main() {
  int i = lwIndex();
  if (i >= u_entries) discard;
  vec3 position = texelFetch(u_position, lwAddress(i), 0).xyz;
  vec4 normal_side = texelFetch(u_normal, lwAddress(i), 0);
  vec3 normal = normal_side.xyz;
  vec3 sum = vec3(0.0);
#if LW_SHADOW == 0
  for (int l = 0; l < u_light_count; ++l) sum += irradianceOf(l, i, position, normal, normal_side.w);
#else
  sum = irradianceOf(0, i, position, normal, normal_side.w);  // one light at a time; software finds a constant place in u_light much faster
#endif
  if (u_accumulate != 0) sum += texelFetch(u_previous, lwPixel(i), 0).rgb;
  o_irradiance = vec4(sum, 1.0);
}
)";

const char kClusters[] = R"(
uniform usampler2DArray u_range;      // first entry, entries
uniform sampler2DArray u_position;    // weight in w
uniform sampler2D u_entry;
uniform sampler2DArray u_pane_sum;
uniform int u_clusters;
out vec4 o_cluster;                   // mean irradiance; contribution to the atlas
void main() {
  int c = lwIndex();
  if (c >= u_clusters) discard;
  uvec2 range = texelFetch(u_range, lwAddress(c), 0).rg;
  vec3 sum = vec3(0.0);
  for (int e = int(range.x), end = int(range.x + range.y); e < end; ++e)
    sum += texelFetch(u_position, lwAddress(e), 0).w * texelFetch(u_entry, lwPixel(e), 0).rgb;
  o_cluster = vec4(sum, dot(vec3(0.2126, 0.7152, 0.0722), sum * texelFetch(u_pane_sum, lwAddress(c), 0).rgb));
}
)";

// Place in the order of contributions, by counting the greater ones.
const char kRank[] = R"(
uniform sampler2D u_cluster;
uniform int u_clusters;
out uint o_rank;
void main() {
  int c = lwIndex();
  if (c >= u_clusters) discard;
  float mine = texelFetch(u_cluster, lwPixel(c), 0).a;
  uint rank = 0u;
  for (int j = 0; j < u_clusters; ++j) {
    float other = texelFetch(u_cluster, lwPixel(j), 0).a;
    if (other > mine || (other == mine && j < c)) ++rank;
  }
  o_rank = rank;
}
)";

// Pixel k < K: irradiance and number of the cluster in place k. Pixel K: the scale that keeps the energy of all.
const char kSelect[] = R"(
uniform sampler2D u_cluster;
uniform usampler2D u_rank;
uniform sampler2DArray u_pane_sum;
uniform int u_clusters, u_brightest, u_keep_energy;
out vec4 o_selected;
void main() {
  int k = lwIndex();
  if (k > u_brightest) discard;
  if (k < u_brightest) {
    for (int c = 0; c < u_clusters; ++c) {
      if (int(texelFetch(u_rank, lwPixel(c), 0).r) == k) {
        o_selected = vec4(texelFetch(u_cluster, lwPixel(c), 0).rgb, float(c));
        return;
      }
    }
    o_selected = vec4(0.0);
    return;
  }
  vec3 all = vec3(0.0), kept = vec3(0.0);
  for (int c = 0; c < u_clusters; ++c) {
    vec3 energy = texelFetch(u_cluster, lwPixel(c), 0).rgb * texelFetch(u_pane_sum, lwAddress(c), 0).rgb;
    all += energy;
    if (int(texelFetch(u_rank, lwPixel(c), 0).r) < u_brightest) kept += energy;
  }
  vec3 scale = vec3(1.0);
  if (u_keep_energy != 0) {
    if (kept.r > 0.0) scale.r = all.r / kept.r;
    if (kept.g > 0.0) scale.g = all.g / kept.g;
    if (kept.b > 0.0) scale.b = all.b / kept.b;
  }
  o_selected = vec4(scale, 0.0);
}
)";

// The values of buried texels, which show another's, are in a list of their own, in the order of the atlas: it costs no memory where
// nothing is buried, and no time unless they are asked for. Two elements for each: texel, map entry; RGB9E5 of emitters and sky.
const char kOwnValue[] = R"(
uniform sampler2DArray u_constant;    // of each texel: emitters' direct, indirect; the sky's; u_constants in all
uniform usampler2DArray u_buried;
uniform int u_constants;
uniform vec4 u_sky;                   // factor on the sky's
uniform int u_emitters, u_fill, u_buried_count;
// What the texel is to show, given its entry in the map. `place`: in the list of buried texels, or -1.
uvec2 lwEntry(usampler2D map, ivec2 texel, out int place) {
  uvec2 shown = texelFetch(map, texel, 0).rg;
  place = -1;
  if (u_fill != 0 || (shown.g & 0x80000000u) == 0u) return shown;
  uint wanted = uint(texel.y * textureSize(map, 0).x + texel.x);
  int low = 0, high = u_buried_count;
  while (low < high) {
    int middle = (low + high) / 2;
    if (texelFetch(u_buried, lwAddress(middle * 2), 0).r < wanted) low = middle + 1;
    else high = middle;
  }
  if (low == u_buried_count) return uvec2(0xffffffffu, 0u);
  uvec4 own = texelFetch(u_buried, lwAddress(low * 2), 0);
  if (own.r != wanted) return uvec2(0xffffffffu, 0u);
  place = low;
  return own.gb;
}
vec3 lwUnpackRgb9e5(uint bits) {
  return vec3((uvec3(bits) >> uvec3(0u, 9u, 18u)) & uvec3(511u)) * uintBitsToFloat(((bits >> 27u) + 103u) << 23u);  // 2^(exponent - 24)
}
vec3 lwConstant(int texel, int place) {
  vec3 sum = vec3(0.0);
  if (u_emitters == 0) return sum;
  uvec4 own = place < 0 ? uvec4(0u) : texelFetch(u_buried, lwAddress(place * 2 + 1), 0);
  int sky = texel * u_constants + u_constants - 2;
  if ((u_emitters & 1) != 0) sum += place < 0 ? texelFetch(u_constant, lwAddress(texel * u_constants), 0).rgb : lwUnpackRgb9e5(own.r);
  if ((u_emitters & 2) != 0) sum += place < 0 ? texelFetch(u_constant, lwAddress(texel * u_constants + 1), 0).rgb : lwUnpackRgb9e5(own.g);
  if ((u_emitters & 4) != 0) sum += u_sky.rgb * (place < 0 ? texelFetch(u_constant, lwAddress(sky), 0).rgb : lwUnpackRgb9e5(own.b));
  if ((u_emitters & 8) != 0) sum += u_sky.rgb * (place < 0 ? texelFetch(u_constant, lwAddress(sky + 1), 0).rgb : lwUnpackRgb9e5(own.a));
  return sum;
}
)";

const char kPanes[] = R"(
uniform usampler2D u_texel_map;       // index of the value that an atlas texel shows
uniform sampler2D u_weight;           // all clusters, or the selected ones
uniform sampler2DArray u_pane;
uniform int u_weights, u_selected, u_texels;
uniform float u_max;
out vec4 o_irradiance;
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int place;
  uint value = lwEntry(u_texel_map, texel, place).r;
  o_irradiance = vec4(0.0);
  if (value == 0xffffffffu) return;
  vec3 sum = vec3(0.0);
  for (int w = 0; w < u_weights; ++w) {
    vec4 weight = texelFetch(u_weight, lwPixel(w), 0);
    if (weight.r + weight.g + weight.b == 0.0) continue;
    int cluster = u_selected != 0 ? int(weight.a) : w;
    sum += weight.rgb * texelFetch(u_pane, lwAddress(cluster * u_texels + int(value)), 0).rgb;
  }
  if (u_selected != 0) sum *= texelFetch(u_weight, lwPixel(u_weights), 0).rgb;
  sum = max(sum, vec3(0.0)) + lwConstant(texel.y * textureSize(u_texel_map, 0).x + texel.x, place);
  o_irradiance = vec4(min(sum, vec3(u_max)), 1.0);
}
)";

const char kReconstruct[] = R"(
uniform float u_max;
uniform int u_keep;                   // 1: texels of blocks that have not changed keep what they show
out vec4 o_irradiance;
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int place;
  uvec2 entry = lwEntry(lw_texel_map, texel, place);
  if (u_keep != 0) {
    int pixel = int(entry.g & 0x3fffffu) * lw_quads;
    if (entry.r == 0xffffffffu || texelFetch(lw_amount, ivec3(pixel & 2047, pixel >> 11, 3), 0).r > 0.5) discard;
  }
  vec4 value = lwLocalBasesEntry(entry);
  if (value.a > 0.0) value.rgb = min(value.rgb + lwConstant(texel.y * textureSize(lw_texel_map, 0).x + texel.x, place), vec3(u_max));
  o_irradiance = value;
}
)";

}  // namespace lightwell::runtime::gl::glsl
