#include "precompute/atlas/planar_cover.h"

#include <algorithm>
#include <limits>

#include "precompute/atlas/coverage.h"

namespace lightwell::atlas {
namespace {

constexpr uint32_t kEnd = std::numeric_limits<uint32_t>::max();
constexpr int kCrowd = 4096;
constexpr CellRange kEverywhere{-(1l << 30), 1l << 30, -(1l << 30), 1l << 30};

uint64_t cellKey(long x, long y) { return uint64_t(uint32_t(int32_t(x))) << 32 | uint32_t(int32_t(y)); }

}  // namespace

void PlanarCover::clear() {
  triangles_.clear();
  nodes_.clear();
  tested_.clear();
  std::unordered_map<uint64_t, uint32_t>().swap(head_);  // clear() would keep, and each time wipe, the buckets of the largest chart
  test_ = 0;
}

/// Separating axis test on the normals of both triangles' edges.
bool PlanarCover::overlap(const PlanarTriangle& a, const PlanarTriangle& b) const {
  for (const PlanarTriangle* t : {&a, &b})
    for (int k = 0; k < 3; ++k) {
      const Vec2d edge = (*t)[(k + 1) % 3] - (*t)[k];
      const double length = edge.length();
      if (!(length > 0)) continue;
      const Vec2d axis = Vec2d(-edge.y, edge.x) / length;
      double a_low = axis.dot(a[0]), a_high = a_low, b_low = axis.dot(b[0]), b_high = b_low;
      for (int i = 1; i < 3; ++i) {
        a_low = std::min(a_low, axis.dot(a[i])), a_high = std::max(a_high, axis.dot(a[i]));
        b_low = std::min(b_low, axis.dot(b[i])), b_high = std::max(b_high, axis.dot(b[i]));
      }
      if (std::min(a_high, b_high) - std::max(a_low, b_low) <= tolerance_) return false;
    }
  return true;
}

bool PlanarCover::tryAdd(const PlanarTriangle& triangle) {
  ClipVertex corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = {triangle[k].x / cell_size_, triangle[k].y / cell_size_, double(k == 1), double(k == 2)};
  touched_.clear();
  clipToCells(corner, kEverywhere, [&](long x, long y, const ClipPolygon&) { touched_.push_back(cellKey(x, y)); });

  ++test_;
  for (uint64_t cell : touched_) {
    const auto found = head_.find(cell);
    int crowd = 0;
    for (uint32_t node = found == head_.end() ? kEnd : found->second; node != kEnd; node = nodes_[node].next) {
      if (++crowd > kCrowd) return false;
      uint32_t& tested = tested_[nodes_[node].triangle];
      if (tested == test_) continue;
      tested = test_;
      if (overlap(triangle, triangles_[nodes_[node].triangle])) return false;
    }
  }
  const uint32_t index = uint32_t(triangles_.size());
  triangles_.push_back(triangle);
  tested_.push_back(test_);
  for (uint64_t cell : touched_) {
    uint32_t& head = head_.try_emplace(cell, kEnd).first->second;
    nodes_.push_back({index, head});
    head = uint32_t(nodes_.size() - 1);
  }
  return true;
}

}  // namespace lightwell::atlas
