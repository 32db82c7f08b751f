// Skins in their rest pose.
#pragma once
#include <vector>

#include "precompute/scene/gltf/document.h"
#include "precompute/scene/gltf/nodes.h"
#include "precompute/scene/gltf/primitive.h"

namespace lightwell::scene::gltf {

/// Moves the vertices of `primitive` to where the joints, as the nodes stand in the file, take them (glTF 2.0, section 3.7.3): world space,
/// so its placement is the identity. `json` is the primitive, `skin` the element of `skins`. Throws InputError naming the place.
void applySkin(Document& document, const JsonValue& json, const JsonValue& skin, const Placements& placements, Primitive& primitive);

}  // namespace lightwell::scene::gltf
