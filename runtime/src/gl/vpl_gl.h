// Light maps from virtual lights on the GPU.
#pragma once
#include "lightwell/lightwell_gl_vpl.h"
#include "runtime/src/gl/context.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/light_pieces.h"

namespace lightwell::runtime::gl {

inline constexpr uint32_t kMostVplLayers = 32;

/// The lights of one source, and what they are to be next.
struct VplSource {
  Array<LightPiece> pieces;         // that its layer holds, or that are being drawn into it
  Array<LightPiece> next_pieces;    // with `moved`: what takes their place
  Array<LightPiece> old_pieces;     // what is being subtracted
  float scale_rgb[3] = {1, 1, 1};   // wanted
  float drawn_rgb[3] = {1, 1, 1};   // in its layer; 1 where the layer is its own
  bool moved = false;
};

/// One piece to draw, with its flux times a factor that may be negative.
struct VplDraw {
  const LightPiece* piece;
  float factor_rgb[3];
};

/// A layer's change in progress: what is drawn goes into the spare layer, which takes the place of the old one at the end.
struct VplJob {
  uint32_t layer = 0, drawn = 0, order = 0;   // order: state of nextSpread
  double power = 0, power_drawn = 0;
  Array<VplDraw> draws;
  bool active = false;
};

namespace vpl_depth_uniform {
enum { right, up, forward, eye };
}
namespace vpl_light_uniform {
enum { light, values };
}
namespace vpl_show_uniform {
enum { weights, layers, max };
}

}  // namespace lightwell::runtime::gl

struct lw_gl_vpl {
  using Name = lightwell::runtime::gl::Name;
  using Target = lightwell::runtime::gl::Target;
  using Program = lightwell::runtime::gl::Program;
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  lw_gl_vpl_options options{};
  uint64_t texture_bytes = 0;
  Program depth, depth_alpha, light, show;

  // Surfaces.
  uint32_t values = 0, opaque_triangles = 0, triangles = 0;
  float extent_m = 0;                     // half of the diagonal of the scene's bounds
  Name place = 0, normal = 0, axes = 0;   // RGBA32F lists, by value; RGBA16F list, two for each
  Name shown = 0;                         // R32UI, atlas: value, or 0xffffffff
  Name corner = 0, alpha_corner = 0;      // RGBA32F lists: of all triangles, opaque ones first; of those with alpha
  Name alpha_material = 0, alpha = 0;     // as in lw_gl_radiosity_injector
  Target depth_map;                       // five faces of a half cube: see kVplDepthVertex

  // Light.
  Array<lightwell::runtime::gl::VplSource> sources;
  uint32_t layers = 0;                    // one more textures' layers than this
  Name layer_texture = 0;                 // RGBA32F, by value
  Name layer_framebuffer[lightwell::runtime::gl::kMostVplLayers + 1] = {};
  int32_t layer_width = 0, layer_height = 0;
  uint32_t texture_layer[lightwell::runtime::gl::kMostVplLayers + 1] = {};  // of each layer; the last: the spare one
  uint32_t changes[lightwell::runtime::gl::kMostVplLayers] = {};            // since it was drawn from darkness; kNeverDrawn
  lightwell::runtime::gl::VplJob job;
  bool shown_is_old = true;
  double light_ms = 0;                    // what a light takes
  Target atlas;
  bool owns_atlas = false;
  float max_value = 0;
};

namespace lightwell::runtime::gl {

inline constexpr uint32_t kNeverDrawn = 0xffffffffu;

/// Adds one piece to the layer whose framebuffer this is: its depth map, then its light. Inside of guards of state, blending set up for sums.
void drawPiece(const lw_gl_vpl& vpl, const VplDraw& draw, Name framebuffer, const SumGuard& sum);
/// The layer of a source.
inline uint32_t layerOf(const lw_gl_vpl& vpl, uint32_t source) { return source < vpl.layers ? source : vpl.layers - 1; }
inline bool isShared(const lw_gl_vpl& vpl, uint32_t layer) { return layer + 1 == vpl.layers && vpl.sources.size() > vpl.layers; }
/// Copies and cuts the chosen lights.
lw_result takeLights(const lw_gl_vpl& vpl, const lw_virtual_light* lights, uint32_t count, Array<LightPiece>& pieces);

}  // namespace lightwell::runtime::gl
