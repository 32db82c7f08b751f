// Errors of an irradiance map as a picture.
#pragma once
#include "precompute/core/image.h"
#include "render/png.h"

namespace lightwell::cli {

/// White where both agree, red where `candidate` is brighter, blue where it is darker: full colour from a fifth of the reference's rms on (as in figure 10 of Luksch et al., "Fast Light-Map Computation with Virtual Polygon
/// Lights", errors are shown five times larger; here with their sign). Grey where one of them covers nothing. Small maps are shown with several pixels a texel. The maps have the same size. `second_reference` may be null; with it the mean of both is the reference.
render::Image8 errorPicture(const ImageRgba& reference, const ImageRgba* second_reference, const ImageRgba& candidate);

}  // namespace lightwell::cli
