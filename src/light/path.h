// Paths of light through the scene, starting at a surface: the reference for every other estimate.
//
// `bounces` counts surfaces between the emitter and the shaded surface: 0 leaves no indirect light, 1 is the light of
// surfaces that are lit directly, OLX_BOUNCES_INFINITE is all light.
#ifndef OLX_LIGHT_PATH_H
#define OLX_LIGHT_PATH_H

#include "scene/direct_light.h"

typedef struct olx_path {
  const olx_scene *scene;
  uint32_t bounces;
  bool emitters_can_be_hit; // result of olx_emitters_can_be_hit(scene)
  olx_sampler sampler;      // sampler of this path; to be reset for another path
  uint64_t rays;            // rays cast
} olx_path;

typedef struct olx_path_light {
  olx_vec3 direct;   // straight from emitters
  olx_vec3 indirect; // by way of at least one surface
} olx_path_light;

// Returns the light that reaches the viewer through one lobe of a surface, along `lobe`, a ray drawn from it.
olx_path_light olx_path_lobe(olx_path *path, const olx_surface *surface, const olx_lobe_ray *lobe);

// Returns the indirect irradiance in W/m^2 (emitters and sky excluded) at `position` with geometric normal `normal`,
// from `paths` cosine-distributed paths that start `epsilon` off the surface. Depends on the arguments alone.
olx_vec3 olx_path_irradiance(const olx_scene *scene, olx_vec3 position, olx_vec3 normal, float epsilon,
                             uint32_t bounces, uint32_t paths, uint32_t seed);

// Returns the indirect irradiance in W/m^2 (emitters and sky excluded) of a surface about its shading normal, from
// `paths` cosine-distributed paths; paths below its geometric normal contribute 0. Adds the rays that it casts to
// *rays. Depends on the arguments alone.
olx_vec3 olx_path_surface_irradiance(const olx_scene *scene, const olx_surface *surface, uint32_t bounces,
                                     uint32_t paths, uint32_t seed, uint64_t *rays);

#endif
