/* Lightwell on OpenGL: the transport of an lw_prm evaluated every frame: panes in fragment shaders without a read-back;
 * local bases with a small sum on the CPU in between, from the light on their clusters.
 *
 *   lw_gl *gl;
 *   lw_gl_config config = LW_GL_CONFIG_INIT;
 *   config.loader = load;                               e.g. a wrapper of eglGetProcAddress, glfwGetProcAddress, SDL_GL_GetProcAddress
 *   lw_gl_create(&config, &gl);
 *   lw_gl_prm_create(gl, prm, NULL, &gl_prm);           uploads the transport and compiles its shaders; the lw_prm may then be released
 *   lw_gl_update_entries(gl_prm, lights, 2);            every frame: light at the entry points, with the game's shadow maps,
 *   lw_gl_evaluate(gl_prm, NULL);                         and the indirect irradiance of every texel
 *   glBindTexture(GL_TEXTURE_2D, lw_gl_prm_atlas_texture(gl_prm));   RGBA, linear filter, ready for lookup in the game's shaders
 *   lw_gl_prm_destroy(gl_prm);
 *   lw_gl_destroy(gl);
 *
 * Contexts. OpenGL 3.3 core or later, or OpenGL ES 3.0 or later with EXT_color_buffer_float. Every function must be called on the thread of
 * the context in which lw_gl_create was called (framebuffers are not shared between contexts). The textures may be used in contexts of
 * its share group. Conditional rendering and transform feedback must not be active.
 *
 * State. Each function leaves the GL state as it found it. It uses, and restores: the program, vertex array, draw and read framebuffer
 * bindings; viewport; active texture unit; on units 0 to 6 the bindings of GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_CUBE_MAP and
 * the sampler; GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_RASTERIZER_DISCARD, the colour mask (of draw buffers 0 to 3 where the context
 * has them one by one); pixel pack and unpack buffer bindings and storage modes; on desktop GL also GL_COLOR_LOGIC_OP, the polygon mode
 * and clip distances 0 to 7; functions of environments also the binding of GL_UNIFORM_BUFFER;
 * lw_gl_radiosity_inject also the depth test, function and mask, scissor box, stencil test, polygon offset, GL_PROGRAM_POINT_SIZE, and the blend functions and
 * equations (of draw buffer 0 where each has its own). Viewports and scissor tests beyond the first are not preserved. Functions that create, upload or read clear
 * GL's error flag; the others never ask for it. A running query that counts samples or primitives counts ours.
 *
 * Coordinates are the container's: metres relative to lw_scene_info.origin_m.
 */
#ifndef LIGHTWELL_LIGHTWELL_GL_H
#define LIGHTWELL_LIGHTWELL_GL_H

#include "lightwell/lightwell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Programs --------------------------------------------------------------------------------------------------------------------- */

/* The shaders and functions of one context. */
typedef struct lw_gl lw_gl;

typedef void (*lw_gl_proc)(void);

typedef struct lw_gl_config {
  size_t size;                                          /* sizeof(lw_gl_config), set by LW_GL_CONFIG_INIT */
  lw_gl_proc (*loader)(void *user, const char *name);   /* "glDrawArrays" → its address; NULL when there is none. Must be given */
  void *loader_user;
  void *(*allocate)(void *user, size_t bytes);          /* as in lw_config */
  void (*release)(void *user, void *memory);
  void *allocator_user;
  void (*message)(void *user, lw_result result, const char *text);
  void *message_user;
} lw_gl_config;
#define LW_GL_CONFIG_INIT {sizeof(lw_gl_config), NULL, NULL, NULL, NULL, NULL, NULL, NULL}

/* Loads functions in the current context. Shaders are compiled by the functions that create what needs them, once for a context; lw_gl_prepare_shadow.
 * Fails with LW_GL_UNSUPPORTED, LW_OUT_OF_MEMORY or LW_INVALID_ARGUMENT.
 *
 * gl: receives a handle; lw_gl_destroy it in the same context, after what was made with it. */
LW_API lw_result lw_gl_create(const lw_gl_config *config, lw_gl **gl);
LW_API void lw_gl_destroy(lw_gl *gl);

/* ---- Precomputed radiance maps ---------------------------------------------------------------------------------------------------- */

/* One transport on the GPU, and the textures that it is evaluated into. */
typedef struct lw_gl_prm lw_gl_prm;

enum { LW_GL_ATLAS_RGBA16F = 0, LW_GL_ATLAS_RGBA32F = 1 };

