// Points and triangles of a chart's plane, in double.
#pragma once
#include <ImathVec.h>

#include <array>

namespace lightwell::atlas {

using Vec2d = Imath::V2d;
using PlanarTriangle = std::array<Vec2d, 3>;

}  // namespace lightwell::atlas
