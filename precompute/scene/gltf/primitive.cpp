#include "precompute/scene/gltf/primitive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/scene/gltf/accessor.h"
#include "precompute/scene/gltf/draco.h"
#include "precompute/scene/gltf/limits.h"
#include "precompute/scene/gltf/triangulate.h"

namespace lightwell::scene::gltf {
namespace {

/// Where the attributes of a primitive come from: its accessors, or a Draco mesh that replaces some of them.
class AttributeSource {
 public:
  AttributeSource(Document& document, const JsonValue& primitive) : document_(document), attributes_(primitive.at("attributes")) {
    if (const auto extension = primitive.extension("KHR_draco_mesh_compression")) draco_.emplace(document, primitive, *extension);
  }
  const std::optional<DracoMesh>& draco() const { return draco_; }

  /// Empty when the primitive has no such attribute. Throws when its length is not `count` (0: any).
  FloatElements read(const std::string& name, int min_components, int max_components, size_t count) {
    const auto reference = attributes_.find(name);
    if (!reference) return {};
    FloatElements elements = draco_ && draco_->has(name) ? draco_->read(name, *reference, min_components, max_components)
                                                         : readFloats(document_, *reference, min_components, max_components);
    if (count != 0 && elements.count != count)
      reference->fail("has " + std::to_string(elements.count) + " elements, but POSITION has " + std::to_string(count));
    return elements;
  }

 private:
  Document& document_;
  JsonValue attributes_;
  std::optional<DracoMesh> draco_;
};

std::vector<Vec3> toVec3(const FloatElements& elements) {
  std::vector<Vec3> result(elements.count);
  for (size_t i = 0; i < elements.count; ++i)
    result[i] = {elements.values[3 * i], elements.values[3 * i + 1], elements.values[3 * i + 2]};
  return result;
}

std::vector<Vec2> toVec2(const FloatElements& elements) {
  std::vector<Vec2> result(elements.count);
  for (size_t i = 0; i < elements.count; ++i) result[i] = {elements.values[2 * i], elements.values[2 * i + 1]};
  return result;
}

/// COLOR_0 is linear RGB or RGBA. Values outside [0, 1] have no meaning as a factor of reflectance and are clamped.
std::vector<std::array<float, 4>> toColors(const FloatElements& elements) {
  std::vector<std::array<float, 4>> result(elements.count, {0, 0, 0, 1});
  const auto width = size_t(elements.components);
  for (size_t i = 0; i < elements.count; ++i)
    for (size_t c = 0; c < width; ++c) result[i][c] = std::clamp(elements.values[i * width + c], 0.0f, 1.0f);
  return result;
}

/// Adds weight * displacement of every morph target (glTF 2.0, section 3.7.2.2).
void morph(Document& document, const JsonValue& primitive, const std::vector<double>& weights, const std::string& name,
           std::vector<Vec3>& values) {
  const auto targets = primitive.find("targets");
  if (!targets || values.empty()) return;
  for (size_t i = 0; i < std::min(targets->size(), weights.size()); ++i) {
    const auto reference = (*targets)[i].find(name);
    if (!reference || weights[i] == 0) continue;
    const FloatElements displacement = readFloats(document, *reference, 3, 3);
    if (displacement.count != values.size()) reference->fail("has another length than the attribute it displaces");
    for (size_t v = 0; v < values.size(); ++v)
      for (int axis = 0; axis < 3; ++axis) values[v][axis] += float(weights[i]) * displacement.values[3 * v + size_t(axis)];
  }
}

/// Makes normals unit length. Zero normals stay zero: the caller replaces them by the face's.
void normalizeNormals(std::vector<Vec3>& normals, const std::string& path, Diagnostics& diagnostics) {
  size_t repaired = 0;
  for (Vec3& n : normals) {
    const Vec3d wide(n);
    const double length = wide.length();
    if (std::abs(length - 1) > 0.01) ++repaired;
    n = length > 0 ? Vec3(wide / length) : Vec3(0);
  }
  if (repaired > 0) diagnostics.warn(path + ".attributes.NORMAL", std::to_string(repaired) + " normals are not of unit length; normalised");
}

std::vector<Vec2> textureCoordinates(AttributeSource& source, const TextureCoordinates* wanted, const std::string& path, size_t count,
                                     Diagnostics& diagnostics) {
  if (wanted == nullptr) return {};
  const std::string name = "TEXCOORD_" + std::to_string(wanted->set);
  std::vector<Vec2> uv = toVec2(source.read(name, 2, 2, count));
  if (uv.empty()) {
    diagnostics.warn(path, "its material has a texture, but there is no " + name + "; the texture is looked up at (0, 0)");
    uv.assign(count, Vec2(0));
  }
  for (Vec2& p : uv) p = wanted->apply(p);
  return uv;
}

}  // namespace

Vec2 TextureCoordinates::apply(const Vec2& uv) const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  const double u = scale[0] * uv.x, v = scale[1] * uv.y;
  return {float(c * u + s * v + offset[0]), float(-s * u + c * v + offset[1])};
}

