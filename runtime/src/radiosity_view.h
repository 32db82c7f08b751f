// A light's view of the scene as numbers of triangles: what each pixel's light meets.
#pragma once
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// What light passes through: texture coordinates and materials of triangles with alpha. Empty when nothing has alpha.
struct AlphaSurfaces {
  Array<float> uv;                      // [vertices][2]
  Array<uint16_t> triangle_material;    // [triangles]; 0xffff: opaque
  Array<lw_alpha_material> material;
  Array<size_t> first_alpha;            // [materials]: into `alpha`
  Array<uint8_t> alpha;                 // of all textures

  /// Whether light goes through the triangle at these barycentrics. Blended surfaces stop it where they cover half.
  bool letsThrough(const uint32_t* corners, uint32_t triangle, const double* barycentrics) const;
};

/// The leaf of a portal: what of it is drawn depends on how far its strips are open.
struct Leaf {
  uint32_t first_triangle, triangles;
  float axis_per_m[3], offset;
  uint32_t first_gate, strips;
};

struct Surfaces {
  Array<float> position_m;              // [vertices][3]
  Array<uint32_t> index;                // [triangles][3]
  AlphaSurfaces alpha;
  Array<Leaf> leaf;
  Array<float> gate_open;               // [gates]
  uint32_t triangles() const { return uint32_t(index.size() / 3); }
  /// The leaf that a triangle belongs to, or null.
  const Leaf* leafOf(uint32_t triangle) const {
    for (const Leaf& l : leaf)
      if (triangle - l.first_triangle < l.triangles) return &l;
    return nullptr;
  }
  /// Whether a point of a leaf is where it has opened.
  bool isOpen(const Leaf& l, const uint32_t* corners, const double* barycentrics) const;
};

inline double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A picture of n × n pixels. Pixel (i, j) has x = (2i + 1) / n − 1 and y alike. Perspective: it looks from `eye_m` along forward + x · right + y · up. Orthographic:
/// along forward from eye + x · right + y · up.
struct View {
  bool perspective = true;
  double eye_m[3], right[3], up[3], forward[3];
};

/// Rasterises triangles with two-dimensional homogeneous coordinates (Olano, Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997): nothing needs to
/// be clipped at a near plane. Edges that triangles share are evaluated with opposite signs, exactly, and pixel centres on them belong to one of the two.
class ViewRaster {
 public:
  static constexpr uint32_t kNothing = 0xffffffffu;

  bool allocate(const Host& host, uint32_t side) {
    side_ = side;
    return triangle_.allocate(host, size_t(side) * side) && nearness_.allocate(host, size_t(side) * side);
  }
  uint32_t side() const { return side_; }
  void draw(const Surfaces& surfaces, const View& view);

  /// What a pixel sees: kNothing or a triangle.
  uint32_t triangleAt(uint32_t i, uint32_t j) const { return triangle_[size_t(j) * side_ + i]; }
  /// Where: barycentrics of the pixel's centre in the triangle that it sees, and its depth along `forward`.
  double placeAt(const Surfaces& surfaces, const View& view, uint32_t i, uint32_t j, double* barycentrics) const;

 private:
  void drawTriangle(const Surfaces& surfaces, const View& view, uint32_t triangle);
  double center(uint32_t i) const { return (2.0 * i + 1.0) / side_ - 1.0; }

  uint32_t side_ = 0;
  Array<uint32_t> triangle_;
  Array<double> nearness_;  // 1 / depth; orthographic: −depth
};

}  // namespace lightwell::runtime
