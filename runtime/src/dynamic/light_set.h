// Which virtual lights of a lamp stay, go and come: Laine et al., "Incremental Instant Radiosity for Real-Time Indirect Illumination" (EGSR 2007), section 4.2.
#pragma once
#include "runtime/src/dynamic/sphere_hull.h"

namespace lightwell::runtime {

/// Where a lamp's light goes, as its virtual lights are known: by unit directions from it, or by offsets across a directional light's view, in half extents of that.
struct LampProjection {
  enum Kind { sphere, cone, plane } kind = sphere;
  float axis[3] = {0, -1, 0}, cos_outer = -1;  // cone
  float half[2] = {1, 1};                      // plane: half extents in metres
};

/// A place for a light.
struct LightRequest {
  float aim[3], light;
};

class LightSet {
 public:
  bool allocate(const Host& host, uint32_t lights);
  uint32_t lights() const { return lights_; }

  /// All lights, spread evenly. requests: [lights].
  uint32_t restart(const LampProjection& projection, LightRequest* requests) const;
  /// aims: [lights][4], direction or offset, and 0 where a light is no longer valid. Lights that are not go, and of those that crowd most so many that at most `most_updates` (≤ lights) are placed anew;
  /// those go where it is emptiest. shining: how many lights have a place then. Returns the number of requests.
  uint32_t update(const LampProjection& projection, const float* aims, uint32_t most_updates, LightRequest* requests, uint32_t& shining);

 private:
  struct Gap {
    Double3 middle;
    double radius;  // distance to the nearest light
  };
  Double3 lifted(Double3 aim) const;
  bool isInside(Double3 aim) const;
  double room(Double3 at) const;
  int borderPlaces(Double3 a, Double3 b, Double3* places) const;
  Gap gapOf(const SphereHull::Face& face, double least) const;
  Gap widestGap() const;
  void place(Double3 aim);
  void findNearest(uint32_t i);
  void removeCrowded(uint32_t most);

  uint32_t lights_ = 0;
  const LampProjection* projection_ = nullptr;  // while update runs
  Array<Double3> aim_, hull_point_;
  Array<uint32_t> slot_, nearest_;
  Array<double> nearest_distance_, gaps_;
  uint32_t placed_ = 0;
  SphereHull hull_;
};

}  // namespace lightwell::runtime
