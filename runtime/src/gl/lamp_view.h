// What shaders of a lamp's view (glsl::kLampViewVertex) are told of it.
#pragma once
#include "runtime/src/gl/api.h"
#include "runtime/src/radiosity_view.h"

namespace lightwell::runtime::gl {

/// `uniform`: locations of u_eye, u_right, u_up and u_forward, of the program in use. Nothing nearer than `nearest_m` is seen; `extent_m` is that of the scene.
inline void setView(const Api& api, const int32_t* uniform, const View& view, double nearest_m, double extent_m) {
  float eye[4], right[4] = {}, up[4] = {}, forward[4];
  for (int k = 0; k < 3; ++k) {
    eye[k] = float(view.eye_m[k]);
    right[k] = float(view.right[k] / dot(view.right, view.right));
    up[k] = float(view.up[k] / dot(view.up, view.up));
    forward[k] = float(view.forward[k]);
  }
  eye[3] = view.perspective ? float(nearest_m) : 0;
  forward[3] = float(0.99 / extent_m);
  const float* values[4] = {eye, right, up, forward};
  for (int i = 0; i < 4; ++i) api.Uniform4fv(uniform[i], 1, values[i]);
}

}  // namespace lightwell::runtime::gl
