#include "runtime/src/light_pieces.h"

#include <bit>
#include <cstring>

namespace lightwell::runtime {
namespace {

constexpr float kMost = 1e12f;

Float3 float3(const float* v) { return {v[0], v[1], v[2]}; }
float lengthOf(Float3 v) { return std::sqrt(dot(v, v)); }
bool areBounded(const float* values, uint32_t count) {
  bool good = true;
  for (uint32_t i = 0; i < count; ++i) good &= std::abs(values[i]) <= kMost;
  return good;
}

/// How much is to be gained by cutting it: where its flux goes wrong and how far apart its points are; 0: nothing.
float urgencyOf(const LightPiece& piece) {
  if (!piece.cuttable) return 0;
  return (0.2126f * piece.flux_rgb[0] + 0.7152f * piece.flux_rgb[1] + 0.0722f * piece.flux_rgb[2]) * piece.reach_m;
}

/// Area, middle and reach of the polygon with these corners; false when it has none.
bool measure(LightPiece& piece) {
  const Float3 origin = piece.vertex_m[0];
  Float3 moment{0, 0, 0};
  float twice = 0;
  for (uint32_t i = 2; i < piece.vertex_count; ++i) {
    const Float3 a = piece.vertex_m[i - 1] - origin, b = piece.vertex_m[i] - origin;
    const float area = dot(cross(a, b), piece.normal);
    twice += area;
    moment = moment + (a + b) * (area / 3);
  }
  piece.area_m2 = 0.5f * twice;
  if (!(piece.area_m2 > 0)) return false;
  piece.position_m = origin + moment * (1 / twice);
  piece.reach_m = 0;
  for (uint32_t i = 0; i < piece.vertex_count; ++i) piece.reach_m = std::max(piece.reach_m, lengthOf(piece.vertex_m[i] - piece.position_m));
  return true;
}

/// The part of `from` where sign * dot(axis, p − middle) ≥ 0 (Sutherland and Hodgman 1974). False when it has too many corners or no area.
bool clip(const LightPiece& from, Float3 axis, float sign, LightPiece& out) {
  out = from;
  out.vertex_count = 0;
  const auto add = [&](Float3 p) {
    if (out.vertex_count < kMostPolygonVertices) out.vertex_m[out.vertex_count] = p;
    ++out.vertex_count;
  };
  for (uint32_t i = 0; i < from.vertex_count; ++i) {
    const Float3 a = from.vertex_m[i], b = from.vertex_m[i + 1 < from.vertex_count ? i + 1 : 0];
    const float da = sign * dot(axis, a - from.position_m), db = sign * dot(axis, b - from.position_m);
    if (da >= 0) add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) add(a + (b - a) * (da / (da - db)));
  }
  return out.vertex_count >= 3 && out.vertex_count <= kMostPolygonVertices && measure(out);
}

/// Cuts a polygon across the way from its middle to its farthest corner. Flux goes by area.
bool cut(LightPiece& piece, LightPiece& other) {
  Float3 axis{0, 0, 0};
  for (uint32_t i = 0; i < piece.vertex_count; ++i)
    if (const Float3 way = piece.vertex_m[i] - piece.position_m; dot(way, way) > dot(axis, axis)) axis = way;
  LightPiece part;
  if (!clip(piece, axis, 1, part) || !clip(piece, axis, -1, other)) return false;
  const float share = part.area_m2 / (part.area_m2 + other.area_m2);
  for (int k = 0; k < 3; ++k) {
    part.flux_rgb[k] = piece.flux_rgb[k] * share;
    other.flux_rgb[k] = piece.flux_rgb[k] - part.flux_rgb[k];
  }
  piece = part;
  return true;
}

}  // namespace

