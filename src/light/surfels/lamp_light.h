// The light of surfaces near lamps (field/near_lamps.h) in a scene of triangles.
#ifndef OLX_LIGHT_LAMP_LIGHT_H
#define OLX_LIGHT_LAMP_LIGHT_H

#include "field/near_lamps.h"
#include "scene/direct_light.h"

// Rays whose light is averaged see lights without area in smooth surfaces as in lobes of this alpha (roughness 0.32). A
// smoother lobe shows a light to one ray in thousands, which then brings thousands of times the mean.
#define OLX_LEAST_LAMP_ALPHA 0.1f

// Light that arrives at a place from one direction.
typedef struct olx_lamp_beam {
  olx_vec3 direction;  // unit, towards its origin
  olx_vec3 irradiance; // of a surface that faces it, W/m^2
} olx_lamp_beam;

// Finds the points of lights in a scene. `needs` are the slots of olx_scene_inputs that they depend on. On failure
// nothing has to be freed.
olx_result olx_lamp_light_create(olx_near_lamps *lamps, const olx_scene *scene, const olx_light *lights,
                                 uint32_t count);

// Returns an estimate of the light that the points send to a surface, without the share that rays bring
// (olx_lamp_light_found): the irradiance times the diffuse reflectance over pi, and the light that the specular lobe
// reflects. Adds the shadow ray that it casts to *rays. 0 without points.
olx_lobes olx_lamp_light(const olx_near_lamps *lamps, const olx_scene *scene, const olx_shading *shading,
                         olx_sampler *sampler, uint64_t *rays);
// Returns an estimate of their irradiance about surface->shading_normal, W/m^2.
olx_vec3 olx_lamp_irradiance(const olx_near_lamps *lamps, const olx_scene *scene, const olx_surface *surface,
                             olx_sampler *sampler, uint64_t *rays);
// Draws one of the points and returns the light that it sends to a place in free space; the mean over samples is the
// light of all points, without the share that rays bring. Returns false for a sample without light.
bool olx_lamp_light_draw(const olx_near_lamps *lamps, const olx_scene *scene, olx_vec3 position, olx_sampler *sampler,
                         olx_lamp_beam *beam, uint64_t *rays);
// Returns the share that a ray brings, as the radiance which the surface that it hit reflects of the lamps near it.
// `direction` and `distance` are the ray's, and the direction is unit. Adds the shadow rays that it casts to *rays.
olx_vec3 olx_lamp_light_found(const olx_near_lamps *lamps, const olx_scene *scene, const olx_surface *surface,
                              olx_vec3 direction, float distance, uint64_t *rays);

#endif
