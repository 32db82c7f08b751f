/* Lightwell on OpenGL without precomputed transport: the first reflection of lamps that do anything, from virtual lights that are found anew in every frame.
 *
 *   lw_gl_dynamic *scene;                                  geometry, albedo and points of a container on the GPU
 *   lw_gl_config config = LW_GL_CONFIG_INIT;               as for lw_gl_create
 *   lw_gl_dynamic_create(&config, container, NULL, &scene);  the container may then be closed
 *   lw_gl_lamp_create(scene, NULL, &lamp);                 one for each lamp: its reflective shadow map, virtual lights and their shadow maps
 *   lw_gl_lamp_update(lamp, &light, NULL);                 every frame in which the lamp, or what is around it, has changed
 *   lw_gl_dynamic_gather(scene, &lamp, 1, NULL);           irradiance of the atlas's texels; or in the game's own pass:
 *   lw_gl_lamp_lookup(lamp, &lookup);                        textures and numbers for lw_glsl_lamp's lwLampIrradiance
 *   lw_gl_lamp_destroy(lamp);
 *   lw_gl_dynamic_destroy(scene);                          after its lamps
 *
 * It is a library of its own, lightwell_dynamic, beside lightwell: games that do not need it do not carry it. The methods are reflective shadow maps (Dachsbacher and
 * Stamminger 2005) whose pixels become virtual lights by their flux, incremental instant radiosity (Laine et al. 2007), and imperfect shadow maps (Ritschel et al. 2008).
 *
 * Contexts, state, coordinates and errors are as in lightwell_gl.h; what lw_gl_radiosity_inject uses is used and restored here, too, and glClipControl must be as OpenGL
 * has it at first. On OpenGL ES EXT_float_blend is needed.
 */
#ifndef LIGHTWELL_LIGHTWELL_GL_DYNAMIC_H
#define LIGHTWELL_LIGHTWELL_GL_DYNAMIC_H

#include "lightwell/lightwell_gl.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- The scene -------------------------------------------------------------------------------------------------------------------- */

typedef struct lw_gl_dynamic lw_gl_dynamic;

typedef struct lw_gl_dynamic_options {
  size_t size;              /* sizeof(lw_gl_dynamic_options), set by LW_GL_DYNAMIC_OPTIONS_INIT */
  uint32_t atlas_format;    /* as in lw_gl_prm_options */
  uint32_t atlas_texture;   /* as in lw_gl_prm_options */
  uint32_t fill;            /* 1: texels without a value of their own (gutters, buried ones) show their source's; 0: each covered texel has its own, others none */
} lw_gl_dynamic_options;
#define LW_GL_DYNAMIC_OPTIONS_INIT {sizeof(lw_gl_dynamic_options), LW_GL_ATLAS_RGBA16F, 0, 1}

/* Compiles shaders and uploads the sections geometry, atlas and, where there is one, points. Doors are shut, as in the file.
 * Fails as lw_gl_create, lw_decode_array and lw_gl_prm_create do.
 *
 * options: NULL for LW_GL_DYNAMIC_OPTIONS_INIT. Memory on the GPU: 112 bytes a triangle, 32 a point, 32 a texel with a value, 16 or 8 and 16 a texel of the atlas. */
LW_API lw_result lw_gl_dynamic_create(const lw_gl_config *config, const lw_container *container, const lw_gl_dynamic_options *options, lw_gl_dynamic **scene);
LW_API void lw_gl_dynamic_destroy(lw_gl_dynamic *scene);
/* As lw_gl_prm_atlas_texture and lw_gl_prm_texture_bytes (the scene's own, without lamps). */
LW_API uint32_t lw_gl_dynamic_atlas_texture(const lw_gl_dynamic *scene);
LW_API uint64_t lw_gl_dynamic_texture_bytes(const lw_gl_dynamic *scene);

/* ---- Lamps ------------------------------------------------------------------------------------------------------------------------ */

typedef struct lw_gl_lamp lw_gl_lamp;

