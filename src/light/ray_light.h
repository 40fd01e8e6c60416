// Indirect light along a ray, from the solved light of the scene.
#ifndef OLX_LIGHT_RAY_LIGHT_H
#define OLX_LIGHT_RAY_LIGHT_H

#include "light/scene_light.h"

// Returns the radiance in W/(sr m^2) that surfaces reflect along `ray`, which hit `hit`: direct and solved light from
// diffuse lobes, after specular reflections on the way. There are at most `bounces` surfaces between emitter and the
// ray's origin, which is at most as many as the solution has; where that is fewer, the share of the last bounces is
// subtracted. Emitters and the sky seen by the ray itself are left out. `ray->direction` is unit. Adds the further rays
// that it casts to *rays.
olx_vec3 olx_ray_light(const olx_scene *scene, const olx_scene_light *light, uint32_t bounces, const olx_ray *ray,
                       const olx_ray_hit *hit, olx_sampler *sampler, uint64_t *rays);

// Returns the same light but for what surfaces near lamps (field/near_lamps.h) reflect of these lamps and send to the
// ray's origin, which would be rare and very bright: olx_scene_light_beam samples it, but for a share from surfaces
// close to the origin, which the ray brings. Smooth surfaces show lamps as wider lobes do, so this is for rays whose
// light is averaged.
olx_vec3 olx_ray_light_but_near_lamps(const olx_scene *scene, const olx_scene_light *light, uint32_t bounces,
                                      const olx_ray *ray, const olx_ray_hit *hit, olx_sampler *sampler, uint64_t *rays);

// Draws what surfaces near lamps send to a place in free space: the mean over samples is all of it that
// olx_ray_light_but_near_lamps leaves out. Returns false for a sample without light. Adds the shadow ray that it casts
// to *rays.
bool olx_scene_light_beam(const olx_scene *scene, const olx_scene_light *light, olx_vec3 position, olx_sampler *sampler,
                          olx_lamp_beam *beam, uint64_t *rays);

#endif
