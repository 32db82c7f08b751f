#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

// A half cube of depths about a light, with 1 along the middle of each face: the whole face ahead, and the front halves of those at its sides, all in one texture of 2 × 1.5 sides:
//   (0, 0) ahead    (1, 0) +tangent, (1, 0.5) −tangent    (0, 1) +bitangent, (1, 1) −bitangent
// Depths are kept as nearness, near / depth, in full precision at any distance; 0: nothing.
const char kVplDepthVertex[] = R"(
uniform sampler2DArray u_corner, u_alpha_corner;
uniform vec4 u_right, u_up, u_forward, u_eye;  // u_up.w: 1 for half a face; u_forward.w: the first corner with alpha; u_eye.w: near
#ifdef LW_ALPHA
flat out int v_material;
out vec2 v_uv;
#endif
void main() {
  vec3 at = texelFetch(u_corner, lwAddress(gl_VertexID), 0).xyz - u_eye.xyz;
  float depth = dot(at, u_forward.xyz);
  gl_Position = vec4(dot(at, u_right.xyz), dot(at, u_up.xyz) - u_up.w * depth, depth - 2.0 * u_eye.w, depth);
#ifdef LW_ALPHA
  vec3 alpha = texelFetch(u_alpha_corner, lwAddress(gl_VertexID - int(u_forward.w)), 0).xyz;
  v_uv = alpha.xy;
  v_material = int(alpha.z);
#endif
}
)";

const char kVplAlphaOn[] = "#define LW_ALPHA\n";

// Blended surfaces hide what lies behind them in as many pixels as they are opaque.
const char kVplDepth[] = R"(
uniform vec4 u_eye;
#ifdef LW_ALPHA
flat in int v_material;
in vec2 v_uv;
#endif
void main() {
#ifdef LW_ALPHA
  vec3 alpha = lwAlpha(v_material, v_uv);
  uint key = lwHash(uint(gl_FragCoord.x) + 4096u * uint(gl_FragCoord.y) + floatBitsToUint(u_eye.x + u_eye.y + u_eye.z));
  if (alpha.x < (alpha.z > 0.0 ? (float(key >> 8) + 0.5) / 16777216.0 : alpha.y)) discard;
#endif
  gl_FragDepth = u_eye.w * gl_FragCoord.w;
}
)";

const char kHash[] = R"(
uint lwHash(uint v) {
  v = v * 747796405u + 2891336453u;
  v = ((v >> ((v >> 28) + 4u)) ^ v) * 277803737u;
  return (v >> 22) ^ v;
}
)";

