#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

// A lamp's view. Vectors are the view's, right and up over their squared lengths; a near plane only to divide by something: depths are compared as nearness.
const char kLampViewVertex[] = R"(
uniform sampler2DArray u_corner;      // two for each: position, light-map u; light-map v, texture coordinates of alpha
uniform vec4 u_eye, u_right, u_up;    // u_eye.w: the near plane; 0: orthographic
uniform vec4 u_forward;               // w: orthographic: one over half of the depth
flat out int v_triangle;
flat out vec4 v_normal;               // on the side that is seen, twice the area long; w: 1: front
out vec3 v_offset;
out vec4 v_uv;
out float v_nearness;
vec3 lwCorner(int corner) { return texelFetch(u_corner, lwAddress(corner * 2), 0).xyz - u_eye.xyz; }
void main() {
  v_triangle = gl_VertexID / 3;
  vec3 a = lwCorner(v_triangle * 3);
  vec3 normal = cross(lwCorner(v_triangle * 3 + 1) - a, lwCorner(v_triangle * 3 + 2) - a);
  bool front = dot(normal, u_eye.w > 0.0 ? -a : -u_forward.xyz) >= 0.0;
  v_normal = front ? vec4(normal, 1.0) : vec4(-normal, 0.0);
  v_offset = lwCorner(gl_VertexID);
  v_uv = vec4(texelFetch(u_corner, lwAddress(gl_VertexID * 2), 0).w, texelFetch(u_corner, lwAddress(gl_VertexID * 2 + 1), 0).xyz);
  vec2 at = vec2(dot(v_offset, u_right.xyz), dot(v_offset, u_up.xyz));
  float depth = dot(v_offset, u_forward.xyz);
  v_nearness = 0.5 - 0.5 * depth * u_forward.w;
  gl_Position = u_eye.w > 0.0 ? vec4(at, depth - 2.0 * u_eye.w, depth) : vec4(at, depth * u_forward.w, 1.0);
}
)";

// Where surfaces with alpha let light through.
const char kAlphaTest[] = R"(
uniform usampler2DArray u_alpha_material;  // two for each: first alpha, size, wrap modes; bits of factor, of the least that is opaque, of 1 where it blends
uniform sampler2DArray u_alpha;
float lwWrapped(float at, uint mode, float size) {
  if (mode == 2u) return clamp(at, -1.0, size + 1.0);
  float period = mode == 3u ? 2.0 * size : size;
  at -= floor(at / period) * period;
  return mode == 3u && at > size ? period - at : at;
}
int lwNeighbour(int at, uint mode, int size) { return mode == 1u ? (at + size) % size : clamp(at, 0, size - 1); }
// The opacity there; from which one on the surface is there at all; 1: it blends.
vec3 lwAlpha(int material, vec2 uv) {
  uvec4 texture_at = texelFetch(u_alpha_material, lwAddress(material * 2), 0);
  uvec4 limits = texelFetch(u_alpha_material, lwAddress(material * 2 + 1), 0);
  float value = uintBitsToFloat(limits.x);
  ivec2 size = ivec2(texture_at.yz);
  if (size.x > 0) {
    uvec2 mode = uvec2(texture_at.w & 3u, texture_at.w >> 2u);
    vec2 at = vec2(lwWrapped(uv.x * float(size.x), mode.x, float(size.x)), lwWrapped(uv.y * float(size.y), mode.y, float(size.y))) - 0.5;
    vec2 low = floor(at), f = at - low;
    float sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      int column = lwNeighbour(int(low.x) + (i & 1), mode.x, size.x), row = lwNeighbour(int(low.y) + (i >> 1), mode.y, size.y);
      sum += ((i & 1) != 0 ? f.x : 1.0 - f.x) * (i > 1 ? f.y : 1.0 - f.y) * texelFetch(u_alpha, lwAddress(int(texture_at.x) + row * size.x + column), 0).r;
    }
    value *= sum;
  }
  return vec3(value, uintBitsToFloat(limits.yz));
}
bool lwLetsThrough(int material, vec2 uv) {
  vec3 alpha = lwAlpha(material, uv);
  return alpha.x < alpha.y;
}
)";

