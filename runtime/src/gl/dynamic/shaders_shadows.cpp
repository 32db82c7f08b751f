// Imperfect shadow maps of virtual lights, and gathering with them.
#include "runtime/src/gl/dynamic/shaders.h"

namespace lightwell::runtime::gl::glsl {

// A half sphere about a normal as a square: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors" (JCGT 2014), hemi-oct.
const char kOctahedron[] = R"(
vec3 lwUnfold(vec2 p) {
  float z = 1.0 - abs(p.x) - abs(p.y), fold = max(-z, 0.0);
  return normalize(vec3(p.x + (p.x >= 0.0 ? -fold : fold), p.y + (p.y >= 0.0 ? -fold : fold), z));
}
// Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017): from the world to a frame whose z is n.
vec3 lwInFrame(vec3 n, vec3 v) {
  float sign = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (sign + n.z), b = n.x * n.y * a;
  return vec3(dot(vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), v), dot(vec3(b, sign + n.y * n.y * a, -n.y), v), dot(n, v));
}
// 0 to 1, for z >= 0.
vec2 lwHalfSphere(vec3 local) {
  vec2 p = local.xy / max(abs(local.x) + abs(local.y) + local.z, 1e-30);
  return vec2(p.x + p.y, p.x - p.y) * 0.5 + 0.5;
}
)";

// lw_lamp_numbers[0]: lights; side of a shadow map, 0: none; maps in a row; radius of a splatted point in metres. [1]: softness; most form, 0: any.
const char kLampLookup[] = R"(
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2D;
#endif
uniform sampler2D lw_lamp_place;
uniform sampler2D lw_lamp_flux;
uniform sampler2D lw_lamp_shadow;
uniform vec4 lw_lamp_numbers[2];
vec3 lwLampFrame(vec3 n, vec3 v) {
  float sign = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (sign + n.z), b = n.x * n.y * a;
  return vec3(dot(vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), v), dot(vec3(b, sign + n.y * n.y * a, -n.y), v), dot(n, v));
}
// Of a point at `offset` from a light. The point is moved along its own normal by as much as a texel and a splatted point are wide there, so that it is not hidden by its own surface.
float lwLampVisible(int light, vec3 light_normal, vec3 offset, vec3 normal) {
  int side = int(lw_lamp_numbers[0].y), row = int(lw_lamp_numbers[0].z);
  if (side == 0) return 1.0;
  float width = length(offset) * 2.5 / float(side) + lw_lamp_numbers[0].w;
  offset += normal * width;
  float distance_m = length(offset);
  vec3 local = lwLampFrame(light_normal, offset / max(distance_m, 1e-30));
  if (local.z <= 0.0) return 1.0;
  vec2 p = local.xy / max(abs(local.x) + abs(local.y) + local.z, 1e-30);
  vec2 at = (vec2(p.x + p.y, p.x - p.y) * 0.5 + 0.5) * float(side);
  ivec2 texel = ivec2(light % row, light / row) * side + clamp(ivec2(at), ivec2(0), ivec2(side - 1));
  float stored = texelFetch(lw_lamp_shadow, texel, 0).r;
  float bias = 1.2 * width;
  return stored <= 0.0 ? 1.0 : clamp((stored + bias - distance_m) / (0.5 * bias) + 1.0, 0.0, 1.0);
}
vec3 lwLampIrradiance(vec3 position, vec3 normal, int first, int step) {
  vec3 sum = vec3(0.0);
  int lights = int(lw_lamp_numbers[0].x);
  for (int i = first; i < lights; i += step) {
    vec4 flux = texelFetch(lw_lamp_flux, ivec2(i, 0), 0);
    if (!(flux.r + flux.g + flux.b > 0.0)) continue;
    vec3 light_normal = texelFetch(lw_lamp_place, ivec2(i, 1), 0).xyz, offset = position - texelFetch(lw_lamp_place, ivec2(i, 0), 0).xyz;
    float square = dot(offset, offset), distance_m = sqrt(square);
    if (!(square > 1e-30)) continue;
    vec3 way = offset / distance_m;
    float sending = dot(way, light_normal), receiving = -dot(way, normal);
    if (!(sending > 0.0 && receiving > 0.0)) continue;
    float form = sending * receiving / (square + flux.a * lw_lamp_numbers[1].x * 0.31830988618);
    if (lw_lamp_numbers[1].y > 0.0) form = min(form, lw_lamp_numbers[1].y);
    sum += flux.rgb * (form * 0.31830988618 * lwLampVisible(i, light_normal, offset, normal));
  }
  return min(sum * float(step), vec3(1e24));
}
)";

