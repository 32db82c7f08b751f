// glTF 2.0 (.glb, .gltf) to Scene. Everything read is hostile until checked.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/file_table.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {

enum class LightUnits { spec, unitless, raw };

struct ImportOptions {
  LightUnits light_units = LightUnits::spec;
  const FileTable* files = nullptr;  // null: the file system
  std::vector<std::string> portals;  // names of nodes that are portals besides those that the file marks; a * at the end stands for any rest
};

/// Reads a scene. Repairs go to `diagnostics`; throws InputError naming the glTF path otherwise, UsageError for a name in `options.portals` that no node has. Never reads outside the file's folder.
Scene importGltf(const std::filesystem::path& file, const ImportOptions& options, Diagnostics& diagnostics);

/// Replaces the scene's punctual lights with those of a LIGHTS.json (docs: the outside contract). Throws InputError.
void replaceLights(Scene& scene, const std::filesystem::path& lights_json, Diagnostics& diagnostics,
                   const FileTable* files = nullptr);

/// Adds a light given in world metres (as LIGHTS.json has it) in the scene's internal units.
Light toInternal(const Scene& scene, const Light& world_light, const Vec3d& position_m);

}  // namespace lightwell::scene
