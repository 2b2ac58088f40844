/* Lambent: indirect and direct light for an engine's frames, in its own OpenGL 4.5 context. C99, C++11 and newer.
 *
 *   lambent_create            in the context that is current, on the thread that will draw
 *   lambent_scene_create      meshes, materials, instances, lights, sky: told once, and again when they change
 *   lambent_view_create       a camera's image of it; several per scene
 *   lambent_render            every frame: camera and G-buffer in, light on its surfaces out, as textures
 *   lambent_irradiance        light at any points: particles, forward-shaded things
 *
 * docs/embedding.md goes through it in this order. Conventions: right-handed, metres, radians; matrices column by
 * column, as OpenGL's; colours linear Rec.709. Radiance in W/(m² sr), irradiance in W/m². Nothing here is scaled for a
 * display.
 *
 * Descriptors: LAMBENT_DEFAULTS(kind, &desc) sets the size field and every default, then set what differs.
 * Errors: each call says how it went; lambent_message() says it in words, with the cure. A call that fails changes
 * nothing, but for LAMBENT_DEVICE_LOST: a fault in the library itself, after which only lambent_destroy() does anything.
 * Threads: a device is used by one thread at a time; calls that draw (marked GL) need the context in which it was
 * created. Devices are independent of each other: two may run in two threads with two contexts. */
#ifndef LAMBENT_H
#define LAMBENT_H

#include <stddef.h>
#include <stdint.h>

#define LAMBENT_VERSION_MAJOR 0
#define LAMBENT_VERSION_MINOR 1
#define LAMBENT_VERSION_PATCH 0
#define LAMBENT_VERSION (LAMBENT_VERSION_MAJOR * 10000 + LAMBENT_VERSION_MINOR * 100 + LAMBENT_VERSION_PATCH)

#if defined(__GNUC__)
#define LAMBENT_API __attribute__((visibility("default")))
#else
#define LAMBENT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Of the library in use, as LAMBENT_VERSION; and as "0.1.0". Minor versions will add to structs at their ends
 * only, and go on taking the sizes of this one. */
LAMBENT_API uint32_t lambent_version(void);
LAMBENT_API const char* lambent_version_text(void);

typedef enum lambent_status {
  LAMBENT_OK = 0,
  LAMBENT_INVALID_ARGUMENT = 1, /* a value, a size or an order of calls that cannot be: lambent_message() says which */
  LAMBENT_INVALID_HANDLE = 2,   /* not of this device, or destroyed */
  LAMBENT_NO_CONTEXT = 3,       /* no OpenGL 4.5 context is current, or not the device's */
  LAMBENT_OUT_OF_MEMORY = 4,
  LAMBENT_FAILED = 5, /* the machine or its driver: a shader that does not compile */
  LAMBENT_DEVICE_LOST = 6, /* a fault in the library, now or before: destroy the device */
  LAMBENT_BUSY = 7    /* another call to the device is on its way, on another thread or around a callback */
} lambent_status;
LAMBENT_API const char* lambent_status_text(int status);

/* A device: everything of one host in one OpenGL context. The rest are numbers that belong to a device; 0 is none, and
 * a number is never given twice, by any device of the process. */
typedef struct lambent_device lambent_device;
typedef uint64_t lambent_scene;
typedef uint64_t lambent_texture;  /* of a scene */
typedef uint64_t lambent_material; /* of a scene */
typedef uint64_t lambent_mesh;     /* of a scene */
typedef uint64_t lambent_instance; /* a mesh placed in a scene */
typedef uint64_t lambent_light;    /* of a scene */
typedef uint64_t lambent_view;     /* of a scene */

typedef enum lambent_kind { /* descriptors, for lambent_defaults() */
  LAMBENT_DEVICE_DESC,
  LAMBENT_TEXTURE_DESC,
  LAMBENT_MATERIAL_DESC,
  LAMBENT_MESH_DESC,
  LAMBENT_LIGHT_DESC,
  LAMBENT_SKY_DESC,
  LAMBENT_VIEW_DESC,
  LAMBENT_FRAME,
  LAMBENT_OUTPUT
} lambent_kind;
/* Writes the defaults of a descriptor of `size` bytes, its size field included. */
LAMBENT_API lambent_status lambent_defaults(int kind, void* desc, size_t size);
#define LAMBENT_DEFAULTS(kind, desc) lambent_defaults((kind), (desc), sizeof *(desc))

/* Device ------------------------------------------------------------------------------------------------------------ */

