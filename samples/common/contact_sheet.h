// Many small pictures as one.
#pragma once
#include "render/png.h"

namespace lightwell::samples {

/// Means of factor × factor pixels, taken in linear light.
render::Image8 reduced(const render::Image8& image, int factor);

/// Pictures of equal size in rows of `columns`, a white line between them.
render::Image8 contactSheet(const std::vector<render::Image8>& images, int columns);

}  // namespace lightwell::samples
