// Any bytes as a glTF file (.glb, or .gltf with data URIs): buffers, Draco, meshopt, PNG, JPEG and WebP inside of it. What is accepted is a scene whose numbers can be computed with.
#include <cmath>

#include "precompute/scene/import.h"
#include "tests/fuzz/temporary_file.h"

namespace lightwell::fuzz {
namespace {

void requireSound(const scene::Scene& scene) {
  const scene::Mesh& mesh = scene.mesh;
  require(mesh.normals.size() == mesh.positions.size(), "a normal for each vertex");
  require(mesh.triangle_material.size() == mesh.triangles.size() && mesh.triangle_object.size() == mesh.triangles.size(), "a material and an object for each triangle");
  for (const Vec3& p : mesh.positions) require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
  for (const Vec3& n : mesh.normals) require(std::abs(n.length2() - 1) < 1e-3f, "unit normals");
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const uint32_t vertex : mesh.triangles[i]) require(vertex < mesh.positions.size(), "vertices that exist");
    require(mesh.triangle_material[i] < scene.materials.size() && mesh.triangle_object[i] < scene.objects.size(), "materials and objects that exist");
  }
  for (uint32_t i = 0; i < std::min<size_t>(mesh.triangles.size(), 64); ++i) {
    const scene::SurfaceColor color = scene::surfaceColor(scene, i, 0.3f, 0.3f);
    for (int k = 0; k < 3; ++k) {
      require(color.albedo_rgb[k] >= 0 && color.albedo_rgb[k] <= 0.999f, "albedo from 0 to 0.999");
      require(color.emitted_radiance_rgb[k] >= 0 && std::isfinite(color.emitted_radiance_rgb[k]), "finite radiance");
    }
    require(color.alpha >= 0 && color.alpha <= 1, "alpha from 0 to 1");
  }
  for (const scene::Light& light : scene.lights) {
    Vec3 to_light;
    float distance;
    const Rgb irradiance = scene::lightIrradiance(light, Vec3(0.1f, 0.2f, 0.3f), Vec3(0, 1, 0), to_light, distance);
    for (int k = 0; k < 3; ++k) require(irradiance[k] >= 0, "light that is a number");
  }
}

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell;
  static fuzz::TemporaryFile file("scene.glb");
  Diagnostics diagnostics;
  try {
    fuzz::requireSound(scene::importGltf(file.write(data, size), {}, diagnostics));
  } catch (const InputError& error) {
    fuzz::require(!error.reason.empty(), "a reason");
  }
  return 0;
}
