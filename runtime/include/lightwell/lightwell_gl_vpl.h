/* Light maps at load time on OpenGL: the sum of a container's virtual lights over the texels of its atlas, each shadowed, drawn over as many frames as it takes.
 *
 *   lw_virtual_lights_load(container, &virtual_lights);
 *   lw_gl_vpl_create(gl, container, virtual_lights, NULL, &gl_vpl);      uploads surfaces and lights, which may then be released
 *   lw_gl_vpl_step(gl_vpl, 4.0, &progress);                             every frame: lights for 4 ms, until progress.lights_left is 0
 *   glBindTexture(GL_TEXTURE_2D, lw_gl_vpl_texture(gl_vpl));            RGBA, linear filter: irradiance
 *   lw_gl_vpl_set_source_scale(gl_vpl, lamp, colour);                   a lamp changes its colour: shown with the next step
 *   lw_gl_vpl_set_source_lights(gl_vpl, lamp, lights, count);           a lamp moves, or goes (0 lights): the next steps draw its new lights
 *
 * Each source has a layer of its own as long as there are layers, so that what changes of one source costs that source's lights alone, and its colour none at all. While lights
 * of a change are on their way the texture fades from the old solution to the new one as they come.
 *
 * Contexts, coordinates and errors are as in lightwell_gl.h. GL state: what lw_gl_radiosity_inject uses, and restores; glClipControl must be as OpenGL has it at first.
 */
#ifndef LIGHTWELL_LIGHTWELL_GL_VPL_H
#define LIGHTWELL_LIGHTWELL_GL_VPL_H

#include "lightwell/lightwell_gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lw_gl_vpl lw_gl_vpl;

enum { LW_GL_VPL_DIRECT = 1, LW_GL_VPL_INDIRECT = 2 };

typedef struct lw_gl_vpl_options {
  size_t size;               /* sizeof(lw_gl_vpl_options), set by LW_GL_VPL_OPTIONS_INIT */
  uint32_t atlas_format;     /* as in lw_gl_prm_options */
  uint32_t atlas_texture;    /* as in lw_gl_prm_options */
  uint32_t fill;             /* 1: for display, gutters and buried texels show the value of their source; 0: for measuring, each covered texel has its own value, others are zero */
  uint32_t component;        /* LW_GL_VPL_DIRECT: lights of bounce 0 (emitters); LW_GL_VPL_INDIRECT: the others; or both */
  uint32_t layers;           /* 1 to 32: sources with a layer of their own; where there are more sources, the last layer is shared by the rest */
  uint32_t shadow_map_side;  /* pixels along the middle face of a light's half cube, even, 16 to 2048; 0: nothing casts a shadow */
  uint32_t filter_samples;   /* 1 to 32 rays from each texel to the light */
  uint32_t blocker_samples;  /* 0 to 32 places of the map where each texel looks for what may hide a part of the light, for soft shadows of few pieces; 0: each piece's shadow has sharp edges */
  float pieces;              /* 1 to 16: polygons with most light and largest size are cut in two until there are so many pieces for each light on average: each has a shadow map of its own */
  float epsilon;             /* 0 to 2, in sides of a texel: as epsilon_m of lw_virtual_light_irradiance. Texels are evaluated where their own surface is, so that 0 is best for meshes that fit */
} lw_gl_vpl_options;
#define LW_GL_VPL_OPTIONS_INIT {sizeof(lw_gl_vpl_options), LW_GL_ATLAS_RGBA16F, 0, 1, LW_GL_VPL_DIRECT | LW_GL_VPL_INDIRECT, 16, 256, 8, 0, 8.0f, 0.0f}

