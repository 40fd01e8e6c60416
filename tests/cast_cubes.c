// Fills cube maps by casting rays, from the definition in octalux/bake.h and nothing else.
#include "cast_cubes.h"

#include "scene/bvh.h"

olx_ray cast_cube_ray(olx_vec3 position, uint32_t side, size_t texel) {
  const uint32_t face = (uint32_t)(texel / ((size_t)side * side)), axis = face / 2;
  const float inner = (float)(side - 2), row = (float)(texel / side % side), column = (float)(texel % side);
  float d[3];
  d[axis] = face % 2 ? -1.0f : 1.0f;
  d[(axis + 1) % 3] = 2.0f * (column - 0.5f) / inner - 1.0f;
  d[(axis + 2) % 3] = 2.0f * (row - 0.5f) / inner - 1.0f;
  return (olx_ray){position, olx_v3(d[0], d[1], d[2]), 0.0f, INFINITY};
}

static const char *look(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles) {
  const olx_scene *scene = user;
  const size_t texels = (size_t)6 * side * side;
  for (size_t i = 0; i < count * texels; i++) {
    const olx_ray ray = cast_cube_ray(positions[i / texels], side, i % texels);
    triangles[i] = olx_bvh_intersect(scene->bvh, &ray).triangle;
  }
  return NULL;
}

olx_bake_raster cast_cube_raster(const olx_scene *scene) {
  return (olx_bake_raster){.name = "cast cubes", .look = look, .user = (void *)(uintptr_t)scene};
}