// Squares of the atlas of shadow maps: two triangles for each request.
const char kTilesVertex[] = R"(
uniform sampler2D u_request;          // w: number of the light
uniform vec4 u_atlas;                 // side of a map, maps in a row, size of the target
flat out ivec2 v_corner;
void main() {
  int light = int(texelFetch(u_request, ivec2(gl_VertexID / 6, 0), 0).w), corner = gl_VertexID % 6, row = int(u_atlas.y);
  vec2 at = vec2(corner == 1 || corner == 2 || corner == 4 ? 1.0 : 0.0, corner == 2 || corner == 4 || corner == 5 ? 1.0 : 0.0);
  v_corner = ivec2(light % row, light / row) * int(u_atlas.x);
  gl_Position = vec4((vec2(v_corner) + at * u_atlas.x) / u_atlas.zw * 2.0 - 1.0, 1.0, 1.0);
}
)";

const char kTilesClear[] = R"(
flat in ivec2 v_corner;
out float o_distance;
void main() {
  gl_FragDepth = 1.0;
  o_distance = 0.0;
}
)";

// Ritschel et al. 2008, section 3.2: points as large as the surface that they stand for.
const char kSplatVertex[] = R"(
uniform sampler2D u_request;
uniform sampler2D u_place;
uniform sampler2DArray u_point;       // two for each: position; normal
uniform vec4 u_atlas;                 // side of a map, maps in a row, size of the target
uniform vec4 u_points;                // of the section, for each light, area of one in m², one over the farthest distance
flat out ivec2 v_corner;
flat out float v_distance;
void main() {
  int each = int(u_points.y), light = int(texelFetch(u_request, ivec2(gl_VertexID / each, 0), 0).w), row = int(u_atlas.y);
  int point = int((uint(light) * uint(each) + uint(gl_VertexID % each)) % uint(u_points.x));
  vec4 place = texelFetch(u_place, ivec2(light, 0), 0);
  vec3 normal = texelFetch(u_place, ivec2(light, 1), 0).xyz;
  vec3 offset = texelFetch(u_point, lwAddress(point * 2), 0).xyz - place.xyz;
  float distance_m = length(offset), radius = sqrt(u_points.z * 0.31830988618);
  vec3 way = offset / max(distance_m, 1e-30);
  v_corner = ivec2(light % row, light / row) * int(u_atlas.x);
  v_distance = distance_m;
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float sending = dot(way, normal);
  if (place.w < 0.5 || place.w > 1.5 || sending <= 0.02 || sending * distance_m <= 0.1 * radius) return;
  float seen = max(abs(dot(way, texelFetch(u_point, lwAddress(point * 2 + 1), 0).xyz)), 0.05);
  // A half sphere of 2 pi is u_atlas.x squared texels.
  gl_PointSize = clamp(u_atlas.x * sqrt(u_points.z * seen * 0.15915494309) / distance_m, 1.0, u_atlas.x);
  vec2 at = vec2(v_corner) + lwHalfSphere(lwInFrame(normal, way)) * u_atlas.x;
  gl_Position = vec4(at / u_atlas.zw * 2.0 - 1.0, distance_m * u_points.w * 2.0 - 1.0, 1.0);
}
)";

const char kSplat[] = R"(
uniform vec4 u_atlas;
flat in ivec2 v_corner;
flat in float v_distance;
out float o_distance;
void main() {
  ivec2 within = ivec2(gl_FragCoord.xy) - v_corner;
  if (any(lessThan(within, ivec2(0))) || any(greaterThanEqual(within, ivec2(int(u_atlas.x))))) discard;
  o_distance = v_distance;
}
)";