// What form_factor.h has, in the same order of operations.
const char kVplIrradiance[] = R"(
#define LW_PI 3.14159265
uniform vec4 u_light[48];             // see LightBlock
// The angle whose tangent is y / x, for y >= 0: Abramowitz and Stegun (1964), 4.4.49, since that of drivers has two digits less.
float lwAngle(float y, float x) {
  float a = abs(x), most = max(y, a);
  if (!(most > 0.0)) return 0.0;
  float t = min(y, a) / most, s = t * t;
  float angle = t + t * s * (-0.3333314528 + s * (0.1999355085 + s * (-0.1420889944 + s * (0.1065626393 + s * (-0.0752896400 + s * (0.0429096138 + s * (-0.0161657367 + s * 0.0028662257)))))));
  if (y > a) angle = 1.5707963268 - angle;
  return x < 0.0 ? LW_PI - angle : angle;
}
float lwEdge(vec3 a, vec3 b) {
  vec3 gamma = cross(a, b - a);
  float size = length(gamma);
  return size > 1e-12 ? lwAngle(size, dot(a, b)) * (gamma.z / size) : 0.0;
}
float lwPolygonFormFactor(vec3 position, vec3 normal, float size) {
  float s = normal.z < 0.0 ? -1.0 : 1.0, c = -1.0 / (s + normal.z), d = normal.x * normal.y * c;
  mat3 local = mat3(1.0 + s * normal.x * normal.x * c, d, normal.x, s * d, s + normal.y * normal.y * c, normal.y, -s * normal.x, -normal.y, normal.z);
  int count = int(u_light[4].w);
  float sum = 0.0;
  vec3 left = vec3(0.0), entered = vec3(0.0), a = local * ((u_light[7 + count].xyz - position) * (1.0 / size));
  for (int i = 0; i < 8; ++i) {
    if (i >= count) break;
    vec3 b = local * ((u_light[8 + i].xyz - position) * (1.0 / size));
    vec3 from = a, to = b;
    if (a.z > 0.0 != b.z > 0.0) {
      vec3 cut = vec3(a.xy + (b.xy - a.xy) * (a.z / (a.z - b.z)), 0.0);
      if (a.z > 0.0) to = left = cut;
      else from = entered = cut;
    }
    if (a.z > 0.0 || b.z > 0.0) sum += lwEdge(from, to);
    a = b;
  }
  sum += lwEdge(left, entered);  // 0 where nothing was cut
  return clamp(-sum / (2.0 * LW_PI), 0.0, 1.0);
}
float lwConeIrradiance(float cosine, float sine) {
  cosine = clamp(cosine, -1.0, 1.0);
  float sine2 = sine * sine;
  if (cosine * cosine >= sine2) return LW_PI * sine2 * max(cosine, 0.0);
  float normal_sine = sqrt(max(1.0 - cosine * cosine, 1e-12)), x = sqrt(max(1.0 / sine2 - 1.0, 0.0));
  float y = clamp(-x * cosine / normal_sine, -1.0, 1.0), root = sqrt(1.0 - y * y), height = normal_sine * root;
  return max(0.0, (cosine * lwAngle(root, y) - x * height) * sine2 + lwAngle(height, x));
}
// Irradiance by a light of flux 1.
float lwUnitIrradiance(vec3 position, vec3 normal, float epsilon) {
  vec3 plane = u_light[2].xyz, from = position - u_light[1].xyz;
  float height = dot(plane, from), type = u_light[0].w;
  if (epsilon > 0.0 && abs(height) < epsilon && dot(normal, from) < 0.0) {
    vec3 along = plane - normal * dot(plane, normal);
    float sine2 = dot(along, along);
    if (sine2 > 0.01) position += along * ((epsilon - height) / sine2);
  }
  vec3 to_light = u_light[1].xyz - position;
  if (!(max(abs(to_light.x), max(abs(to_light.y), abs(to_light.z))) < 1e18)) return 0.0;
  float distance2 = dot(to_light, to_light), distance = sqrt(distance2);
  vec3 direction = distance > 0.0 ? to_light * (1.0 / distance) : normal;
  float received = dot(direction, normal), sent = -dot(direction, plane), area = u_light[2].w, radius = u_light[3].w;
  float point = max(received, 0.0) * max(sent, 0.0) / max(LW_PI * max(distance2, epsilon * epsilon) + (type == 2.0 ? area : 0.0), 1e-30);
  if (type < 2.5) return point;
  if (type < 3.5) {
    float sine = distance > radius ? radius / distance : 1.0;
    if (sine < 1e-3) return point;
    float solid_angle = 2.0 * LW_PI * (sine * sine / (1.0 + sqrt(max(1.0 - sine * sine, 0.0))));
    return lwConeIrradiance(received, sine) * lwConeIrradiance(sent, sine) / (solid_angle * LW_PI * area);
  }
  if (!(sent > 0.0) || received * distance <= -radius) return 0.0;
  if (radius * radius < 1.6e-5 * distance2) return point;
  return lwPolygonFormFactor(position, normal, distance + radius) / area;
}
)";

