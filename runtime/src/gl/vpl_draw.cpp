// One virtual light on all texels.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/gl/vpl_gl.h"

namespace lightwell::runtime::gl {
namespace {

constexpr uint32_t kLightPoints = 32;
constexpr float kEyeOffset = 4e-6f, kNear = 1e-6f;  // of the scene's extent: how far above its surface a light sees from, and from where on

/// What kVplIrradiance and kVplLight take: an array of vec4.
struct LightBlock {
  float eye_m[3], type;
  float position_m[3], unused;
  float normal[3], area_m2;
  float tangent[3], radius_m;   // of polygons: their reach
  float bitangent[3], vertices;
  float flux_rgb[3], epsilon;   // in halves of a texel's side
  float near_m, side, blockers, filters;
  float unused2, seed, unused3[2];
  float vertex_m[kMostPolygonVertices][4];
  float point_m[kLightPoints][4];  // in the light's frame, about its middle
};
static_assert(sizeof(LightBlock) == 48 * 4 * sizeof(float));

void put(float* to, Float3 v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

LightBlock blockOf(const lw_gl_vpl& vpl, const VplDraw& draw) {
  const LightPiece& piece = *draw.piece;
  LightBlock block{};
  const Float3 n = piece.normal;
  const float sign = std::copysign(1.0f, n.z), c = -1 / (sign + n.z), d = n.x * n.y * c;  // Duff et al. 2017
  const Float3 tangent{1 + sign * n.x * n.x * c, sign * d, -sign * n.x}, bitangent{d, sign + n.y * n.y * c, -n.y};
  put(block.eye_m, piece.position_m + n * (kEyeOffset * vpl.extent_m));
  put(block.position_m, piece.position_m);
  put(block.normal, n);
  put(block.tangent, tangent);
  put(block.bitangent, bitangent);
  block.type = float(piece.type), block.area_m2 = piece.area_m2, block.radius_m = piece.reach_m, block.vertices = float(piece.vertex_count);
  for (int k = 0; k < 3; ++k) block.flux_rgb[k] = piece.flux_rgb[k] * draw.factor_rgb[k];
  block.epsilon = 2 * vpl.options.epsilon;
  block.near_m = kNear * vpl.extent_m;
  block.side = vpl.triangles > 0 ? float(vpl.options.shadow_map_side) : 0.0f;
  block.blockers = float(vpl.options.blocker_samples), block.filters = float(vpl.options.filter_samples);
  block.seed = piece.position_m.x + piece.position_m.y + piece.position_m.z;
  for (uint32_t i = 0; i < piece.vertex_count; ++i) put(block.vertex_m[i], piece.vertex_m[i]);
  const lw_virtual_light light = publicLight(piece);
  for (uint32_t i = 0; i < kLightPoints; ++i) {
    // Roberts' sequence (2018): any run of its points is spread evenly.
    const double u = 0.5 + 0.7548776662466927 * i, v = 0.5 + 0.5698402909980532 * i;
    const float uv[2] = {float(u - std::floor(u)), float(v - std::floor(v))};
    float at[3];
    lw_virtual_light_point(&light, uv, at);
    const Float3 offset = Float3{at[0], at[1], at[2]} - piece.position_m;
    put(block.point_m[i], {dot(tangent, offset), dot(bitangent, offset), dot(n, offset)});
  }
  return block;
}

/// The five faces of the half cube: what their right, up and forward are of tangent, bitangent and normal, and where they lie, in halves of a side.
struct Face {
  int8_t right[3], up[3], forward[3];
  uint8_t x, y;
};
constexpr Face kFaces[] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0, 0},
                           {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, 2, 0},
                           {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, 2, 1},
                           {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0, 2},
                           {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, 2, 2}};

void drawFace(const lw_gl_vpl& vpl, const LightBlock& block, const Program& program, const Face& face, uint32_t first_triangle, uint32_t triangles) {
  const Api& api = vpl.context->api;
  const bool is_half = face.up[2] != 0;
  const auto axis = [&](const int8_t* of, float scale, float w, int32_t uniform) {
    float v[4];
    for (int k = 0; k < 3; ++k) v[k] = scale * (float(of[0]) * block.tangent[k] + float(of[1]) * block.bitangent[k] + float(of[2]) * block.normal[k]);
    v[3] = w;
    api.Uniform4fv(uniform, 1, v);
  };
  const float eye[4] = {block.eye_m[0], block.eye_m[1], block.eye_m[2], block.near_m};
  api.UseProgram(program.name);
  axis(face.right, 1, 0, program.uniform[vpl_depth_uniform::right]);
  axis(face.up, is_half ? 2 : 1, is_half ? 1 : 0, program.uniform[vpl_depth_uniform::up]);
  axis(face.forward, 1, float(vpl.opaque_triangles * 3), program.uniform[vpl_depth_uniform::forward]);
  api.Uniform4fv(program.uniform[vpl_depth_uniform::eye], 1, eye);
  const auto side = int32_t(vpl.options.shadow_map_side), half = side / 2;
  api.Viewport(face.x * half, face.y * half, side, is_half ? half : side);
  api.DrawArrays(kTriangles, int32_t(first_triangle * 3), int32_t(triangles * 3));
}

void bindLists(const Api& api, std::initializer_list<Name> names) {
  uint32_t unit = 0;
  for (const Name name : names) {
    api.ActiveTexture(kTexture0 + unit++);
    api.BindTexture(kTexture2dArray, name);
  }
}

void drawDepths(const lw_gl_vpl& vpl, const LightBlock& block) {
  const Api& api = vpl.context->api;
  constexpr float kFarthest = 0;
  bindLists(api, {vpl.corner, vpl.alpha_corner, vpl.alpha_material, vpl.alpha});
  api.BindFramebuffer(kDrawFramebuffer, vpl.depth_map.framebuffer);
  api.Enable(kDepthTest);
  api.ClearBufferfv(kDepth, 0, &kFarthest);
  const uint32_t with_alpha = vpl.triangles - vpl.opaque_triangles;
  for (const Face& face : kFaces) {
    if (vpl.opaque_triangles > 0) drawFace(vpl, block, vpl.depth, face, 0, vpl.opaque_triangles);
    if (with_alpha > 0) drawFace(vpl, block, vpl.depth_alpha, face, vpl.opaque_triangles, with_alpha);
  }
  api.Disable(kDepthTest);
}

}  // namespace

void drawPiece(const lw_gl_vpl& vpl, const VplDraw& draw, Name framebuffer, const SumGuard& sum) {
  const Api& api = vpl.context->api;
  const LightBlock block = blockOf(vpl, draw);
  if (block.side > 0) drawDepths(vpl, block);
  const Program& program = vpl.light;
  api.UseProgram(program.name);
  api.Uniform4fv(program.uniform[vpl_light_uniform::light], 48, reinterpret_cast<const float*>(&block));
  api.Uniform1i(program.uniform[vpl_light_uniform::values], int32_t(vpl.values));
  bindLists(api, {vpl.place, vpl.normal, vpl.axes});
  api.ActiveTexture(kTexture0 + 3);
  api.BindTexture(kTexture2d, vpl.depth_map.texture);
  api.BindFramebuffer(kDrawFramebuffer, framebuffer);
  api.Viewport(0, 0, vpl.layer_width, vpl.layer_height);
  sum.blend(true);
  api.DrawArrays(kTriangles, 0, 3);
  sum.blend(false);
}

}  // namespace lightwell::runtime::gl
