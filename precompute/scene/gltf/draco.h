// KHR_draco_mesh_compression: the attributes and indices of one primitive.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "precompute/scene/gltf/accessor.h"
#include "precompute/scene/gltf/document.h"

namespace lightwell::scene::gltf {

class DracoMesh {
 public:
  /// Decodes the buffer view that the extension of `primitive` names. Throws InputError at the extension when the data is damaged or
  /// larger than the primitive's accessors say.
  DracoMesh(Document& document, const JsonValue& primitive, const JsonValue& extension);
  ~DracoMesh();

  /// Whether the compressed mesh holds the attribute; others come from their accessors.
  bool has(const std::string& attribute) const;
  /// As readFloats; normalisation as the accessor `reference` declares it.
  FloatElements read(const std::string& attribute, const JsonValue& reference, int min_components, int max_components) const;
  /// Three per face, each below the number of points.
  const std::vector<uint32_t>& indices() const { return indices_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::vector<uint32_t> indices_;
};

}  // namespace lightwell::scene::gltf
