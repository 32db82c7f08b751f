// GLSL of lamps that move. Each text is put behind its version line as those of runtime/src/gl/shaders.h are.
#pragma once

namespace lightwell::runtime::gl::glsl {

// Parts that others include.
extern const char kLampLookup[];       // lwLampIrradiance: public
extern const char kOctahedron[];       // lwUnfold, and the frame and the map of a half sphere
extern const char kLampViews[];        // lwLampAim, lwLampPixel: from points to directions to pixels of the views
// Programs, each a fragment shader and, where it has its own, a vertex shader.
extern const char kLampSee[];
extern const char kFluxSum[], kFluxReduce[];
extern const char kSampleLights[];
extern const char kCheckLights[];
extern const char kPlaceVertex[], kPlaceLights[];
extern const char kShareVertex[], kShareFlux[];
extern const char kTilesVertex[], kTilesClear[], kTilesPull[], kTilesPush[];
extern const char kSplatVertex[], kSplat[];
extern const char kGatherTexels[], kShowTexels[], kLampVisibility[];

}  // namespace lightwell::runtime::gl::glsl
