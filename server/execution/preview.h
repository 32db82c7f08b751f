// The picture of a light map that the status page shows.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace lightwell::server {

/// A PNG, at most 512 texels on a side: the indirect irradiance of the container's section prm under the scene's own lights, shadowed; when
/// it has none, with every surface lit alike. Exposed so that the bright parts are just white. Empty when there is nothing to show.
std::vector<uint8_t> previewPng(std::span<const uint8_t> container);

}  // namespace lightwell::server
