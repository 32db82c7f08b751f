#include "samples/scenes/cell_building.h"

#include <algorithm>

#include "samples/scenes/shapes.h"

namespace lightwell::samples {
namespace {

/// A piece of wall over one grid edge.
struct WallPiece {
  float low_m, high_m;
  uint32_t material;
  bool operator==(const WallPiece&) const = default;
};

/// The walls that close cell `here` toward `there` (null: outside).
std::vector<WallPiece> wallsBetween(const Cell& here, const Cell* there) {
  if (here.solid()) return {};
  if (!there || there->solid()) return {{here.floor_m, here.ceiling_m, here.wall_material}};
  std::vector<WallPiece> pieces;
  if (there->floor_m > here.floor_m)
    pieces.push_back({here.floor_m, std::min(there->floor_m, here.ceiling_m), there->riser_material});
  if (there->makes_lintels && there->ceiling_m < here.ceiling_m)
    pieces.push_back({std::max(there->ceiling_m, here.floor_m), here.ceiling_m, there->lintel_material});
  return pieces;
}

}  // namespace

std::vector<float> gridLines(std::vector<float> lines) {
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end(), [](float a, float b) { return b - a < 1e-3f; }), lines.end());
  return lines;
}

CellGrid::CellGrid(std::vector<float> xs, std::vector<float> zs) : xs_(std::move(xs)), zs_(std::move(zs)) {
  cells_.resize(columns() * rows());
}

const Cell* CellGrid::cell(int i, int j) const {
  if (i < 0 || j < 0 || i >= int(columns()) || j >= int(rows())) return nullptr;
  return &cells_[size_t(j) * columns() + size_t(i)];
}

void CellGrid::edit(float x0, float x1, float z0, float z1, const std::function<void(Cell&)>& change) {
  for (size_t j = 0; j < rows(); ++j)
    for (size_t i = 0; i < columns(); ++i) {
      const float x = (xs_[i] + xs_[i + 1]) / 2, z = (zs_[j] + zs_[j + 1]) / 2;
      if (x > x0 && x < x1 && z > z0 && z < z1) change(at(i, j));
    }
}

void CellGrid::buildPlanes(Node& node, bool ceilings) const {
  const auto made = [&](const Cell& c) {
    return !c.solid() && (ceilings ? c.makes_ceiling && !c.open_sky : c.makes_floor);
  };
  const auto same = [&](const Cell& a, const Cell& b) {
    return made(a) && made(b) && (ceilings ? a.ceiling_m == b.ceiling_m && a.ceiling_material == b.ceiling_material
                                           : a.floor_m == b.floor_m && a.floor_material == b.floor_material);
  };
  // Flood fill gives each cell the number of its connected plane.
  std::vector<int> plane(cells_.size(), -1);
  int planes = 0;
  std::vector<size_t> stack;
  for (size_t seed = 0; seed < cells_.size(); ++seed) {
    if (plane[seed] >= 0 || !made(cells_[seed])) continue;
    plane[seed] = planes;
    stack.push_back(seed);
    while (!stack.empty()) {
      const size_t k = stack.back();
      stack.pop_back();
      const int i = int(k % columns()), j = int(k / columns());
      for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const Cell* next = cell(i + di, j + dj);
        if (!next || !same(cells_[k], *next)) continue;
        const size_t n = size_t(next - cells_.data());
        if (plane[n] >= 0) continue;
        plane[n] = planes;
        stack.push_back(n);
      }
    }
    ++planes;
  }
  // Each plane is covered by greedy rectangles: as wide as possible, then as deep as possible.
  std::vector<std::vector<Vec3>> corners(static_cast<size_t>(planes));
  std::vector<uint32_t> material(static_cast<size_t>(planes));
  for (size_t j = 0; j < rows(); ++j)
    for (size_t i = 0; i < columns(); ++i) {
      const Cell& first = cells_[j * columns() + i];
      const int p = plane[j * columns() + i];
      if (p < 0) continue;
      size_t i_end = i, j_end = j + 1;
      while (i_end < columns() && plane[j * columns() + i_end] == p) ++i_end;
      const auto rowMatches = [&](size_t row) {
        for (size_t k = i; k < i_end; ++k)
          if (plane[row * columns() + k] != p) return false;
        return true;
      };
      while (j_end < rows() && rowMatches(j_end)) ++j_end;
      for (size_t row = j; row < j_end; ++row) std::fill_n(plane.begin() + long(row * columns() + i), i_end - i, -1);
      const float y = ceilings ? first.ceiling_m : first.floor_m;
      const Vec3 a(xs_[i], y, zs_[j]), b(xs_[i], y, zs_[j_end]), c(xs_[i_end], y, zs_[j_end]), d(xs_[i_end], y, zs_[j]);
      for (const Vec3& corner : ceilings ? std::array{a, d, c, b} : std::array{a, b, c, d}) corners[size_t(p)].push_back(corner);
      material[size_t(p)] = ceilings ? first.ceiling_material : first.floor_material;
    }
  for (size_t p = 0; p < corners.size(); ++p) addPlanarChart(node, material[p], corners[p], 4);
}

void CellGrid::buildWalls(Node& node, bool along_x) const {
  const std::vector<float>& along = along_x ? xs_ : zs_;
  const std::vector<float>& across = along_x ? zs_ : xs_;
  const auto cellAt = [&](int a, int b) { return along_x ? cell(a, b) : cell(b, a); };
  for (int line = 0; line < int(across.size()); ++line)
    for (const int side : {-1, 0}) {  // walls seen from the cells before the line, then from those behind it
      const auto piecesAt = [&](int a) -> std::vector<WallPiece> {
        const Cell* here = cellAt(a, line + side);
        return here ? wallsBetween(*here, cellAt(a, line - 1 - side)) : std::vector<WallPiece>{};
      };
      struct Run {
        WallPiece piece;
        int from;
      };
      std::vector<Run> open;
      const int count = int(along.size()) - 1;
      for (int a = 0; a <= count; ++a) {
        const std::vector<WallPiece> pieces = a < count ? piecesAt(a) : std::vector<WallPiece>{};
        std::vector<Run> still_open;
        for (const Run& run : open) {
          if (std::find(pieces.begin(), pieces.end(), run.piece) != pieces.end()) {
            still_open.push_back(run);
            continue;
          }
          const auto corner = [&](int at, float y) {
            return along_x ? Vec3(along[size_t(at)], y, across[size_t(line)]) : Vec3(across[size_t(line)], y, along[size_t(at)]);
          };
          // Seen from before the line along +x, the run's end is to the right when it runs along z, to the left otherwise.
          const bool forward = (side == 0) == along_x;
          const int left = forward ? run.from : a, right = forward ? a : run.from;
          addQuad(node, run.piece.material, corner(left, run.piece.low_m), corner(right, run.piece.low_m),
                  corner(right, run.piece.high_m), corner(left, run.piece.high_m));
        }
        for (const WallPiece& piece : pieces)
          if (std::none_of(open.begin(), open.end(), [&](const Run& run) { return run.piece == piece; })) still_open.push_back({piece, a});
        open = std::move(still_open);
      }
    }
}

void CellGrid::build(Node& node) const {
  buildPlanes(node, false);
  buildPlanes(node, true);
  buildWalls(node, true);
  buildWalls(node, false);
}

}  // namespace lightwell::samples
