// Which surface lies in which texel of the atlas: exact cutting of triangles along the lines of a unit grid.
#pragma once
#include <algorithm>
#include <cfloat>
#include <cmath>

namespace lightwell::format {

/// A point in grid coordinates with its barycentrics (1 − u − v, u, v) in the triangle that is cut.
struct ClipVertex {
  double x, y, u, v;
};

/// A convex piece of a triangle. Four cuts of a triangle leave at most seven corners.
struct ClipPolygon {
  int count = 0;
  ClipVertex vertex[8];

  void add(const ClipVertex& v) {
    if (count < 8) vertex[count++] = v;
  }
  /// Area in the grid's unit², unsigned.
  double gridArea() const {
    double twice = 0;
    for (int i = 2; i < count; ++i)
      twice += (vertex[i - 1].x - vertex[0].x) * (vertex[i].y - vertex[0].y) -
               (vertex[i].x - vertex[0].x) * (vertex[i - 1].y - vertex[0].y);
    return 0.5 * std::abs(twice);
  }
  /// Share of the whole triangle's area, in [0, 1]. Meaningful too where the triangle has no area in the grid.
  double share() const {
    double sum = 0;
    for (int i = 2; i < count; ++i) sum += fanShare(i);
    return sum;
  }
  /// Share of the fan triangle (0, i − 1, i).
  double fanShare(int i) const {
    return std::abs((vertex[i - 1].u - vertex[0].u) * (vertex[i].v - vertex[0].v) -
                    (vertex[i].u - vertex[0].u) * (vertex[i - 1].v - vertex[0].v));
  }
};

/// Cells [x_begin, x_end) × [y_begin, y_end). Triangles are attributed to the border cells where they lie outside.
struct CellRange {
  long x_begin, x_end, y_begin, y_end;
};

namespace detail {

/// Sutherland and Hodgman, "Reentrant Polygon Clipping" (CACM 1974): the part with sign * coordinate ≥ sign * bound; the border
/// belongs to it.
inline ClipPolygon clipHalfPlane(const ClipPolygon& polygon, double ClipVertex::*coordinate, double bound, double sign) {
  ClipPolygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const ClipVertex& a = polygon.vertex[i];
    const ClipVertex& b = polygon.vertex[i + 1 == polygon.count ? 0 : i + 1];
    const double da = sign * (a.*coordinate - bound), db = sign * (b.*coordinate - bound);
    if (da >= 0) result.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      const double t = da / (da - db);
      ClipVertex cut{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)};
      cut.*coordinate = bound;
      result.add(cut);
    }
  }
  return result;
}

/// The cells [first, last) that the extent of `polygon` along `coordinate` spans: at least one, at most those of [begin, end).
inline void cellSpan(const ClipPolygon& polygon, double ClipVertex::*coordinate, long begin, long end, long& first, long& last) {
  double low = polygon.vertex[0].*coordinate, high = low;
  for (int i = 1; i < polygon.count; ++i) {
    low = std::min(low, polygon.vertex[i].*coordinate);
    high = std::max(high, polygon.vertex[i].*coordinate);
  }
  first = std::clamp(long(std::floor(low)), begin, end - 1);
  last = std::clamp(long(std::ceil(high)), first + 1, std::max(end, first + 1));
}

}  // namespace detail

/// Calls emit(x, y, polygon) for every cell that the triangle touches. The pieces partition the triangle: their shares sum to 1, also for
/// triangles that are a segment or a point in the grid, which have shares all the same.
template <class Emit>
void clipToCells(const ClipVertex (&corner)[3], const CellRange& range, Emit&& emit) {
  ClipPolygon triangle;
  for (const ClipVertex& c : corner) triangle.add(c);
  long row, row_end;
  detail::cellSpan(triangle, &ClipVertex::y, range.y_begin, range.y_end, row, row_end);
  const bool one_row = row + 1 == row_end;
  for (; row < row_end; ++row) {
    ClipPolygon strip = triangle;
    if (!one_row) {
      if (row > range.y_begin) strip = detail::clipHalfPlane(strip, &ClipVertex::y, double(row), 1);
      if (row + 1 < range.y_end) strip = detail::clipHalfPlane(strip, &ClipVertex::y, double(row + 1), -1);
    }
    if (strip.count < 3) continue;
    long column, column_end;
    detail::cellSpan(strip, &ClipVertex::x, range.x_begin, range.x_end, column, column_end);
    if (column + 1 == column_end) {
      emit(column, row, strip);
      continue;
    }
    for (; column < column_end; ++column) {
      ClipPolygon piece = strip;
      if (column > range.x_begin) piece = detail::clipHalfPlane(piece, &ClipVertex::x, double(column), 1);
      if (column + 1 < range.x_end) piece = detail::clipHalfPlane(piece, &ClipVertex::x, double(column + 1), -1);
      if (piece.count >= 3) emit(column, row, piece);
    }
  }
}

/// A light-map coordinate in texels of a grid of that size, clamped to it. What misses a texel's border by no more than the rounding of a float coordinate is put on it.
inline double toTexels(float uv, int size) {
  const double t = std::clamp(double(uv), 0.0, 1.0) * size;
  const double nearest = std::round(t);
  return std::abs(t - nearest) <= size * double(FLT_EPSILON) ? nearest : t;
}

/// Whether a piece comes from rounding at texels' corners.
inline bool isNegligible(const ClipPolygon& piece) {
  constexpr double kNegligible = 1e-7;  // both as a share of its triangle and in texel²
  return piece.share() < kNegligible && piece.gridArea() < kNegligible;
}

}  // namespace lightwell::format
