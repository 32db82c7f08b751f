// Reflective shadow maps, and virtual lights from them.
#include "runtime/src/gl/dynamic/shaders.h"

namespace lightwell::runtime::gl::glsl {

// u_lamp: 0: where it is, or the middle of an orthographic view; w: 0 six views, 1 one view, 2 orthographic. 1 to 3: axes of the first view: right, up (six views: unit; one: over the tangent of its half
// angle; orthographic: over half the extent), forward (orthographic: over half the depth). 4: side of a view, spot's scale and offset, w: scale of pixels' solid angles, orthographic their area. 5: intensity; w: range. 6: the way a spot or
// a directional light shines.
const char kLampViews[] = R"(
uniform vec4 u_lamp[7];
const float kPi = 3.14159265359;
// What identifies a place of the lamp's light: its direction from the lamp; orthographic: the offset across it, in half extents.
vec3 lwLampAim(vec3 position) {
  vec3 offset = position - u_lamp[0].xyz;
  return u_lamp[0].w < 1.5 ? normalize(offset) : vec3(dot(offset, u_lamp[1].xyz), dot(offset, u_lamp[2].xyz), 0.0);
}
// The pixel there; x < 0: outside of the views.
ivec2 lwLampPixel(vec3 aim) {
  vec2 at = aim.xy;
  int view = 0;
  if (u_lamp[0].w < 1.5) {
    vec3 q = vec3(dot(aim, u_lamp[3].xyz), dot(aim, u_lamp[1].xyz), dot(aim, u_lamp[2].xyz));  // forward, right, up
    if (u_lamp[0].w < 0.5) {
      vec3 size = abs(q);
      int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      vec3 turned = axis == 0 ? q : axis == 1 ? q.yzx : q.zxy;
      at = turned.yz / abs(turned.x);
      view = axis * 2 + (turned.x < 0.0 ? 1 : 0);
    } else {
      if (q.x <= 0.0) return ivec2(-1);
      at = q.yz / q.x;
    }
  }
  if (max(abs(at.x), abs(at.y)) > 1.0001) return ivec2(-1);
  int side = int(u_lamp[4].x);
  ivec2 pixel = clamp(ivec2((at * 0.5 + 0.5) * float(side)), ivec2(0), ivec2(side - 1));
  return pixel + ivec2(view & 3, view >> 2) * side;
}
// The reverse for a point of the views, in pixels.
vec3 lwLampAimOf(vec2 pixel) {
  float side = u_lamp[4].x;
  vec2 cell = floor(pixel / side), at = (pixel / side - cell) * 2.0 - 1.0;
  if (u_lamp[0].w > 1.5) return vec3(at, 0.0);
  if (u_lamp[0].w > 0.5) {
    vec3 right = u_lamp[1].xyz / dot(u_lamp[1].xyz, u_lamp[1].xyz), up = u_lamp[2].xyz / dot(u_lamp[2].xyz, u_lamp[2].xyz);
    return normalize(u_lamp[3].xyz + right * at.x + up * at.y);
  }
  int view = int(cell.x) + int(cell.y) * 4, axis = view >> 1;
  vec3 q = vec3((view & 1) != 0 ? -1.0 : 1.0, at);
  q = axis == 0 ? q : axis == 1 ? q.zxy : q.yzx;
  return normalize(u_lamp[3].xyz * q.x + u_lamp[1].xyz * q.y + u_lamp[2].xyz * q.z);
}
// Solid angle of a pixel, orthographic its area, and all views' scale.
float lwLampPixelSize(vec2 pixel) {
  float side = u_lamp[4].x;
  if (u_lamp[0].w > 1.5) return u_lamp[4].w;
  vec2 at = (pixel / side - floor(pixel / side)) * 2.0 - 1.0;
  float tangent = 1.0 / length(u_lamp[1].xyz), w = 1.0 + dot(at, at) * tangent * tangent;
  return u_lamp[4].w * 4.0 * tangent * tangent / (side * side * w * sqrt(w));
}
)";

const char kLampSee[] = R"(
uniform usampler2DArray u_triangle;   // double-sided; alpha material or 0xffffffff
uniform sampler2D u_albedo;
uniform vec4 u_eye;
uniform vec4 u_lamp[7];
flat in int v_triangle;
flat in vec4 v_normal;
in vec3 v_offset;
in vec4 v_uv;
in float v_nearness;
layout(location = 0) out vec4 o_position;
layout(location = 1) out vec4 o_normal;
layout(location = 2) out vec4 o_flux;
void main() {
  uvec2 triangle = texelFetch(u_triangle, lwAddress(v_triangle), 0).rg;
  if (triangle.y != 0xffffffffu && lwLetsThrough(int(triangle.y), v_uv.zw)) discard;
  gl_FragDepth = u_eye.w > 0.0 ? u_eye.w * gl_FragCoord.w : v_nearness;
  vec3 normal = v_normal.xyz / max(length(v_normal.xyz), 1e-37);
  float square = dot(v_offset, v_offset);
  bool directional = u_eye.w <= 0.0;
  vec3 way = directional ? u_lamp[6].xyz : v_offset / sqrt(max(square, 1e-37));
  float falling = max(-dot(way, normal), 1e-4);
  o_position = vec4(u_eye.xyz + v_offset, 1.0);
  o_normal = vec4(normal, (directional ? 1.0 : square) / falling);
  vec3 light = u_lamp[5].rgb;
  if (!directional) {
    float edge = clamp(dot(way, u_lamp[6].xyz) * u_lamp[4].y + u_lamp[4].z, 0.0, 1.0);
    light *= edge * edge;
    if (u_lamp[5].w > 0.0) {
      float relative = square / (u_lamp[5].w * u_lamp[5].w);
      light *= clamp(1.0 - relative * relative, 0.0, 1.0);
    }
  }
  o_flux = vec4(0.0);
  if (v_normal.w == 0.0 && triangle.x == 0u) return;  // absorbed
  ivec2 size = textureSize(u_albedo, 0);
  o_flux.rgb = light * texelFetch(u_albedo, clamp(ivec2(v_uv.xy * vec2(size)), ivec2(0), size - 1), 0).rgb;
}
)";