/* Who turns the sums of local bases into the atlas. Both show the same, up to rounding. */
enum {
  LW_GL_RECONSTRUCT_AUTO = 0,   /* the CPU where GL_RENDERER names a rasteriser in software, whose shaders run on it anyway, and the atlas is the library's own; else a shader */
  LW_GL_RECONSTRUCT_SHADER = 1,
  LW_GL_RECONSTRUCT_CPU = 2     /* as lw_prm_state_update does, then rows that have changed are uploaded; needs the library's own atlas */
};

typedef struct lw_gl_prm_options {
  size_t size;              /* sizeof(lw_gl_prm_options), set by LW_GL_PRM_OPTIONS_INIT */
  uint32_t atlas_format;    /* LW_GL_ATLAS_…; RGBA16F ends at 65504 lux; to filter RGBA32F on ES needs OES_texture_float_linear */
  uint32_t atlas_texture;   /* 0: own texture. Else a GL_TEXTURE_2D of the caller of that format, width × height or larger */
  uint32_t reconstruct;     /* LW_GL_RECONSTRUCT_…; of no meaning for panes */
} lw_gl_prm_options;
#define LW_GL_PRM_OPTIONS_INIT {sizeof(lw_gl_prm_options), LW_GL_ATLAS_RGBA16F, 0, LW_GL_RECONSTRUCT_AUTO}

/* Uploads a transport. The caller may release `prm` afterwards: what is still needed of it (local bases) is kept. Waits for the GPU only as texture uploads do.
 * On the CPU, LW_GL_RECONSTRUCT_CPU takes what an lw_prm_state does and 8 bytes a texel of the atlas (16 with RGBA32F). Fails with LW_LIMIT_EXCEEDED (texture sizes), LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT.
 *
 * options: NULL for LW_GL_PRM_OPTIONS_INIT. */
LW_API lw_result lw_gl_prm_create(lw_gl *gl, const lw_prm *prm, const lw_gl_prm_options *options, lw_gl_prm **gl_prm);
LW_API void lw_gl_prm_destroy(lw_gl_prm *gl_prm);

/* GL name of the atlas texture: GL_TEXTURE_2D, width × height, irradiance in RGB and 1 in A where a texel has a value; linear filter,
 * clamped to the edge. All zero before the first lw_gl_evaluate (unless it is the caller's). 0 for NULL. */
LW_API uint32_t lw_gl_prm_atlas_texture(const lw_gl_prm *gl_prm);

/* Bytes of texture memory that were asked for. */
LW_API uint64_t lw_gl_prm_texture_bytes(const lw_gl_prm *gl_prm);

/* ---- Light at the entry points ---------------------------------------------------------------------------------------------------- */

enum {
  LW_GL_SHADOW_NONE = 0,       /* nothing is in the way */
  LW_GL_SHADOW_2D = 1,         /* depth map, GL_TEXTURE_2D: spot and directional lights */
  LW_GL_SHADOW_CUBE = 2,       /* depth map, GL_TEXTURE_CUBE_MAP: point lights */
  LW_GL_SHADOW_VISIBILITY = 3  /* one number per entry point: lw_gl_create_visibility */
};

/* A light and how its shadow is known. Start from LW_GL_LIGHT_INIT.
 *
 * Shadow maps are the caller's textures of a depth format, one level. Their own compare mode, filter and wrap are ignored: a sampler object
 * is used (comparison, linear filter, clamped). A point is lit where its depth minus the bias is at most the stored one.
 *
 * LW_GL_SHADOW_2D: a point p (moved by the normal offset) has the clip coordinates q = shadow_matrix * (p, 1), texture coordinates
 *   q.xy / q.w * 0.5 + 0.5 and depth q.z / q.w * 0.5 + 0.5: the plain OpenGL projection with glDepthRange(0, 1). Points outside of the
 *   map (any of the three outside [0, 1], or q.w ≤ 0) are lit. With reversed_depth: depth q.z / q.w as it is (glClipControl zero to one,
 *   1 at the near plane), and a point is lit where its depth plus the bias is at least the stored one.
 * LW_GL_SHADOW_CUBE: six faces rendered from position_m with a 90° projection in GL's face order and orientation,
 *   near and far plane as given. The depth of a point is that of z = max(|x|, |y|, |z|) of its offset from the light:
 *   (far / (far − near)) * (1 − near / z), the plain projection again, or with reversed_depth one minus that. Points beyond the far
 *   plane are lit.
 * LW_GL_SHADOW_VISIBILITY: the texture that lw_gl_create_visibility made for this lw_gl_prm. */
