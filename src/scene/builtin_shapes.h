// Simple meshes from which the built-in scenes are made. Faces wind counter-clockwise seen from the side that shows.
#ifndef OLX_SCENE_BUILTIN_SHAPES_H
#define OLX_SCENE_BUILTIN_SHAPES_H

#include "scene/scene_build.h"

// A Lambertian material.
olx_result olx_add_matte(olx_scene *scene, const char *name, olx_vec3 base_color, uint32_t *material);
// A material with a GGX lobe.
olx_result olx_add_glossy(olx_scene *scene, const char *name, olx_vec3 base_color, float metallic, float roughness,
                          uint32_t *material);

olx_result olx_add_view(olx_scene *scene, const char *name, olx_vec3 eye, olx_vec3 target, float fov_y_degrees);

void olx_set_probes(olx_scene *scene, olx_vec3 first, olx_vec3 last, uint32_t nx, uint32_t ny, uint32_t nz);

// A square light `side` long under a ceiling, shining down.
olx_result olx_add_ceiling_light(olx_scene *scene, olx_vec3 center, float side, olx_vec3 radiance);

olx_result olx_add_quad(olx_scene *scene, const char *name, const olx_vec3 corners[4], uint32_t material);

// The six faces of a box, seen from outside or, as a room, from inside. Materials in the order -x, +x, -y, +y, -z, +z.
olx_result olx_add_box(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, uint32_t material);
olx_result olx_add_room(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, const uint32_t materials[6]);

// A surface of revolution about the vertical through `base`: the profile holds (radius, height), rising along the side
// seen from outside. Corners sharper than a half right angle stay sharp.
olx_result olx_add_lathe(olx_scene *scene, const char *name, olx_vec3 base, const olx_vec2 *profile, uint32_t points,
                         uint32_t segments, uint32_t material);

// A round pillar with a flat top.
olx_result olx_add_cylinder(olx_scene *scene, const char *name, olx_vec3 base, float radius, float height,
                            uint32_t material);

// A hall on an outline all of which is seen from `center`, shown from inside. In the plane xz the outline turns from +x
// to +z and the prism reaches from `low` to `high` along y; in the plane xy it turns from +y to +x, along z.
typedef enum olx_plane { OLX_PLANE_XZ, OLX_PLANE_XY } olx_plane;

typedef struct olx_prism {
  const olx_vec2 *outline;
  uint32_t points;
  olx_vec2 center;
  olx_plane plane;
  float low, high;
  uint32_t low_material, high_material;
  const uint32_t *side_materials; // of the side from point i to the next
} olx_prism;

olx_result olx_add_prism(olx_scene *scene, const char *name, const olx_prism *prism);

// Rooms cut out of solid matter, seen from above: cell (column, row) lies between x[column], x[column + 1] and z[row],
// z[row + 1], and is open where the plan has a dot. Neighbouring faces share their corners, so nothing slips through.
typedef struct olx_plan {
  const char *const *cells; // `rows` strings of `columns` characters
  uint32_t columns, rows;
  const float *x, *z;
  float floor, ceiling;
  uint32_t floor_material, ceiling_material, wall_material;
} olx_plan;

olx_result olx_add_plan(olx_scene *scene, const char *name, const olx_plan *plan);

#endif
