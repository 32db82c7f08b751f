/* Lightwell runtime: reads a container (.lwc) and evaluates its light transport on the CPU. lightwell_gl.h does the same on OpenGL.
 *
 *   lw_container *container;                                  open: header and directory are read and checked
 *   lw_open_file("room.lwc", NULL, &container);
 *   lw_get_atlas_info(container, &atlas);                      query: sizes, no decoding
 *   lw_decode_array(container, LW_ARRAY_INDEX, index, bytes);  decode: into memory of the caller
 *   lw_prm_load(container, &prm);                              decode the transport
 *   lw_prm_entry_irradiance(prm, lights, 1, NULL, NULL, e);    evaluate, every frame: light at the entry points,
 *   lw_prm_cluster_irradiance(prm, e, c);                        its averages over clusters,
 *   lw_prm_evaluate(prm, c, NULL, scratch, size, rgba);          and from them the indirect light of every texel
 *   lw_prm_release(prm);                                       close, in any order
 *   lw_close(container);
 *
 * Conventions. Right-handed, +Y up, metres, relative to lw_scene_info.origin_m. Linear Rec. 709 RGB. Light units are glTF's: a point or
 * spot light has candela (1 cd gives 1 lux at 1 m), a directional light lux. Values at texels and entry points are irradiance E, not
 * multiplied by albedo and not divided by pi; a diffuse surface shows the radiance albedo / pi * E. A light's direction is the way
 * the light travels. Texel (x, y) has index y * width + x; row 0 is at v = 0, and its centre at u = (x + 0.5) / width. Matrices are
 * column-major.
 *
 * Memory. Nothing is allocated except by the functions that open or load, and temporarily by those that decode; all of it through
 * lw_config.allocate. Callers' arrays need the alignment of their elements.
 *
 * Threads. A handle never changes after it was made: any number of threads may use it at once, with results of their own. Releasing it is
 * the last use. There is no global state.
 *
 * Hostile input. Containers may hold any bytes. The answer is an lw_result; never a crash, a hang, or memory beyond lw_config's limits.
 *
 * Results. Every function that can fail returns lw_result, and tells the message callback why. Results leave through the last
 * parameters, which are untouched on failure (arrays: unspecified). A NULL handle or out-parameter is LW_INVALID_ARGUMENT. Release and
 * close functions accept NULL.
 */
#ifndef LIGHTWELL_LIGHTWELL_H
#define LIGHTWELL_LIGHTWELL_H

#include <stddef.h>
#include <stdint.h>

#include "lightwell/version.h"

#if defined(LIGHTWELL_STATIC)
#define LW_API
#elif defined(_WIN32)
#ifdef LIGHTWELL_BUILDING
#define LW_API __declspec(dllexport)
#else
#define LW_API __declspec(dllimport)
#endif
#else
#define LW_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Results ---------------------------------------------------------------------------------------------------------------------- */

/* One of the LW_… values below. Zero is success; values are never reused. */
typedef int32_t lw_result;
enum {
  LW_OK = 0,
  LW_IO_ERROR = 10,         /* the file or the caller's reader failed */
  LW_TRUNCATED = 20,        /* shorter than the header says */
  LW_BAD_MAGIC = 21,        /* not a container */
  LW_TOO_NEW = 22,          /* needs a later version of the library */
  LW_BAD_HEADER = 23,
  LW_BAD_CHECKSUM = 24,
  LW_BAD_DIRECTORY = 25,
  LW_BAD_CHUNK = 26,        /* does not decode to the size its shape gives */
  LW_BAD_SECTION = 27,      /* a chunk is missing, or its values are out of range */
  LW_TRAILING_BYTES = 28,
  LW_LIMIT_EXCEEDED = 30,   /* larger than lw_config or the GL implementation allows */
  LW_OUT_OF_MEMORY = 31,
  LW_NOT_FOUND = 40,        /* the container has no such section, array or item */
  LW_INVALID_ARGUMENT = 41, /* NULL, wrong size, a number that is not finite or out of its range */
  LW_GL_UNSUPPORTED = 50,   /* the context lacks a function, extension or format that is needed */
  LW_GL_FAILED = 51         /* a shader did not compile, a framebuffer is incomplete, or GL reported an error */
};

/* The name of a result, "LW_BAD_CHUNK"; "LW_UNKNOWN" for other values. Static storage. */
LW_API const char *lw_result_name(lw_result result);

/* The version of the library that runs: major * 10000 + minor * 100 + patch, as LW_VERSION is for this header. */
LW_API uint32_t lw_version(void);

/* ---- Opening ---------------------------------------------------------------------------------------------------------------------- */

typedef struct lw_container lw_container;

/* How handles get memory, report failures and limit what a file may ask for. Start from LW_CONFIG_INIT. */
typedef struct lw_config {
  size_t size;                                      /* sizeof(lw_config), set by LW_CONFIG_INIT */
  void *(*allocate)(void *user, size_t bytes);      /* 16-byte aligned memory or NULL; NULL with release: malloc and free */
  void (*release)(void *user, void *memory);
  void *allocator_user;
  /* Called on the failing thread before the failing call returns; `text` lives during the call. NULL: silent. */
  void (*message)(void *user, lw_result result, const char *text);
  void *message_user;
  uint64_t max_file_bytes;                          /* 0: 1 TiB */
  uint64_t max_decoded_bytes;                       /* over all chunks of the file together; 0: 2 GiB */
} lw_config;
#define LW_CONFIG_INIT {sizeof(lw_config), NULL, NULL, NULL, NULL, NULL, 0, 0}

/* Where a container is read from when it is neither memory nor a plain file. */
typedef struct lw_reader {
  /* Fills destination with bytes [offset, offset + bytes) and returns 0, or returns something else. Never asked beyond file_bytes. Must
     be callable from every thread that decodes. */
  int (*read)(void *user, uint64_t offset, void *destination, size_t bytes);
  void *user;
  uint64_t file_bytes;
} lw_reader;

/* Opens a container: reads and checks header, directory and the scene's lights, no more.
 * Fails with LW_IO_ERROR to LW_INVALID_ARGUMENT except LW_BAD_SECTION, LW_NOT_FOUND. The bytes may be hostile.
 *
 * config: copied; its callbacks must stay callable until the container and everything loaded from it is released. NULL: LW_CONFIG_INIT.
 * container: receives a handle, to be closed with lw_close.
 *
 * lw_open_memory reads in place: `data` must stay unchanged until lw_close. lw_open_file keeps the file (UTF-8 path) open.
 * lw_open_reader copies `reader`. */