typedef struct lw_gl_lamp_options {
  size_t size;              /* sizeof(lw_gl_lamp_options), set by LW_GL_LAMP_OPTIONS_INIT */
  uint32_t lights;          /* virtual lights, 16 to 1024 */
  uint32_t view_side;       /* pixels along a view of the reflective shadow map (six views for a point light): a power of two, 16 to 1024 */
  uint32_t shadow_side;     /* texels along a virtual light's shadow map: a power of two, 8 to 128; 0: virtual lights shine through everything */
  uint32_t shadow_points;   /* of section points, splatted into each map, at most; each light takes others */
  uint32_t incremental;     /* 1: virtual lights stay where they are as long as the lamp shines there; 0: they are drawn by flux in every update */
  uint32_t most_updates;    /* incremental: so many of them, at most, change place in an update; all do in the first one, and after lw_gl_lamp_reset */
  uint32_t late;            /* incremental: 1: what the GPU finds out about the lights is used one update later, so that nothing waits for it; 0: waits */
} lw_gl_lamp_options;
#define LW_GL_LAMP_OPTIONS_INIT {sizeof(lw_gl_lamp_options), 256, 128, 32, 4096, 1, 16, 0}

/* Fails with LW_LIMIT_EXCEEDED (texture sizes), LW_NOT_FOUND (shadows without section points), LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT.
 *
 * options: NULL for LW_GL_LAMP_OPTIONS_INIT; without section points shadow_side is then 0. */
LW_API lw_result lw_gl_lamp_create(lw_gl_dynamic *scene, const lw_gl_lamp_options *options, lw_gl_lamp **lamp);
LW_API void lw_gl_lamp_destroy(lw_gl_lamp *lamp);
/* Bytes of texture memory that were asked for; 0 for NULL. */
LW_API uint64_t lw_gl_lamp_texture_bytes(const lw_gl_lamp *lamp);

/* What an update did. */
typedef struct lw_gl_lamp_work {
  uint32_t lights;          /* that shine, as far as is known without waiting: after an incremental one, those whose place was found valid, and new ones */
  uint32_t updated;         /* of them, how many got a new place and a new shadow map */
  uint32_t draws;           /* draw calls */
  uint64_t points;          /* splatted into shadow maps */
} lw_gl_lamp_work;

/* Draws what the lamp sees of the container's triangles, and brings the virtual lights and their shadow maps up to date. A new type of light starts anew.
 * LW_INVALID_ARGUMENT when the light's values are out of range.
 *
 * work: NULL, or receives what was done. */
LW_API lw_result lw_gl_lamp_update(lw_gl_lamp *lamp, const lw_light *light, lw_gl_lamp_work *work);

/* What a lamp sees, drawn by the game, with things that move. Each texture is a GL_TEXTURE_2D of floats, the views' width × height of lw_gl_lamp_views:
 *   position  xyz in container coordinates; w: 1 where there is surface, else 0
 *   normal    xyz unit, toward the lamp; w: surface per solid angle, distance² / cos, in m²/sr; directional: 1 / cos
 *   flux      rgb reflected light per solid angle: intensity × albedo (× the spot's and the range's falloff); directional: per area, lux × albedo; w: unused */
typedef struct lw_gl_reflective_shadow_map {
  uint32_t position_texture, normal_texture, flux_texture;
} lw_gl_reflective_shadow_map;
/* The views: view v is the square of view_side² pixels whose lower left corner is pixel (v % 4, v / 4) × view_side of a texture that is `width` × `height`. */
typedef struct lw_gl_lamp_view {
  float clip_from_container[16];  /* column-major; OpenGL's clip space */
} lw_gl_lamp_view;
typedef struct lw_gl_lamp_views {
  uint32_t count;                 /* 6: point lights and wide spots; 1: others */
  uint32_t width, height;         /* of the textures */
  lw_gl_lamp_view view[6];
} lw_gl_lamp_views;
/* LW_INVALID_ARGUMENT for NULL, or when the light's values are out of range. */
LW_API lw_result lw_gl_lamp_get_views(const lw_gl_lamp *lamp, const lw_light *light, lw_gl_lamp_views *views);
/* lw_gl_lamp_update from textures of the game's. Fails as that does, and with LW_INVALID_ARGUMENT for a texture name of 0. */
LW_API lw_result lw_gl_lamp_update_from(lw_gl_lamp *lamp, const lw_light *light, const lw_gl_reflective_shadow_map *map, lw_gl_lamp_work *work);

