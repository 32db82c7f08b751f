// Form factors on the GPU, and the light that they carry there.
#pragma once
#include "runtime/src/gl/programs.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/radiosity.h"

struct lw_gl_radiosity {
  using Name = lightwell::runtime::gl::Name;
  using Target = lightwell::runtime::gl::Target;
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  uint32_t patches = 0, gate_sets = 0, materials = 0, width = 0, height = 0;
  uint32_t levels = 0, level_first[lightwell::runtime::kMostRadiosityLevels + 1] = {};
  uint64_t texture_bytes = 0;
  bool owns_atlas = false, emits = false, emitters_valid = false;
  float max_value = 0;                    // of the atlas's format
  Array<float> gate_open;                 // [gates], as uploaded last
  uint32_t portals_uploaded = 1;          // how often, and once more
  Array<float> row_sum;                   // [patches]: share of what leaves the others that is received, at most
  float gain_rgb[3] = {};                 // bound on what a sweep leaves of an error

  Name link = 0, row = 0, run = 0;        // R32UI, RGBA32UI, RG32UI lists; see kRadiosityGather
  Name gate = 0;                          // R32F list, by gate set
  Name share = 0;                         // R32F list, by node; see kRadiosityNodes
  Name albedo = 0, emitted = 0, kept = 0; // RGBA32F lists, by patch
  Name texel_map = 0;                     // RG32UI, width × height: what a texel shows, what it has; 0xffffffff: nothing
  Name texel_patch = 0, texel_weight = 0; // RGBA32UI list; RG32UI list: four weights of eight bits, exposure

  Target direct, emitters;                // by patch: irradiance of lights, of emitters
  Target irradiance[3];                   // by patch: the last solution, the one before, the next; they take turns
  uint32_t current = 0;
  Target node, level;                     // radiosities of all nodes; of one level while it is made
  Target atlas;
};

/// The container's triangles, and a view of them. Works for one lw_gl_radiosity.
struct lw_gl_radiosity_injector {
  using Name = lightwell::runtime::gl::Name;

  lightwell::runtime::Host host;
  lw_gl_radiosity* target = nullptr;
  uint32_t side = 0, triangles = 0;
  uint64_t texture_bytes = 0;
  float bounds_min_m[3] = {}, bounds_max_m[3] = {};
  lightwell::runtime::Array<double> corner;  // [2][side + 1]: see cornerAngles

  Name corners = 0, triangle = 0;         // RGBA32F, RGBA32UI lists; see kInjectSee
  Name texel_patches = 0;                 // RG32UI, width × height
  Name patch = 0;                         // RGBA32F list
  Name alpha_material = 0, alpha = 0;     // RGBA32UI, R8 lists
  lightwell::runtime::Array<float> leaf_values;  // of each leaf its axis, offset, where its first gate is, strips; then how far each gate is open
  Name leaf = 0;                          // R32F list of these
  uint32_t portals_seen = 0;              // lw_gl_radiosity::portals_uploaded when it was uploaded
  lightwell::runtime::gl::Target seen;    // RG32UI, side × side
  Name depth = 0;
};

namespace lightwell::runtime::gl {

/// Draws the rows of the target that hold elements [begin, end).
void drawInto(const lw_gl_radiosity& radiosity, const Target& target, uint32_t begin, uint32_t end);
void bind(const Api& api, uint32_t unit, Enum target, Name texture);
/// Radiosities of all nodes: LW_RADIOSITY_INDIRECT, what patches reflect of the current solution; LW_RADIOSITY_EMITTERS, what they emit.
void updateNodes(const lw_gl_radiosity& radiosity, uint32_t light);

}  // namespace lightwell::runtime::gl
