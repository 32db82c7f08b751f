#include "precompute/scene/import.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "precompute/core/error.h"
#include "precompute/scene/albedo_check.h"
#include "precompute/scene/gltf/document.h"
#include "precompute/scene/gltf/lights.h"
#include "precompute/scene/gltf/limits.h"
#include "precompute/scene/gltf/materials.h"
#include "precompute/scene/gltf/nodes.h"
#include "precompute/scene/gltf/primitive.h"
#include "precompute/scene/gltf/skin.h"
#include "precompute/scene/mesh_builder.h"
#include "precompute/scene/normalization.h"
#include "precompute/scene/portals.h"

namespace lightwell::scene {
namespace {

/// One import under way: materials and meshes are read once, when the first node that uses them is met.
class Importer {
 public:
  Importer(const std::filesystem::path& file, const FileTable* table, Scene& scene, Diagnostics& diagnostics)
      : document_(file, table, diagnostics), scene_(scene), diagnostics_(diagnostics),
        material_importer_(document_, scene.textures, diagnostics) {}

  void run(const ImportOptions& options) {
    gltf::Placements placements = gltf::placeNodes(document_, options.portals, diagnostics_);
    for (gltf::Placement& placement : placements.meshes) {
      readMesh(placements, placement);
      if (document_.element("nodes", placement.node).find("skin")) placement.world = gltf::Matrix();  // its joints place it
    }
    if (not_surfaces_ > 0)
      diagnostics_.warn(first_not_surface_, not_surfaces_ == 1 ? "is points or lines, not a surface, and is left out"
                                                               : std::to_string(not_surfaces_) + " primitives are points or lines, not surfaces, and are left out, the first of them here");
    const Frame frame = chooseFrame(placements.meshes);
    scene_.origin_m = frame.origin_m;
    scene_.metres_per_unit = frame.metres_per_unit;
    buildMesh(placements, frame);
    if (scene_.mesh.triangles.empty()) diagnostics_.warn("scenes", "the scene has no surfaces");
    reportHighAlbedo(scene_, diagnostics_);
    for (const gltf::PlacedLight& placed : gltf::readLights(document_, placements.lights, options.light_units, diagnostics_))
      scene_.lights.push_back(toInternal(scene_, placed.light, placed.position_m));
  }

 private:
  struct KnownMaterial {
    uint32_t scene_index;
    gltf::ImportedMaterial imported;
  };

  const KnownMaterial& material(size_t index) {
    const auto known = materials_.find(index);
    if (known != materials_.end()) return known->second;
    KnownMaterial added{uint32_t(scene_.materials.size()), material_importer_.import(index)};
    scene_.materials.push_back(added.imported.material);
    return materials_.emplace(index, std::move(added)).first->second;
  }

  /// Meshes are shared between nodes, but for those that a node itself shapes: (mesh, node) or (mesh, kShared).
  using MeshKey = std::pair<size_t, size_t>;
  static constexpr size_t kShared = ~size_t(0);
  static MeshKey meshKey(const gltf::Placement& placement) { return {placement.target, placement.posed ? placement.node : kShared}; }
  const std::vector<gltf::Primitive>& primitives(const gltf::Placement& placement) const { return meshes_.at(meshKey(placement)); }

  /// Reads the primitives of the placement's mesh unless they are known, and counts what its instance adds.
  void readMesh(const gltf::Placements& placements, const gltf::Placement& placement) {
    const MeshKey key = meshKey(placement);
    const auto known = meshes_.find(key);
    if (known != meshes_.end()) {
      for (const gltf::Primitive& primitive : known->second) countInstance(primitive, placement);
    } else {
      meshes_.emplace(key, readPrimitives(placements, placement));
    }
  }

  void countInstance(const gltf::Primitive& primitive, const gltf::Placement& placement) {
    vertices_ += primitive.normals.empty() ? primitive.triangles.size() * 3 : primitive.positions.size();
    triangles_ += primitive.triangles.size();
    const auto check = [&](uint64_t count, uint64_t limit, const char* what) {
      if (count > limit)
        throw InputError(document_.file(), placement.path,
                         std::string("the scene has more ") + what + " than the limit of " + std::to_string(limit));
    };
    check(vertices_, gltf::kMaxVertices, "vertices");
    check(triangles_, gltf::kMaxTriangles, "triangles");
  }