// The patch that a pixel sees, and what a lamp's range leaves of the light there.
const char kInjectSee[] = R"(
uniform usampler2DArray u_triangle;   // double-sided, from bit 1 on the leaf's number + 1; alpha material; nearest patches, front and back; 0xffffffff: none
uniform usampler2D u_texel_patches;   // front, back
uniform sampler2DArray u_patch;       // normal; one over area
uniform sampler2DArray u_leaf;        // six for each: axis, offset, where its first gate is, strips; then how far gates are open
uniform vec4 u_eye;
uniform float u_range;
flat in int v_triangle;
flat in vec4 v_normal;
in vec3 v_offset;
in vec4 v_uv;
in float v_nearness;
out uvec2 o_seen;
const uint kNone = 0xffffffffu;
float lwLeaf(int at) { return texelFetch(u_leaf, lwAddress(at), 0).r; }
bool lwIsOpen(int leaf) {
  vec3 axis = vec3(lwLeaf(leaf * 6), lwLeaf(leaf * 6 + 1), lwLeaf(leaf * 6 + 2));
  float strips = lwLeaf(leaf * 6 + 5);
  float place = clamp(dot(axis, v_offset + u_eye.xyz) + lwLeaf(leaf * 6 + 3), 0.0, 1.0) * strips;
  float strip = min(floor(place), strips - 1.0);
  return place - strip < lwLeaf(int(lwLeaf(leaf * 6 + 4) + strip));
}
uint lwPatchOf(ivec2 texel) {
  uvec2 patches = texelFetch(u_texel_patches, texel, 0).rg;
  return v_normal.w > 0.0 ? patches.r : patches.g;
}
void main() {
  uvec4 triangle = texelFetch(u_triangle, lwAddress(v_triangle), 0);
  if (triangle.x > 1u && lwIsOpen(int(triangle.x >> 1u) - 1)) discard;
  if (triangle.y != kNone && lwLetsThrough(int(triangle.y), v_uv.zw)) discard;
  gl_FragDepth = u_eye.w > 0.0 ? u_eye.w * gl_FragCoord.w : v_nearness;
  float left = 1.0;
  if (u_range > 0.0) {
    float relative = dot(v_offset, v_offset) / (u_range * u_range);
    left = clamp(1.0 - relative * relative, 0.0, 1.0);
  }
  o_seen = uvec2(kNone, floatBitsToUint(left));
  if (v_normal.w == 0.0 && (triangle.x & 1u) == 0u) return;  // absorbed
  ivec2 size = textureSize(u_texel_patches, 0), last = size - 1;
  ivec2 texel = clamp(ivec2(v_uv.xy * vec2(size)), ivec2(0), last);
  uint patch_seen = lwPatchOf(texel);
  if (patch_seen == kNone) {
    // As PatchFinder does: a near texel's whose patch faces the same way, else the nearest of all.
    int best = 9;
    for (int v = max(texel.y - 2, 0); v <= min(texel.y + 2, last.y); ++v)
      for (int u = max(texel.x - 2, 0); u <= min(texel.x + 2, last.x); ++u) {
        int distance2 = (u - texel.x) * (u - texel.x) + (v - texel.y) * (v - texel.y);
        uint other = distance2 < best ? lwPatchOf(ivec2(u, v)) : kNone;
        if (other != kNone && dot(texelFetch(u_patch, lwAddress(int(other)), 0).xyz, v_normal.xyz) > 0.0) {
          patch_seen = other;
          best = distance2;
        }
      }
  }
  if (patch_seen == kNone) patch_seen = v_normal.w > 0.0 ? triangle.z : triangle.w;
  o_seen.r = patch_seen;
}
)";

// One point for each pixel of a view. A pixel's solid angle is that of two triangles: van Oosterom and Strackee, "The Solid Angle of a Plane Triangle" (1983),
// eq. 8. Unlike differences of corner terms it loses no digits where pixels are small; of the arc tangent of at most 0.04 three terms are exact.
const char kInjectAddVertex[] = R"(
uniform usampler2D u_seen;
uniform sampler2DArray u_patch;
uniform int u_side;
uniform vec4 u_light;                 // intensity; w: scale of all pixels, or, orthographic, their area
uniform vec4 u_cone;                  // the light's direction along right, up and forward; w: tangent of the view; 0: orthographic
uniform vec4 u_spot;                  // scale, offset; size of the target
flat out vec3 v_irradiance;
float lwTriangleAngle(vec3 a, vec3 b, vec3 c, float volume) {
  vec3 l = vec3(length(a), length(b), length(c));
  float t = volume / (l.x * l.y * l.z + dot(a, b) * l.z + dot(b, c) * l.x + dot(c, a) * l.y), t2 = t * t;
  return 2.0 * t * (1.0 - t2 * (1.0 / 3.0 - t2 * 0.2));
}
void main() {
  ivec2 pixel = ivec2(gl_VertexID % u_side, gl_VertexID / u_side);
  uvec2 seen = texelFetch(u_seen, pixel, 0).rg;
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  v_irradiance = vec3(0.0);
  if (seen.r == 0xffffffffu) return;
  float amount = u_light.w * uintBitsToFloat(seen.g), tangent = u_cone.w;
  if (tangent > 0.0) {
    vec2 low = (2.0 * vec2(pixel) / float(u_side) - 1.0) * tangent, high = (2.0 * vec2(pixel + 1) / float(u_side) - 1.0) * tangent;
    vec3 a = vec3(low, 1.0), b = vec3(high.x, low.y, 1.0), c = vec3(high, 1.0), d = vec3(low.x, high.y, 1.0);
    float size = 2.0 * tangent / float(u_side);
    amount *= lwTriangleAngle(a, b, c, size * size) + lwTriangleAngle(a, c, d, size * size);
    vec3 way = vec3((2.0 * vec2(pixel) + 1.0) / float(u_side) - 1.0, 1.0);
    float edge = clamp(dot(way, u_cone.xyz) / length(vec3(way.xy * tangent, 1.0)) * u_spot.x + u_spot.y, 0.0, 1.0);
    amount *= edge * edge;
  }
  v_irradiance = min(u_light.rgb * (amount * texelFetch(u_patch, lwAddress(int(seen.r)), 0).w), vec3(1e24));
  gl_Position = vec4((vec2(lwPixel(int(seen.r))) + 0.5) / u_spot.zw * 2.0 - 1.0, 0.0, 1.0);
}
)";

const char kInjectAdd[] = R"(
flat in vec3 v_irradiance;
out vec4 o_irradiance;
void main() { o_irradiance = vec4(v_irradiance, 0.0); }
)";

}  // namespace lightwell::runtime::gl::glsl
