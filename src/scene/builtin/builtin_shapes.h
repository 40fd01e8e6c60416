// Simple meshes of the built-in scenes. Faces wind counter-clockwise seen from their visible side.
#ifndef OLX_SCENE_BUILTIN_SHAPES_H
#define OLX_SCENE_BUILTIN_SHAPES_H

#include "scene/scene_build.h"

// Adds a Lambertian material.
olx_result olx_add_matte(olx_scene *scene, const char *name, olx_vec3 base_color, uint32_t *material);
// Adds a material with a GGX lobe.
olx_result olx_add_glossy(olx_scene *scene, const char *name, olx_vec3 base_color, float metallic, float roughness,
                          uint32_t *material);

olx_result olx_add_view(olx_scene *scene, const char *name, olx_vec3 eye, olx_vec3 target, float fov_y_degrees);

void olx_set_probes(olx_scene *scene, olx_vec3 first, olx_vec3 last, uint32_t nx, uint32_t ny, uint32_t nz);

// Adds a square light with sides `side` long under a ceiling, facing down.
olx_result olx_add_ceiling_light(olx_scene *scene, olx_vec3 center, float side, olx_vec3 radiance);

olx_result olx_add_quad(olx_scene *scene, const char *name, const olx_vec3 corners[4], uint32_t material);

// In place of a material: the face is omitted.
#define OLX_NO_FACE UINT32_MAX
// Faces of a block that touch something and are left out, as bits.
enum { OLX_OPEN_X0 = 1, OLX_OPEN_X1 = 2, OLX_OPEN_Y0 = 4, OLX_OPEN_Y1 = 8, OLX_OPEN_Z0 = 16, OLX_OPEN_Z1 = 32 };
// Adds the six faces of a box, visible from outside or, as a room, from inside; a room's materials are in the order -x,
// +x, -y, +y, -z, +z. A block is a box without the faces in `open`.
olx_result olx_add_box(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, uint32_t material);
olx_result olx_add_block(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, uint32_t open,
                         uint32_t material);
olx_result olx_add_room(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, const uint32_t materials[6]);

// Adds a surface of revolution about the vertical through `base`: the profile holds (radius, height), rising along the
// side visible from outside. Corners sharper than 45 degrees stay sharp.
olx_result olx_add_lathe(olx_scene *scene, const char *name, olx_vec3 base, const olx_vec2 *profile, uint32_t points,
                         uint32_t segments, uint32_t material);

// Adds a round pillar with a flat top.
olx_result olx_add_cylinder(olx_scene *scene, const char *name, olx_vec3 base, float radius, float height,
                            uint32_t material);

// An upright prism. Its outline lies in the plane xz, turns from +x to +z, and is wholly visible from `center`.
typedef struct olx_prism {
  const olx_vec2 *outline;
  uint32_t points;
  olx_vec2 center;
  float low, high; // heights of its ends
  uint32_t low_material, high_material;
  const uint32_t *side_materials; // material of the side from point i to the next
} olx_prism;

// Adds a hall in the form of a prism, visible from inside.
olx_result olx_add_prism(olx_scene *scene, const char *name, const olx_prism *prism);

// A sheet without thickness that hangs down from the edge at `top` (along `across`), with waves that grow downwards.
typedef struct olx_cloth {
  olx_vec3 top, across, down;
  float waves, depth; // number of waves across, and their amplitude at the lower edge
} olx_cloth;

olx_result olx_add_cloth(olx_scene *scene, const char *name, const olx_cloth *cloth, uint32_t material);

// A solid with a constant section, visible from outside. The outline is simple, convex or not, in either orientation;
// its points are (x, y) of a solid along z, (z, y) of one along x. Faces that touch something can be omitted.
typedef enum olx_axis { OLX_ALONG_X, OLX_ALONG_Z } olx_axis;

typedef struct olx_extrusion {
  const olx_vec2 *outline;
  uint32_t points; // at most 64
  olx_axis axis;
  float low, high;
  bool low_open, high_open; // omits that end
  uint64_t open_sides;      // bit i: omits the side from point i to the next
} olx_extrusion;

olx_result olx_add_extrusion(olx_scene *scene, const char *name, const olx_extrusion *extrusion, uint32_t material);

// Outlines with an opening `width` wide, which has straight sides up to `spring` and an elliptic arch `rise` high
// above.
typedef struct olx_arch {
  float center, base, width, spring, rise; // base and spring are heights
} olx_arch;

enum {
  OLX_ARCH_STEPS = 16,
  OLX_ARCHED_WALL_POINTS = OLX_ARCH_STEPS + 7,
  OLX_ARCH_BAND_POINTS = 2 * OLX_ARCH_STEPS + 6
};
// Sides at the base of an arched wall, for open_sides.
#define OLX_WALL_BASE (1ull | 1ull << (OLX_ARCH_STEPS + 3))
#define OLX_WALL_ENDS (1ull << (OLX_ARCH_STEPS + 4) | 1ull << (OLX_ARCH_STEPS + 6))
#define OLX_WALL_TOP (1ull << (OLX_ARCH_STEPS + 5))

// Makes the outline of a wall from `left` to `right`, from the arch's base up to `top`, with the arch as its opening.
void olx_arched_wall(const olx_arch *arch, float left, float right, float top,
                     olx_vec2 outline[OLX_ARCHED_WALL_POINTS]);
// Makes the outline of a band of that breadth around the arch, on both sides down to its base.
void olx_arch_band(const olx_arch *arch, float breadth, olx_vec2 outline[OLX_ARCH_BAND_POINTS]);

// Rooms cut out of solid matter, seen from above: cell (column, row) lies between x[column], x[column + 1] and z[row],
// z[row + 1], and is open where the plan has a dot. Neighbouring faces share their corners, so that there are no gaps.
typedef struct olx_plan {
  const char *const *cells; // `rows` strings of `columns` characters
  uint32_t columns, rows;
  const float *x, *z;
  float floor, ceiling;
  uint32_t floor_material, ceiling_material, wall_material;
} olx_plan;

olx_result olx_add_plan(olx_scene *scene, const char *name, const olx_plan *plan);

#endif