LW_API lw_result lw_open_memory(const void *data, size_t bytes, const lw_config *config, lw_container **container);
LW_API lw_result lw_open_file(const char *path, const lw_config *config, lw_container **container);
LW_API lw_result lw_open_reader(const lw_reader *reader, const lw_config *config, lw_container **container);

/* Closes a container. What was loaded from it (lw_prm) stays valid. */
LW_API void lw_close(lw_container *container);

/* 1 when the container has this section ("scene", "geometry", "atlas", "prm", "environment", "radiosity", "probes") in a version that this library knows, else 0. */
LW_API int lw_has_section(const lw_container *container, const char *section);

/* ---- Scene ------------------------------------------------------------------------------------------------------------------------ */

typedef struct lw_scene_info {
  double origin_m[3];      /* add it to a position of the container for glTF world coordinates */
  float bounds_min_m[3];   /* of the surfaces, relative to the origin; min > max when there are none */
  float bounds_max_m[3];
  uint32_t light_count;    /* punctual lights of the scene itself */
} lw_scene_info;

/* Fails as lw_decode_array does. */
LW_API lw_result lw_get_scene_info(const lw_container *container, lw_scene_info *info);

enum { LW_LIGHT_POINT = 1, LW_LIGHT_SPOT = 2, LW_LIGHT_DIRECTIONAL = 3 };

/* A punctual light with the physics of KHR_lights_punctual. */
typedef struct lw_light {
  uint32_t type;                /* LW_LIGHT_… */
  float position_m[3];          /* point, spot; relative to the container's origin */
  float direction[3];           /* spot, directional; the way the light travels; any length but zero */
  float intensity_rgb[3];       /* ≥ 0; candela (point, spot) or lux (directional) */
  float inner_cone_angle_rad;   /* spot; 0 ≤ inner < outer ≤ pi/2 */
  float outer_cone_angle_rad;
  float range_m;                /* point, spot: where the light ends smoothly; 0: infinite */
} lw_light;

/* The scene's own light number `index` < light_count; LW_NOT_FOUND beyond. Else fails as lw_decode_array does. */
LW_API lw_result lw_get_light(const lw_container *container, uint32_t index, lw_light *light);

/* ---- Atlas and geometry ----------------------------------------------------------------------------------------------------------- */

typedef struct lw_atlas_info {
  uint32_t width, height;      /* texels */
  uint32_t covered_texels;
  uint32_t charts;
  uint32_t unwrapped;          /* 1: the light-map coordinates were made by the bake; 0: they are the asset's own */
} lw_atlas_info;

/* Fails as lw_decode_array does. */
LW_API lw_result lw_get_atlas_info(const lw_container *container, lw_atlas_info *info);

/* Arrays that a container may hold, and what lw_decode_array makes of them. v: vertices, t: triangles, h, w: atlas height, width. */
typedef enum lw_array {
  LW_ARRAY_POSITION = 1,       /* float[v][3]   metres relative to the origin */
  LW_ARRAY_NORMAL = 2,         /* float[v][3]   unit shading normals */
  LW_ARRAY_LIGHTMAP_UV = 3,    /* float[v][2]   in [0, 1] */
  LW_ARRAY_INDEX = 4,          /* uint32[t][3]  < v; counter-clockwise from the front */
  LW_ARRAY_TRIANGLE_FLAGS = 5, /* uint8[t]      LW_TRIANGLE_… */
  LW_ARRAY_ALPHA_UV = 6,       /* float[v][2]   texture coordinates of the alpha textures; only if some triangle has alpha */
  LW_ARRAY_TRIANGLE_ALPHA = 7, /* uint16[t]     index for lw_get_alpha_material, or 0xffff: opaque; only if some triangle has alpha */
  LW_ARRAY_ATLAS_SOURCE = 16,  /* uint32[h][w]  the texel whose value a texel shows (gutters show a neighbour's), 0xffffffff: none */
  LW_ARRAY_ATLAS_COVERAGE = 17,/* uint8[h][w]   1 where the surface covers the texel */
  LW_ARRAY_ATLAS_ALBEDO = 18,  /* uint8[h][w][3] sRGB-encoded diffuse albedo; gutters filled */
  LW_ARRAY_ATLAS_EMISSION = 19 /* float[h][w][3] emitted radiance; only if something emits */
} lw_array;
enum { LW_TRIANGLE_DOUBLE_SIDED = 1, LW_TRIANGLE_CUT_OUT = 2, LW_TRIANGLE_BLEND = 4 };

typedef struct lw_array_info {
  uint64_t elements;          /* v, t or h * w */
  uint32_t components;        /* numbers per element */
  uint32_t component_bytes;   /* 1, 2 or 4 */
  size_t bytes;               /* their product: what lw_decode_array fills */
} lw_array_info;

/* Sizes of an array, without decoding. LW_NOT_FOUND when the container has none; LW_BAD_SECTION when its type or shape is not the
 * format's. */
LW_API lw_result lw_get_array_info(const lw_container *container, lw_array array, lw_array_info *info);

/* Decodes an array and checks its values (finite, indices in range).
 * Fails with LW_NOT_FOUND, LW_BAD_SECTION, LW_BAD_CHECKSUM, LW_BAD_CHUNK, LW_TRAILING_BYTES, LW_TOO_NEW, LW_IO_ERROR, LW_OUT_OF_MEMORY or
 * LW_INVALID_ARGUMENT.
 *
 * destination: `bytes` bytes, exactly lw_array_info.bytes. */
LW_API lw_result lw_decode_array(const lw_container *container, lw_array array, void *destination, size_t bytes);

enum { LW_ALPHA_MASK = 1, LW_ALPHA_BLEND = 2 };
enum { LW_WRAP_REPEAT = 1, LW_WRAP_CLAMP = 2, LW_WRAP_MIRROR = 3 };

/* How a triangle with alpha lets light through. alpha = factor * texture(alpha_uv). LW_ALPHA_MASK: opaque where alpha ≥ cutoff,
 * else nothing; LW_ALPHA_BLEND: blocks the fraction alpha. */