// How much of the light a texel sees: rays from points all over the texel to where the light is seen from, each ended by the map. With blocker samples they end on points all over the light, moved
// together by how far from the receiver things in the way are: percentage-closer soft shadows (Fernando 2005) whose filter has the light's own shape.
// A surface counts as in the way where it stands out of the receiver's own plane, by more than a tenth of how far the pixel's middle is beside the ray: the plane itself does not shadow itself.
const char kVplLight[] = R"(
uniform sampler2DArray u_place;       // position; half of the texel's side
uniform sampler2DArray u_normal;      // shading, surface
uniform sampler2DArray u_axes;        // two for each texel, in halves of its side: see TexelSurface
uniform sampler2D u_depth;
uniform int u_values;
out vec4 o_irradiance;
vec3 lwNormal(vec2 packed_normal) {
  vec3 n = vec3(packed_normal, 1.0 - abs(packed_normal.x) - abs(packed_normal.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}
// The direction, in the light's frame, through the middle of the pixel that a direction falls in, and the pixel's nearness.
vec3 lwPixelAlong(vec3 way, out float nearness) {
  float side = u_light[6].y, half_side = 0.5 * side;
  vec3 size = abs(way);
  bool ahead = way.z >= max(size.x, size.y), first = size.x >= size.y;
  float forward = max(ahead ? way.z : first ? size.x : size.y, 1e-30);
  vec2 at = (ahead ? way.xy : first ? way.yz : way.xz) / forward;
  vec2 pixel = vec2(floor((0.5 * at.x + 0.5) * side), floor(ahead ? (0.5 * at.y + 0.5) * side : 0.5 * at.y * side));
  pixel = clamp(pixel, vec2(0.0), vec2(side, ahead ? side : half_side) - 1.0);
  float turned = (first ? way.x : way.y) < 0.0 ? -1.0 : 1.0;
  vec2 corner = ahead ? vec2(0.0) : first ? vec2(side, turned > 0.0 ? 0.0 : half_side) : vec2(turned > 0.0 ? 0.0 : side, side);
  nearness = texelFetch(u_depth, ivec2(pixel + corner), 0).r;
  vec2 middle = (pixel + 0.5) * (2.0 / side) - 1.0;
  return ahead ? vec3(middle, 1.0) : first ? vec3(turned, middle.x, middle.y + 1.0) : vec3(middle.x, turned, middle.y + 1.0);
}
// Whether what the pixel along `way` shows is between the light and the receiver; `share`: how far it is from the light, of the way to the receiver.
bool lwIsHidden(vec3 receiver, vec3 normal, vec3 way, float slack, out float share) {
  float nearness;
  vec3 line = lwPixelAlong(way, nearness);
  float along = dot(receiver, line) / dot(line, line), seen = u_light[6].x / max(nearness, 1e-30);  // along: where the line is next to the receiver
  share = seen / max(along, 1e-30);
  return nearness > 0.0 && share < 1.0 && dot(normal, line * seen - receiver) > 0.1 * length(receiver - line * along) + slack;
}
// `a`, `b`: the receiver's axes.
float lwVisible(vec3 position, vec3 normal, vec3 surface, vec3 a, vec3 b, float half_side) {
  if (u_light[6].y < 1.0) return 1.0;
  mat3 frame = transpose(mat3(u_light[3].xyz, u_light[4].xyz, u_light[2].xyz));
  vec3 middle = frame * (position - u_light[0].xyz);
  normal = frame * normal;
  surface = frame * surface;
  a = frame * a * 1.7320508;
  b = frame * b * 1.7320508;
  float distance = length(middle), slack = 1e-4 * distance + 0.02 * half_side;
  // Within a pixel of the map: a square across the way.
  vec3 across = normalize(abs(middle.z) > 0.5 * distance ? cross(middle, vec3(1.0, 0.0, 0.0)) : cross(middle, vec3(0.0, 0.0, 1.0)));
  vec3 other = cross(across, middle / distance);
  float pixel = 2.0 * distance / u_light[6].y;
  uint key = lwHash(uint(lwIndex()) ^ floatBitsToUint(u_light[7].y));
  int first = int(key & 31u), blockers = int(u_light[6].z), filters = int(u_light[6].w);
  vec2 shift = vec2(float(key >> 20), float((key >> 8) & 4095u)) / 4096.0;
  float sum = 0.0, found = 0.0, hidden = 0.0, share;
  for (int i = 0; i < 32; ++i) {
    if (i >= blockers) break;
    float t = float(i) / float(blockers), reach = 3.0 * t * t;
    vec2 at = fract(shift + float(i) * vec2(0.7548776662, 0.5698402910)) - 0.5, on = 2.0 * fract(shift + float(i) * vec2(0.8191725134, 0.6710436067)) - 1.0;
    vec3 receiver = middle + on.x * a + on.y * b;
    vec3 way = receiver + reach * u_light[16 + ((first + i) & 31)].xyz + pixel * (at.x * across + at.y * other);
    if (!lwIsHidden(receiver, surface, way, slack, share)) continue;
    float spread = 1.0 / max(share, 1e-4) - 1.0;
    hidden += 1.0;
    if (reach > 1.2 * spread) continue;
    sum += spread;
    found += 1.0;
  }
  if (blockers > 0 && hidden == 0.0) return 1.0;
  float spread = found > 0.0 ? min(sum / found, 1.0) : 0.0, all = 0.0, seen = 0.0;
  for (int i = 0; i < 32; ++i) {
    if (i >= filters) break;
    vec2 at = fract(shift + float(i) * vec2(0.7548776662, 0.5698402910)) - 0.5, on = 2.0 * fract(shift + float(i) * vec2(0.8191725134, 0.6710436067)) - 1.0;
    vec3 receiver = middle + on.x * a + on.y * b, point = u_light[16 + ((first + 7 + i) & 31)].xyz, to = point - receiver;
    float weight = max(dot(to, normal), 0.0) * (u_light[0].w == 3.0 ? 1.0 : max(-to.z, 0.0)) / max(pow(dot(to, to), u_light[0].w == 3.0 ? 1.5 : 2.0), 1e-30);
    all += weight;
    if (dot(to, surface) > 0.0 && !lwIsHidden(receiver, surface, receiver + spread * point + pixel * (at.x * across + at.y * other), slack, share)) seen += weight;
  }
  return all > 0.0 ? seen / all : 0.0;
}
void main() {
  o_irradiance = vec4(0.0);
  int value = lwIndex();
  if (value >= u_values) return;
  vec4 place = texelFetch(u_place, lwAddress(value), 0), normals = texelFetch(u_normal, lwAddress(value), 0);
  vec4 first = place.w * texelFetch(u_axes, lwAddress(value * 2), 0);
  vec3 normal = lwNormal(normals.xy), surface = lwNormal(normals.zw), a = first.xyz, b = place.w * texelFetch(u_axes, lwAddress(value * 2 + 1), 0).xyz;
  float epsilon = place.w * u_light[5].w, share = 0.0;
  // Near the light its irradiance is not even over the texel: the mean of four points with its covariance.
  vec3 way = place.xyz - u_light[1].xyz;
  float gap = max(length(way) - u_light[3].w, abs(dot(way, u_light[2].xyz)));
  if (8.0 * place.w > gap) {
    for (int i = 0; i < 4; ++i)
      share += 0.25 * lwUnitIrradiance(place.xyz + ((i & 1) == 0 ? a : -a) + ((i & 2) == 0 ? b : -b), normal, epsilon);
  } else {
    share = lwUnitIrradiance(place.xyz, normal, epsilon);
  }
  // Rays start on top of what is curved or folded, whose middle lies inside of it.
  if (share > 0.0) o_irradiance.rgb = clamp(u_light[5].rgb * (share * lwVisible(place.xyz + first.w * surface, normal, surface, a, b, place.w)), -1e30, 1e30);
}
)";

// The light map: all layers, each with its source's colour.
const char kVplShow[] = R"(
uniform sampler2DArray u_layer;
uniform usampler2D u_shown;
uniform vec4 u_weight[33];
uniform int u_layers;
uniform float u_max;
out vec4 o_irradiance;
void main() {
  uint value = texelFetch(u_shown, ivec2(gl_FragCoord.xy), 0).r;
  o_irradiance = vec4(0.0);
  if (value == 0xffffffffu) return;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 33; ++i) {
    if (i >= u_layers) break;
    sum += u_weight[i].rgb * max(texelFetch(u_layer, ivec3(lwPixel(int(value)), i), 0).rgb, 0.0);  // what is left of differences is no light
  }
  o_irradiance = vec4(min(sum, u_max), 1.0);
}
)";

}  // namespace lightwell::runtime::gl::glsl
