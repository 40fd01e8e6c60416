// A ray through the scene, and its hit on a triangle.
#ifndef OLX_SCENE_RAY_H
#define OLX_SCENE_RAY_H

#include "core/vec.h"

#define OLX_NO_HIT UINT32_MAX

typedef struct olx_ray {
  olx_vec3 origin, direction; // direction need not be unit; distances are in units of its length
  float t_min, t_max;
} olx_ray;

typedef struct olx_ray_hit {
  uint32_t triangle; // OLX_NO_HIT for a miss
  float t, u, v;     // barycentric weights of the second and third corner
} olx_ray_hit;

#endif
