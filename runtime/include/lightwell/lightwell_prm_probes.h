/* Indirect light for things that move, from the same transport as the radiance maps: probes at the points that the bake was given.
 *
 *   lw_prm_probes_load(container, prm, &probes);
 *   lw_prm_probes_evaluate(probes, cluster_irradiance_rgb, NULL, scratch, scratch_bytes, radiance_sh);   each frame, for all or for those that something is near to
 *   lw_sh_irradiance((const float (*)[3])(radiance_sh + i * 27), normal, irradiance_rgb);                 or in the game's own shader
 *
 * Direct light is not in them: the game has its shadows. Conventions, memory, threads and results are as in lightwell.h.
 */
#ifndef LIGHTWELL_LIGHTWELL_PRM_PROBES_H
#define LIGHTWELL_LIGHTWELL_PRM_PROBES_H

#include "lightwell/lightwell.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lw_prm_probes lw_prm_probes;

typedef struct lw_prm_probes_info {
  uint32_t probes;             /* in the order of the bake's list */
  uint32_t has_emitter;        /* 1: emitting surfaces add a constant light */
  const float *position_m;     /* [probes][3]; lives as long as the lw_prm_probes */
} lw_prm_probes_info;

/* Decodes and checks the section "prm_probes" of the container that `prm` is of. Memory: about the decoded size of the section. Fails as lw_decode_array does; LW_NOT_FOUND when the bake was
 * given no points; LW_INVALID_ARGUMENT for a prm with panes.
 *
 * probes: receives a handle, to be released with lw_prm_probes_release. It needs no lw_prm that the caller keeps. */
LW_API lw_result lw_prm_probes_load(const lw_container *container, const lw_prm *prm, lw_prm_probes **probes);
LW_API void lw_prm_probes_release(lw_prm_probes *probes);
LW_API lw_result lw_prm_probes_get_info(const lw_prm_probes *probes, lw_prm_probes_info *info);

typedef struct lw_prm_probes_evaluation {
  size_t size;                 /* sizeof(lw_prm_probes_evaluation), set by LW_PRM_PROBES_EVALUATION_INIT */
  uint32_t emitters;           /* 1: with the light of emitting surfaces, straight and reflected; 0: without */
  const uint32_t *probe;       /* [count]: which; NULL: all */
  uint32_t count;
} lw_prm_probes_evaluation;
#define LW_PRM_PROBES_EVALUATION_INIT {sizeof(lw_prm_probes_evaluation), 1, NULL, 0}

/* Bytes of scratch memory that lw_prm_probes_evaluate needs; 0 for NULL. */
LW_API size_t lw_prm_probes_scratch_bytes(const lw_prm_probes *probes);

/* What probes receive when the clusters have this light: reflected once or more, from all sides. Where the coefficients would give some normal a negative irradiance, all but the first are scaled
 * down until none is: the mean stays. LW_NOT_FOUND for a probe beyond the last.
 *
 * cluster_irradiance_rgb: [clusters][3], finite and ≥ 0, else LW_INVALID_ARGUMENT.
 * evaluation: NULL for LW_PRM_PROBES_EVALUATION_INIT.
 * scratch: lw_prm_probes_scratch_bytes bytes, 4-byte aligned, one per call at a time.
 * radiance_sh: [probes, or count][9][3], integrals of radiance times Y in the order of lw_environment_info.sky_radiance_sh: what lw_sh_irradiance takes. */
LW_API lw_result lw_prm_probes_evaluate(const lw_prm_probes *probes, const float *cluster_irradiance_rgb, const lw_prm_probes_evaluation *evaluation, void *scratch,
                                        size_t scratch_bytes, float *radiance_sh);

#ifdef __cplusplus
}
#endif

#endif