typedef struct lw_alpha_material {
  uint32_t mode;             /* LW_ALPHA_… */
  float cutoff;              /* LW_ALPHA_MASK */
  float factor;
  int32_t texture;           /* for lw_decode_alpha_texture; −1: none */
  uint32_t wrap_u, wrap_v;   /* LW_WRAP_…; 0 without a texture */
  uint32_t texture_width, texture_height; /* 0 without a texture */
} lw_alpha_material;

/* LW_NOT_FOUND for an index beyond the last. Else fails as lw_decode_array does. */
LW_API lw_result lw_get_alpha_material(const lw_container *container, uint32_t index, lw_alpha_material *material);
/* The first `count` of them in one pass. LW_NOT_FOUND when there are fewer; else fails as lw_decode_array does. materials: [count]; NULL for none. */
LW_API lw_result lw_get_alpha_materials(const lw_container *container, uint32_t count, lw_alpha_material *materials);

/* Decodes uint8[height][width] of linear alpha, 255 = 1. `bytes` must be width * height. Fails as lw_decode_array does. */
LW_API lw_result lw_decode_alpha_texture(const lw_container *container, uint32_t texture, void *destination, size_t bytes);

/* ---- Precomputed radiance maps ---------------------------------------------------------------------------------------------------- */

/* Light transport of a static scene (Szécsi, Szirmay-Kalos: "On Making Light Maps Dynamic"): irradiance at clusters of entry points, times
 * a matrix, is indirect irradiance at the texels of the atlas. */
typedef struct lw_prm lw_prm;

enum { LW_PRM_PANES = 1, LW_PRM_LOCAL_BASES = 2 };

typedef struct lw_prm_info {
  uint32_t layout;         /* LW_PRM_… */
  uint32_t entries;
  uint32_t clusters;
  uint32_t texels;         /* with a value */
  uint32_t blocks;         /* local bases, else 0 */
  uint32_t max_rank;       /* local bases, else 0 */
  uint32_t brightest;      /* panes: the number of clusters that the bake recommends; 0: all */
  uint32_t has_emitter;    /* 1: emitting surfaces add a constant irradiance */
  uint32_t has_sky;        /* 1: so does the sky that the scene was baked under */
  uint32_t width, height;  /* of the atlas */
} lw_prm_info;

/* Decodes and checks the transport and the atlas's source map. Memory: about the decoded size of the section "prm" plus 8 bytes per atlas
 * texel. Fails as lw_decode_array does, and with LW_LIMIT_EXCEEDED.
 *
 * prm: receives a handle, to be released with lw_prm_release. */
LW_API lw_result lw_prm_load(const lw_container *container, lw_prm **prm);
LW_API void lw_prm_release(lw_prm *prm);

LW_API lw_result lw_prm_get_info(const lw_prm *prm, lw_prm_info *info);

/* The entry points, sorted by cluster. Arrays live as long as the lw_prm. */
typedef struct lw_prm_entries {
  const float *position_m;              /* [entries][3], on the surface */
  const float *normal;                  /* [entries][3], unit, on the lit side */
  const float *weight;                  /* [entries], sum 1 in each cluster */
  const uint32_t *cluster_first_entry;  /* [clusters + 1] */
} lw_prm_entries;
LW_API lw_result lw_prm_get_entries(const lw_prm *prm, lw_prm_entries *entries);

/* A question for the caller's ray tracer: how much of the light arrives at an entry point? */
typedef struct lw_shadow_ray {
  float origin_m[3];      /* the entry point, on the surface: start a little off it */
  float normal[3];        /* unit, the surface's side that is lit */
  float direction[3];     /* unit, toward the light */
  float distance_m;       /* to the light; INFINITY for a directional light */
  uint32_t entry;
} lw_shadow_ray;

/* Fills visibility[count]: 1 where the light arrives, 0 where it is blocked, between for partly transparent things. At most 256 rays, all
 * of one light, in the order of the entry points. */
typedef void (*lw_visibility_fn)(void *user, const lw_shadow_ray *rays, uint32_t count, float *visibility);

/* Irradiance of the lights at the entry points, about their normals; light from behind the surface is not received. With local bases a point or spot light
 * close to an entry is averaged over the rectangle of surface that the entry stands for, by its solid angle.
 * LW_INVALID_ARGUMENT names the light whose values are out of range.
 *
 * lights: `light_count` of them (0: all results are zero); positions relative to the container's origin.
 * visibility: asked for every entry point that a light could reach; NULL: nothing is in the way. user: handed to it.
 * entry_irradiance_rgb: [entries][3]. */
LW_API lw_result lw_prm_entry_irradiance(const lw_prm *prm, const lw_light *lights, uint32_t light_count, lw_visibility_fn visibility,
                                         void *user, float *entry_irradiance_rgb);

/* Weighted means over the clusters: the lights' own irradiance, before any reflection.
 *
 * entry_irradiance_rgb: [entries][3]. cluster_irradiance_rgb: [clusters][3]. */
LW_API lw_result lw_prm_cluster_irradiance(const lw_prm *prm, const float *entry_irradiance_rgb, float *cluster_irradiance_rgb);

/* What emitting surfaces and the sky of the bake add (lw_prm_options.emitters): bits. */
enum { LW_EMITTERS_OFF = 0, LW_EMITTERS_DIRECT = 1, LW_EMITTERS_INDIRECT = 2, LW_SKY_DIRECT = 4, LW_SKY_INDIRECT = 8 };

typedef struct lw_prm_options {
  size_t size;               /* sizeof(lw_prm_options), set by LW_PRM_OPTIONS_INIT */
  uint32_t brightest;        /* panes: use only the K clusters that contribute most light; 0: all. Local bases always use all */
  uint32_t keep_energy;      /* 1: scale what the K give, per channel, so that the atlas's total is that of all; 0: drop the rest */
  uint32_t emitters;         /* LW_EMITTERS_… and LW_SKY_… bits; nothing happens when the container has no such maps */
  uint32_t fill;             /* 1: for display, gutters and buried texels show the value of their source (LW_ARRAY_ATLAS_SOURCE); 0: for
                                measuring, each texel with a value has its own mean over the surface in it, others are zero */
  float sky_rgb[3];          /* factor on the sky's light, finite and ≥ 0: brighter, darker, another colour without a new bake */
  float tolerance;           /* local bases: share of the light's root mean square that sums may leave out to be faster, 0 to 1; 0: none */
} lw_prm_options;
#define LW_PRM_OPTIONS_INIT {sizeof(lw_prm_options), 0, 1, LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT, 1, {1, 1, 1}, 0.0003f}

