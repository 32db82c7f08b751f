#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

const char kRadiosityPatches[] = R"(
uniform sampler2DArray u_albedo, u_emitted, u_kept;  // kept: what blockers leave
uniform sampler2D u_direct, u_irradiance;
uniform int u_patches, u_light;       // 1: reflected, 2: emitted
out vec4 o_radiosity;
void main() {
  int i = lwIndex();
  if (i >= u_patches) discard;
  vec3 radiosity = vec3(0.0);
  if ((u_light & 2) != 0) radiosity = texelFetch(u_emitted, lwAddress(i), 0).rgb;
  if ((u_light & 1) != 0)
    radiosity += texelFetch(u_albedo, lwAddress(i), 0).rgb * (texelFetch(u_direct, lwPixel(i), 0).rgb + texelFetch(u_kept, lwAddress(i), 0).rgb * texelFetch(u_irradiance, lwPixel(i), 0).rgb);
  o_radiosity = vec4(clamp(radiosity, vec3(-1e26), vec3(1e26)), 1.0);
}
)";

// Nodes [begin, end) of a level as means over their children, eight each; or, without children, as they are in the texture.
const char kRadiosityNodes[] = R"(
uniform sampler2D u_node;
uniform sampler2DArray u_share;       // of a node's area in its parent's
uniform int u_begin, u_end, u_child_begin;
out vec4 o_radiosity;
void main() {
  int i = lwIndex();
  if (i < u_begin || i >= u_end) discard;
  if (u_child_begin < 0) {
    o_radiosity = texelFetch(u_node, lwPixel(i), 0);
    return;
  }
  int child = u_child_begin + (i - u_begin) * 8, end = min(child + 8, u_begin);
  vec3 sum = vec3(0.0);
  for (; child < end; ++child) sum += texelFetch(u_share, lwAddress(child), 0).r * texelFetch(u_node, lwPixel(child), 0).rgb;
  o_radiosity = vec4(sum, 1.0);
}
)";

// One sweep: previous + omega (gathered - previous). Plain sweeps have omega 1.
const char kRadiosityGather[] = R"(
uniform usampler2DArray u_link;       // node << 8 | code
uniform usampler2DArray u_row;        // first run, end run, first link, bits of the scale
uniform usampler2DArray u_run;        // end link, gate set
uniform sampler2DArray u_gate;        // how much links of a set count
uniform sampler2D u_node, u_previous;
uniform int u_patches;
uniform vec4 u_omega;
out vec4 o_irradiance;
void main() {
  int i = lwIndex();
  if (i >= u_patches) discard;
  uvec4 row = texelFetch(u_row, lwAddress(i), 0);
  vec3 sum = vec3(0.0);
  int l = int(row.z);
  for (int r = int(row.x); r < int(row.y); ++r) {
    uvec2 run = texelFetch(u_run, lwAddress(r), 0).rg;
    float factor = texelFetch(u_gate, lwAddress(int(run.y)), 0).r;
    int end = int(run.x);
    vec3 part = vec3(0.0);
    if (factor > 0.0) {
      for (; l < end; ++l) {
        uint link = texelFetch(u_link, lwAddress(l), 0).r;
        part += float((16u + (link & 15u)) << ((link >> 4u) & 15u)) * texelFetch(u_node, lwPixel(int(link >> 8u)), 0).rgb;
      }
    }
    sum += factor * part;
    l = end;
  }
  vec3 previous = texelFetch(u_previous, lwPixel(i), 0).rgb;
  vec3 result = previous + u_omega.rgb * (sum * uintBitsToFloat(row.w) - previous);
  o_irradiance = vec4(clamp(result, vec3(-1e26), vec3(1e26)), 1.0);
}
)";

const char kRadiosityShade[] = R"(
uniform usampler2D u_texel_map;
uniform usampler2DArray u_texel_patch, u_texel_weight;
uniform sampler2D u_irradiance, u_emitters, u_direct;
uniform int u_fill;
uniform vec4 u_amounts;               // of the light from patches, of the emitters' part of it, of lights
uniform float u_max;
out vec4 o_irradiance;
void main() {
  uvec2 entry = texelFetch(u_texel_map, ivec2(gl_FragCoord.xy), 0).rg;
  uint value = u_fill != 0 ? entry.r : entry.g;
  o_irradiance = vec4(0.0);
  if (value == 0xffffffffu) return;
  uvec4 patches = texelFetch(u_texel_patch, lwAddress(int(value)), 0);
  uvec2 weights = texelFetch(u_texel_weight, lwAddress(int(value)), 0).rg;
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    if (patches[k] == 0xffffffffu) continue;
    ivec2 at = lwPixel(int(patches[k]));
    vec3 others = u_amounts.x * max(texelFetch(u_irradiance, at, 0).rgb, vec3(0.0)) + u_amounts.y * texelFetch(u_emitters, at, 0).rgb;
    sum += float((weights.r >> uint(8 * k)) & 255u) * (max(others, vec3(0.0)) + u_amounts.z * texelFetch(u_direct, at, 0).rgb);
  }
  sum *= (u_fill != 0 ? 1.0 : float(weights.g) / 255.0) / 255.0;
  o_irradiance = vec4(min(sum, vec3(u_max)), 1.0);
}
)";

}  // namespace lightwell::runtime::gl::glsl
