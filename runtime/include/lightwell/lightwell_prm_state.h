/* Radiance maps from frame to frame on the CPU: where the light has not changed nothing is summed and no texel is written.
 *
 *   lw_prm_state_create(prm, &state);
 *   lw_prm_cluster_irradiance(prm, e, c);                         every frame, as for lw_prm_evaluate;
 *   lw_prm_state_update(state, c, NULL, atlas_rgba, &changed);      the same atlas again and again:
 *   if (changed.rows) upload(atlas_rgba, changed.first_row, changed.rows);
 *
 * Conventions, threads and results are as in lightwell.h. On OpenGL lw_gl_evaluate does the same by itself.
 */
#ifndef LIGHTWELL_LIGHTWELL_PRM_STATE_H
#define LIGHTWELL_LIGHTWELL_PRM_STATE_H

#include "lightwell/lightwell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What an atlas shows. Belongs to one thread at a time; any number of states share an lw_prm. */
typedef struct lw_prm_state lw_prm_state;

/* Memory: lw_prm_scratch_bytes; with local bases also 4 bytes for each value and 8 for each texel of the atlas that shows one. LW_OUT_OF_MEMORY without it; LW_INVALID_ARGUMENT for NULL.
 *
 * state: receives a handle, to be released with lw_prm_state_release. It needs no lw_prm that the caller keeps. */
LW_API lw_result lw_prm_state_create(const lw_prm *prm, lw_prm_state **state);
LW_API void lw_prm_state_release(lw_prm_state *state);

typedef struct lw_prm_changes {
  uint32_t texels;           /* of the atlas that may have changed */
  uint32_t first_row, rows;  /* of the atlas: they all lie in these; rows 0: nothing has changed */
} lw_prm_changes;

/* Brings the atlas to the light of this frame. What it holds then is what lw_prm_evaluate gives, but for the tolerance of the options and the rounding of sums that were brought from light to light.
 *
 * The whole atlas is written in the first call, whenever atlas_rgba is another place than in the last call, and when emitters, fill or sky_rgb of the options are others; else the texels whose sums
 * have changed. Panes are summed as lw_prm_evaluate sums them, all of them each time. After lw_prm_state_forget everything is written again, as for an atlas that something else has drawn into.
 *
 * cluster_irradiance_rgb: [clusters][3], finite and >= 0, else LW_INVALID_ARGUMENT, and nothing is written.
 * options: NULL for LW_PRM_OPTIONS_INIT.
 * atlas_rgba: [height][width][4] as for lw_prm_evaluate; between calls nobody else may write to it.
 * changes: NULL or receives what was written. */
LW_API lw_result lw_prm_state_update(lw_prm_state *state, const float *cluster_irradiance_rgb, const lw_prm_options *options, float *atlas_rgba, lw_prm_changes *changes);
LW_API void lw_prm_state_forget(lw_prm_state *state);

#ifdef __cplusplus
}
#endif

#endif
