/* The public headers are C99 and need nothing before them. */
#include "lightwell/lightwell_gl_dynamic.h"
#include "lightwell/lightwell_gl_vpl.h"
#include "lightwell/lightwell_error.h"
#include "lightwell/lightwell_prm_state.h"
#include "lightwell/lightwell_prm_probes.h"
#include "lightwell/lightwell_gl.h"
#include "lightwell/lightwell.h"

int main(void) {
  lw_config config = LW_CONFIG_INIT;
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  lw_gl_config gl_config = LW_GL_CONFIG_INIT;
  lw_gl_prm_options gl_options = LW_GL_PRM_OPTIONS_INIT;
  lw_gl_light light = LW_GL_LIGHT_INIT;
  lw_gl_environment_options sky = LW_GL_ENVIRONMENT_OPTIONS_INIT;
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  lw_gl_vpl_options light_map = LW_GL_VPL_OPTIONS_INIT;
  lw_prm_probes_evaluation probes = LW_PRM_PROBES_EVALUATION_INIT;
  lw_container *container = NULL;
  lw_gl *gl = NULL;
  if (config.size != sizeof config || probes.emitters != 1 || options.emitters != (LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT) || gl_options.atlas_texture != 0 || light.shadow_matrix[15] != 1)
    return 1;
  if (sky.bounds_max_m[2] != 1 || shading.technique != LW_ENVIRONMENT_SHARE || shading.scale_rgb[2] != 1) return 5;
  if (light_map.size != sizeof light_map || light_map.fill != 1 || light_map.epsilon != 0.0f) return 6;
  if (lw_open_memory("not a container", 15, &config, &container) != LW_BAD_MAGIC) return 2;
  if (lw_gl_create(&gl_config, &gl) != LW_INVALID_ARGUMENT) return 3;
  return lw_version() == LW_VERSION ? 0 : 4;
}
