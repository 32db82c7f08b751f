#include "render/shadow_maps.h"

#include <algorithm>
#include <cstring>

#include "render/error.h"
#include "render/shaders.h"

namespace lightwell::render {
namespace {

constexpr float kPi = 3.14159265f;
// Entry points are looked up with one filtered tap: moved by so many texels, none is shadowed by its own surface.
constexpr float kEntryOffset = 1.5f;
// A wider spot would waste its map on the rim; it gets a cube.
constexpr float kWidestSpot = 65 * kPi / 180;

/// Texels per side, so that all maps together stay below about a quarter of a gigabyte for a hundred lights.
int resolutionFor(size_t light_count, uint32_t shadow) {
  const int cube = light_count <= 4 ? 1024 : light_count <= 16 ? 512 : 256;
  return shadow == LW_GL_SHADOW_CUBE ? cube : light_count <= 4 ? 4 * cube : 2 * cube;
}

uint32_t shadowKind(const lw_light& light) {
  const bool cube = light.type == LW_LIGHT_POINT || (light.type == LW_LIGHT_SPOT && light.outer_cone_angle_rad > kWidestSpot);
  return cube ? LW_GL_SHADOW_CUBE : LW_GL_SHADOW_2D;
}

/// Whether the map made for `a` serves `b` as well: everything but colour, brightness and the inner cone is equal.
bool sameShadow(const lw_light& a, const lw_light& b) {
  return a.type == b.type && std::memcmp(a.position_m, b.position_m, sizeof a.position_m) == 0 &&
         std::memcmp(a.direction, b.direction, sizeof a.direction) == 0 && a.outer_cone_angle_rad == b.outer_cone_angle_rad;
}

Float3 vector(const float v[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

ShadowMaps::ShadowMaps(const SceneMesh& mesh)
    : mesh_(mesh), program_(kSceneVertexGlsl, std::string(kAlphaGlsl) + kDepthFragmentGlsl), framebuffer_(Framebuffer::make()) {}

void ShadowMaps::update(std::span<const lw_light> lights) {
  std::vector<ShadowMap> next;
  for (const lw_light& light : lights) {
    const int resolution = resolutionFor(lights.size(), shadowKind(light));
    const auto kept = std::find_if(maps_.begin(), maps_.end(), [&](const ShadowMap& map) {
      return map.texture && map.resolution == resolution && sameShadow(map.light.light, light);
    });
    next.push_back(kept != maps_.end() ? std::move(*kept) : render(light, resolution));
    next.back().light.light = light;
  }
  maps_ = std::move(next);
}

ShadowMap ShadowMaps::render(const lw_light& light, int resolution) const {
  ShadowMap map;
  map.light = LW_GL_LIGHT_INIT;
  map.light.light = light;
  map.light.shadow = shadowKind(light);
  map.resolution = resolution;
  map.texture = Texture::make();
  map.light.shadow_texture = map.texture;
  const bool cube = map.light.shadow == LW_GL_SHADOW_CUBE;
  const GLenum target = cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D;
  bindTexture(0, target, map.texture);
  for (int face = 0; face < (cube ? 6 : 1); ++face)
    glTexImage2D(cube ? GLenum(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face) : target, 0, GL_DEPTH_COMPONENT24, resolution, resolution, 0,
                 GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(target, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(target, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);

  GLint previous = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &previous);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
  glViewport(0, 0, resolution, resolution);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_POLYGON_OFFSET_FILL);  // pushed back, a wall would leak light into the corner behind it
  if (cube) renderCube(map);
  else render2D(map);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(previous));
  return map;
}

void ShadowMaps::renderCube(ShadowMap& map) const {
  static constexpr Float3 kForward[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  static constexpr Float3 kUp[6] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
  const Float3 eye = vector(map.light.light.position_m);
  map.light.near_m = 1e-3f * mesh_.diagonal_m();
  map.light.far_m = std::max(1.05f * mesh_.farthest_m(eye), 2 * map.light.near_m);
  map.texel_slope = 2.0f / float(map.resolution);
  // Depth is not linear: a bias that is right near the light hides contacts far from it. The offset along the normal does the work.
  map.light.depth_bias = 1e-6f;
  map.light.normal_offset_m = kEntryOffset * map.texel_slope * 0.5f * mesh_.diagonal_m();
  const Matrix4 projection = perspective(1, 1, map.light.near_m, map.light.far_m);
  for (size_t face = 0; face < 6; ++face) {
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GLenum(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face), map.texture, 0);
    drawDepth(projection * lookAlong(eye, kForward[face], kUp[face]));
  }
}

void ShadowMaps::render2D(ShadowMap& map) const {
  const lw_light& light = map.light.light;
  const Float3 forward = normalized(vector(light.direction)), up = perpendicular(forward);
  Matrix4 view_projection;
  if (light.type == LW_LIGHT_SPOT) {
    const Float3 eye = vector(light.position_m);
    const float slope = std::tan(light.outer_cone_angle_rad) * 1.02f, near = 1e-3f * mesh_.diagonal_m();
    map.light.near_m = near;
    map.light.far_m = std::max(1.05f * mesh_.farthest_m(eye), 2 * near);
    map.texel_slope = 2 * slope / float(map.resolution);
    map.light.depth_bias = 1e-6f;
    map.light.normal_offset_m = kEntryOffset * map.texel_slope * 0.5f * mesh_.diagonal_m();
    view_projection = perspective(slope, slope, near, map.light.far_m) * lookAlong(eye, forward, up);
  } else {
    const float radius = 0.51f * mesh_.diagonal_m();
    map.texel_slope = 2 * radius / float(map.resolution);
    map.light.depth_bias = 1e-5f;
    map.light.normal_offset_m = kEntryOffset * map.texel_slope;
    view_projection = orthographic(radius, radius, 0, 2 * radius) * lookAlong(mesh_.center_m() - forward * radius, forward, up);
  }
  std::copy(view_projection.begin(), view_projection.end(), map.light.shadow_matrix);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map.texture, 0);
  drawDepth(view_projection);
}

void ShadowMaps::drawDepth(const Matrix4& view_projection) const {
  glClear(GL_DEPTH_BUFFER_BIT);
  program_.use();
  program_.set("view_projection", view_projection);
  mesh_.draw(SceneMesh::Kind::solid, program_, 0, false);
  mesh_.draw(SceneMesh::Kind::blended, program_, 0, false);
}

}  // namespace lightwell::render
