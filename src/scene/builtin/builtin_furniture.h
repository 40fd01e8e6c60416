// Pieces of furniture of the built-in flat. Each is placed on the floor and turned about the vertical; in its own
// coordinates +y is up and its front faces +z.
#ifndef OLX_SCENE_BUILTIN_FURNITURE_H
#define OLX_SCENE_BUILTIN_FURNITURE_H

#include "scene/scene_build.h"

typedef struct olx_stand {
  olx_scene *scene;
  olx_vec3 at;
  float turn; // radians, from +z towards +x
} olx_stand;

// Adds a box with flat faces, or one whose edges are rounded to a radius of at most half of its least side.
olx_result olx_add_solid(const olx_stand *stand, const char *name, olx_vec3 low, olx_vec3 high, uint32_t material);
olx_result olx_add_cushion(const olx_stand *stand, const char *name, olx_vec3 low, olx_vec3 high, float radius,
                           uint32_t material);

// Adds a sofa `width` metres wide, with a seat for each cushion.
olx_result olx_add_sofa(const olx_stand *stand, float width, uint32_t places, uint32_t cloth, uint32_t wood);
// Adds a table on four legs.
olx_result olx_add_table(const olx_stand *stand, olx_vec3 size, uint32_t top, uint32_t legs);
// Adds a chair with a back.
olx_result olx_add_chair(const olx_stand *stand, uint32_t wood);
// Adds a bookcase whose shelves are filled with books of several materials; `seed` selects their sizes and order.
olx_result olx_add_bookcase(const olx_stand *stand, olx_vec3 size, uint32_t shelves, uint32_t wood,
                            const uint32_t *covers, uint32_t cover_count, uint32_t seed);
// Adds a frame of width and height `size` that hangs on the wall behind it, with a picture of three fields of colour.
olx_result olx_add_picture(const olx_stand *stand, olx_vec2 size, uint32_t frame, const uint32_t fields[3]);
// Adds a floor lamp, 1.6 m high, with a point light in its shade.
olx_result olx_add_floor_lamp(const olx_stand *stand, uint32_t metal, uint32_t shade, olx_vec3 intensity);
// Adds a plant with long bent leaves in a pot.
olx_result olx_add_plant(const olx_stand *stand, float height, uint32_t pot, uint32_t leaf);

#endif