typedef enum lambent_level { LAMBENT_LOG_INFO, LAMBENT_LOG_WARNING, LAMBENT_LOG_ERROR } lambent_level;
/* Called on the thread that called the library, with one line without its end. */
typedef void (*lambent_log_function)(void* user, lambent_level level, const char* line);
/* Called with the bytes by which memory for ray tracing grows (above 0, before it does) or has shrunk, from any thread.
 * Returns 0 to refuse: the call that asked fails with LAMBENT_OUT_OF_MEMORY. */
typedef int (*lambent_memory_function)(void* user, int64_t bytes);

typedef struct lambent_device_desc {
  size_t size;
  uint32_t seed;                /* same seed, calls and driver: same light, to the bit, for any number of threads */
  int threads;                  /* that compute, the caller included; 0: one for each core */
  lambent_log_function log;     /* NULL: nothing is logged */
  lambent_memory_function memory; /* NULL: nobody is asked */
  void* user;                   /* handed to both */
  const char* shader_folder;    /* NULL: the shaders in the library; for work on these: the folder shaders/ */
} lambent_device_desc;

/* GL. On failure *device is NULL and lambent_message(NULL) says why. `desc` may be NULL. */
LAMBENT_API lambent_status lambent_create(const lambent_device_desc* desc, lambent_device** device);
/* GL. With all that it holds; waits for what it still computes. NULL does nothing, nor does a call from a callback. */
LAMBENT_API void lambent_destroy(lambent_device* device);
/* What the last failed call said, one line; "" when none failed. Valid until the next call. NULL: of this thread's last
 * call without a device, or to one that was busy. */
LAMBENT_API const char* lambent_message(const lambent_device* device);

typedef struct lambent_memory_row {
  char owner[32]; /* "scene", "rays", "vpl maps", … */
  int gpu;        /* 1: on the GPU, 0: for the CPU */
  uint64_t bytes;
} lambent_memory_row;
/* Fills up to *count rows and sets *count to how many there are. `rows` may be NULL where *count is 0. */
LAMBENT_API lambent_status lambent_memory(lambent_device* device, lambent_memory_row* rows, size_t* count);

/* Scene ------------------------------------------------------------------------------------------------------------- */
/* All may come and go while frames run; the library finds out what that means for the light. Only a material that is
 * changed (lambent_material_set) has the next frame begin its light anew. Calls that need the OpenGL context are marked
 * GL. None waits, but that textures, materials and meshes wait for an update of lights beside the GPU (frame.overlap),
 * and have the next frame build and upload what came. */

LAMBENT_API lambent_status lambent_scene_create(lambent_device* device, lambent_scene* scene);
/* LAMBENT_OK where the device has this scene. */
LAMBENT_API lambent_status lambent_scene_exists(lambent_device* device, lambent_scene scene);
/* GL. With its views. */
LAMBENT_API lambent_status lambent_scene_destroy(lambent_device* device, lambent_scene scene);

typedef enum lambent_wrap {
  LAMBENT_WRAP_REPEAT,
  LAMBENT_WRAP_MIRRORED_REPEAT,
  LAMBENT_WRAP_CLAMP_TO_EDGE
} lambent_wrap;
typedef struct lambent_texture_desc {
  size_t size;
  int width, height;
  const uint8_t* rgba; /* width * height texels of four bytes; row 0 lies at v = 0 */
  uint32_t gl_texture; /* GL. Instead of `rgba`: level 0 of a GL_TEXTURE_2D, copied now as 8 bits a channel (values
                          beyond 1 are 1), which waits for the GPU */
  int srgb;            /* colours are sRGB-encoded, alpha is not; default 1 */
  int32_t wrap_u, wrap_v; /* lambent_wrap */
  int nearest; /* 1: no filter between texels */
} lambent_texture_desc;
LAMBENT_API lambent_status lambent_texture_create(lambent_device* device, lambent_scene scene,
                                                  const lambent_texture_desc* desc, lambent_texture* texture);

/* Not while a material uses it. */
LAMBENT_API lambent_status lambent_texture_destroy(lambent_device* device, lambent_scene scene,
                                                   lambent_texture texture);

/* What alpha (alpha × base_texture × vertex colour) is for. Mask: below alpha_cutoff the surface is not there. Blend: it
 * lets 1 - alpha of lamps' and suns' light pass exactly, and of all other light in the mean; leave it out of your
 * G-buffer, and draw it over your image. */
