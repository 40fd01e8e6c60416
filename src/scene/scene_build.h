// Growing a scene while it is made, and finishing it.
#ifndef OLX_SCENE_SCENE_BUILD_H
#define OLX_SCENE_SCENE_BUILD_H

#include "scene/local_frame.h"

// A material with white-ish Lambertian defaults: base colour 0.8, specular weight 0, roughness 1, no textures.
olx_material olx_material_default(void);

// An array of `count` elements with the room that the functions below count on when they append to it.
void *olx_scene_array(uint32_t count, size_t element_bytes);

// Whether a triangle's corners are among the vertices and within the limit of positions, and it has an area.
bool olx_sane_triangle(const olx_scene *scene, const olx_vec3 *positions, uint32_t vertex_count,
                       const uint32_t corner[3]);

// Each appends and returns the new element's index through *index (may be NULL).
olx_result olx_scene_add_material(olx_scene *scene, const olx_material *material, uint32_t *index);
// Takes ownership of texture->texels.
olx_result olx_scene_add_texture(olx_scene *scene, const olx_texture *texture, uint32_t *index);
olx_result olx_scene_add_light(olx_scene *scene, const olx_light *light);
olx_result olx_scene_add_camera(olx_scene *scene, const olx_camera *camera);
// A rectangle light: an absorbing, one-sided emitter that shines along cross(edge_u, edge_v).
olx_result olx_scene_add_rect_light(olx_scene *scene, olx_vec3 center, olx_vec3 edge_u, olx_vec3 edge_v,
                                    olx_vec3 radiance);
// Vertices and triangles of one material. All of a vertex but its position may be NULL: normals are flat then, uvs 0,
// colours white, and tangents follow from uvs.
typedef struct olx_mesh {
  const olx_vec3 *positions, *normals;
  const olx_vec2 *uvs, *second_uvs;
  const olx_vec4 *colors, *tangents; // as olx_scene_content has them
  const uint32_t *indices;           // three a triangle
  uint32_t vertex_count, triangle_count, material;
} olx_mesh;

// Append a mesh. Degenerate triangles, positions that are NaN or absurdly far away, and indices out of range are
// skipped and counted in one warning that names `name`.
olx_result olx_scene_append_mesh(olx_scene *scene, const char *name, const olx_mesh *mesh);
// Append a mesh that has no more than normals and uvs, which may be NULL.
olx_result olx_scene_add_mesh(olx_scene *scene, const char *name, const olx_vec3 *positions, const olx_vec3 *normals,
                              const olx_vec2 *uvs, uint32_t vertex_count, const uint32_t *indices,
                              uint32_t triangle_count, uint32_t material);

// Log what was skipped or clamped, once the scene is as it stays.
void olx_scene_log_warnings(const olx_scene *scene);

// Bounds, hash and the count of lights; fails with OLX_ERROR_EMPTY for a scene without triangles.
olx_result olx_scene_summarize(olx_scene *scene);
// That, emitters and the ray caster.
olx_result olx_scene_finish(olx_scene *scene);
// Release what a scene holds but emitters and the ray caster, not the scene itself.
void olx_scene_release_arrays(olx_scene *scene);

// A new scene that `fill` makes of what is called `name`, finished. `settings` may be NULL.
olx_result olx_scene_load_by(olx_result (*fill)(const char *name, olx_scene *scene), const char *name,
                             const olx_scene_load_settings *settings, olx_scene **scene);

// Append the content of a cooked scene to an empty one.
olx_result olx_scene_read_cooked(const char *path, olx_scene *scene);

#endif
