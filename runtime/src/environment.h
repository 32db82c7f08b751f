// A decoded environment and its evaluation. docs/format.md gives the meaning of the arrays, docs/environment.md the formulas.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/host.h"
#include "runtime/src/sky_levels.h"

struct lw_environment {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lightwell::format::EnvironmentHeader header;
  Array<float> direction;       // [cells][3]
  Array<float> flux_rgb;        // [cells][3]
  Array<float> solid_angle_sr;  // [cells]
  Array<float> cos_radius;      // [cells]
  Array<float> spread;          // [cells]
  Array<float> covariance;      // [cells][3]
  Array<float> tangent;         // [cells][3]
  lightwell::runtime::SkyLevels sky;
};
