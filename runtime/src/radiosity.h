// Form factors and what is known of the light that they carry. docs/format.md gives the meaning of the container's arrays.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// A colour, padded to what one vector register holds.
struct Float4 {
  float v[4];
};

/// Consecutive links of a row that share a gate set. Without portals there is one run for each row.
struct LinkRun {
  uint32_t end_link;
  uint32_t gate_set;
};

inline constexpr uint32_t kRadiosityBranching = 8;
inline constexpr uint32_t kMostRadiosityLevels = 9;  // 8^8 = 2^24 nodes
inline constexpr uint32_t kMostLinkNodes = 1u << 24;
inline constexpr float kMostAlbedo = 0.999f;
/// Beyond this nothing is a sensible radiosity; sums of weighted ones stay finite.
inline constexpr float kMostRadiosity = 1e26f;

}  // namespace lightwell::runtime

struct lw_radiosity {
  template <class T>
  using Array = lightwell::runtime::Array<T>;
  struct Portal {
    uint32_t name, first_gate, strips;  // name: into `names`
    uint32_t first_triangle, triangles;
    float axis_per_m[3], offset;        // s(p) = axis · p + offset: where a leaf opens first 0, last 1
  };

  lightwell::runtime::Host host;
  lightwell::format::RadiosityHeader header;
  uint32_t width = 0, height = 0;       // of the atlas
  Array<uint32_t> source;               // [height * width]; each texel's source is its own source, or none
  uint32_t gates = 0, gate_sets = 1;

  // Nodes: level k is [level_first[k], level_first[k + 1]); level 0 are the patches.
  uint32_t levels = 1, level_first[lightwell::runtime::kMostRadiosityLevels + 1] = {};
  Array<float> node_share;              // [nodes]: of the area of the node above

  Array<float> patch_area_m2, patch_position_m, patch_normal, patch_albedo_rgb, patch_emission_rgb;  // [patches], [patches][3]
  Array<uint16_t> patch_material;

  Array<uint32_t> link;                 // [links]: node << 8 | code
  Array<uint32_t> row_first_run;        // [patches + 1]
  Array<lightwell::runtime::LinkRun> run;
  Array<float> row_scale;               // [patches]
  Array<uint32_t> gate_set_first;       // [gate_sets + 1]
  Array<uint16_t> gate_set;             // gate * 2 + closed

  Array<uint32_t> texel;                // [texels]; ascending
  Array<uint32_t> texel_patch;          // [texels][4]; kNone: none
  Array<uint8_t> texel_weight;          // [texels][4]
  Array<uint8_t> texel_exposed;         // [texels]
  Array<uint32_t> texel_back_patch;     // [texels], or empty

  Array<uint32_t> material_name;        // [materials]: into `names`
  Array<Portal> portal;
  Array<char> names;                    // ended by zeros

  uint32_t patches() const { return header.patches; }
  uint32_t nodes() const { return level_first[levels]; }
};

/// Everything but `radiosity` is by patch unless a comment says otherwise.
struct lw_radiosity_state {
  template <class T>
  using Array = lightwell::runtime::Array<T>;
  using Float4 = lightwell::runtime::Float4;

  lightwell::runtime::Host host;
  const lw_radiosity* radiosity = nullptr;
  Array<lw_radiosity_material> material;  // [materials]
  Array<float> gate_open;                 // [gates]
  Array<float> gate_set_factor;           // [gate sets]: how much of a link with that set counts
  Array<Float4> albedo;
  Array<Float4> emitted;                  // radiosity: π times radiance
  Array<Float4> direct;                   // irradiance of lights
  Array<Float4> kept;                     // what blockers leave of it
  Array<Float4> irradiance;               // the solution so far: from other patches, emitters among them
  Array<Float4> node;                     // [nodes]: radiosity while sweeping
  Array<Float4> emitter_irradiance;       // straight from emitters; see emitter_irradiance_valid
  bool emits = false, emitter_irradiance_valid = false;
};

namespace lightwell::runtime {

constexpr float linkWeight(uint32_t code) { return float((16u + (code & 15u)) << (code >> 4)); }

/// Fills node[0 … patches) with radiosities of the patches: albedo · (direct + kept · irradiance) (LW_RADIOSITY_INDIRECT) + emitted (LW_RADIOSITY_EMITTERS).
void patchRadiosity(const lw_radiosity_state& state, const Float4* irradiance, Float4* node,
                    uint32_t light = LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS);
/// Fills the nodes above the patches with the means of those below.
void averageNodes(const lw_radiosity& radiosity, Float4* node);
/// What every patch receives from the nodes.
void gather(const lw_radiosity_state& state, const Float4* node, Float4* irradiance);
/// Brings emitter_irradiance up to date.
void updateEmitterIrradiance(lw_radiosity_state& state);

}  // namespace lightwell::runtime
