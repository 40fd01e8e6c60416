// Builds and finishes a scene.
#ifndef OLX_SCENE_SCENE_BUILD_H
#define OLX_SCENE_SCENE_BUILD_H

#include "scene/local_frame.h"

// Returns a material with Lambertian defaults: base colour 0.8, specular weight 0, roughness 1, no textures.
olx_material olx_material_default(void);

// Allocates an array of `count` elements with the capacity that the functions below expect when they append to it.
void *olx_scene_array(uint32_t count, size_t element_bytes);

// Returns whether a triangle's corners exist and lie within the limit of positions, and whether it has an area.
bool olx_sane_triangle(const olx_scene *scene, const olx_vec3 *positions, uint32_t vertex_count,
                       const uint32_t corner[3]);

// These functions append an element and return its index in *index (may be NULL).
olx_result olx_scene_add_material(olx_scene *scene, const olx_material *material, uint32_t *index);
// Appends a texture, and takes ownership of texture->texels.
olx_result olx_scene_add_texture(olx_scene *scene, const olx_texture *texture, uint32_t *index);
// Appends a light without area.
olx_result olx_scene_add_light(olx_scene *scene, const olx_light *light);
olx_result olx_scene_add_camera(olx_scene *scene, const olx_camera *camera);
// Adds a rectangle light: an absorbing, one-sided emitter that shines along cross(edge_u, edge_v).
olx_result olx_scene_add_rect_light(olx_scene *scene, olx_vec3 center, olx_vec3 edge_u, olx_vec3 edge_v,
                                    olx_vec3 radiance);
// Vertices and triangles of one material. Every attribute of a vertex except its position may be NULL: then normals are
// flat, uvs 0, colours white, and tangents are derived from uvs.
typedef struct olx_mesh {
  const olx_vec3 *positions, *normals;
  const olx_vec2 *uvs, *second_uvs;
  const olx_vec4 *colors, *tangents; // as in olx_scene_content
  const uint32_t *indices;           // three per triangle
  uint32_t vertex_count, triangle_count, material;
} olx_mesh;

// Appends a mesh. Degenerate triangles, positions that are NaN or beyond the limit, and indices out of range are
// skipped and counted in one warning that names `name`, or, after a few such meshes, in olx_scene_warn_about_rest.
olx_result olx_scene_append_mesh(olx_scene *scene, const char *name, const olx_mesh *mesh);
// Appends a mesh with at most normals and uvs, which may be NULL.
olx_result olx_scene_add_mesh(olx_scene *scene, const char *name, const olx_vec3 *positions, const olx_vec3 *normals,
                              const olx_vec2 *uvs, uint32_t vertex_count, const uint32_t *indices,
                              uint32_t triangle_count, uint32_t material);

// Ends a model: warns about the skipped triangles of all meshes that no warning has named.
void olx_scene_warn_about_rest(olx_scene *scene, const char *path);

// Logs what was skipped or clamped, once the scene is complete.
void olx_scene_log_warnings(const olx_scene *scene);

// Computes bounds, hash and the number of lights, and forgets texture coordinates that no mesh has; fails with
// OLX_ERROR_EMPTY for a scene without triangles.
olx_result olx_scene_summarize(olx_scene *scene);
// Summarizes the scene and builds its emitters and ray caster.
olx_result olx_scene_finish(olx_scene *scene);
// Releases the arrays of a scene, but not its emitters, its ray caster or the scene itself.
void olx_scene_release_arrays(olx_scene *scene);

// Creates a scene, has `fill` build it from `name`, and finishes it. `settings` may be NULL.
olx_result olx_scene_load_by(olx_result (*fill)(const char *name, olx_scene *scene), const char *name,
                             const olx_scene_load_settings *settings, olx_scene **scene);

// Appends the content of a cooked scene to an empty scene.
olx_result olx_scene_read_cooked(const char *path, olx_scene *scene);

#endif