/* Bytes of scratch memory that lw_prm_evaluate needs; 0 for a NULL prm. */
LW_API size_t lw_prm_scratch_bytes(const lw_prm *prm);

/* Indirect irradiance of every texel: sums the transport of the clusters. Values are finite and ≥ 0.
 *
 * Panes: a cluster contributes luminance(irradiance * sum of its pane over the texels); equal ones are ranked by index.
 *
 * cluster_irradiance_rgb: [clusters][3], finite and ≥ 0, else LW_INVALID_ARGUMENT.
 * options: NULL for LW_PRM_OPTIONS_INIT.
 * scratch: lw_prm_scratch_bytes bytes, 4-byte aligned, one per call at a time.
 * atlas_rgba: [height][width][4]; irradiance, and alpha 1 where a texel has a value. With fill, gutters show their source's value, so that
 *   bilinear lookup is safe everywhere on the surface; other texels are zero. */
LW_API lw_result lw_prm_evaluate(const lw_prm *prm, const float *cluster_irradiance_rgb, const lw_prm_options *options, void *scratch,
                                 size_t scratch_bytes, float *atlas_rgba);

/* ---- Radiosity -------------------------------------------------------------------------------------------------------------------- */

/* Form factors between patches of a static scene: what share of the light that leaves one reaches another. Albedo, emission and portals (doors,
 * shutters) may change; every sweep over the links is one more bounce of light.
 *
 *   lw_radiosity_load(container, &radiosity);
 *   lw_radiosity_state_create(radiosity, &state);
 *   lw_radiosity_set_material(state, sign, &night); lw_radiosity_set_portal(state, door, 0.5f);    when they change
 *   lw_radiosity_set_direct(state, e);                     every frame: irradiance of the lights at the patches,
 *   lw_radiosity_step(state, 1);                             one bounce more on top of the last frame's light,
 *   lw_radiosity_shade(state, NULL, atlas_rgba);             and what the atlas shows
 *
 * An lw_radiosity never changes and serves any number of states; it must live as long as they do. A state belongs to one thread at a time. */
typedef struct lw_radiosity lw_radiosity;
typedef struct lw_radiosity_state lw_radiosity_state;

typedef struct lw_radiosity_info {
  uint32_t patches;
  uint32_t nodes;          /* patches, and groups of them that links may come from */
  uint32_t links;
  uint32_t texels;         /* with a value */
  uint32_t materials;
  uint32_t portals;
  uint32_t gates;          /* strips of all portals */
  uint32_t has_emission;   /* 1: some patch emits light of its own */
  uint32_t has_backs;      /* 1: some patches lie on the backs of double-sided surfaces */
  uint32_t width, height;  /* of the atlas */
} lw_radiosity_info;

/* Decodes and checks the form factors and the atlas's source map. Memory: 4 bytes a link, about 70 a patch, 25 a texel. Fails as
 * lw_decode_array does.
 *
 * radiosity: receives a handle, to be released with lw_radiosity_release. */
LW_API lw_result lw_radiosity_load(const lw_container *container, lw_radiosity **radiosity);
LW_API void lw_radiosity_release(lw_radiosity *radiosity);

LW_API lw_result lw_radiosity_get_info(const lw_radiosity *radiosity, lw_radiosity_info *info);

/* As they were baked. Arrays live as long as the lw_radiosity. */
typedef struct lw_radiosity_patches {
  const float *area_m2;        /* [patches], of what is in the open */
  const float *position_m;     /* [patches][3], mean of the surface */
  const float *normal;         /* [patches][3], unit, on the lit side */
  const float *albedo_rgb;     /* [patches][3] */
  const float *emission_rgb;   /* [patches][3], radiance */
  const uint16_t *material;    /* [patches] */
} lw_radiosity_patches;
LW_API lw_result lw_radiosity_get_patches(const lw_radiosity *radiosity, lw_radiosity_patches *patches);

/* Which patches a texel shows. Arrays live as long as the lw_radiosity. */
typedef struct lw_radiosity_texels {
  const uint32_t *texel;       /* [texels], of the atlas; ascending */
  const uint32_t *patch;       /* [texels][4], first the one that the texel's surface belongs to; 0xffffffff: none */
  const uint8_t *weight;       /* [texels][4], / 255 */
  const uint8_t *exposed;      /* [texels], share of the texel's surface that is in the open, / 255 */
  const uint32_t *back_patch;  /* [texels], of the back of double-sided surfaces, or 0xffffffff; NULL without backs */
} lw_radiosity_texels;
LW_API lw_result lw_radiosity_get_texels(const lw_radiosity *radiosity, lw_radiosity_texels *texels);

/* The material's name in the glTF file, maybe empty; lives as long as the lw_radiosity. NULL for an index beyond the last. */
LW_API const char *lw_radiosity_material_name(const lw_radiosity *radiosity, uint32_t material);

/* A door or a shutter, cut into strips side by side, each of them a gate. Its leaf is part of the geometry as it stands when shut, and opens as if it slid into the wall: open by
 * t, what is left of it is where s >= t, s = dot(axis_per_m, position) + offset. A leaf that swings or folds is the game's to draw; its light is that of one that slides. */
typedef struct lw_radiosity_portal {
  const char *name;            /* of the glTF node, maybe empty; lives as long as the lw_radiosity */
  uint32_t first_gate, gates;
  uint32_t first_triangle, triangles;  /* of LW_ARRAY_INDEX: the leaf */
  float axis_per_m[3], offset;         /* s: 0 where it opens first, 1 where it opens last; positions as in LW_ARRAY_POSITION */
} lw_radiosity_portal;
/* LW_NOT_FOUND for an index beyond the last. */
LW_API lw_result lw_radiosity_get_portal(const lw_radiosity *radiosity, uint32_t index, lw_radiosity_portal *portal);

