#include "render/scene_mesh.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "render/error.h"

namespace lightwell::render {
namespace {

constexpr uint16_t kOpaque = 0xffff;

template <class T>
std::vector<T> decode(const lw_container* container, lw_array array) {
  lw_array_info info{};
  check(lw_get_array_info(container, array, &info), "the container's geometry");
  std::vector<T> values(info.bytes / sizeof(T));
  if (!values.empty()) check(lw_decode_array(container, array, values.data(), info.bytes), "the container's geometry");
  return values;
}

bool hasArray(const lw_container* container, lw_array array) {
  lw_array_info info{};
  return lw_get_array_info(container, array, &info) == LW_OK;
}

template <class T>
Buffer upload(GLenum target, const std::vector<T>& values) {
  Buffer buffer = Buffer::make();
  glBindBuffer(target, buffer);
  glBufferData(target, GLsizeiptr(values.size() * sizeof(T)), values.data(), GL_STATIC_DRAW);
  return buffer;
}

GLint wrapMode(uint32_t wrap) {
  return wrap == LW_WRAP_CLAMP ? GL_CLAMP_TO_EDGE : wrap == LW_WRAP_MIRROR ? GL_MIRRORED_REPEAT : GL_REPEAT;
}

}  // namespace

SceneMesh::SceneMesh(const lw_container* container, std::vector<Leaf> leaves) : leaves_(std::move(leaves)) {
  check(lw_get_scene_info(container, &info_), "the container's scene");
  const Float3 low{info_.bounds_min_m[0], info_.bounds_min_m[1], info_.bounds_min_m[2]};
  const Float3 high{info_.bounds_max_m[0], info_.bounds_max_m[1], info_.bounds_max_m[2]};
  if (low[0] <= high[0]) {
    center_m_ = (low + high) * 0.5f;
    diagonal_m_ = std::max(length(high - low), 1e-6f);
  }
  const uint8_t opaque = 255;
  const float black[3] = {};
  opaque_ = makeTexture2D(GL_R8, 1, 1, GL_RED, GL_UNSIGNED_BYTE, &opaque, GL_NEAREST);
  emission_ = makeTexture2D(GL_RGB16F, 1, 1, GL_RGB, GL_FLOAT, black, GL_NEAREST);
  if (lw_has_section(container, "geometry")) loadGeometry(container);
  if (lw_has_section(container, "atlas")) loadAtlas(container);
}

float SceneMesh::farthest_m(const Float3& from) const {
  float farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Float3 p;
    for (size_t axis = 0; axis < 3; ++axis) p[axis] = corner >> axis & 1 ? info_.bounds_max_m[axis] : info_.bounds_min_m[axis];
    farthest = std::max(farthest, length(p - from));
  }
  return farthest;
}

void SceneMesh::loadGeometry(const lw_container* container) {
  const auto index = decode<std::array<uint32_t, 3>>(container, LW_ARRAY_INDEX);
  const auto flags = decode<uint8_t>(container, LW_ARRAY_TRIANGLE_FLAGS);
  const bool has_alpha = hasArray(container, LW_ARRAY_TRIANGLE_ALPHA);
  const auto alpha = has_alpha ? decode<uint16_t>(container, LW_ARRAY_TRIANGLE_ALPHA) : std::vector<uint16_t>(index.size(), kOpaque);
  if (flags.size() != index.size() || alpha.size() != index.size())
    throw RenderError(LW_BAD_SECTION, "the container's geometry: arrays per triangle differ in length");

  // Triangles of equal state in one run; blended ones last, otherwise in file order.
  std::vector<uint32_t> order(index.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto leafOf = [&](uint32_t t) {
    uint32_t leaf = 0;
    while (leaf < leaves_.size() && t - leaves_[leaf].first_triangle >= leaves_[leaf].triangle_count) ++leaf;
    return leaf;
  };
  const auto state = [&](uint32_t t) {
    return std::tuple(flags[t] & LW_TRIANGLE_BLEND, flags[t] & LW_TRIANGLE_DOUBLE_SIDED, alpha[t], leafOf(t));
  };
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return state(a) < state(b); });
  std::vector<std::array<uint32_t, 3>> sorted;
  sorted.reserve(index.size());
  for (uint32_t t : order) {
    if (batches_.empty() || state(t) != state(order[batches_.back().first_triangle]))
      batches_.push_back({flags[t], alpha[t], leafOf(t), uint32_t(sorted.size()), 0});
    ++batches_.back().triangle_count;
    sorted.push_back(index[t]);
  }

  vertex_array_ = VertexArray::make();
  glBindVertexArray(vertex_array_);
  const auto attribute = [&](GLuint location, lw_array array, GLint components) {
    buffers_.push_back(upload(GL_ARRAY_BUFFER, decode<float>(container, array)));
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, 0, nullptr);
  };
  attribute(0, LW_ARRAY_POSITION, 3);
  attribute(1, LW_ARRAY_NORMAL, 3);
  attribute(2, LW_ARRAY_LIGHTMAP_UV, 2);
  if (has_alpha) attribute(3, LW_ARRAY_ALPHA_UV, 2);
  buffers_.push_back(upload(GL_ELEMENT_ARRAY_BUFFER, sorted));
  glBindVertexArray(0);
  loadAlphaMaterials(container, alpha);
}

