#include "precompute/scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>

#include "precompute/scene/gltf/accessor.h"
#include "precompute/scene/gltf/limits.h"

namespace lightwell::scene::gltf {
namespace {

/// Translation, rotation (unit quaternion x, y, z, w) and scale as one matrix; scale acts first.
Matrix compose(const std::array<double, 3>& t, const std::array<double, 4>& q, const std::array<double, 3>& s) {
  const auto [x, y, z, w] = q;
  // Rows are the images of the axes.
  const double axes[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                             {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                             {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  Matrix m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m[row][column] = s[size_t(row)] * axes[row][column];
  for (int column = 0; column < 3; ++column) m[3][column] = t[size_t(column)];
  return m;
}

/// Scales a quaternion to unit length; the identity for zero. True when it was noticeably off.
bool normalizeQuaternion(std::array<double, 4>& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 1e-12)) {
    q = {0, 0, 0, 1};
    return true;
  }
  for (double& component : q) component /= length;
  return std::abs(length - 1) > 0.01;
}

std::vector<size_t> rootNodes(const Document& document, Diagnostics& diagnostics) {
  const JsonValue root = document.root();
  const size_t node_count = document.count("nodes"), scene_count = document.count("scenes");
  std::vector<size_t> roots;
  if (scene_count > 0) {
    const auto chosen = root.find("scene");
    const JsonValue scene = document.element("scenes", chosen ? chosen->index(scene_count, "scenes") : 0);
    if (scene_count > 1)
      diagnostics.warn("scenes", "the file has " + std::to_string(scene_count) + " scenes; only " + scene.path() + (chosen ? ", its default," : ", the first,") + " is baked");
    if (const auto nodes = scene.find("nodes"))
      for (size_t i = 0; i < nodes->size(); ++i) roots.push_back((*nodes)[i].index(node_count, "nodes"));
    if (roots.empty()) diagnostics.warn(scene.path(), "the scene has no nodes");
    return roots;
  }
  diagnostics.warn("scenes", "there is no scene; all root nodes are taken");
  if (const auto chosen = root.find("scene")) chosen->unsignedInteger();
  std::vector<bool> is_child(node_count, false);
  for (size_t i = 0; i < node_count; ++i)
    if (const auto children = document.element("nodes", i).find("children"))
      for (size_t c = 0; c < children->size(); ++c) is_child[(*children)[c].index(node_count, "nodes")] = true;
  for (size_t i = 0; i < node_count; ++i)
    if (!is_child[i]) roots.push_back(i);
  return roots;
}

/// EXT_mesh_gpu_instancing: the transform of every instance in the node's space.
std::vector<Matrix> readInstances(Document& document, const JsonValue& extension, Diagnostics& diagnostics) {
  const JsonValue attributes = extension.at("attributes");
  std::optional<size_t> count;
  const auto read = [&](const char* name, int components) {
    const auto reference = attributes.find(name);
    if (!reference) return FloatElements{};
    FloatElements elements = readFloats(document, *reference, components, components);
    if (count && *count != elements.count) reference->fail("has another number of elements than the other attributes");
    count = elements.count;
    return elements;
  };
  const FloatElements translation = read("TRANSLATION", 3), rotation = read("ROTATION", 4), scale = read("SCALE", 3);
  if (!count) attributes.fail("has neither TRANSLATION nor ROTATION nor SCALE");
  if (*count > kMaxInstances) attributes.fail("has more instances than the limit of " + std::to_string(kMaxInstances));
  std::vector<Matrix> instances(*count);
  size_t repaired = 0;
  for (size_t i = 0; i < *count; ++i) {
    std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
    std::array<double, 4> q{0, 0, 0, 1};
    for (size_t c = 0; c < 3; ++c) {
      if (translation.count) t[c] = translation.values[3 * i + c];
      if (scale.count) s[c] = scale.values[3 * i + c];
    }
    for (size_t c = 0; c < 4 && rotation.count; ++c) q[c] = rotation.values[4 * i + c];
    if (normalizeQuaternion(q)) ++repaired;
    instances[i] = compose(t, q, s);
  }
  if (repaired > 0)
    diagnostics.warn(attributes.path() + ".ROTATION",
                     std::to_string(repaired) + " rotations are not unit quaternions; normalised");
  return instances;
}

/// A node still to be visited, and the world transform of its parent.
struct Visit {
  size_t node;
  Matrix parent;
  size_t portal;  // that the parent belongs to
};

void placeNode(Document& document, const JsonValue& node, size_t index, const Matrix& world, size_t portal, Placements& placements,
               Diagnostics& diagnostics) {
  Placement placement{index, 0, node.path(), "", node.stringOr("name", ""), world};
  placement.portal = portal;
  if (const auto light = node.extension("KHR_lights_punctual")) {
    const auto lights = document.root().extension("KHR_lights_punctual");
    placement.target = light->at("light").index(lights ? lights->at("lights").size() : 0, "lights");
    placements.lights.push_back(placement);
  }
  const auto mesh = node.find("mesh");
  if (!mesh) return;
  placement.target = mesh->index(document.count("meshes"), "meshes");
  placement.posed = node.find("skin") || node.find("weights");
  const auto instancing = node.extension("EXT_mesh_gpu_instancing");
  std::vector<Matrix> instances(1);
  if (instancing && portal != Placement::kNoPortal) node.fail("is part of a portal and cannot have instances");
  if (instancing) instances = readInstances(document, *instancing, diagnostics);
  if (placements.meshes.size() + instances.size() > kMaxInstances)
    node.fail("the scene has more instances than the limit of " + std::to_string(kMaxInstances));
  for (size_t i = 0; i < instances.size(); ++i) {
    placement.world = instances[i] * world;
    if (instancing) placement.instance.assign(1, '#').append(std::to_string(i));
    placements.meshes.push_back(placement);
  }
}

}  // namespace

Matrix localTransform(const JsonValue& node, Diagnostics& diagnostics) {
  if (const auto matrix = node.find("matrix")) {
    const auto values = matrix->numbers<16>();
    if (values[3] != 0 || values[7] != 0 || values[11] != 0 || std::abs(values[15] - 1) > 1e-6) matrix->fail("is not an affine transform");
    Matrix m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = values[size_t(i)];
    m[3][3] = 1;
    return m;
  }
  std::array<double, 4> rotation = node.numbersOr<4>("rotation", {0, 0, 0, 1});
  if (normalizeQuaternion(rotation)) diagnostics.warn(node.path() + ".rotation", "is not a unit quaternion; normalised");
  return compose(node.numbersOr<3>("translation", {0, 0, 0}), rotation, node.numbersOr<3>("scale", {1, 1, 1}));
}

Placements placeNodes(Document& document, std::span<const std::string> portals, Diagnostics& diagnostics) {
  const size_t node_count = document.count("nodes");
  Placements placements;
  placements.node_world.resize(node_count);
  std::vector<bool> visited(node_count, false);
  std::vector<Visit> stack;
  PortalMarks marks(portals);
  const auto push = [&](size_t node, const Matrix& parent, size_t portal, const JsonValue& reference) {
    if (visited[node]) reference.fail("nodes[" + std::to_string(node) + "] is reached twice: a cycle, or a node with two parents");
    visited[node] = true;
    stack.push_back({node, parent, portal});
  };
  for (const size_t root : rootNodes(document, diagnostics)) push(root, Matrix(), Placement::kNoPortal, document.element("nodes", root));
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const JsonValue node = document.element("nodes", visit.node);
    const Matrix world = localTransform(node, diagnostics) * visit.parent;
    placements.node_world[visit.node] = world;
    size_t portal = visit.portal;
    if (auto mark = marks.of(node, world, diagnostics)) {
      if (portal == Placement::kNoPortal) {
        portal = placements.portals.size();
        placements.portals.push_back(std::move(*mark));
      } else if (node.find("extras")) {
        diagnostics.warn(node.path(), "is part of the portal " + placements.portals[portal].path + " and no portal of its own");
      }
    }
    placeNode(document, node, visit.node, world, portal, placements, diagnostics);
    if (const auto children = node.find("children"))
      for (size_t i = children->size(); i-- > 0;)  // the first child ends on top of the stack
        push((*children)[i].index(node_count, "nodes"), world, portal, (*children)[i]);
  }
  std::vector<std::string> candidates;
  for (const Placement& placement : placements.meshes) candidates.push_back(placement.name);
  marks.requireAllFound(document.file(), candidates);
  return placements;
}

}  // namespace lightwell::scene::gltf