/* Dark, with materials and portals as they were baked: all portals shut. Memory: about 100 bytes a patch. */
LW_API lw_result lw_radiosity_state_create(const lw_radiosity *radiosity, lw_radiosity_state **state);
LW_API void lw_radiosity_state_destroy(lw_radiosity_state *state);

/* No amount of light, factor or colour that is handed in may be greater. */
#define LW_RADIOSITY_MOST 1e24f

/* What becomes of a material: baked value * factor + value. All numbers 0 to LW_RADIOSITY_MOST; an albedo above 0.999 counts as 0.999. */
typedef struct lw_radiosity_material {
  float albedo_factor_rgb[3], albedo_rgb[3];
  float emission_factor_rgb[3], emission_rgb[3];   /* radiance */
} lw_radiosity_material;
#define LW_RADIOSITY_MATERIAL_INIT {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {0, 0, 0}}

/* LW_NOT_FOUND for an index beyond the last, LW_INVALID_ARGUMENT for values out of range. */
LW_API lw_result lw_radiosity_set_material(lw_radiosity_state *state, uint32_t index, const lw_radiosity_material *material);
/* open: 0 to 1. A portal opens its strips one after the other, the last one partly. LW_NOT_FOUND for an index beyond the last, LW_INVALID_ARGUMENT for an
 * open out of range. */
LW_API lw_result lw_radiosity_set_portal(lw_radiosity_state *state, uint32_t index, float open);
LW_API lw_result lw_radiosity_set_gate(lw_radiosity_state *state, uint32_t gate, float open);
/* irradiance_rgb: [patches][3], of lights, shadowed, mean over what of the patch is in the open; 0 to LW_RADIOSITY_MOST. */
LW_API lw_result lw_radiosity_set_direct(lw_radiosity_state *state, const float *irradiance_rgb);

/* Light of moving lamps on the patches, without a ray tracer: pictures of what each lamp sees, drawn on the CPU from the container's own triangles. Six faces
 * for a point light, one for a spot (six for a very wide one), an orthographic one for a directional light. Each pixel hands the light of its exact
 * solid angle to the patch that it sees, so that the power is the lamp's at any number of pixels. Cut-outs let light through; blended surfaces stop it where
 * they cover half. The backs of single-sided surfaces absorb it. Things that are not in the container cast no shadow.
 *
 * An injector has scratch memory: one thread at a time. It needs its lw_radiosity, not the container. */
typedef struct lw_radiosity_injector lw_radiosity_injector;
/* side: pixels along a view, 8 to 4096; 128 is enough for most rooms. Memory: the geometry, 4 bytes an atlas texel, 12 a pixel. Fails as lw_decode_array
 * does, LW_NOT_FOUND when the container has no geometry. */
LW_API lw_result lw_radiosity_injector_create(const lw_container *container, const lw_radiosity *radiosity, uint32_t side,
                                              lw_radiosity_injector **injector);
LW_API void lw_radiosity_injector_destroy(lw_radiosity_injector *injector);
/* From now on leaves are drawn as far as portals and gates are open in `state`, exactly, so that light moves with a door's edge. Without this call they are shut.
 * LW_INVALID_ARGUMENT when the state is of other form factors. */
LW_API lw_result lw_radiosity_injector_set_portals(lw_radiosity_injector *injector, const lw_radiosity_state *state);
/* irradiance_rgb: [patches][3], receives what all lights give: what lw_radiosity_set_direct takes. LW_INVALID_ARGUMENT names the light whose values are
 * out of range. */
LW_API lw_result lw_radiosity_inject(lw_radiosity_injector *injector, const lw_light *lights, uint32_t light_count, float *irradiance_rgb);

/* Things that move and stand in the way of ambient light: spheres. Each takes from the light of patches what of their hemisphere it fills (by the cosine), as if light came evenly
 * from all around, and gives back its albedo times the same light; several multiply. A character is a handful of spheres. */
typedef struct lw_blocker {
  float position_m[3];     /* centre */
  float radius_m;          /* ≥ 0 */
  float albedo_rgb[3];     /* 0 to 1 */
} lw_blocker;
/* From now on patches reflect what blockers leave them of light from other patches (not of lamps: their shadows are the game's). What is shown of a patch, by lw_radiosity_shade or
 * lw_radiosity_get_irradiance, is still without the blockers right above it: contact shadows are finer than patches, and belong to lw_blockers_kept or LW_GLSL_BLOCKERS.
 * LW_INVALID_ARGUMENT names the blocker whose values are out of range; nothing changes then. Costs patches × count.
 *
 * blockers: copied; with count 0 there are none any more. */
LW_API lw_result lw_radiosity_set_blockers(lw_radiosity_state *state, const lw_blocker *blockers, uint32_t count);
/* What is left of indirect light at a point of a surface: the factor by which to multiply its irradiance. normal: unit. kept_rgb: 0 to 1. */
LW_API lw_result lw_blockers_kept(const lw_blocker *blockers, uint32_t count, const float position_m[3], const float normal[3], float kept_rgb[3]);

/* Sweeps over all links, each of them one more bounce, from the light that was there: last frame's is the start of this one's, and bounces beyond
 * the first cost nothing more. */
LW_API lw_result lw_radiosity_step(lw_radiosity_state *state, uint32_t sweeps);

typedef struct lw_radiosity_report {
  uint32_t sweeps;         /* that were done */
  double residual;         /* rms of what the last changed, over rms of the irradiance */
} lw_radiosity_report;

/* Sweeps until all bounces are there: until the residual is at most `tolerance` (> 0), or rounding lets it fall no further, or most_sweeps are done.
 * The relative error is at most about residual / (1 − greatest albedo). Accelerated, so that closed rooms of albedo 0.999 take tens of sweeps.
 * Temporary memory: 300 bytes a patch.
 *
 * report: NULL, or receives what was reached. */
LW_API lw_result lw_radiosity_solve(lw_radiosity_state *state, double tolerance, uint32_t most_sweeps, lw_radiosity_report *report);

/* Kinds of light: bits. */
enum {
  LW_RADIOSITY_INDIRECT = 1,   /* after at least one reflection */
  LW_RADIOSITY_EMITTERS = 2,   /* straight from emitting patches */
  LW_RADIOSITY_LIGHTS = 4      /* straight from lights: lw_radiosity_set_direct, as coarse as patches are */
};