// The lowest level of the sums: each pixel's reflected light in lumen, and its surface.
const char kFluxSum[] = R"(
uniform sampler2D u_position;
uniform sampler2D u_normal;
uniform sampler2D u_flux;
out vec4 o_sum;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  o_sum = vec4(0.0);
  int side = int(u_lamp[4].x), view = at.x / side + (at.y / side) * 4;
  if (view >= (u_lamp[0].w < 0.5 ? 6 : 1) || texelFetch(u_position, at, 0).w < 0.5) return;
  vec3 flux = texelFetch(u_flux, at, 0).rgb;
  if (!(flux.r + flux.g + flux.b > 0.0)) return;
  o_sum = min(vec4(flux, min(texelFetch(u_normal, at, 0).w, 1e24)) * lwLampPixelSize(vec2(at) + 0.5), vec4(1e24));
}
)";

const char kFluxReduce[] = R"(
uniform sampler2D u_sum;
out vec4 o_sum;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) * 2, size = textureSize(u_sum, 0);
  o_sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 child = at + ivec2(i & 1, i >> 1);
    if (child.x < size.x && child.y < size.y) o_sum += texelFetch(u_sum, child, 0);
  }
}
)";

// Hierarchical warping: Clarberg et al., "Wavelet Importance Sampling" (SIGGRAPH 2005), section 4. A light's point of the unit square goes down the sums; lights keep their points from frame to frame.
// Row 0: position; row 1: normal; row 2: flux, area.
const char kSampleLights[] = R"(
uniform sampler2D u_position;
uniform sampler2D u_normal;
uniform sampler2D u_sum;
uniform int u_levels, u_lights, u_row;  // row: 0: places; 2: flux
out vec4 o_light;
float lwWeight(ivec2 at, int level) {
  ivec2 size = textureSize(u_sum, level);
  return at.x < size.x && at.y < size.y ? dot(texelFetch(u_sum, at, level).rgb, vec3(0.2126, 0.7152, 0.0722)) : 0.0;
}
void main() {
  int i = int(gl_FragCoord.x), row = int(gl_FragCoord.y) + u_row;
  // The R2 sequence (Roberts 2018).
  vec2 u = fract(vec2(0.5) + float(i) * vec2(0.7548776662466927, 0.5698402909980532));
  float all = lwWeight(ivec2(0), u_levels - 1);
  o_light = vec4(0.0);
  if (!(all > 0.0)) return;
  ivec2 at = ivec2(0);
  for (int level = u_levels - 2; level >= 0; --level) {
    at *= 2;
    vec2 low = vec2(lwWeight(at, level), lwWeight(at + ivec2(1, 0), level)), high = vec2(lwWeight(at + ivec2(0, 1), level), lwWeight(at + ivec2(1), level));
    vec2 columns = low + high;
    float share = columns.x / max(columns.x + columns.y, 1e-37);
    bool right = columns.y > 0.0 && (u.x >= share || columns.x <= 0.0);
    u.x = right ? (u.x - share) / max(1.0 - share, 1e-7) : u.x / max(share, 1e-7);
    vec2 rows = right ? vec2(low.y, high.y) : vec2(low.x, high.x);
    share = rows.x / max(rows.x + rows.y, 1e-37);
    bool upper = rows.y > 0.0 && (u.y >= share || rows.x <= 0.0);
    u.y = upper ? (u.y - share) / max(1.0 - share, 1e-7) : u.y / max(share, 1e-7);
    u = clamp(u, vec2(0.0), vec2(0.9999999));
    at += ivec2(right ? 1 : 0, upper ? 1 : 0);
  }
  vec4 sum = texelFetch(u_sum, at, 0);
  float weight = dot(sum.rgb, vec3(0.2126, 0.7152, 0.0722));
  if (!(weight > 0.0)) return;
  if (row == 0) o_light = texelFetch(u_position, at, 0);
  else if (row == 1) o_light = vec4(texelFetch(u_normal, at, 0).xyz, 0.0);
  else o_light = min(sum * (all / (float(u_lights) * weight)), vec4(1e24));
}
)";

