// The convex hull of points on the unit sphere: their Delaunay triangulation there. Points of a plane are lifted by stereographic projection, which keeps circles circles.
#pragma once
#include "runtime/src/host.h"

namespace lightwell::runtime {

struct Double3 {
  double x, y, z;
};
inline Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Double3 cross(Double3 a, Double3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

class SphereHull {
 public:
  struct Face {
    uint32_t corner[3];  // counter-clockwise from outside
    Double3 normal;      // unit: the middle of the empty circle through the corners
    double offset;       // cosine of that circle's radius
  };
  static constexpr uint32_t kNone = 0xffffffffu;

  /// For up to `points` points. False when there is no memory.
  bool allocate(const Host& host, uint32_t points);
  /// The hull of points[0 … count); false when they lie in a plane or nearly so, or are fewer than four: no faces then.
  bool build(const Double3* points, uint32_t count);
  /// Adds a point; one that lies on the hull already (another is there) or is no point of the sphere changes nothing.
  void insert(Double3 point);

  uint32_t count() const { return faces_; }
  const Face& face(uint32_t i) const { return face_[i]; }
  const Double3& point(uint32_t i) const { return point_[i]; }

 private:
  void add(uint32_t a, uint32_t b, uint32_t c);
  void addToHull(uint32_t point);

  Array<Double3> point_;
  Array<Face> face_;
  Array<uint32_t> visible_;      // faces
  Array<uint32_t> horizon_;      // edges: two corners each
  uint32_t points_ = 0, faces_ = 0;
};

}  // namespace lightwell::runtime