/* light: LW_RADIOSITY_… bits. irradiance_rgb: [patches][3], ≥ 0. */
LW_API lw_result lw_radiosity_get_irradiance(lw_radiosity_state *state, uint32_t light, float *irradiance_rgb);

typedef struct lw_radiosity_shading {
  size_t size;             /* sizeof(lw_radiosity_shading), set by LW_RADIOSITY_SHADING_INIT */
  uint32_t light;          /* LW_RADIOSITY_… bits */
  uint32_t fill;           /* 1: for display, gutters and buried texels show the value of their source; 0: for measuring, each texel with a value has
                              the mean over the surface in it, others are zero */
} lw_radiosity_shading;
#define LW_RADIOSITY_SHADING_INIT {sizeof(lw_radiosity_shading), LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS, 1}

/* Irradiance of every texel, interpolated between patches.
 *
 * shading: NULL for LW_RADIOSITY_SHADING_INIT.
 * atlas_rgba: [height][width][4]; alpha 1 where a texel has a value. */
LW_API lw_result lw_radiosity_shade(lw_radiosity_state *state, const lw_radiosity_shading *shading, float *atlas_rgba);

/* ---- Light map -------------------------------------------------------------------------------------------------------------------- */

/* Irradiance of lights that do not move, per texel: decode, shade once, upload as a texture (or lw_gl_lightmap_create). Immutable, usable from any thread. */
typedef struct lw_lightmap lw_lightmap;

typedef struct lw_lightmap_info {
  uint32_t texels;         /* with a value */
  uint32_t width, height;  /* of the atlas */
  uint32_t has_direct;     /* 0: no light falls on anything straight from lamps, emitters or a sky */
  uint32_t has_indirect;   /* 0: none after a reflection */
  uint32_t has_gradients;  /* 1: the map knows how light changes with the normal, for normal-mapped surfaces (bake --directional) */
} lw_lightmap_info;

/* Decodes and checks the section "lightmap" and the atlas's source map. Memory: 12 bytes a texel, 6 more with gradients, 4 a texel of the atlas. Fails as lw_decode_array does.
 *
 * lightmap: receives a handle, to be released with lw_lightmap_release. */
LW_API lw_result lw_lightmap_load(const lw_container *container, lw_lightmap **lightmap);
LW_API void lw_lightmap_release(lw_lightmap *lightmap);
LW_API lw_result lw_lightmap_get_info(const lw_lightmap *lightmap, lw_lightmap_info *info);

enum { LW_LIGHTMAP_DIRECT = 1, LW_LIGHTMAP_INDIRECT = 2 };
typedef struct lw_lightmap_shading {
  size_t size;             /* sizeof(lw_lightmap_shading), set by LW_LIGHTMAP_SHADING_INIT */
  uint32_t light;          /* LW_LIGHTMAP_… bits: which light */
  uint32_t fill;           /* as in lw_prm_options */
} lw_lightmap_shading;
#define LW_LIGHTMAP_SHADING_INIT {sizeof(lw_lightmap_shading), LW_LIGHTMAP_DIRECT | LW_LIGHTMAP_INDIRECT, 1}

/* The map as it is shown. Fails with LW_INVALID_ARGUMENT for values out of range.
 *
 * shading: NULL for LW_LIGHTMAP_SHADING_INIT. atlas_rgba: [height][width][4], irradiance and coverage as lw_prm_evaluate gives them. */
LW_API lw_result lw_lightmap_shade(const lw_lightmap *lightmap, const lw_lightmap_shading *shading, float *atlas_rgba);

/* How that map changes with the normal: about a unit normal m other than the surface's own n, irradiance is E * max(0, 1 + g . (m - n)). E and g may be interpolated
 * between texels first. Zero everywhere for maps without gradients. Fails as lw_lightmap_shade does.
 *
 * atlas_xyz: [height][width][3], g in world axes, each component from -LW_LIGHTMAP_MOST_GRADIENT to LW_LIGHTMAP_MOST_GRADIENT; of both lights their mean by luminance. */
#define LW_LIGHTMAP_MOST_GRADIENT 4.0f
LW_API lw_result lw_lightmap_shade_gradients(const lw_lightmap *lightmap, const lw_lightmap_shading *shading, float *atlas_xyz);

/* Irradiance at one texel about a normal of the caller's choice, each light with its own gradient. Fails with LW_INVALID_ARGUMENT for a texel outside the atlas, and as above.
 *
 * shading: fill: a texel without a value of its own answers as its source. surface_normal: unit, of the surface at the texel, as interpolated from the mesh; normal: unit,
 * as shaded. rgb: zero where there is no value. */
LW_API lw_result lw_lightmap_irradiance(const lw_lightmap *lightmap, const lw_lightmap_shading *shading, uint32_t x, uint32_t y, const float surface_normal[3],
                                        const float normal[3], float rgb[3]);

/* ---- Virtual lights --------------------------------------------------------------------------------------------------------------- */

/* Light of lamps, emitters and a sky that do not move, reflected or straight from emitters, as a few hundred Lambertian lights: a light map is their sum over points of
 * surfaces, each shadowed. Those of one source follow each other, so that one lamp can be left out or recoloured alone. Immutable, usable from any thread. */
typedef struct lw_virtual_lights lw_virtual_lights;

typedef struct lw_virtual_lights_info {
  uint32_t lights;
  uint32_t sources;        /* lamps of the scene, in its order; all emitters together; the sky, if it shone */
} lw_virtual_lights_info;

enum { LW_VIRTUAL_POINT = 1, LW_VIRTUAL_DISK = 2, LW_VIRTUAL_SPHERE = 3, LW_VIRTUAL_POLYGON = 4 };

typedef struct lw_virtual_light {
  uint32_t type;           /* LW_VIRTUAL_… */
  uint32_t source;
  uint32_t bounce;         /* reflections between the source and this; 0: an emitter's own light, which is direct. 255 stands for more, too */
  float position_m[3];     /* the middle of its area */
  float normal[3];         /* unit; it shines to this side, a sphere mostly */
  float flux_rgb[3];       /* lumen, in all directions together */
  float radius_m;          /* of disks and spheres; else 0 */
  float area_m2;           /* of disks, polygons, and a sphere's disk; 0 for points */
  uint32_t vertex_count;   /* of polygons: 3 to 8; else 0 */
  const float *vertices_m; /* [vertex_count][3], convex, counter-clockwise from the front; lives as long as the lw_virtual_lights */
} lw_virtual_light;

