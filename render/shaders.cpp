#include "render/shaders.h"

namespace lightwell::render {

// `invariant`: the passes of the lights meet exactly the depth of the first pass. `centroid`: no multisampled pixel looks up the
// light map beyond its triangle, where another chart may be.
const char* const kSceneVertexGlsl = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 lightmap_uv;
layout(location = 3) in vec2 alpha_uv;
uniform mat4 view_projection;
invariant gl_Position;
out vec3 v_position;
out vec3 v_normal;
centroid out vec2 v_lightmap_uv;
out vec2 v_alpha_uv;
void main() {
  gl_Position = view_projection * vec4(position, 1.0);
  v_position = position;
  v_normal = normal;
  v_lightmap_uv = lightmap_uv;
  v_alpha_uv = alpha_uv;
}
)";

const char* const kAlphaGlsl = R"(
in vec3 v_position;
in vec3 v_normal;
centroid in vec2 v_lightmap_uv;
in vec2 v_alpha_uv;
uniform sampler2D alpha_texture;
uniform float alpha_factor, alpha_cutoff, alpha_blend;
uniform vec4 leaf;         // of a door: what is left of it is where leaf.xyz * position + leaf.w >= leaf_open
uniform float leaf_open;
float surfaceAlpha() {
  if (dot(leaf.xyz, v_position) + leaf.w < leaf_open) discard;
  float alpha = alpha_factor * texture(alpha_texture, v_alpha_uv).r;
  if (alpha < alpha_cutoff) discard;
  return mix(1.0, alpha, alpha_blend);
}
)";

const char* const kDepthFragmentGlsl = R"(
void main() {
  if (surfaceAlpha() < 0.5) discard;
}
)";

// Radiance is multiplied by the exposure before it is stored, so that half floats hold any scene.
const char* const kBaseFragmentGlsl = R"(
uniform sampler2D albedo_atlas, emission_atlas, irradiance_atlas;
uniform float uniform_albedo;   // negative: the atlas's
uniform float emission_scale;
uniform float exposure;
out vec4 color;
void main() {
  float alpha = surfaceAlpha();
  vec3 albedo = uniform_albedo < 0.0 ? texture(albedo_atlas, v_lightmap_uv).rgb : vec3(uniform_albedo);
  vec3 radiance = lwDiffuseRadiance(albedo, lwAtlasIrradiance(irradiance_atlas, v_lightmap_uv));
  radiance += texture(emission_atlas, v_lightmap_uv).rgb * emission_scale;
  color = vec4(min(radiance * exposure, vec3(60000.0)) * alpha, alpha);
}
)";

// Percentage-closer filtering over 4 x 4 taps, each filtered by the hardware: a smooth kernel five texels wide. The receiver is
// moved along its geometric normal by the kernel's radius times the sine of the angle of incidence, just enough that a plane does not
// shadow itself.
const char* const kLightFragmentGlsl = R"(
uniform LwLight light;
uniform sampler2D albedo_atlas;
uniform float uniform_albedo;
uniform float exposure;
uniform float texel_slope, depth_bias;
uniform mat4 shadow_matrix;
uniform vec2 shadow_planes;
#ifdef SHADOW_CUBE
uniform samplerCubeShadow shadow_map;
#else
uniform sampler2DShadow shadow_map;
uniform float shadow_texel;   // of texture coordinates
#endif
out vec4 color;

const float kKernelRadius = 3.6;   // of its corners: two and a half texels each way

// The penumbra lies wholly in the light: what is exactly at an edge is dark. Walls without thickness then leak no light at their corners.
float withinLight(float lit) { return clamp(2.0 * lit - 1.0, 0.0, 1.0); }

vec3 movedOff(vec3 position, vec3 geometric_normal, vec3 to_light, float texel_m) {
  float cosine = dot(geometric_normal, to_light);
  return position + geometric_normal * (texel_m * (0.5 + kKernelRadius * sqrt(max(0.0, 1.0 - cosine * cosine))));
}

#ifdef SHADOW_CUBE
float largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