typedef enum lambent_alpha { LAMBENT_ALPHA_OPAQUE, LAMBENT_ALPHA_MASK, LAMBENT_ALPHA_BLEND } lambent_alpha;
/* What light and eyes see of a surface: Lambert, albedo = base_color × texture × vertex colour; both sides reflect. */
typedef struct lambent_material_desc {
  size_t size;
  float base_color[3];          /* default 0.8 */
  lambent_texture base_texture; /* 0: none */
  float emission[3];            /* radiance of the front side, or of both */
  lambent_texture emission_texture;
  int double_sided;  /* emits on both sides */
  int32_t alpha_mode;        /* lambent_alpha; default opaque */
  float alpha, alpha_cutoff; /* default 1, 0.5 */
  int32_t base_uv_set, emission_uv_set; /* 0: uvs of the mesh, 1: uvs1 */
  float base_uv[6], emission_uv[6]; /* m: a texture is read at (m0 u + m1 v + m2, m3 u + m4 v + m5); default u, v */
  int back_hidden; /* your camera looks through its back, as where you cull by facing; light meets both sides */
} lambent_material_desc;
LAMBENT_API lambent_status lambent_material_create(lambent_device* device, lambent_scene scene,
                                                   const lambent_material_desc* desc, lambent_material* material);
/* Makes it another one on all meshes that have it; the next frame of each view then places its lights anew. */
LAMBENT_API lambent_status lambent_material_set(lambent_device* device, lambent_scene scene,
                                                lambent_material material, const lambent_material_desc* desc);
/* Not while a mesh has it. */
LAMBENT_API lambent_status lambent_material_destroy(lambent_device* device, lambent_scene scene,
                                                    lambent_material material);

/* Triangles of a mesh that share a material: indices from 3 × first_triangle on. */
typedef struct lambent_submesh {
  uint32_t first_triangle, triangle_count;
  lambent_material material;
} lambent_submesh;
/* Object space. All arrays are copied. */
typedef struct lambent_mesh_desc {
  size_t size;
  uint32_t vertex_count, triangle_count;
  const float* positions;  /* 3 a vertex */
  const float* normals;    /* 3 a vertex, of any length; NULL: the triangles' own, means where they share vertices */
  const float *uvs, *uvs1; /* 2 a vertex; NULL: all 0 */
  const float* colors;     /* linear RGBA, 4 a vertex; NULL: white */
  const uint32_t* indices; /* 3 a triangle; the front is seen counter-clockwise */
  const lambent_submesh* submeshes;
  uint32_t submesh_count;    /* 0: all triangles are of `material` */
  lambent_material material; /* 0: a grey one */
  const char* name;          /* in messages; may be NULL */
} lambent_mesh_desc;
LAMBENT_API lambent_status lambent_mesh_create(lambent_device* device, lambent_scene scene,
                                               const lambent_mesh_desc* desc, lambent_mesh* mesh);
/* Not while an instance shows it. */
LAMBENT_API lambent_status lambent_mesh_destroy(lambent_device* device, lambent_scene scene, lambent_mesh mesh);

LAMBENT_API lambent_status lambent_instance_create(lambent_device* device, lambent_scene scene, lambent_mesh mesh,
                                                   const float world_from_object[16], lambent_instance* instance);
LAMBENT_API lambent_status lambent_instance_move(lambent_device* device, lambent_scene scene,
                                                 lambent_instance instance, const float world_from_object[16]);
/* Gives the instance positions of its own, object space, 3 for each vertex of its mesh, and normals; NULL normals: made
 * from the triangles; NULL positions: the mesh's again. */
LAMBENT_API lambent_status lambent_instance_deform(lambent_device* device, lambent_scene scene,
                                                   lambent_instance instance, const float* positions,
                                                   const float* normals, uint32_t vertex_count);
LAMBENT_API lambent_status lambent_instance_destroy(lambent_device* device, lambent_scene scene,
                                                    lambent_instance instance);

typedef enum lambent_light_type {
  LAMBENT_LIGHT_POINT,
  LAMBENT_LIGHT_SPOT,
  LAMBENT_LIGHT_DIRECTIONAL
} lambent_light_type;
typedef struct lambent_light_desc {
  size_t size;
  int32_t type;          /* lambent_light_type */
  float position[3];
  float direction[3];    /* the way the light travels, of any length; default downwards */
  float intensity[3];    /* W/sr; of a directional light irradiance, W/m², on what faces it */
  float range;           /* metres, with glTF's smooth window; default infinite */
  float inner_cone_angle, outer_cone_angle; /* of a spot, from its axis; between them glTF's falloff */
  float angular_radius;  /* of a directional light's disk: soft shadows; 0: sharp ones */
} lambent_light_desc;
LAMBENT_API lambent_status lambent_light_create(lambent_device* device, lambent_scene scene,
                                                const lambent_light_desc* desc, lambent_light* light);