  std::vector<gltf::Primitive> readPrimitives(const gltf::Placements& placements, const gltf::Placement& placement) {
    const JsonValue node = document_.element("nodes", placement.node), mesh = document_.element("meshes", placement.target);
    const JsonValue json = mesh.at("primitives");
    auto rest_pose = node.find("weights");
    if (!rest_pose) rest_pose = mesh.find("weights");
    std::vector<double> weights;
    if (rest_pose)
      for (size_t i = 0; i < rest_pose->size(); ++i) weights.push_back((*rest_pose)[i].number());
    std::vector<gltf::Primitive> primitives;
    for (size_t i = 0; i < json.size(); ++i) {
      if (!gltf::isSurface(json[i])) {
        if (not_surfaces_++ == 0) first_not_surface_ = json[i].path();
        continue;
      }
      primitives.push_back(readPrimitive(json[i], weights));
      if (const auto skin = node.find("skin")) {
        gltf::applySkin(document_, json[i], document_.element("skins", *skin), placements, primitives.back());
        diagnostics_.warn(json[i].path(), "has a skin; its rest pose is baked");
      }
      countInstance(primitives.back(), placement);
    }
    return primitives;
  }

  gltf::Primitive readPrimitive(const JsonValue& json, const std::vector<double>& weights) {
    const gltf::ImportedMaterial& imported = material(gltf::materialIndex(document_, json)).imported;
    gltf::WantedCoordinates wanted;
    if (imported.base_coordinates) wanted.base = &*imported.base_coordinates;
    if (imported.emissive_coordinates) wanted.emissive = &*imported.emissive_coordinates;
    if (json.find("targets")) diagnostics_.warn(json.path(), "has morph targets; its rest pose is baked");
    return gltf::readPrimitive(document_, json, wanted, weights, diagnostics_);
  }

  Frame chooseFrame(const std::vector<gltf::Placement>& placements) const {
    Imath::Box3d bounds_m;
    for (const gltf::Placement& placement : placements)
      for (const gltf::Primitive& primitive : primitives(placement)) extend(bounds_m, primitive, placement);
    if (!bounds_m.isEmpty()) {
      const Vec3d size = bounds_m.size();
      const double extent = std::max({size.x, size.y, size.z});
      if (extent > gltf::kMaxExtentM || (extent > 0 && extent < gltf::kMinExtentM))
        throw InputError(document_.file(), "scenes",
                         "the scene is absurdly large or small: its extent is " + std::to_string(extent) + " m");
    }
    return scene::chooseFrame(bounds_m);
  }

  void extend(Imath::Box3d& bounds_m, const gltf::Primitive& primitive, const gltf::Placement& placement) const {
    for (const auto& triangle : primitive.triangles)
      for (const uint32_t v : triangle) {
        Vec3d world_m;
        placement.world.multVecMatrix(Vec3d(primitive.positions[v]), world_m);
        if (!(world_m.length() <= gltf::kMaxCoordinateM * 2))
          throw InputError(document_.file(), placement.path, "the transform puts " + primitive.path + " absurdly far away");
        bounds_m.extendBy(world_m);
      }
  }

  void buildMesh(const gltf::Placements& placements, const Frame& frame) {
    MeshBuilder builder(scene_, frame);
    std::vector<uint32_t> portal_first(placements.portals.size(), 0), portal_end(placements.portals.size(), 0);
    for (const gltf::Placement& placement : placements.meshes) {
      const auto before = uint32_t(scene_.mesh.triangles.size());
      for (const gltf::Primitive& primitive : primitives(placement))
        builder.add(primitive, placement.world, materials_.at(primitive.material).scene_index,
                    placement.path + "/" + primitive.path + placement.instance, placement.name);
      if (placement.portal == gltf::Placement::kNoPortal) continue;
      if (portal_end[placement.portal] == 0) portal_first[placement.portal] = before;
      portal_end[placement.portal] = uint32_t(scene_.mesh.triangles.size());
    }
    for (const Vec3& p : scene_.mesh.positions) scene_.bounds.extendBy(p);
    builder.report(diagnostics_);
    addPortals(scene_, placements.portals, portal_first, portal_end, diagnostics_);
  }

  gltf::Document document_;
  Scene& scene_;
  Diagnostics& diagnostics_;
  gltf::MaterialImporter material_importer_;
  std::map<size_t, KnownMaterial> materials_;
  std::map<MeshKey, std::vector<gltf::Primitive>> meshes_;
  uint64_t vertices_ = 0, triangles_ = 0;
  size_t not_surfaces_ = 0;
  std::string first_not_surface_;
};

}  // namespace

Scene importGltf(const std::filesystem::path& file, const ImportOptions& options, Diagnostics& diagnostics) {
  Scene scene;
  scene.file = file.string();
  Importer(file, options.files, scene, diagnostics).run(options);
  return scene;
}

}  // namespace lightwell::scene