/* Decodes and checks the section "vpl". Memory: 62 bytes a light, 12 a vertex. Fails as lw_decode_array does.
 *
 * lights: receives a handle, to be released with lw_virtual_lights_release. */
LW_API lw_result lw_virtual_lights_load(const lw_container *container, lw_virtual_lights **lights);
LW_API void lw_virtual_lights_release(lw_virtual_lights *lights);
/* Both fail with LW_INVALID_ARGUMENT for NULL. index: < info.lights, else LW_INVALID_ARGUMENT. */
LW_API lw_result lw_virtual_lights_get_info(const lw_virtual_lights *lights, lw_virtual_lights_info *info);
LW_API lw_result lw_virtual_lights_get(const lw_virtual_lights *lights, uint32_t index, lw_virtual_light *light);

/* Irradiance that a light gives to a point, unoccluded: for polygons exact (Lambert's formula over what is above the point's horizon), for disks and spheres the usual
 * approximations (Wallace et al., "A Ray Tracing Algorithm for Progressive Radiosity", 1989; Hasan et al., "Virtual Spherical Lights for Many-Light Rendering of Glossy Scenes", 2009).
 * Finite and not negative for all finite arguments. LW_INVALID_ARGUMENT for NULL, a negative epsilon, or a light whose type and numbers do not fit each other.
 *
 * position_m, normal: of the receiving point; the normal is a unit vector.
 * epsilon_m: half the size of a texel, or 0: points nearer than that to the light's plane are moved off it along their own surface, against dark edges in corners;
 *     points and disks are never nearer than that (Luksch et al., "Fast Light-Map Computation with Virtual Polygon Lights", 2013, section 6.1).
 * irradiance_rgb: lux. */
LW_API lw_result lw_virtual_light_irradiance(const lw_virtual_light *light, const float position_m[3], const float normal[3], float epsilon_m, float irradiance_rgb[3]);
/* A point on the light, even over its area for even uv in [0, 1)^2: where shadow rays go. Of a sphere, on its disk across `normal`. LW_INVALID_ARGUMENT for NULL, or a polygon without vertices. */
LW_API lw_result lw_virtual_light_point(const lw_virtual_light *light, const float uv[2], float position_m[3]);

/* ---- Surface points --------------------------------------------------------------------------------------------------------------- */

/* Points spread evenly over the opaque surfaces, for shadow maps of many lights at once (lightwell_gl_dynamic.h): every 2^k of them that follow each other from a
 * multiple of 2^k are spread evenly, too. Immutable, usable from any thread. */
typedef struct lw_points lw_points;

typedef struct lw_points_info {
  uint32_t points;
  float area_m2;           /* of all surface; each point stands for as much of it */
  const float *position_m; /* [points][3], rounded to 1/65535 of the scene's bounds; arrays live as long as the lw_points */
  const float *normal;     /* [points][3], unit, of the front */
  const uint32_t *texel;   /* [points], of the atlas, where albedo and light of the surface are; 0xffffffff: nowhere */
} lw_points_info;

/* Decodes and checks the section "points". Memory: 28 bytes a point. Fails as lw_decode_array does.
 *
 * points: receives a handle, to be released with lw_points_release. */
LW_API lw_result lw_points_load(const lw_container *container, lw_points **points);
LW_API void lw_points_release(lw_points *points);
/* LW_INVALID_ARGUMENT for NULL. */
LW_API lw_result lw_points_get_info(const lw_points *points, lw_points_info *info);

/* ---- Probes ----------------------------------------------------------------------------------------------------------------------- */

/* Light for what moves: places in the air that know what they receive from the patches of radiosity, on a lattice and at points that the bake was asked for. It is light that patches
 * reflect and emit; light straight from lamps is the game's own.
 *
 *   lw_probes_load(container, radiosity, &probes);
 *   lw_probes_evaluate(probes, state, NULL, sh);             after lw_radiosity_step or _solve: all probes,
 *   lw_probes_sample(probes, sh, position, object_sh);         what arrives at an object,
 *   lw_sh_irradiance(object_sh, normal, irradiance);           and on one side of it
 *
 * An lw_probes never changes; it needs the lw_radiosity only while it is loaded. */
typedef struct lw_probes lw_probes;

typedef struct lw_probes_info {
  uint32_t probes;             /* those on the lattice first, then the points in the order of the bake's list */
  uint32_t lattice_probes;
  uint32_t links;
  uint32_t lattice_count[3];   /* points of the lattice along the axes, not all of which have a probe; 0: no lattice */
  float lattice_first_m[3];
  float lattice_spacing_m;
  const float *position_m;     /* [probes][3]; lives as long as the lw_probes */
} lw_probes_info;

/* Decodes and checks the section "probes" of the container that `radiosity` is of. Memory: 8 bytes a link, about 100 a probe, 8 or less a point of the lattice. Fails as lw_decode_array does.
 *
 * probes: receives a handle, to be released with lw_probes_release. */
LW_API lw_result lw_probes_load(const lw_container *container, const lw_radiosity *radiosity, lw_probes **probes);
LW_API void lw_probes_release(lw_probes *probes);
LW_API lw_result lw_probes_get_info(const lw_probes *probes, lw_probes_info *info);

typedef struct lw_probes_evaluation {
  size_t size;                 /* sizeof(lw_probes_evaluation), set by LW_PROBES_EVALUATION_INIT */
  uint32_t light;              /* LW_RADIOSITY_INDIRECT: what patches reflect; LW_RADIOSITY_EMITTERS: what they emit; or both */
  uint32_t coefficients;       /* 9, or 4: the last five are zero then */
  const uint32_t *probe;       /* [count]: which; NULL: all */
  uint32_t count;
} lw_probes_evaluation;
#define LW_PROBES_EVALUATION_INIT {sizeof(lw_probes_evaluation), LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS, 9, NULL, 0}