const char* checkVirtualLight(const lw_virtual_light& light) {
  const bool polygon = light.type == LW_VIRTUAL_POLYGON, round = light.type == LW_VIRTUAL_DISK || light.type == LW_VIRTUAL_SPHERE;
  if (light.type < LW_VIRTUAL_POINT || light.type > LW_VIRTUAL_POLYGON) return "its type is unknown";
  if (!areBounded(light.position_m, 3)) return "its position is not finite, or too far away";
  const Float3 normal = float3(light.normal);
  if (!(std::abs(dot(normal, normal) - 1) < 1e-3f)) return "its normal is not a unit vector";
  for (const float flux : light.flux_rgb)
    if (!(flux >= 0 && flux <= 1e30f)) return "its flux is negative or not finite";
  if (round && !(light.radius_m > 0 && light.radius_m <= kMost)) return "its radius is not positive, or too large";
  if (light.type != LW_VIRTUAL_POINT && !(light.area_m2 > 0)) return "its area is not positive";
  if (!polygon) return nullptr;
  if (light.vertex_count < 3 || light.vertex_count > kMostPolygonVertices || !light.vertices_m) return "a polygon has 3 to 8 corners";
  if (!areBounded(light.vertices_m, light.vertex_count * 3)) return "a corner is not finite, or too far away";
  LightPiece piece = wholeLight(light);
  return measure(piece) ? nullptr : "it has no area on its front";
}

LightPiece wholeLight(const lw_virtual_light& light) {
  LightPiece piece{};
  piece.type = light.type;
  piece.position_m = float3(light.position_m), piece.normal = float3(light.normal);
  std::memcpy(piece.flux_rgb, light.flux_rgb, sizeof piece.flux_rgb);
  piece.radius_m = piece.reach_m = light.radius_m, piece.area_m2 = light.area_m2;
  if (light.type != LW_VIRTUAL_POLYGON) return piece;
  piece.cuttable = true;
  piece.vertex_count = light.vertex_count;
  for (uint32_t i = 0; i < light.vertex_count; ++i) {
    piece.vertex_m[i] = float3(light.vertices_m + size_t(i) * 3);
    piece.reach_m = std::max(piece.reach_m, lengthOf(piece.vertex_m[i] - piece.position_m));
  }
  return piece;
}

uint32_t cutLights(LightPiece* pieces, uint32_t count, uint32_t most) {
  // A heap by urgency: its first piece is cut, one half stays on top and sinks, the other comes last and rises.
  const auto less = [](const LightPiece& a, const LightPiece& b) { return urgencyOf(a) < urgencyOf(b); };
  std::make_heap(pieces, pieces + count, less);
  while (count > 0 && count < most && urgencyOf(pieces[0]) > 0) {
    std::pop_heap(pieces, pieces + count, less);
    LightPiece& piece = pieces[count - 1];
    if (cut(piece, pieces[count])) {
      std::push_heap(pieces, pieces + count, less);
      std::push_heap(pieces, pieces + ++count, less);
    } else {
      piece.cuttable = false;
      std::push_heap(pieces, pieces + count, less);
    }
  }
  return count;
}

lw_virtual_light publicLight(const LightPiece& piece) {
  lw_virtual_light light{};
  light.type = piece.type;
  std::memcpy(light.position_m, &piece.position_m, sizeof light.position_m);
  std::memcpy(light.normal, &piece.normal, sizeof light.normal);
  std::memcpy(light.flux_rgb, piece.flux_rgb, sizeof light.flux_rgb);
  light.radius_m = piece.radius_m, light.area_m2 = piece.area_m2;
  light.vertex_count = piece.vertex_count;
  light.vertices_m = piece.vertex_count > 0 ? &piece.vertex_m[0].x : nullptr;
  return light;
}

uint32_t nextSpread(uint32_t& next, uint32_t count) {
  const uint32_t bits = uint32_t(std::bit_width(count > 1 ? count - 1 : 1u));
  for (;; ++next) {
    uint32_t reversed = 0;
    for (uint32_t b = 0; b < bits; ++b) reversed |= (next >> b & 1) << (bits - 1 - b);
    if (reversed < count) {
      ++next;
      return reversed;
    }
  }
}

}  // namespace lightwell::runtime
