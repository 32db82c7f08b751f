#include "precompute/scene/gltf/skin.h"

#include "precompute/scene/gltf/accessor.h"
#include "precompute/scene/normal_transform.h"

namespace lightwell::scene::gltf {
namespace {

/// World matrices of the joints, the inverse bind matrices included.
std::vector<Matrix> jointMatrices(Document& document, const JsonValue& skin, const Placements& placements) {
  const JsonValue joints = skin.at("joints");
  std::vector<Matrix> matrices(joints.size());
  for (size_t j = 0; j < matrices.size(); ++j) {
    const auto& world = placements.node_world[joints[j].index(placements.node_world.size(), "nodes")];
    if (!world) joints[j].fail("the joint is not a node of the scene");
    matrices[j] = *world;
  }
  const auto reference = skin.find("inverseBindMatrices");
  if (!reference) return matrices;
  const FloatElements inverse_bind = readFloats(document, *reference, 16, 16);
  if (inverse_bind.count < matrices.size()) reference->fail("has fewer matrices than the skin has joints");
  for (size_t j = 0; j < matrices.size(); ++j) {
    Matrix m;
    for (size_t i = 0; i < 16; ++i) m[int(i / 4)][int(i % 4)] = inverse_bind.values[16 * j + i];
    m[0][3] = m[1][3] = m[2][3] = 0;
    m[3][3] = 1;
    matrices[j] = m * matrices[j];
  }
  return matrices;
}

/// Adds weight * matrix of the four influences of every vertex that JOINTS_n and WEIGHTS_n give.
void accumulate(Document& document, const JsonValue& attributes, const std::string& set, const std::vector<Matrix>& joints,
                std::vector<Matrix>& blended, std::vector<double>& total_weight) {
  const JsonValue joints_reference = attributes.at("JOINTS_" + set), weights_reference = attributes.at("WEIGHTS_" + set);
  const FloatElements indices = readFloats(document, joints_reference, 4, 4), weights = readFloats(document, weights_reference, 4, 4);
  if (indices.count != blended.size()) joints_reference.fail("has another length than POSITION");
  if (weights.count != blended.size()) weights_reference.fail("has another length than POSITION");
  for (size_t i = 0; i < indices.values.size(); ++i) {
    const float weight = weights.values[i];
    if (weight <= 0) continue;
    const float index = indices.values[i];  // FLOAT and BYTE are no types of joints, but are read: they may be negative
    if (!(index >= 0 && index < float(joints.size()))) joints_reference.fail("element " + std::to_string(i / 4) + " names a joint that the skin does not have");
    const auto joint = size_t(index);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) blended[i / 4][row][column] += double(weight) * joints[joint][row][column];
    total_weight[i / 4] += double(weight);
  }
}

}  // namespace

void applySkin(Document& document, const JsonValue& json, const JsonValue& skin, const Placements& placements, Primitive& primitive) {
  const std::vector<Matrix> joints = jointMatrices(document, skin, placements);
  const JsonValue attributes = json.at("attributes");
  std::vector<Matrix> blended(primitive.positions.size(), Matrix(0.0));
  std::vector<double> total_weight(blended.size(), 0);
  for (int set = 0; attributes.find("JOINTS_" + std::to_string(set)); ++set)
    accumulate(document, attributes, std::to_string(set), joints, blended, total_weight);
  for (size_t v = 0; v < blended.size(); ++v) {
    // Without weights a vertex belongs to the first joint, as if its only weight were 1.
    const Matrix m = total_weight[v] > 0 ? blended[v] * (1 / total_weight[v]) : (joints.empty() ? Matrix() : joints[0]);
    Vec3d position;
    m.multVecMatrix(Vec3d(primitive.positions[v]), position);
    primitive.positions[v] = Vec3(position);
    if (!primitive.normals.empty()) primitive.normals[v] = NormalTransform(m).apply(primitive.normals[v]);
  }
}

}  // namespace lightwell::scene::gltf