/* Decodes the geometry, finds the surface in each texel, uploads both, compiles the shaders. Nothing of container and lights is used afterwards. The texture is dark.
 * Fails with LW_GL_UNSUPPORTED (on ES EXT_float_blend is needed), LW_LIMIT_EXCEEDED (more than 2^22 texels with a value; texture sizes), LW_OUT_OF_MEMORY, LW_GL_FAILED,
 * LW_INVALID_ARGUMENT, and as lw_decode_array does for the sections geometry and atlas.
 *
 * lights: NULL: none at first, 1 source.
 * options: NULL for LW_GL_VPL_OPTIONS_INIT.
 * gl_vpl: receives a handle; destroy it before `gl`. */
LW_API lw_result lw_gl_vpl_create(lw_gl *gl, const lw_container *container, const lw_virtual_lights *lights, const lw_gl_vpl_options *options, lw_gl_vpl **gl_vpl);
LW_API void lw_gl_vpl_destroy(lw_gl_vpl *gl_vpl);

/* GL name of the light map: GL_TEXTURE_2D, width × height of the atlas, irradiance in RGB and 1 in A where a texel has a value; linear filter, clamped to the edge. 0 for NULL. */
LW_API uint32_t lw_gl_vpl_texture(const lw_gl_vpl *gl_vpl);
/* Bytes of texture memory that were asked for: for each texel with a value 48, and 16 a layer and for one more layer; 4 an atlas texel, and the atlas; 12 a pixel of the middle
 * face; 48 a triangle. */
LW_API uint64_t lw_gl_vpl_texture_bytes(const lw_gl_vpl *gl_vpl);

typedef struct lw_gl_vpl_progress {
  uint32_t lights_drawn;     /* by this call; pieces of lights count as lights */
  uint32_t lights_left;      /* of all changes so far; 0: the texture is complete */
  double ms;                 /* that this call took, by the clock of the thread that waits for the GPU */
} lw_gl_vpl_progress;

/* Draws whole lights until the budget is used up, and the texture; nothing, and at once, when all is done. At least one light is drawn; another only when, by what the last ones took, it
 * fits into what is left. The time is that of the clock between two waits for the GPU: the only one that holds for software rasterisers, too, whose timer queries leave out vertices.
 * What the game has given the GPU before the call is waited for first, and is not counted. LW_INVALID_ARGUMENT for a budget that is negative or not finite.
 *
 * budget_ms: 0: exactly one light. progress: NULL, or receives what was done. */
LW_API lw_result lw_gl_vpl_step(lw_gl_vpl *gl_vpl, double budget_ms, lw_gl_vpl_progress *progress);

/* All light of a source is scaled: by colour and intensity of the lamp now over those that it was baked with. A source with a layer of its own shows it with the next step, as it is; in a shared
 * layer its lights are drawn again, each once, with the difference. LW_NOT_FOUND for a source beyond the last; LW_INVALID_ARGUMENT for a number that is not 0 to 1e12. */
LW_API lw_result lw_gl_vpl_set_source_scale(lw_gl_vpl *gl_vpl, uint32_t source, const float rgb[3]);

/* The lights of a source that has moved: from then on it has these, which the next steps draw; in a shared layer the old ones are subtracted. What is being drawn when
 * it moves again is finished first, so that a lamp that never rests is shown, too. LW_NOT_FOUND for a source beyond the last; LW_INVALID_ARGUMENT names a light whose values are out of range.
 *
 * lights: [count], copied; `source` in them says nothing. count 0: the source is gone. */
LW_API lw_result lw_gl_vpl_set_source_lights(lw_gl_vpl *gl_vpl, uint32_t source, const lw_virtual_light *lights, uint32_t count);

/* All lights are drawn again, from darkness; what is shown fades into it. LW_INVALID_ARGUMENT for NULL, as for all functions here. */
LW_API lw_result lw_gl_vpl_redraw(lw_gl_vpl *gl_vpl);

/* Reads the light map. For tools and tests: waits for the GPU. Fails with LW_GL_FAILED.
 *
 * rgba: [height][width][4], irradiance in lux and coverage. */
LW_API lw_result lw_gl_vpl_read(lw_gl_vpl *gl_vpl, float *rgba);

#ifdef __cplusplus
}
#endif
#endif
