// Architecture on a grid of cells, each with a floor and a ceiling height. Steps, walls, door jambs, lintels, benches and
// coffers all follow from neighbouring heights, so that the building closes by construction.
#pragma once
#include <functional>
#include <vector>

#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

/// A cell whose floor is not below its ceiling is solid.
struct Cell {
  float floor_m = 0, ceiling_m = 0;
  uint32_t floor_material = 0, ceiling_material = 0;
  uint32_t wall_material = 0;    // of the walls around it, where the neighbour is solid
  uint32_t riser_material = 0;   // of the step up to it from a lower neighbour
  uint32_t lintel_material = 0;  // of the face above its ceiling, seen from a higher neighbour
  bool open_sky = false;         // no ceiling; ceiling_m is the height of the parapet
  bool makes_floor = true, makes_ceiling = true;  // false: other shapes close it there
  bool makes_lintels = true;                      // false: other shapes make the faces above it
  bool solid() const { return !(floor_m < ceiling_m); }
};

class CellGrid {
 public:
  /// Ascending grid lines, in metres; cell (i, j) lies between xs[i], xs[i + 1] and zs[j], zs[j + 1]. All cells start solid.
  CellGrid(std::vector<float> xs, std::vector<float> zs);

  /// Changes every cell whose centre lies in the rectangle.
  void edit(float x0, float x1, float z0, float z1, const std::function<void(Cell&)>& change);
  Cell& at(size_t i, size_t j) { return cells_[j * columns() + i]; }
  size_t columns() const { return xs_.size() - 1; }
  size_t rows() const { return zs_.size() - 1; }

  /// Appends floors, ceilings and walls: one chart per connected plane of one material.
  void build(Node& node) const;

 private:
  const Cell* cell(int i, int j) const;  // null outside the grid
  void buildPlanes(Node& node, bool ceilings) const;
  void buildWalls(Node& node, bool along_x) const;
  std::vector<float> xs_, zs_;
  std::vector<Cell> cells_;
};

/// Sorted grid lines without duplicates (closer than 1 mm).
std::vector<float> gridLines(std::vector<float> lines);

}  // namespace lightwell::samples