/* What probes receive from the state's light. Where the coefficients would give some normal a negative irradiance, all but the first are scaled down until none is: the mean stays.
 * LW_NOT_FOUND for a probe beyond the last; LW_INVALID_ARGUMENT for a state of other form factors.
 *
 * evaluation: NULL for LW_PROBES_EVALUATION_INIT.
 * radiance_sh: [probes, or count][9][3], integrals of radiance times Y in the order of lw_environment_info.sky_radiance_sh: what lw_sh_irradiance takes. */
LW_API lw_result lw_probes_evaluate(const lw_probes *probes, lw_radiosity_state *state, const lw_probes_evaluation *evaluation, float *radiance_sh);

/* The probes of the lattice around a position. */
typedef struct lw_probes_around {
  uint32_t count;              /* 0 to 8 */
  uint32_t probe[8];
  float weight[8];             /* > 0, sum 1 */
} lw_probes_around;
/* Which probes light a position, and how much each: trilinear, as far as they see it. What is near a wall takes no light from behind it; positions inside of walls take that of the nearer
 * side. Beyond the lattice its border counts. None where there is no lattice, or no probe around. */
LW_API lw_result lw_probes_find(const lw_probes *probes, const float position_m[3], lw_probes_around *around);
/* The sum of what these probes have. probe_radiance_sh: [probes][9][3] as lw_probes_evaluate gives it for all. */
LW_API lw_result lw_probes_sample(const lw_probes *probes, const float *probe_radiance_sh, const float position_m[3], float radiance_sh[9][3]);

/* ---- Environment light ------------------------------------------------------------------------------------------------------------ */

/* The light of a sky (after Barsi, Szirmay-Kalos, Szécsi: "Image-Based Illumination on the GPU", with a map for what is not occluded):
 *
 *   reflected = sky(R, n) · (1 − Σ_cells (1 − visibility) · flux · a(cell, R, n) / Σ_cells flux · a(cell, R, n))
 *             + Σ_suns visibility · flux · a(sun, R, n)
 *
 * `sky` is the integral over a small map of the sky without its suns, `cells` are those that are no suns, a(cell, R, n) is the mean of
 * max(0, cos)^n about R over the cell's light. Cells cut the sphere of directions: one shadow map or ray for each. About a normal only
 * cells above the horizon count in the two sums. */
typedef struct lw_environment lw_environment;

typedef struct lw_environment_info {
  uint32_t cells;
  uint32_t suns;                   /* the first so many cells: bright spots with edges of their own */
  float max_shininess;             /* sharper lobes see the sky as blurred as this one does, at their own energy; suns stay sharp */
  float sky_flux_rgb[3];           /* integral of radiance over all directions, without the suns */
  float sky_radiance_sh[9][3];     /* real spherical harmonics of the sky without the suns, integral of L Y: Y00; Y1: y, z, x; Y2: xy, yz,
                                      3zz − 1, xz, xx − yy; orthonormal, positive factors (no Condon-Shortley phase), no cosine folded in */
} lw_environment_info;

/* Decodes and checks the section "environment". Memory: about 24 bytes per node of the sky, 0.8 MB for the bake's default. Fails as
 * lw_decode_array does.
 *
 * environment: receives a handle, to be released with lw_environment_release. */
LW_API lw_result lw_environment_load(const lw_container *container, lw_environment **environment);
LW_API void lw_environment_release(lw_environment *environment);

LW_API lw_result lw_environment_get_info(const lw_environment *environment, lw_environment_info *info);

/* The cells: suns first, then by falling luminance of their flux. Arrays live as long as the lw_environment. */
typedef struct lw_environment_cells {
  const float *direction;       /* [cells][3], unit, toward the light: the centroid of its power */
  const float *flux_rgb;        /* [cells][3], integral of radiance over the cell: the irradiance on a surface that faces it */
  const float *solid_angle_sr;  /* [cells], all together 4 pi */
  const float *cos_radius;      /* [cells], cosine of the angular radius of a cap with that solid angle */
  const float *spread;          /* [cells], 1 − mean cosine between the power and `direction`; 0 to 1 */
  const float *covariance;      /* [cells][3], xx, xy, yy of the power on the tangents below */
  const float *tangent;         /* [cells][3], unit; the other tangent is cross(direction, tangent) */
} lw_environment_cells;
LW_API lw_result lw_environment_get_cells(const lw_environment *environment, lw_environment_cells *cells);

/* Light that arrives from the environment. All directions are of any finite length but zero; results are finite and ≥ 0. LW_INVALID_ARGUMENT
 * when a number is out of range.
 *
 * visibility: [cells], 0 (hidden) to 1 for each cell; NULL: nothing is hidden.
 *
 * lw_environment_irradiance: about a normal. lw_environment_phong: the integral of radiance times cos^shininess of the angle to `mirror` over
 * the half sphere around it; shininess 1 to 1e5. lw_environment_ggx: mean radiance under the GGX filter of glTF's perceptual roughness (0 to
 * 1, below 0.075 as 0.075) about `mirror`, for the split-sum approximation (Karis 2013): multiply it with the reflectance of view and
 * roughness. */
LW_API lw_result lw_environment_irradiance(const lw_environment *environment, const float normal[3], const float *visibility,
                                           float irradiance_rgb[3]);
LW_API lw_result lw_environment_phong(const lw_environment *environment, const float mirror[3], float shininess, const float *visibility,
                                      float integral_rgb[3]);
LW_API lw_result lw_environment_ggx(const lw_environment *environment, const float mirror[3], float roughness, const float *visibility,
                                    float radiance_rgb[3]);

/* Irradiance about a normal from coefficients as in lw_environment_info: π, 2π/3 and π/4 times the bands (Ramamoorthi and Hanrahan 2001), ≥ 0.
 * For what needs neither shadows nor an lw_environment: nine coefficients are all it takes. */
LW_API lw_result lw_sh_irradiance(const float radiance_sh[9][3], const float normal[3], float irradiance_rgb[3]);

/* The lobes that lw_environment_ggx sums: weight · (shininess + 1) / 2 pi · cos^shininess, weights ≥ 0 that add to 1. */
typedef struct lw_phong_lobe {
  float weight, shininess;
} lw_phong_lobe;
LW_API lw_result lw_ggx_lobes(float roughness, lw_phong_lobe lobes[4]);

#ifdef __cplusplus
}
#endif
#endif
