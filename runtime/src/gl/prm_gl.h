// A precomputed radiance map on the GPU.
#pragma once
#include "lightwell/lightwell_prm_state.h"
#include "runtime/src/gl/programs.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/running_sums.h"

struct lw_gl_prm {
  using Name = lightwell::runtime::gl::Name;
  using Target = lightwell::runtime::gl::Target;

  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  bool panes = false;
  uint32_t entries = 0, clusters = 0, texels = 0, blocks = 0, quads = 0;  // quads: of ranks, ceil(max_rank / 4)
  uint32_t width = 0, height = 0;
  uint64_t texture_bytes = 0;
  bool owns_atlas = false;
  float max_value = 0;               // of the atlas's format

  Name entry_position = 0, entry_normal = 0;  // RGBA32F lists; the position's w is the weight, the normal's the longer half side of the rectangle
  Name entry_rectangle = 0;                   // RGBA32F list; see kEntries
  Name cluster_range = 0, pane_sum = 0;       // RG32UI, RGBA32F lists
  Target entry[2];                            // irradiance; light after light they take turns
  uint32_t current_entry = 0;
  Target cluster;                             // mean irradiance, contribution
  bool entries_are_clusters = false;          // one entry each, of weight 1: after lw_gl_update_entries their light is the clusters'
  bool clusters_in_entries = false;           // and so the clusters' light now lies in entry[current_entry]

  // RG32UI, width × height: what a texel shows. Panes: index of the value, 0. Local bases: see kLocalBases. 0xffffffff:
  // nothing. The highest bit of the second is set where it is another texel's value.
  Name texel_map = 0;
  Name buried = 0;                            // RGBA32UI list; see kOwnValue
  uint32_t buried_count = 0;
  Name constant = 0;                          // RGB9E5 list [height][width][constants]; 0 without; see kOwnValue
  uint32_t constants = 0;                     // 2 each for emitters and sky: direct, indirect
  bool has_emitter = false, has_sky = false;
  float sky_scale = 1;
  Target atlas;

  Name pane = 0;                              // list [cluster][texel]
  Target rank, selected;
  lightwell::runtime::Array<float> pane_sum_rgb;  // [clusters][3]; empty for local bases

  // Local bases: amounts are summed on the CPU, from the transport that is kept for it. With a state also the atlas is made there.
  lw_prm_state* state = nullptr;
  lightwell::runtime::Array<float> atlas_rgba;      // [height][width][4], of the state; one of the two, as the texture
  lightwell::runtime::Array<uint16_t> atlas_half;
  lw_prm* transport = nullptr;
  Name basis = 0;                             // list; see kLocalBases
  Name amount = 0;                            // RGBA32F, 4 layers of amount_width × amount_height
  int32_t amount_width = 0, amount_height = 0;
  lightwell::runtime::Array<float> cluster_rgba, cluster_rgb;  // staging: as read back, or as given; [clusters][3]
  lightwell::runtime::RunningSums sums;
  lightwell::runtime::Array<float> amount_rgba;  // [4][amount_height][amount_width][4], as uploaded
  bool clusters_on_cpu = false;               // cluster_rgb holds what the cluster texture does
  bool drawn = false;                         // the atlas holds the last reconstruction, with these options:
  lw_prm_options drawn_options = LW_PRM_OPTIONS_INIT;
};

namespace lightwell::runtime::gl {

inline const Target& clusterLight(const lw_gl_prm& prm) { return prm.clusters_in_entries ? prm.entry[prm.current_entry] : prm.cluster; }

/// Draws one triangle over the target with the program that is in use. Inside a StateGuard.
void drawInto(const lw_gl_prm& prm, const Target& target);
/// Whether shaders run on the CPU.
bool isSoftware(const Api& api);
/// Readies what evaluateOnCpu() needs, from the transport and the atlas that are there.
lw_result prepareOnCpu(lw_gl_prm& prm);
/// lw_gl_evaluate of local bases without a shader, from the light in cluster_rgb.
lw_result evaluateOnCpu(lw_gl_prm& prm, const lw_prm_options& options);

/// Makes `texture` what the sampler of this unit reads.
void bindUnit(const Api& api, uint32_t unit, Enum target, Name texture);

}  // namespace lightwell::runtime::gl