size_t materialIndex(const Document& document, const JsonValue& primitive) {
  const auto material = primitive.find("material");
  return material ? material->index(document.count("materials"), "materials") : Primitive::kNoMaterial;
}

bool isSurface(const JsonValue& primitive) {
  const auto mode = primitive.find("mode");
  return !mode || mode->index(7, "primitive modes") >= size_t(TopologyMode::triangles);
}

Primitive readPrimitive(Document& document, const JsonValue& primitive, const WantedCoordinates& wanted, const std::vector<double>& weights,
                        Diagnostics& diagnostics) {
  Primitive result;
  result.path = primitive.path();
  result.material = materialIndex(document, primitive);
  AttributeSource source(document, primitive);
  if (!primitive.at("attributes").find("POSITION")) {
    diagnostics.warn(result.path, "has no POSITION and is left out");
    return result;
  }
  const JsonValue position = primitive.at("attributes").at("POSITION");
  result.positions = toVec3(source.read("POSITION", 3, 3, 0));
  const size_t count = result.positions.size();
  if (count == 0) return result;
  morph(document, primitive, weights, "POSITION", result.positions);
  for (const Vec3& p : result.positions)
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= kMaxCoordinateM)) position.fail("holds a coordinate that is absurdly large");

  result.normals = toVec3(source.read("NORMAL", 3, 3, count));
  morph(document, primitive, weights, "NORMAL", result.normals);
  normalizeNormals(result.normals, result.path, diagnostics);
  result.lightmap_uv = toVec2(source.read("TEXCOORD_1", 2, 2, count));
  result.colors = toColors(source.read("COLOR_0", 3, 4, count));
  result.base_uv = textureCoordinates(source, wanted.base, result.path, count, diagnostics);
  result.emissive_uv = textureCoordinates(source, wanted.emissive, result.path, count, diagnostics);

  std::vector<uint32_t> indices;
  const auto reference = primitive.find("indices");
  if (source.draco()) {
    indices = source.draco()->indices();
  } else if (reference) {
    indices = readIndices(document, *reference);
  } else {
    indices.resize(count);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  for (size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= count)
      (reference ? *reference : primitive)
          .fail("index " + std::to_string(i) + " is " + std::to_string(indices[i]) + ", but there are " + std::to_string(count) +
                " vertices");
  // A Draco mesh comes as a list of faces whatever the mode says.
  const size_t mode = primitive.unsignedOr("mode", size_t(TopologyMode::triangles));
  result.triangles = triangulate(indices, source.draco() ? TopologyMode::triangles : TopologyMode(mode));
  if (result.triangles.empty()) diagnostics.warn(result.path, "has no triangles");
  else if (mode == size_t(TopologyMode::triangles) && indices.size() % 3 != 0)
    diagnostics.warn(result.path, std::to_string(indices.size()) + (reference ? " indices" : " vertices") + " make no whole number of triangles; the last " +
                                      (indices.size() % 3 == 1 ? "is" : "two are") + " left out");
  return result;
}

}  // namespace lightwell::scene::gltf
