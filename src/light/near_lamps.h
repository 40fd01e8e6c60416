// Lamps without area that hang close to surfaces, such as in their own fixtures.
//
// A lamp lights a surface by the inverse square of their distance, so that a ray which happens to end within a few
// centimetres of it brings many thousands of times the mean, and no number of rays makes the mean certain. The light
// that surfaces near a lamp reflect is therefore sampled from the lamp: rays of equal light leave it, and each that ends
// nearby leaves a point that reflects this light as a matte surface does. Rays from elsewhere that end near the lamp do
// not see its direct light, because these points already stand for it (Keller, Instant Radiosity, SIGGRAPH 1997, for
// surfaces near lamps only).
#ifndef OLX_LIGHT_NEAR_LAMPS_H
#define OLX_LIGHT_NEAR_LAMPS_H

#include "scene/direct_light.h"

// A point near a lamp, which reflects some of its light.
typedef struct olx_lamp_point {
  olx_vec3 position, normal; // position: off the surface
  olx_vec3 intensity;        // reflected along the normal, W/sr; elsewhere times the cosine
  float soft_squared;        // square of the least distance at which its light is computed, m^2
} olx_lamp_point;

typedef struct olx_near_lamps {
  float *radius; // of each light of the scene, metres: the surfaces within it have points; NULL: no light has any
  olx_lamp_point *points;
  float *sums; // distribution of the points' light
  uint32_t count;
  uint64_t needs; // slots of olx_scene_inputs that the points depend on
  uint64_t rays;  // rays cast to find the points
} olx_near_lamps;

// Rays whose light is averaged see lights without area in smooth surfaces as in lobes of this alpha (roughness 0.32). A
// smoother lobe shows a light to one ray in thousands, which then brings thousands of times the mean.
#define OLX_LEAST_LAMP_ALPHA 0.1f

// Light that arrives at a place from one direction.
typedef struct olx_lamp_beam {
  olx_vec3 direction;  // unit, towards its origin
  olx_vec3 irradiance; // of a surface that faces it, W/m^2
} olx_lamp_beam;

// Finds the points of all point and spot lights. On failure nothing has to be freed.
olx_result olx_near_lamps_create(olx_near_lamps *lamps, const olx_scene *scene);
void olx_near_lamps_free(olx_near_lamps *lamps);

// Returns an estimate of the light that the points send to a surface: the irradiance times the diffuse reflectance over
// pi, and the light that the specular lobe reflects. Adds the shadow ray that it casts to *rays. 0 without points.
olx_lobes olx_near_lamps_light(const olx_near_lamps *lamps, const olx_scene *scene, const olx_shading *shading,
                               olx_sampler *sampler, uint64_t *rays);
// Returns an estimate of their irradiance about surface->shading_normal, W/m^2.
olx_vec3 olx_near_lamps_irradiance(const olx_near_lamps *lamps, const olx_scene *scene, const olx_surface *surface,
                                   olx_sampler *sampler, uint64_t *rays);
// Draws one of the points and returns the light that it sends to a place in free space; the mean over samples is the
// light of all points. Returns false for a sample without light.
bool olx_near_lamps_draw(const olx_near_lamps *lamps, const olx_scene *scene, olx_vec3 position, olx_sampler *sampler,
                         olx_lamp_beam *beam, uint64_t *rays);

#endif