// Pull: of four distances those near the nearest. Push: holes take what is coarser, from neighbours near the nearest of them; what lies far behind the coarser surface was seen through a hole.
const char kTilesPull[] = R"(
uniform sampler2D u_fine;
uniform float u_threshold;            // relative
flat in ivec2 v_corner;
out float o_distance;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) * 2;
  vec4 d = vec4(texelFetch(u_fine, at, 0).r, texelFetch(u_fine, at + ivec2(1, 0), 0).r, texelFetch(u_fine, at + ivec2(0, 1), 0).r, texelFetch(u_fine, at + ivec2(1), 0).r);
  vec4 known = vec4(greaterThan(d, vec4(0.0))), from = mix(vec4(1e30), d, known);
  float nearest = min(min(from.x, from.y), min(from.z, from.w));
  vec4 near = known * vec4(lessThanEqual(from, vec4(nearest * (1.0 + u_threshold))));
  o_distance = nearest < 1e30 ? dot(d, near) / dot(near, vec4(1.0)) : 0.0;
}
)";

const char kTilesPush[] = R"(
uniform sampler2D u_fine;             // pulled
uniform sampler2D u_coarse;           // pushed
uniform vec4 u_atlas;
uniform int u_level;                  // of u_coarse that is read
uniform float u_threshold;
flat in ivec2 v_corner;
out float o_distance;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), low = v_corner / 2, high = low + int(u_atlas.x) / 2 - 1, parent = at / 2;
  float fine = texelFetch(u_fine, at, 0).r;
  ivec2 next = clamp(parent + ivec2((at.x & 1) * 2 - 1, (at.y & 1) * 2 - 1), low, high);
  vec4 d = vec4(texelFetch(u_coarse, parent, u_level).r, texelFetch(u_coarse, ivec2(next.x, parent.y), u_level).r, texelFetch(u_coarse, ivec2(parent.x, next.y), u_level).r,
                texelFetch(u_coarse, next, u_level).r);
  float base = d.x > 0.0 ? d.x : max(max(d.y, d.z), d.w);
  vec4 weight = vec4(9.0, 3.0, 3.0, 1.0) * vec4(greaterThan(d, vec4(0.0))) * vec4(lessThanEqual(abs(d - base), vec4(base * u_threshold)));
  float coarse = base > 0.0 ? dot(d, weight) / dot(weight, vec4(1.0)) : 0.0;
  o_distance = fine > 0.0 ? fine : coarse;
}
)";

const char kGatherTexels[] = R"(
uniform sampler2D u_place;            // of the texels: position, half a side
uniform sampler2D u_normal;           // octahedral: shading normal, surface's normal
uniform int u_values;
out vec4 o_irradiance;
void main() {
  int i = lwIndex();
  if (i >= u_values) discard;
  vec4 place = texelFetch(u_place, lwPixel(i), 0), normal = texelFetch(u_normal, lwPixel(i), 0);
  o_irradiance = vec4(lwLampIrradiance(place.xyz, lwUnfold(normal.xy), 0, 1), 0.0);
}
)";

const char kShowTexels[] = R"(
uniform usampler2D u_texel_map;
uniform sampler2D u_value;
uniform float u_max;
out vec4 o_irradiance;
void main() {
  uint value = texelFetch(u_texel_map, ivec2(gl_FragCoord.xy), 0).r;
  o_irradiance = value == 0xffffffffu ? vec4(0.0) : vec4(min(texelFetch(u_value, lwPixel(int(value)), 0).rgb, vec3(u_max)), 1.0);
}
)";

const char kLampVisibility[] = R"(
uniform vec4 u_point, u_point_normal;
out vec4 o_visible;
void main() {
  int i = int(gl_FragCoord.x);
  vec4 place = texelFetch(lw_lamp_place, ivec2(i, 0), 0);
  vec3 normal = texelFetch(lw_lamp_place, ivec2(i, 1), 0).xyz, offset = u_point.xyz - place.xyz;
  o_visible = vec4(0.0);
  if (place.w < 0.5 || place.w > 1.5 || !(dot(offset, normal) > 0.0) || !(dot(offset, u_point_normal.xyz) < 0.0)) return;
  o_visible = vec4(lwLampVisible(i, normal, offset, u_point_normal.xyz));
}
)";

}  // namespace lightwell::runtime::gl::glsl