LAMBENT_API lambent_status lambent_light_set(lambent_device* device, lambent_scene scene, lambent_light light,
                                             const lambent_light_desc* desc);
LAMBENT_API lambent_status lambent_light_destroy(lambent_device* device, lambent_scene scene, lambent_light light);

typedef enum lambent_sky_type { LAMBENT_SKY_CONSTANT, LAMBENT_SKY_CLEAR, LAMBENT_SKY_PICTURE } lambent_sky_type;
typedef struct lambent_sky_desc {
  size_t size;
  int32_t type;          /* lambent_sky_type */
  float radiance[3];     /* of a constant sky; default black */
  float towards_sun[3];  /* of a clear one, +Y up; its sun is a directional light of yours: lambent_sky_sun */
  float turbidity;       /* 2 very clear … 10 nearly fog; default 3 */
  const float* texels;   /* of a picture: radiance, 3 floats each, 0 to 65504, the uppermost row first; columns are
                            longitudes: the middle is +X, a quarter right of it +Z. Copied by the call */
  int32_t width, height; /* of it, texels: 1 to 4096 */
  float scale;           /* factor on it; default 1 */
  float turn;            /* of it around +Y, radians, counter-clockwise seen from above */
} lambent_sky_desc;
LAMBENT_API lambent_status lambent_scene_set_sky(lambent_device* device, lambent_scene scene,
                                                 const lambent_sky_desc* desc);

/* The sun that goes with a clear sky: irradiance on what faces it, W/m², and the radius of its disk. Tell it as a
 * directional light that travels along -towards_sun. In these units a sun at noon is about 3 W/m²; scale both alike for
 * others. Either may be NULL. */
LAMBENT_API lambent_status lambent_sky_sun(const lambent_sky_desc* desc, float irradiance[3], float* angular_radius);
/* Radiance of a sky from `count` directions (3 floats each, world space), 3 floats each: what a host draws where nothing
 * is seen. */
LAMBENT_API lambent_status lambent_sky_radiance(const lambent_sky_desc* desc, const float* directions, size_t count,
                                                float* radiance);

/* View -------------------------------------------------------------------------------------------------------------- */

typedef struct lambent_view_desc {
  size_t size;
  int width, height; /* of the image, pixels */
} lambent_view_desc;
/* GL. */
LAMBENT_API lambent_status lambent_view_create(lambent_device* device, lambent_scene scene,
                                               const lambent_view_desc* desc, lambent_view* view);
/* GL. */
LAMBENT_API lambent_status lambent_view_destroy(lambent_device* device, lambent_view view);
LAMBENT_API lambent_status lambent_view_resize(lambent_device* device, lambent_view view, int width, int height);

/* Sets what accuracy may cost: "low", "medium", "high" (docs/measurements/presets.md), or "default". */
LAMBENT_API lambent_status lambent_view_preset(lambent_device* device, lambent_view view, const char* preset);
/* Any setting by its name, "smc.vpls" to "4096" (the program `lambent settings` lists them), or "technique". Takes
 * effect at the next frame. */
LAMBENT_API lambent_status lambent_view_set(lambent_device* device, lambent_view view, const char* setting,
                                            const char* value);
/* Copies the present value to `value`, of `size` bytes with its end. */
LAMBENT_API lambent_status lambent_view_get(lambent_device* device, lambent_view view, const char* setting, char* value,
                                            size_t size);

/* How a depth buffer tells how far something is. */
typedef enum lambent_depth {
  LAMBENT_DEPTH_FORWARD,  /* 0 at near, 1 at far; for a perspective of any far plane, infinite too */
  LAMBENT_DEPTH_REVERSED, /* 1 at near, 0 at far */
  LAMBENT_DEPTH_LINEAR    /* metres along the view direction, in red; what is 0 or less, or not finite, is nothing */
} lambent_depth;
typedef enum lambent_normals {
  LAMBENT_NORMALS_XYZ,         /* in -1..1, of any length: floats, snorm */
  LAMBENT_NORMALS_UNORM,       /* (n + 1) / 2 */
  LAMBENT_NORMALS_OCTAHEDRAL,  /* two channels in -1..1 */
  LAMBENT_NORMALS_OCTAHEDRAL_UNORM /* two channels in 0..1 */
} lambent_normals;
typedef enum lambent_space { LAMBENT_SPACE_WORLD, LAMBENT_SPACE_VIEW } lambent_space;

