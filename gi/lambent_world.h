/* Lambent's worlds: scenes of glTF 2.0 files (or made by calls), kept as entities with components, and told to a
 * lambent_scene. Optional: what has a scene of its own needs lambent.h alone. C99, C++11 and newer.
 *
 *   lambent_world_load           a .gltf or .glb, with its animation, skins, morph targets, lights and cameras
 *   lambent_world_animate        its animation at some time
 *   lambent_world_set_transform  and others: changes of the host's
 *   lambent_world_sync           tells a scene what there is, and later what has changed
 *
 * Conventions are those of lambent.h. Coordinates count from lambent_world_origin(), which is zero but for files that
 * lie far from their own; "local" matrices are in the parent's space. Errors are those of lambent.h; the last message
 * is lambent_world_message(). A world is used by one thread at a time; nothing here needs OpenGL. Loading, posing of
 * skins and the camera of a file without one use all cores. */
#ifndef LAMBENT_WORLD_H
#define LAMBENT_WORLD_H

#include "lambent.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lambent_world lambent_world;
typedef uint32_t lambent_entity; /* of a world; a number that ended is not given again soon */
#define LAMBENT_NO_ENTITY 0xffffffffu

/* Reads a file; `scene` picks one of several by name or number, NULL: the file's default. `file` NULL: a world without
 * anything. What the file names is read from its folder and below alone, unless allowed. Its sky is that of the
 * scene's extras (lambent_sky), else black. On failure *world is NULL and lambent_world_message(NULL) says why. */
LAMBENT_API lambent_status lambent_world_load(const char* file, const char* scene, lambent_world** world);
/* Not 0: files loaded from now on, by any thread, may name others anywhere. For files that you trust. */
LAMBENT_API void lambent_world_allow_outside(int allow);
/* Not 0: they may ask for more memory and time than their size explains. For files that you trust. */
LAMBENT_API void lambent_world_allow_large(int allow);
/* Not 0: their materials do not hide backs (back_hidden), as glTF has it where they are not double-sided. For hosts
 * that draw them without culling. */
LAMBENT_API void lambent_world_two_sided(int shown);
/* What it told stays in its scenes. NULL does nothing. */
LAMBENT_API void lambent_world_destroy(lambent_world* world);
/* What the last failed call said; as lambent_message(). */
LAMBENT_API const char* lambent_world_message(const lambent_world* world);
/* Line `index` of what is shown differently, or left out; NULL beyond the last. Valid until the next call. */
LAMBENT_API const char* lambent_world_warning(const lambent_world* world, size_t index);
LAMBENT_API lambent_status lambent_world_origin(lambent_world* world, double origin[3]);

/* Entities: nodes of the file, in its order, and those that are made. */

/* Fills up to *count and sets *count to how many there are. `entities` may be NULL where *count is 0. */
LAMBENT_API lambent_status lambent_world_entities(lambent_world* world, lambent_entity* entities, size_t* count);
LAMBENT_API lambent_status lambent_world_find(lambent_world* world, const char* name, lambent_entity* entity);
/* Valid until the entity is removed; NULL for no entity. */
LAMBENT_API const char* lambent_world_name(const lambent_world* world, lambent_entity entity);
/* An entity without anything, at `local` (NULL: where the parent is). */
LAMBENT_API lambent_status lambent_world_create(lambent_world* world, const char* name, lambent_entity parent,
                                                const float local[16], lambent_entity* entity);
/* With its descendants. */
LAMBENT_API lambent_status lambent_world_remove(lambent_world* world, lambent_entity entity);

/* Takes the place of what animation says of the entity, which is then left out. */
LAMBENT_API lambent_status lambent_world_set_transform(lambent_world* world, lambent_entity entity,
                                                       const float local[16]);
/* Either may be NULL. */
LAMBENT_API lambent_status lambent_world_get_transform(lambent_world* world, lambent_entity entity, float local[16],
                                                       float world_from_node[16]);
/* Poses all clips of the file, looped, at some time. Seconds. */
LAMBENT_API lambent_status lambent_world_animate(lambent_world* world, double seconds);

/* Gives the entity a light, or changes or takes (NULL) that it has. It stands at the entity and shines along its -Z:
 * `position` and `direction` are not read. */
LAMBENT_API lambent_status lambent_world_set_light(lambent_world* world, lambent_entity entity,
                                                   const lambent_light_desc* light);
/* LAMBENT_INVALID_ARGUMENT where it has none. */
LAMBENT_API lambent_status lambent_world_get_light(lambent_world* world, lambent_entity entity,
                                                   lambent_light_desc* light);
LAMBENT_API lambent_status lambent_world_set_sky(lambent_world* world, const lambent_sky_desc* sky);

/* Shows a mesh of the world at the entity, in place of what it shows. By number: those of the file in its order. */
LAMBENT_API lambent_status lambent_world_set_mesh(lambent_world* world, lambent_entity entity, uint32_t mesh);
/* LAMBENT_INVALID_ARGUMENT where the entity shows none. */
LAMBENT_API lambent_status lambent_world_get_mesh(lambent_world* world, lambent_entity entity, uint32_t* mesh);
/* The arrays of a mesh, for a host's own drawing: vertex_count to uvs1, valid as long as the world; its submeshes
 * and materials are 0. LAMBENT_INVALID_ARGUMENT beyond the last. */
LAMBENT_API lambent_status lambent_world_mesh_data(lambent_world* world, uint32_t mesh, lambent_mesh_desc* desc);

/* Camera `index` of the file, posed, into `frame`: world_from_view, fov_y or ortho_half_height, near_plane.
 * LAMBENT_INVALID_ARGUMENT beyond the last. Where there is none, index 0 is one that shows the scene, for which all its
 * triangles are looked at: ask once. */
LAMBENT_API lambent_status lambent_world_camera(lambent_world* world, size_t index, lambent_frame* frame);

/* Tells a scene of `device` all that there is, and from the second call on what has changed. What else is in the scene
 * stays; what the host destroyed of it is made again when it changes. What the scene does not take is left out, with a
 * warning. Roughness and metalness are not told. The world gets the failures of the calls that it makes of lambent.h,
 * LAMBENT_DEVICE_LOST too, and lives on. */
LAMBENT_API lambent_status lambent_world_sync(lambent_world* world, lambent_device* device, lambent_scene scene);
/* The instance, or 0, that the entity is in a scene that was told. */
LAMBENT_API lambent_instance lambent_world_instance(const lambent_world* world, lambent_entity entity,
                                                    lambent_device* device, lambent_scene scene);

#ifdef __cplusplus
}
#endif
#endif
