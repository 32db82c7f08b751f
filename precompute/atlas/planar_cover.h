// A set of triangles in the plane that must not overlap, with a hash grid to tell whether one more fits.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "precompute/atlas/plane.h"

namespace lightwell::atlas {

class PlanarCover {
 public:
  /// `cell_size` > 0: about the size of a triangle. `tolerance`: depth up to which triangles may overlap (rounding of their corners).
  PlanarCover(double cell_size, double tolerance) : cell_size_(cell_size), tolerance_(tolerance) {}

  void clear();
  /// Adds `triangle` unless its interior meets that of one already there. Where more than 4096 triangles crowd one cell it refuses too,
  /// which bounds the time for hostile meshes.
  bool tryAdd(const PlanarTriangle& triangle);

 private:
  struct Node {
    uint32_t triangle, next;
  };
  bool overlap(const PlanarTriangle& a, const PlanarTriangle& b) const;

  double cell_size_, tolerance_;
  std::vector<PlanarTriangle> triangles_;
  std::vector<Node> nodes_;
  std::vector<uint32_t> tested_;  // per triangle: the number of the last one it was tested against
  std::unordered_map<uint64_t, uint32_t> head_;
  std::vector<uint64_t> touched_;
  uint32_t test_ = 0;
};

}  // namespace lightwell::atlas
