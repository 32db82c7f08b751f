// GLSL of the renderer, without #version lines: good for 330 core and 300 es. LW_GLSL_ATLAS and LW_GLSL_LIGHT of the runtime go before
// the fragment shaders that call them.
#pragma once

namespace lightwell::render {

extern const char* const kSceneVertexGlsl;      // attributes of SceneMesh; view_projection
extern const char* const kAlphaGlsl;            // float surfaceAlpha(): discards cut-outs
extern const char* const kDepthFragmentGlsl;    // shadow maps
extern const char* const kBaseFragmentGlsl;     // atlas irradiance and emission
extern const char* const kLightFragmentGlsl;    // one light with its shadow map; #define SHADOW_CUBE for a cube map
extern const char* const kEnvironmentFragmentGlsl;  // the light of the sky, LW_GLSL_ENVIRONMENT before it
extern const char* const kEnvironmentPointFragmentGlsl;
extern const char* const kBackgroundVertexGlsl;     // one triangle over the target, a direction for each pixel
extern const char* const kBackgroundFragmentGlsl;   // the sky itself, LW_GLSL_ENVIRONMENT before it
extern const char* const kLampVertexGlsl;       // a glow that faces the camera
extern const char* const kLampFragmentGlsl;
extern const char* const kScreenVertexGlsl;     // one triangle over the target
extern const char* const kToneMapFragmentGlsl;  // radiance to sRGB

}  // namespace lightwell::render