float visibility(vec3 geometric_normal) {
  vec3 offset = v_position - light.position_range.xyz;
  vec3 size = abs(offset);
  float texel_m = texel_slope * largest(size);
  offset = movedOff(v_position, geometric_normal, -normalize(offset), texel_m) - light.position_range.xyz;
  size = abs(offset);
  float z = largest(size);
  if (z >= shadow_planes.y) return 1.0;
  vec3 side = size.x >= z ? vec3(0, 1, 0) : vec3(1, 0, 0);
  vec3 other = size.z >= z ? vec3(0, 1, 0) : vec3(0, 0, 1);
  float lit = 0.0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      // A tap may fall on the neighbouring face, whose depth is along another axis.
      vec3 tap = offset + (side * (float(x) - 1.5) + other * (float(y) - 1.5)) * texel_m;
      float depth = shadow_planes.y / (shadow_planes.y - shadow_planes.x) * (1.0 - shadow_planes.x / largest(abs(tap)));
      lit += texture(shadow_map, vec4(tap, depth - depth_bias));
    }
  return withinLight(lit / 16.0);
}
#else
float visibility(vec3 geometric_normal) {
  bool directional = light.direction_type.w > 2.5;
  float w = directional ? 1.0 : (shadow_matrix * vec4(v_position, 1.0)).w;
  vec3 to_light = directional ? -normalize(light.direction_type.xyz) : normalize(light.position_range.xyz - v_position);
  vec4 clip = shadow_matrix * vec4(movedOff(v_position, geometric_normal, to_light, texel_slope * w), 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec3 coordinate = clip.xyz / clip.w * 0.5 + 0.5;
  if (any(lessThan(coordinate, vec3(0.0))) || any(greaterThan(coordinate, vec3(1.0)))) return 1.0;
  coordinate.z -= depth_bias;
  float lit = 0.0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      lit += texture(shadow_map, vec3(coordinate.xy + (vec2(float(x), float(y)) - 1.5) * shadow_texel, coordinate.z));
  return withinLight(lit / 16.0);
}
#endif

void main() {
  float alpha = surfaceAlpha();
  vec3 normal = normalize(gl_FrontFacing ? v_normal : -v_normal);
  vec3 geometric_normal = cross(dFdx(v_position), dFdy(v_position));
  geometric_normal = dot(geometric_normal, geometric_normal) > 0.0 ? normalize(geometric_normal) : normal;
  if (dot(geometric_normal, normal) < 0.0) geometric_normal = -geometric_normal;
  vec3 irradiance = lwLightIrradiance(light, v_position, normal);
  if (max(irradiance.r, max(irradiance.g, irradiance.b)) > 0.0) irradiance *= visibility(geometric_normal);
  vec3 albedo = uniform_albedo < 0.0 ? texture(albedo_atlas, v_lightmap_uv).rgb : vec3(uniform_albedo);
  color = vec4(min(lwDiffuseRadiance(albedo, irradiance) * exposure, vec3(60000.0)) * alpha, 0.0);
}
)";

const char* const kEnvironmentFragmentGlsl = R"(
uniform sampler2D albedo_atlas;
uniform float uniform_albedo;
uniform float exposure;
out vec4 color;
void main() {
  float alpha = surfaceAlpha();
  vec3 normal = normalize(gl_FrontFacing ? v_normal : -v_normal);
  vec3 facing = cross(dFdx(v_position), dFdy(v_position));
  facing = dot(facing, facing) > 0.0 ? normalize(facing) : normal;
  if (dot(facing, normal) < 0.0) facing = -facing;
  vec3 irradiance = lwEnvironmentDiffuse(v_position, facing, normal);
  vec3 albedo = uniform_albedo < 0.0 ? texture(albedo_atlas, v_lightmap_uv).rgb : vec3(uniform_albedo);
  color = vec4(min(lwDiffuseRadiance(albedo, irradiance) * exposure, vec3(60000.0)) * alpha, 0.0);
}
)";

const char* const kEnvironmentPointFragmentGlsl = R"(
uniform sampler2D positions, facings, normals;   // one texel for each point
out vec4 color;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 normal = texelFetch(normals, at, 0).xyz;
  color = vec4(0.0);
  if (dot(normal, normal) > 0.0)
    color.rgb = lwEnvironmentDiffuse(texelFetch(positions, at, 0).xyz, texelFetch(facings, at, 0).xyz, normal);
}
)";

const char* const kBackgroundVertexGlsl = R"(
uniform vec3 forward, right, up;
out vec3 v_direction;
void main() {
  vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  v_direction = forward + right * at.x + up * at.y;
  gl_Position = vec4(at, 0.0, 1.0);
}
)";

const char* const kBackgroundFragmentGlsl = R"(
uniform float exposure;
in vec3 v_direction;
out vec4 color;
void main() { color = vec4(min(lwEnvironmentRadiance(normalize(v_direction)) * exposure, vec3(60000.0)), 1.0); }
)";

const char* const kLampVertexGlsl = R"(
uniform mat4 view_projection;
uniform vec3 center, right, up;
out vec2 v_offset;
void main() {
  v_offset = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  gl_Position = view_projection * vec4(center + right * v_offset.x + up * v_offset.y, 1.0);
}
)";

const char* const kLampFragmentGlsl = R"(
uniform vec3 hue;
in vec2 v_offset;
out vec4 color;
void main() {
  float r2 = dot(v_offset, v_offset);
  float glow = 6.0 * exp(-60.0 * r2) + 0.35 * exp(-7.0 * r2);
  color = vec4(hue * glow * smoothstep(1.0, 0.6, r2), 0.0);
}
)";

const char* const kScreenVertexGlsl = R"(
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

// The filmic curve is Stephen Hill's fit of the ACES reference rendering and output transforms; dividing by 0.6 keeps middle grey
// where it is, as common viewers do. `dither`: one least significant bit of triangular noise
// hides banding on a screen; a PNG is better off without.
const char* const kToneMapFragmentGlsl = R"(
uniform sampler2D radiance;
uniform float dither;
out vec4 color;

const mat3 kInput = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
const mat3 kOutput = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);

vec3 filmic(vec3 linear_rgb) {
  vec3 v = kInput * (linear_rgb / 0.6);
  v = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  return clamp(kOutput * v, 0.0, 1.0);
}

vec3 encodeSrgb(vec3 c) { return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308)))); }

float hash(uvec2 p) {
  uint h = p.x * 0x9e3779b9u ^ p.y * 0x85ebca6bu;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return float((h ^ (h >> 16)) & 0xffffu) / 65536.0;
}

void main() {
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  vec3 encoded = encodeSrgb(filmic(texelFetch(radiance, ivec2(pixel), 0).rgb));
  color = vec4(encoded + dither * (hash(pixel) + hash(pixel + 7919u) - 1.0) / 255.0, 1.0);
}
)";

}  // namespace lightwell::render