// Whether a light is still where the lamp shines: Laine et al. 2007, section 4.1. xyz: its direction from the lamp; w: 0: no more; 1: yes; 2: it stands for a direction in which there is nothing.
const char kCheckLights[] = R"(
uniform sampler2D u_place;
uniform sampler2D u_position;
out vec4 o_aim;
void main() {
  int i = int(gl_FragCoord.x);
  vec4 place = texelFetch(u_place, ivec2(i, 0), 0);
  o_aim = vec4(0.0);
  if (place.w < 0.5) return;
  bool nothing = place.w > 1.5;
  vec3 aim = nothing ? place.xyz : lwLampAim(place.xyz);
  ivec2 pixel = lwLampPixel(aim);
  if (pixel.x < 0) return;
  vec3 offset = place.xyz - u_lamp[0].xyz;
  if (!nothing && u_lamp[0].w < 1.5 && u_lamp[4].y > 0.0 && dot(aim, u_lamp[6].xyz) * u_lamp[4].y + u_lamp[4].z <= 0.0) return;  // outside of the cone
  vec4 seen = texelFetch(u_position, pixel, 0);
  if (nothing) {
    if (seen.w < 0.5) o_aim = vec4(aim, 2.0);
    return;
  }
  if (seen.w < 0.5) return;
  bool directional = u_lamp[0].w > 1.5;
  vec3 normal = texelFetch(u_place, ivec2(i, 1), 0).xyz;
  float pixel_m = 2.0 / (u_lamp[4].x * length(u_lamp[1].xyz));
  vec3 way = directional ? u_lamp[6].xyz : aim;
  float falling = -dot(way, normal);
  if (falling < 0.02) return;
  if (!directional) pixel_m *= length(offset);
  float tolerance = 1.5 * pixel_m * (1.0 + sqrt(max(1.0 - falling * falling, 0.0)) / falling);
  if (abs(dot(seen.xyz - place.xyz, way)) <= tolerance) o_aim = vec4(aim, 1.0);
}
)";

// New places of some lights. Three points for each request: its position, its normal, its direction (the last into a texture of its own).
const char kPlaceVertex[] = R"(
uniform sampler2D u_request;          // direction, number of the light
uniform int u_lights, u_rows;
flat out vec3 v_aim;
flat out int v_row;
void main() {
  vec4 request = texelFetch(u_request, ivec2(gl_VertexID / u_rows, 0), 0);
  v_aim = request.xyz;
  v_row = u_rows == 1 ? 2 : gl_VertexID % u_rows;
  gl_PointSize = 1.0;
  gl_Position = vec4((vec2(request.w, float(v_row % 2)) + 0.5) / vec2(float(u_lights), float(u_rows)) * 2.0 - 1.0, 0.0, 1.0);
}
)";

const char kPlaceLights[] = R"(
uniform sampler2D u_position;
uniform sampler2D u_normal;
flat in vec3 v_aim;
flat in int v_row;
out vec4 o_light;
void main() {
  ivec2 pixel = lwLampPixel(v_aim);
  vec4 seen = pixel.x < 0 ? vec4(0.0) : texelFetch(u_position, pixel, 0);
  bool nothing = seen.w < 0.5;
  if (v_row == 0) o_light = nothing ? vec4(v_aim, 2.0) : vec4(seen.xyz, 1.0);
  else if (v_row == 1) o_light = nothing ? vec4(0.0) : vec4(texelFetch(u_normal, pixel, 0).xyz, 0.0);
  else o_light = nothing ? vec4(v_aim, 2.0) : vec4(lwLampAim(seen.xyz), 1.0);
}
)";

// The light of each cell of the sums goes to the valid light that is nearest in the lamp's projection: the Voronoi diagram of Laine et al. 2007, section 4.3, with all of the map's light in it.
const char kShareVertex[] = R"(
uniform sampler2D u_sum;
uniform sampler2D u_aim;
uniform int u_level, u_lights;
flat out vec4 v_flux;
void main() {
  ivec2 size = textureSize(u_sum, u_level), cell = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
  v_flux = texelFetch(u_sum, cell, u_level);
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (!(v_flux.r + v_flux.g + v_flux.b > 0.0)) return;
  float scale = float(1 << u_level);
  vec3 aim = lwLampAimOf((vec2(cell) + 0.5) * scale);
  int nearest = -1;
  float least = 1e30;
  for (int i = 0; i < u_lights; ++i) {
    vec4 other = texelFetch(u_aim, ivec2(i, 0), 0);
    vec3 apart = other.xyz - aim;
    float square = dot(apart, apart);
    if (other.w > 0.5 && other.w < 1.5 && square < least) {
      least = square;
      nearest = i;
    }
  }
  if (nearest >= 0) gl_Position = vec4((float(nearest) + 0.5) / float(u_lights) * 2.0 - 1.0, 0.0, 0.0, 1.0);
}
)";

const char kShareFlux[] = R"(
flat in vec4 v_flux;
out vec4 o_flux;
void main() { o_flux = v_flux; }
)";

}  // namespace lightwell::runtime::gl::glsl
