// Small scenes made in code. Any failure fails the running test.
#ifndef OLX_TESTS_MADE_SCENES_H
#define OLX_TESTS_MADE_SCENES_H

#include "scene/scene_data.h"

// Make an empty scene, to be filled, finished and freed with olx_scene_free.
olx_scene *made_scene(void);
uint32_t made_material(olx_scene *scene, const olx_material *material);
// Adds a texture from 8-bit RGBA texels, which are copied.
uint32_t made_texture(olx_scene *scene, uint32_t width, uint32_t height, const uint8_t *rgba, bool srgb);
// Adds a parallelogram of two triangles around `center` whose front faces along cross(edge_u, edge_v); u runs along
// edge_u.
void made_quad(olx_scene *scene, olx_vec3 center, olx_vec3 edge_u, olx_vec3 edge_v, uint32_t material);
// Adds the square [-1, 1]^2 at height y, seen from above, with u along x and v along z: triangles 2n and 2n + 1.
void made_square(olx_scene *scene, float y, uint32_t material);
// Adds a cube around `center` that is seen from inside.
void made_room(olx_scene *scene, olx_vec3 center, float side, uint32_t material);
// Add a box that is seen from inside, or from outside when `outward`.
void made_box(olx_scene *scene, olx_vec3 low, olx_vec3 high, bool outward, uint32_t material);
olx_scene *made_finish(olx_scene *scene);

// Returns two uniform random numbers for the counter `index`.
olx_vec2 made_random(uint32_t seed, uint32_t index);

#endif
