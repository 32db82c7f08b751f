// GLSL sources. Each is put behind its version line by compileProgram, so that one text serves OpenGL 3.3 and OpenGL ES 3.0.
#pragma once

namespace lightwell::runtime::gl::glsl {

/// Addresses in textures that hold a long list: 2048 to a row, 2048 rows to a layer.
inline constexpr int kRow = 2048;

extern const char kVersionDesktop[], kVersionEmbedded[];
extern const char kAddress[];     // lwAddress, lwPixel, lwIndex
extern const char kVertex[];      // one triangle over everything
extern const char kLight[], kAtlas[], kLocalBases[], kEnvironment[], kProbeLight[], kBlockers[], kLightmap[];  // public snippets
extern const char kAlphaTest[];   // lwAlpha, lwLetsThrough
extern const char kOwnValue[];    // lwEntry, lwEmitted: what a texel shows, and what buried texels have themselves
// Fragment shaders.
extern const char kEntries[], kClusters[], kRank[], kSelect[], kPanes[], kReconstruct[];
extern const char kRadiosityPatches[], kRadiosityNodes[], kRadiosityGather[], kRadiosityShade[], kInjectSee[], kInjectAdd[], kProbes[];
extern const char kVplDepth[], kVplIrradiance[], kVplLight[], kVplShow[];
extern const char kHash[], kVplAlphaOn[];
// Vertex shaders.
extern const char kLampViewVertex[], kInjectAddVertex[], kVplDepthVertex[];

}  // namespace lightwell::runtime::gl::glsl