/* The next update places all lights anew: for a lamp that jumps. */
LW_API void lw_gl_lamp_reset(lw_gl_lamp *lamp);

/* ---- Irradiance ------------------------------------------------------------------------------------------------------------------- */

typedef struct lw_gl_gathering {
  size_t size;              /* sizeof(lw_gl_gathering), set by LW_GL_GATHERING_INIT */
  float softness;           /* 0 to 4: virtual lights are disks of their area times this, against bright spots near them; 0: points */
  float most_form;          /* the greatest cos cos / distance² that is taken, in 1/m²; 0: no bound. Lost light is not given back */
} lw_gl_gathering;
#define LW_GL_GATHERING_INIT {sizeof(lw_gl_gathering), 0.25f, 0.0f}

/* Irradiance at the texels of the atlas after one reflection of the lamps' light, the sum of all `count` lamps (of this scene), into the atlas texture: lux, at most 1e24. One draw a lamp and two more.
 *
 * gathering: NULL for LW_GL_GATHERING_INIT. */
LW_API lw_result lw_gl_dynamic_gather(lw_gl_dynamic *scene, lw_gl_lamp *const *lamps, uint32_t count, const lw_gl_gathering *gathering);

/* GLSL (330 or 300 es) of   vec3 lwLampIrradiance(vec3 position, vec3 normal, int first, int step)   : irradiance from every step-th virtual light from `first` on, times
 * `step`, in lux. Static storage. For all lights (0, 1); for interleaved sampling a pixel of an n × n pattern takes (its number, n²), and a geometry-aware blur over n × n pixels follows. */
LW_API const char *lw_glsl_lamp(void);
/* The uniforms of that; LW_INVALID_ARGUMENT for NULL (not for `gathering`: its defaults) or values out of range. Textures stay the same from update to update. */
typedef struct lw_gl_lamp_lookup_values {
  uint32_t place_texture;   /* uniform sampler2D lw_lamp_place */
  uint32_t flux_texture;    /* uniform sampler2D lw_lamp_flux */
  uint32_t shadow_texture;  /* uniform sampler2D lw_lamp_shadow: not read where there are no shadows */
  float numbers[8];         /* uniform vec4 lw_lamp_numbers[2] */
} lw_gl_lamp_lookup_values;
LW_API lw_result lw_gl_lamp_lookup(const lw_gl_lamp *lamp, const lw_gl_gathering *gathering, lw_gl_lamp_lookup_values *values);

/* ---- Reading back: for tools and tests; waits for the GPU. They fail with LW_INVALID_ARGUMENT for NULL, LW_GL_FAILED ---- */

LW_API lw_result lw_gl_dynamic_read_atlas(lw_gl_dynamic *scene, float *atlas_rgba);   /* [height][width][4], irradiance in lux and coverage */
/* The virtual lights: type LW_VIRTUAL_DISK, those that do not shine with flux 0. lights: [options.lights]. */
LW_API lw_result lw_gl_lamp_read_lights(lw_gl_lamp *lamp, lw_virtual_light *lights);
/* What the shadow map of each light says about a point, in the lights' order: 1 lit, 0 hidden, or between; 0 behind the light. visibility: [options.lights]. */
LW_API lw_result lw_gl_lamp_read_visibility(lw_gl_lamp *lamp, const float position_m[3], const float normal[3], float *visibility);

#ifdef __cplusplus
}
#endif
#endif
