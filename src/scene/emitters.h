// Samples points on lights: emissive triangles, lights without area, the environment.
#ifndef OLX_SCENE_EMITTERS_H
#define OLX_SCENE_EMITTERS_H

#include "scene/surface.h"

// Emitters are divided into groups, over which light is summed. Each light without area is a group, the emissive
// triangles are one, the environment is one. More than OLX_MAX_LIGHT_GROUPS point and spot lights share one group, and
// so do more than OLX_MAX_LIGHT_GROUPS suns. Within a group one emitter is drawn: lamps about by the light that
// each sends to the shaded point (scene/many_lamps.h), suns by their irradiance, triangles by power or, when at most 32
// emit, by the approximate light that each sends to the point. Triangles of such a group with a large solid angle are
// sampled evenly over that angle, others evenly over their area.
#define OLX_MAX_LIGHT_GROUPS 16

typedef struct olx_light_sample {
  olx_vec3 direction; // unit, from the surface to the light
  olx_vec3 target;    // the point on the light; for the sun and the environment far outside the scene
  float epsilon_end;  // distance from the target at which the shadow ray must stop
  bool infinite;      // target is only a direction: the shadow ray has no end
  bool delta;         // cannot be hit by random rays: no multiple importance sampling
  uint32_t light;     // number of a light without area in the scene; of delta samples
  olx_vec3 emission;  // radiance (delta: irradiance at normal incidence, W/m^2) divided by pdf; without visibility
  float pdf;          // over solid angle at the surface; 1 for delta
} olx_light_sample;

olx_result olx_emitters_create(const olx_scene *scene, olx_emitters **emitters);
void olx_emitters_free(olx_emitters *emitters);

uint32_t olx_emitters_group_count(const olx_scene *scene);
// Returns whether samples of a group vary (area lights, environment, lights that share a group) or are always the same
// (a single light without area).
bool olx_emitters_group_varies(const olx_scene *scene, uint32_t group);
// Returns whether a group is a single sun.
bool olx_emitters_group_is_a_sun(const olx_scene *scene, uint32_t group);

// Samples a light of a group for a surface point. Returns false when it cannot contribute (behind the surface, or
// dark).
bool olx_emitters_sample(const olx_scene *scene, uint32_t group, olx_vec3 position, olx_vec2 random, float random_pick,
                         olx_light_sample *sample);

// Returns the density over solid angle with which olx_emitters_sample samples the point of the emitting `surface` that
// is seen from `position` along `direction`.
float olx_emitters_surface_pdf(const olx_scene *scene, const olx_surface *surface, olx_vec3 position,
                               olx_vec3 direction);

// Returns the density over area of points on a triangle drawn by power: its share of the power over its area.
float olx_emitters_area_pdf(const olx_scene *scene, uint32_t triangle);

// Returns whether a group is the environment.
bool olx_emitters_group_is_sky(const olx_scene *scene, uint32_t group);

// Returns the `random` from which olx_emitters_sample draws a direction of the sky.
olx_vec2 olx_environment_random(const olx_scene *scene, olx_vec3 direction);

bool olx_environment_lit(const olx_scene *scene);
// Returns whether the environment is lit, and so evenly that rays find its light well without sampling it.
bool olx_environment_is_even(const olx_scene *scene);
// Returns the luminance of the environment's radiance, as a mean over all directions.
float olx_environment_mean(const olx_scene *scene);
olx_vec3 olx_environment_radiance(const olx_scene *scene, olx_vec3 direction);
float olx_environment_pdf(const olx_scene *scene, olx_vec3 direction);

#endif
