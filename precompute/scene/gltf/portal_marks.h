// Which nodes are doors and shutters: by their extras, or by names that the caller gives.
//
//   "extras": {"lightwell": {"portal": true}}
//   "extras": {"lightwell": {"portal": {"strips": 8, "opens_along": [1, 0, 0]}}}
#pragma once
#include <ImathMatrix.h>

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/core/math.h"
#include "precompute/scene/json_value.h"

namespace lightwell::scene::gltf {

/// Row vectors as Imath has them: world = local * matrix. In memory that is glTF's column-major matrix.
using Matrix = Imath::M44d;

struct PortalMark {
  std::string name, path;              // of the node
  uint32_t strips;
  std::optional<Vec3d> opens_along;    // in the world, not zero; nothing: along its widest horizontal extent
};

class PortalMarks {
 public:
  explicit PortalMarks(std::span<const std::string> names) : names_(names) {}

  /// What is said of a node; nothing when it is no portal. InputError for extras that cannot be meant.
  std::optional<PortalMark> of(const JsonValue& node, const Matrix& world, Diagnostics& diagnostics);
  /// Throws UsageError that lists the nodes which might have been meant (`candidates`) when a name was no node's.
  void requireAllFound(const std::string& file, const std::vector<std::string>& candidates) const;

 private:
  bool isNamed(const std::string& node);

  std::span<const std::string> names_;
  std::set<std::string> found_;  // of the names
};

}  // namespace lightwell::scene::gltf
