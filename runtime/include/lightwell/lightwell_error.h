/* How far off the light of a container is, as its bake has measured it: for players who choose between files, for tools, for a game's own log.
 *
 *   lw_count_measured_errors(container, "lightmap", &count);
 *   lw_get_measured_errors(container, "lightmap", count, errors);
 *
 * Conventions, memory, threads and results are as in lightwell.h.
 */
#ifndef LIGHTWELL_LIGHTWELL_ERROR_H
#define LIGHTWELL_LIGHTWELL_ERROR_H

#include "lightwell/lightwell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A share of one, not a percentage, with bounds that hold the true value in about 95 of 100 cases; low = high = 0: not known. */
typedef struct lw_estimate {
  double value, low, high;
} lw_estimate;

/* Errors of irradiance c against path-traced irradiance r that knows nothing of the bake, over lit texels; where lights move, medians over test lights. */
typedef struct lw_measured_error {
  char section[64];      /* "prm", "lightmap", … */
  char against[256];     /* what it was measured with, in words (UTF-8); cut where it is longer */
  lw_estimate relrmse;   /* rms(c - r) / rms(r), ≥ 0: what the bright parts are off by */
  lw_estimate texrel;    /* sqrt(mean(((c - r) / (r + 0.1 mean r))²)), ≥ 0: the error seen in each texel, dark ones too */
  lw_estimate bias;      /* mean c / mean r - 1 */
  lw_estimate maximum;   /* the largest |c - r| of a texel that was measured / rms(r); all 0 in files of older bakes */
  double seconds;        /* that the section took to bake; 0: not recorded */
  uint32_t texels;       /* that were measured, of a sky: directions; 0: not recorded */
} lw_measured_error;

/* How many errors are known of a section; 0 when nothing was measured, or the container does not have it. Fails as lw_decode_array does, but not with LW_NOT_FOUND.
 *
 * section: its type; NULL: of all sections together.
 * count: receives the number. A section has several where its light was measured in several ways. */
LW_API lw_result lw_count_measured_errors(const lw_container *container, const char *section, uint32_t *count);

/* One of them. LW_NOT_FOUND for an index that is not below the count. Else fails as lw_count_measured_errors. Reads the section's header anew: many are had at once from lw_get_measured_errors. */
LW_API lw_result lw_get_measured_error(const lw_container *container, const char *section, uint32_t index, lw_measured_error *error);

/* The first `count` of them, in the time of one. LW_NOT_FOUND when there are fewer; what was written then is not to be used. Else fails as lw_count_measured_errors.
 *
 * errors: [count]; may be NULL when that is 0. */
LW_API lw_result lw_get_measured_errors(const lw_container *container, const char *section, uint32_t count, lw_measured_error *errors);

#ifdef __cplusplus
}
#endif

#endif