/* A frame: what is seen, as the host has drawn it, and where its light goes. All textures are GL_TEXTURE_2D that
 * samplers read as floats, without mipmaps. */
typedef struct lambent_frame {
  size_t size;
  double time; /* seconds; for what moves by itself: nothing today */

  float world_from_view[16]; /* rigid; the camera looks along -Z of view space */
  float fov_y;               /* radians, default 1; of a symmetric perspective without jitter */
  float ortho_half_height;   /* metres; above 0: parallel rays */
  float near_plane, far_plane; /* metres, of the host's projection; default 0.05 and infinite */

  uint32_t depth, normal; /* names; 0 both: the library draws the surfaces itself */
  uint32_t emission;      /* 0: none of what is seen glows */
  int32_t depth_type; /* lambent_depth; default forward */
  int depth_minus_one; /* 1: depth is stored as -1..1 (0..1 is what a depth buffer holds, whatever clip space was) */
  int32_t normal_type; /* lambent_normals; default x, y, z */
  int32_t normal_space; /* lambent_space; default world */
  int origin_top; /* 1: row 0 of all textures is the image's upper row, of those written too */
  int x, y;       /* corner of the view's rectangle in all textures of the host, in their own rows and columns */

  /* Where light goes, as RGB of any format that can be drawn to (one that holds more than 1), into the same rectangle as
   * that of the G-buffer; black where nothing is seen. 0: into textures of the library's, of the view's size. */
  uint32_t indirect_out, direct_out;
} lambent_frame;

typedef struct lambent_output {
  size_t size;
  uint32_t indirect, direct;         /* names of the textures whose RGB holds irradiance now, W/m² (alpha is the library's
                                        own), valid until the next lambent_render of this view; 0: no such light */
  uint32_t depth, normal, albedo, emission; /* surfaces that the library drew: reversed infinite depth, world normals;
                                        0 with a host's. Of blended surfaces each pixel has one, by chance */
  int converged;                     /* 1: nothing moves, and another frame would bring nothing new */
  double milliseconds;               /* that the call took */
} lambent_output;

/* GL. Computes a frame of a view: with `frame` as described, into `output` (may be NULL). Leaves all OpenGL state as it
 * found it (but for queries and the like, which engine/gl/state_guard.h names). The first frame of a view places its
 * lights, which takes up to seconds, and compares the host's surfaces with the scene: the log hears where they differ.
 * Other frames do not wait for the GPU. */
LAMBENT_API lambent_status lambent_render(lambent_device* device, lambent_view view, const lambent_frame* frame,
                                          lambent_output* output);

/* Irradiance at `count` points with normals (3 floats each, world space; a point stands a little off its surface), by
 * the lights of the view's last frame: 3 floats each into `indirect` and `direct`, W/m²; either may be NULL. On the CPU;
 * takes about 0.3 ms a point with 2048 lights on two cores. After a material changed, or meshes, materials or textures
 * were destroyed, the view is to be rendered first. */
LAMBENT_API lambent_status lambent_irradiance(lambent_device* device, lambent_view view, const float* points,
                                              const float* normals, size_t count, float* indirect, float* direct);
/* GL. The same as textures: RGBA32F, `width` texels a row, row by row; valid until the next call for this view. */
LAMBENT_API lambent_status lambent_irradiance_texture(lambent_device* device, lambent_view view, const float* points,
                                                      const float* normals, size_t count, int width,
                                                      uint32_t* indirect, uint32_t* direct);

/* Driver ------------------------------------------------------------------------------------------------------------ */

/* GL. Draws a small room with every technique in the current context, compares its light with that of rays on the CPU,
 * and calls `report` (may be NULL) with one line for each: what was tried and found, and whether it worked (ok 1 or 0).
 * Returns LAMBENT_OK where all work, LAMBENT_FAILED where one does not. Takes seconds, on llvmpipe ten. */
typedef void (*lambent_check_function)(void* user, int ok, const char* line);
LAMBENT_API lambent_status lambent_check(lambent_check_function report, void* user);

/* GL. For work on shaders, with a shader_folder: compiles again what changed there since it was read. The log hears of
 * each program. One that does not compile keeps its last good version, and the call fails, saying where. */
LAMBENT_API lambent_status lambent_reload_shaders(lambent_device* device);

#ifdef __cplusplus
}
#endif
#endif