typedef struct lw_gl_light {
  lw_light light;
  uint32_t shadow;            /* LW_GL_SHADOW_… */
  uint32_t shadow_texture;    /* GL name; 0 only with LW_GL_SHADOW_NONE */
  float shadow_matrix[16];    /* LW_GL_SHADOW_2D: container coordinates to clip coordinates, column-major */
  float near_m, far_m;        /* LW_GL_SHADOW_CUBE: 0 < near < far */
  uint32_t reversed_depth;    /* 0 or 1 */
  float depth_bias;           /* in units of stored depth; 0.0005 suits most maps */
  float normal_offset_m;      /* moves the entry point along its normal before the lookup; about one shadow texel's size */
} lw_gl_light;
#define LW_GL_LIGHT_INIT \
  {{LW_LIGHT_POINT, {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 0, 0.785398163f, 0}, LW_GL_SHADOW_NONE, 0, \
   {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 0.05f, 100.0f, 0, 0.0005f, 0.0f}

/* Irradiance at the entry points, the sum of all `count` lights, and its averages over the clusters; replaces what was there. One draw
 * per shadowed light, one per 16 others, one for the averages.
 * Point and spot lights close to an entry of local bases are averaged over its rectangle, as lw_prm_entry_irradiance does.
 * LW_INVALID_ARGUMENT names the light whose values are out of range; nothing is drawn then, nor after LW_GL_FAILED (lw_gl_prepare_shadow). */
LW_API lw_result lw_gl_update_entries(lw_gl_prm *gl_prm, const lw_gl_light *lights, uint32_t count);

/* Compiles now what lights with this LW_GL_SHADOW_… need; else the first lw_gl_update_entries with such a light does, and takes its time. A game compiles so what its
 * lights have, and nothing else. Fails with LW_GL_FAILED (the message holds the compiler's log) or LW_INVALID_ARGUMENT. */
LW_API lw_result lw_gl_prepare_shadow(lw_gl *gl, uint32_t shadow);

/* A texture of visibilities for LW_GL_SHADOW_VISIBILITY, filled with 1; glDeleteTextures it, or lw_gl_destroy_visibility. */
LW_API lw_result lw_gl_create_visibility(lw_gl_prm *gl_prm, uint32_t *texture);
LW_API void lw_gl_destroy_visibility(lw_gl_prm *gl_prm, uint32_t texture);
/* visibility: [entries], 0 to 1 (lw_shadow_ray's order of entry points). */
LW_API lw_result lw_gl_upload_visibility(lw_gl_prm *gl_prm, uint32_t texture, const float *visibility);

/* Instead of lw_gl_update_entries: cluster averages from the CPU (lw_prm_cluster_irradiance), [clusters][3], finite and ≥ 0. */
LW_API lw_result lw_gl_upload_cluster_irradiance(lw_gl_prm *gl_prm, const float *cluster_irradiance_rgb);

/* ---- Indirect light of the atlas -------------------------------------------------------------------------------------------------- */

/* lw_prm_evaluate on the GPU, from the cluster averages of the last update, into the atlas texture. The brightest panes are ranked on
 * the GPU. Local bases: their amounts as by lw_gl_update_coefficients, then the atlas by LW_GL_RECONSTRUCT_….
 *
 * Local bases keep, in the library's own atlas texture, the texels whose light has not changed since the last call: nobody else may write to it.
 *
 * options: as lw_prm_evaluate's; NULL for LW_PRM_OPTIONS_INIT. */
LW_API lw_result lw_gl_evaluate(lw_gl_prm *gl_prm, const lw_prm_options *options);

/* Local bases: only the amounts of the blocks' basis maps, for a game that reconstructs in
 * its own shader (LW_GLSL_LOCAL_BASES, filled as for display) and needs no atlas texture. They are summed on the CPU: after lw_gl_update_entries the cluster
 * averages are read back once, which waits for the GPU; after lw_gl_upload_cluster_irradiance nothing is. Fails with LW_GL_FAILED when reading back does.
 * LW_INVALID_ARGUMENT for panes. Emitters are not part of it. */
LW_API lw_result lw_gl_update_coefficients(lw_gl_prm *gl_prm);

/* ---- Reading back: for tools and tests; waits for the GPU ------------------------------------------------------------------------- */

LW_API lw_result lw_gl_read_entries(lw_gl_prm *gl_prm, float *entry_irradiance_rgb);      /* [entries][3] */
LW_API lw_result lw_gl_read_clusters(lw_gl_prm *gl_prm, float *cluster_irradiance_rgb);   /* [clusters][3] */
LW_API lw_result lw_gl_read_atlas(lw_gl_prm *gl_prm, float *atlas_rgba);                  /* [height][width][4] */

/* ---- Radiosity -------------------------------------------------------------------------------------------------------------------- */

/* Form factors on the GPU, the light that they carry, and the atlas texture that it is shown in.
 *
 *   lw_gl_radiosity_create(gl, radiosity, NULL, &gl_radiosity);     uploads the links; materials and portals as baked, darkness
 *   lw_gl_radiosity_upload(gl_radiosity, state, LW_GL_RADIOSITY_DIRECT);   every frame: what the game changed in a state on the CPU,
 *   lw_gl_radiosity_step(gl_radiosity, 1);                                   one bounce more on top of the last frame's light,
 *   lw_gl_radiosity_shade(gl_radiosity, NULL);                               and the atlas texture */
typedef struct lw_gl_radiosity lw_gl_radiosity;

typedef struct lw_gl_radiosity_options {
  size_t size;              /* sizeof(lw_gl_radiosity_options), set by LW_GL_RADIOSITY_OPTIONS_INIT */
  uint32_t atlas_format;    /* as in lw_gl_prm_options */
  uint32_t atlas_texture;   /* as in lw_gl_prm_options */
} lw_gl_radiosity_options;
#define LW_GL_RADIOSITY_OPTIONS_INIT {sizeof(lw_gl_radiosity_options), LW_GL_ATLAS_RGBA16F, 0}

/* Uploads form factors. `radiosity` is not used afterwards (states are, by lw_gl_radiosity_upload).
 * Fails with LW_LIMIT_EXCEEDED (texture sizes; more than 2^22 patches and nodes), LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT. */
LW_API lw_result lw_gl_radiosity_create(lw_gl *gl, const lw_radiosity *radiosity, const lw_gl_radiosity_options *options,
                                        lw_gl_radiosity **gl_radiosity);
LW_API void lw_gl_radiosity_destroy(lw_gl_radiosity *gl_radiosity);

/* As lw_gl_prm_atlas_texture and lw_gl_prm_texture_bytes. */
LW_API uint32_t lw_gl_radiosity_atlas_texture(const lw_gl_radiosity *gl_radiosity);
LW_API uint64_t lw_gl_radiosity_texture_bytes(const lw_gl_radiosity *gl_radiosity);

/* What of a state is uploaded: bits. */
enum { LW_GL_RADIOSITY_MATERIALS = 1, LW_GL_RADIOSITY_PORTALS = 2, LW_GL_RADIOSITY_DIRECT = 4, LW_GL_RADIOSITY_BLOCKERS = 8 };
/* Takes over what a state of the same form factors says; the light that the state holds is not touched. 16 bytes a patch for direct light and
 * for blockers, 32 for materials, 4 a gate set for portals. */
LW_API lw_result lw_gl_radiosity_upload(lw_gl_radiosity *gl_radiosity, const lw_radiosity_state *state, uint32_t what);

/* lw_radiosity_step on the GPU: each sweep fetches twice for each link, and is three draws and two more for each level of nodes. */
LW_API lw_result lw_gl_radiosity_step(lw_gl_radiosity *gl_radiosity, uint32_t sweeps);

/* All bounces, without a read-back: as many Chebyshev-accelerated sweeps as bring any error down to `tolerance` (> 0) of what it was, which the greatest albedo
 * times a row's sum gives; at most most_sweeps. For 0.01: 5 at albedo 0.5, 12 at 0.9, 38 at 0.99, 119 at 0.999.
 *
 * sweeps: NULL, or receives their number. */
LW_API lw_result lw_gl_radiosity_solve(lw_gl_radiosity *gl_radiosity, double tolerance, uint32_t most_sweeps, uint32_t *sweeps);

/* lw_radiosity_shade on the GPU, into the atlas texture. shading: NULL for LW_RADIOSITY_SHADING_INIT. */
LW_API lw_result lw_gl_radiosity_shade(lw_gl_radiosity *gl_radiosity, const lw_radiosity_shading *shading);

/* Light of moving lamps, as by lw_radiosity_inject, drawn by the GPU: every frame lw_gl_radiosity_inject in place of lw_gl_radiosity_upload with
 * LW_GL_RADIOSITY_DIRECT. Each view is a draw of all of the container's triangles and one of side² points, which are added up in the texture of direct light.
 * glClipControl must be as OpenGL has it at first. */
typedef struct lw_gl_radiosity_injector lw_gl_radiosity_injector;
/* `container` and `radiosity` are those that `gl_radiosity` was made of, and are not used afterwards; gl_radiosity must outlive the injector.
 * Fails with LW_GL_UNSUPPORTED (on ES EXT_float_blend is needed), LW_LIMIT_EXCEEDED, LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT, and as
 * lw_radiosity_injector_create does.
 *
 * side: pixels along a view, 8 to 4096; 128 is enough for most rooms. Textures: 112 bytes a triangle, 8 an atlas texel, 16 a patch, 12 a pixel. */
LW_API lw_result lw_gl_radiosity_injector_create(lw_gl_radiosity *gl_radiosity, const lw_container *container, const lw_radiosity *radiosity,
                                                 uint32_t side, lw_gl_radiosity_injector **injector);
LW_API void lw_gl_radiosity_injector_destroy(lw_gl_radiosity_injector *injector);
LW_API uint64_t lw_gl_radiosity_injector_texture_bytes(const lw_gl_radiosity_injector *injector);
/* The direct light of the injector's lw_gl_radiosity becomes what all `count` lights give. Leaves are drawn as far as portals were open at the last lw_gl_radiosity_upload with
 * LW_GL_RADIOSITY_PORTALS. LW_INVALID_ARGUMENT names the light whose values are out of
 * range; nothing is drawn then. A spot costs the CPU the smooth edge at side² pixels (six times that when it is very wide). */
LW_API lw_result lw_gl_radiosity_inject(lw_gl_radiosity_injector *injector, const lw_light *lights, uint32_t count);

/* For tools and tests; waits for the GPU. irradiance_rgb: [patches][3], from other patches, or of lights; atlas_rgba: [height][width][4]. */
LW_API lw_result lw_gl_radiosity_read_direct(lw_gl_radiosity *gl_radiosity, float *irradiance_rgb);
LW_API lw_result lw_gl_radiosity_read_irradiance(lw_gl_radiosity *gl_radiosity, float *irradiance_rgb);
LW_API lw_result lw_gl_radiosity_read_atlas(lw_gl_radiosity *gl_radiosity, float *atlas_rgba);

/* Blockers as pixels see them: sets the uniforms of LW_GLSL_BLOCKERS in `program`, which multiplies its indirect irradiance by
 *
 *   vec3 lwBlockersKept(vec3 position_m, vec3 normal)
 *
 * A program with more than 16 blockers defines LW_BLOCKERS before the source (two vectors each). LW_NOT_FOUND when the program does not use the snippet. State is restored. */
LW_API lw_result lw_gl_set_blockers(lw_gl *gl, uint32_t program, const lw_blocker *blockers, uint32_t count);

/* ---- Light map -------------------------------------------------------------------------------------------------------------------- */

/* A baked light map as a texture of irradiance: made once, with gutters filled, linear filter. */
typedef struct lw_gl_lightmap lw_gl_lightmap;

typedef struct lw_gl_lightmap_options {
  size_t size;                         /* sizeof(lw_gl_lightmap_options), set by LW_GL_LIGHTMAP_OPTIONS_INIT */
  uint32_t atlas_format;               /* as in lw_gl_prm_options */
  const lw_lightmap_shading *shading;  /* NULL for LW_LIGHTMAP_SHADING_INIT */
} lw_gl_lightmap_options;
#define LW_GL_LIGHTMAP_OPTIONS_INIT {sizeof(lw_gl_lightmap_options), LW_GL_ATLAS_RGBA16F, NULL}

/* `lightmap` is not used afterwards. Fails with LW_LIMIT_EXCEEDED (a light beyond half floats, 65504 lux, too: LW_GL_ATLAS_RGBA32F takes it), LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT. */
LW_API lw_result lw_gl_lightmap_create(lw_gl *gl, const lw_lightmap *lightmap, const lw_gl_lightmap_options *options, lw_gl_lightmap **gl_lightmap);
LW_API void lw_gl_lightmap_destroy(lw_gl_lightmap *gl_lightmap);
/* As lw_gl_prm_atlas_texture and lw_gl_prm_texture_bytes; 0 for NULL. */
LW_API uint32_t lw_gl_lightmap_texture(const lw_gl_lightmap *gl_lightmap);
LW_API uint64_t lw_gl_lightmap_texture_bytes(const lw_gl_lightmap *gl_lightmap);
/* lw_lightmap_shade_gradients as RGBA8_SNORM, divided by LW_LIGHTMAP_MOST_GRADIENT, with gutters filled, linear filter: what LW_GLSL_LIGHTMAP reads. 0 for NULL, and for
   maps without gradients. */
LW_API uint32_t lw_gl_lightmap_gradient_texture(const lw_gl_lightmap *gl_lightmap);
/* For tools and tests; waits for the GPU. Fails with LW_GL_FAILED. rgba: [height][width][4]. */
LW_API lw_result lw_gl_lightmap_read(lw_gl_lightmap *gl_lightmap, float *rgba);

/* ---- Probes ----------------------------------------------------------------------------------------------------------------------- */

/* Probes for moving objects on the GPU, lit by an lw_gl_radiosity.
 *
 *   lw_gl_probes_create(gl_radiosity, probes, NULL, &gl_probes);     uploads links; the lw_probes may then be released
 *   lw_gl_probes_evaluate(gl_probes, LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS);   after lw_gl_radiosity_step: what all probes receive
 *   lw_gl_bind_probes(gl_probes, program, first_unit);               for the shaders of what moves, with LW_GLSL_PROBES:
 *
 *   vec3 lwProbesIrradiance(vec3 position_m, vec3 normal)            what arrives, from the probes around that see the position; or, where one lookup serves several normals,
 *   LwProbeLight lwProbeLight(vec3 position_m)                       (in a vertex shader, say: seven varyings)
 *   vec3 lwProbeIrradiance(LwProbeLight light, vec3 normal) */
typedef struct lw_gl_probes lw_gl_probes;

typedef struct lw_gl_probes_options {
  size_t size;              /* sizeof(lw_gl_probes_options), set by LW_GL_PROBES_OPTIONS_INIT */
  uint32_t coefficients;    /* 9, or 4 for half the work and memory */
} lw_gl_probes_options;
#define LW_GL_PROBES_OPTIONS_INIT {sizeof(lw_gl_probes_options), 9}

/* `probes` are of the form factors that gl_radiosity was made of, which must outlive gl_probes. Textures: 8 bytes a link, 64 or 128 a probe, about 300 more of those on the lattice.
 * Fails with LW_LIMIT_EXCEEDED, LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT. */
LW_API lw_result lw_gl_probes_create(lw_gl_radiosity *gl_radiosity, const lw_probes *probes, const lw_gl_probes_options *options, lw_gl_probes **gl_probes);
LW_API void lw_gl_probes_destroy(lw_gl_probes *gl_probes);
LW_API uint64_t lw_gl_probes_texture_bytes(const lw_gl_probes *gl_probes);

/* lw_probes_evaluate for all probes, from the last solution on the GPU and the portals as uploaded: two fetches for each link (four with 9 coefficients).
 *
 * light: LW_RADIOSITY_INDIRECT, LW_RADIOSITY_EMITTERS or both. */
LW_API lw_result lw_gl_probes_evaluate(lw_gl_probes *gl_probes, uint32_t light);

/* Binds two textures to the units first_unit and first_unit + 1 and sets the uniforms of LW_GLSL_PROBES in `program`. These bindings (and the sampler objects of these units, unbound) stay;
 * the rest of the state is restored. LW_NOT_FOUND when the program does not use the snippet. */
LW_API lw_result lw_gl_bind_probes(lw_gl_probes *gl_probes, uint32_t program, uint32_t first_unit);

/* For tools and tests; waits for the GPU. radiance_sh: [probes][9][3] as of lw_probes_evaluate. */
LW_API lw_result lw_gl_probes_read(lw_gl_probes *gl_probes, float *radiance_sh);

/* ---- Environment light ------------------------------------------------------------------------------------------------------------ */

/* A sky on the GPU: its cells in a uniform block, a prefiltered picture for what is not hidden, and a depth map for each cell.
 * The game's shaders light surfaces with the functions of LW_GLSL_ENVIRONMENT; all take unit vectors in the container's axes:
 *
 *   vec3 lwEnvironmentRadiance(vec3 direction)                     the sky itself, suns as discs: backgrounds
 *   vec3 lwEnvironmentHarmonicIrradiance(vec3 normal)              nine coefficients, no texture: what is small or far away
 *   vec3 lwEnvironmentIrradiance(vec3 normal)                      unoccluded, exact: what needs no shadow
 *   vec3 lwEnvironmentLobe(vec3 mirror, float shininess)           unoccluded integral of radiance × cos^shininess, 1 to 1e5
 *   vec3 lwEnvironmentGgx(vec3 mirror, float roughness)            unoccluded mean radiance under the GGX filter (lw_environment_ggx)
 *   vec3 lwEnvironmentDiffuse(vec3 position_m, vec3 facing, vec3 normal)                       irradiance, shadowed
 *   LwEnvironmentLight lwEnvironmentPhong(position_m, facing, normal, mirror, shininess)       .irradiance and .lobe, shadowed
 *   LwEnvironmentLight lwEnvironmentRough(position_m, facing, normal, mirror, roughness)       the same with GGX
 *
 * `facing` is the surface's true normal on the lit side (of the triangle, not interpolated): cells below it are hidden by the surface.
 * A diffuse surface shows albedo / pi × irradiance. A program that has more than 256 cells to hold defines LW_ENVIRONMENT_CELLS before
 * the source; OpenGL guarantees room for 318. */
typedef struct lw_gl_environment lw_gl_environment;

typedef struct lw_gl_environment_options {
  size_t size;               /* sizeof(lw_gl_environment_options), set by LW_GL_ENVIRONMENT_OPTIONS_INIT */
  uint32_t cells;            /* use only the first so many (suns, then the brightest), which then carry the light of all; 0: all */
  uint32_t map_texels;       /* side of a cell's depth map, 16 to 2048; 2 bytes a texel */
  uint32_t sun_map_texels;   /* the same of a sun's, whose shadows have edges; 16 to 4096 */
  float bounds_min_m[3];     /* of everything that casts shadow, relative to the container's origin */
  float bounds_max_m[3];
} lw_gl_environment_options;
#define LW_GL_ENVIRONMENT_OPTIONS_INIT {sizeof(lw_gl_environment_options), 0, 256, 1024, {-1, -1, -1}, {1, 1, 1}}

/* Uploads a sky and prefilters its picture, which keeps the calling thread busy for up to a second or two. `environment` is not used afterwards.
 * Until depth maps are drawn nothing is hidden.
 * Fails with LW_LIMIT_EXCEEDED (texture or uniform block sizes), LW_OUT_OF_MEMORY, LW_GL_FAILED, LW_INVALID_ARGUMENT. */
LW_API lw_result lw_gl_environment_create(lw_gl *gl, const lw_environment *environment, const lw_gl_environment_options *options,
                                          lw_gl_environment **gl_environment);
LW_API void lw_gl_environment_destroy(lw_gl_environment *gl_environment);

/* Cells in use; 0 for NULL. */
LW_API uint32_t lw_gl_environment_cells(const lw_gl_environment *gl_environment);
/* Bytes of texture memory that were asked for; 0 for NULL. */
LW_API uint64_t lw_gl_environment_texture_bytes(const lw_gl_environment *gl_environment);

/* Fits the depth maps to other bounds. All of them count as never drawn then, and hide nothing until they are. */
LW_API lw_result lw_gl_environment_set_bounds(lw_gl_environment *gl_environment, const float bounds_min_m[3], const float bounds_max_m[3]);

/* Draws everything that casts shadow into one depth map. In state: framebuffer, viewport and scissor of the map, depth test (less or equal)
 * and mask on, culling, blending, stencil test and polygon offset off, glDepthRange and glClipControl as the game has them, which
 * must be OpenGL's defaults. The callback may change any state that the library restores, and the depth state; it must draw into the
 * bound framebuffer. Casters may be one-sided or not; front faces are counter-clockwise as ever.
 *
 * cell: its number. view_projection: container coordinates to clip coordinates, column-major, orthographic. */
typedef void (*lw_gl_draw_casters)(void *user, uint32_t cell, const float view_projection[16]);

/* Draws at most `most_maps` depth maps: those never drawn first, then by falling power × age, the age counted in calls of this function.
 * Every map has its turn. With the number of cells, all are drawn; a few per frame follow casters that move.
 * State: besides the above, the depth test, function and mask, scissor box, stencil test and polygon offset are restored.
 *
 * refreshed: NULL, or receives the number of maps drawn. */
LW_API lw_result lw_gl_environment_refresh(lw_gl_environment *gl_environment, uint32_t most_maps, lw_gl_draw_casters draw, void *user,
                                           uint32_t *refreshed);

enum {
  LW_ENVIRONMENT_SHARE = 0,      /* the sky's exact light, less the share of it that the hidden cells have; and visible suns */
  LW_ENVIRONMENT_SUM = 1,        /* the sum of visible cells, each with its own spread */
  LW_ENVIRONMENT_SUM_PAPER = 2,  /* the sum with the paper's average reflectivity: even light over a round cell */
  LW_ENVIRONMENT_UNSHADOWED = 3
};

typedef struct lw_gl_environment_shading {
  size_t size;               /* sizeof(lw_gl_environment_shading), set by LW_GL_ENVIRONMENT_SHADING_INIT */
  uint32_t technique;        /* LW_ENVIRONMENT_… */
  uint32_t filter_taps;      /* 1 or 4 comparisons for each cell, each filtered over 2 × 2 texels */
  float scale_rgb[3];        /* of all radiance of the sky */
} lw_gl_environment_shading;
#define LW_GL_ENVIRONMENT_SHADING_INIT {sizeof(lw_gl_environment_shading), LW_ENVIRONMENT_SHARE, 1, {1, 1, 1}}

/* Gives a program what LW_GLSL_ENVIRONMENT reads: textures on the units first_unit and first_unit + 1 (without sampler objects), and
 * the uniform buffer at the binding point `binding`. These bindings stay; the rest of the state is restored. The shading belongs to the
 * environment: the last call counts for all programs.
 * LW_NOT_FOUND when the program does not use the snippet, LW_LIMIT_EXCEEDED when its LW_ENVIRONMENT_CELLS is too small.
 *
 * shading: NULL for LW_GL_ENVIRONMENT_SHADING_INIT. */
LW_API lw_result lw_gl_bind_environment(lw_gl_environment *gl_environment, uint32_t program, uint32_t first_unit, uint32_t binding,
                                        const lw_gl_environment_shading *shading);

/* ---- For the game's own shaders --------------------------------------------------------------------------------------------------- */

typedef enum lw_glsl {
  /* vec3 lwAtlasIrradiance(sampler2D atlas, vec2 lightmap_uv): irradiance, safe beside texels without a value.
     vec3 lwDiffuseRadiance(vec3 albedo, vec3 irradiance): albedo / pi * E. */
  LW_GLSL_ATLAS = 1,
  /* struct LwLight {vec4 position_range, direction_type, intensity, spot;} as lw_gl_pack_light fills it, and
     vec3 lwLightIrradiance(LwLight light, vec3 position, vec3 normal): the physics of lw_light. */
  LW_GLSL_LIGHT = 2,
  /* vec3 lwLocalBasesIrradiance(vec2 lightmap_uv): bilinear reconstruction from four texels, without an atlas texture.
     Its uniforms are set by lw_gl_bind_local_bases. */
  LW_GLSL_LOCAL_BASES = 3,
  /* Light of a sky, for fragment shaders; see "Environment light" above. */
  LW_GLSL_ENVIRONMENT = 4,
  /* Light of probes at a position; see "Probes" above. Its uniforms are set by lw_gl_bind_probes. */
  LW_GLSL_PROBES = 5,
  /* Contact shadows of what moves; see lw_gl_set_blockers. */
  LW_GLSL_BLOCKERS = 6,
  /* vec3 lwLightmapIrradiance(sampler2D atlas, sampler2D gradients, vec2 lightmap_uv, vec3 surface_normal, vec3 normal): irradiance about a normal-mapped normal, both
     normals unit, in world space; needs LW_GLSL_ATLAS before it. See lw_gl_lightmap_gradient_texture. */
  LW_GLSL_LIGHTMAP = 7
} lw_glsl;

/* GLSL source without a #version line, good for `#version 330 core` and `#version 300 es` alike. On ES it sets the default precision to highp
 * for what it uses, and for what follows. Static storage; NULL for other values. */
LW_API const char *lw_glsl_source(lw_glsl snippet);

/* The 16 numbers of an LwLight, in its order. LW_INVALID_ARGUMENT when the light's values are out of range. */
LW_API lw_result lw_gl_pack_light(const lw_light *light, float packed[16]);

/* Binds three textures to the units first_unit to first_unit + 2 and sets the uniforms of LW_GLSL_LOCAL_BASES in `program`. These
 * bindings (and the sampler objects of these units, unbound) stay; the rest of the state is restored. LW_INVALID_ARGUMENT for panes,
 * LW_NOT_FOUND when the program does not use the snippet. */
LW_API lw_result lw_gl_bind_local_bases(lw_gl_prm *gl_prm, uint32_t program, uint32_t first_unit);

#ifdef __cplusplus
}
#endif
#endif
