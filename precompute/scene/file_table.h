// Scenes whose files do not lie in a folder under their own names, as in a store that names files by content.
#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace lightwell::scene {

/// A file's name, relative to the scene's folder and in normal form with '/' ("room.gltf", "textures/wood.png") → where its bytes are.
/// Whoever is given a table opens nothing that is not in it.
using FileTable = std::map<std::string, std::filesystem::path>;

}  // namespace lightwell::scene