void SceneMesh::loadAlphaMaterials(const lw_container* container, const std::vector<uint16_t>& triangle_alpha) {
  uint32_t count = 0;
  for (uint16_t material : triangle_alpha)
    if (material != kOpaque) count = std::max(count, uint32_t(material) + 1);
  if (count == 0) return;
  std::vector<lw_alpha_material> materials(count);
  check(lw_get_alpha_materials(container, count, materials.data()), "the container's alpha materials");
  for (const lw_alpha_material& values : materials) {
    AlphaMaterial& material = alpha_materials_.emplace_back();
    material.values = values;
    if (material.values.texture < 0) continue;
    std::vector<uint8_t> texels(size_t(material.values.texture_width) * material.values.texture_height);
    check(lw_decode_alpha_texture(container, uint32_t(material.values.texture), texels.data(), texels.size()), "an alpha texture");
    material.texture = makeTexture2D(GL_R8, int(material.values.texture_width), int(material.values.texture_height), GL_RED,
                                     GL_UNSIGNED_BYTE, texels.data(), GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrapMode(material.values.wrap_u));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrapMode(material.values.wrap_v));
  }
}

void SceneMesh::loadAtlas(const lw_container* container) {
  lw_atlas_info atlas{};
  check(lw_get_atlas_info(container, &atlas), "the container's atlas");
  if (hasArray(container, LW_ARRAY_ATLAS_ALBEDO)) {
    const auto rgb = decode<uint8_t>(container, LW_ARRAY_ATLAS_ALBEDO);
    albedo_ = makeTexture2D(GL_SRGB8, int(atlas.width), int(atlas.height), GL_RGB, GL_UNSIGNED_BYTE, rgb.data(), GL_LINEAR);
  }
  if (hasArray(container, LW_ARRAY_ATLAS_EMISSION)) {
    const auto rgb = decode<float>(container, LW_ARRAY_ATLAS_EMISSION);
    emission_ = makeTexture2D(GL_RGB16F, int(atlas.width), int(atlas.height), GL_RGB, GL_FLOAT, rgb.data(), GL_LINEAR);
  }
}

void SceneMesh::draw(Kind kind, const Program& program, int alpha_unit, bool cull) const {
  if (batches_.empty()) return;
  glBindVertexArray(vertex_array_);
  program.set("alpha_texture", alpha_unit);
  for (const Batch& batch : batches_) {
    if (bool(batch.flags & LW_TRIANGLE_BLEND) != (kind == Kind::blended)) continue;
    const bool has_alpha = batch.alpha_material != kOpaque;
    const lw_alpha_material opaque{0, 0, 1, -1, 0, 0, 0, 0};
    const lw_alpha_material& alpha = has_alpha ? alpha_materials_[batch.alpha_material].values : opaque;
    bindTexture(alpha_unit, GL_TEXTURE_2D, alpha.texture >= 0 ? alpha_materials_[batch.alpha_material].texture : opaque_);
    program.set("alpha_factor", alpha.factor);
    program.set("alpha_cutoff", alpha.mode == LW_ALPHA_MASK ? alpha.cutoff : 0.0f);
    program.set("alpha_blend", alpha.mode == LW_ALPHA_BLEND ? 1.0f : 0.0f);
    const Leaf leaf = batch.leaf < leaves_.size() ? leaves_[batch.leaf] : Leaf{};
    program.set4("leaf", std::array{leaf.axis_per_m[0], leaf.axis_per_m[1], leaf.axis_per_m[2], leaf.offset}.data());
    program.set("leaf_open", leaf.open);
    if (cull && !(batch.flags & LW_TRIANGLE_DOUBLE_SIDED)) glEnable(GL_CULL_FACE);
    else glDisable(GL_CULL_FACE);
    glDrawElements(GL_TRIANGLES, GLsizei(batch.triangle_count * 3), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(size_t(batch.first_triangle) * 3 * sizeof(uint32_t)));
  }
  glBindVertexArray(0);
}

}  // namespace lightwell::render
