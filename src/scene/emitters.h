// Drawing points on lights: emissive triangles, lights without area, the environment.
#ifndef OLX_SCENE_EMITTERS_H
#define OLX_SCENE_EMITTERS_H

#include "scene/surface.h"

// A way in which light can reach a surface. Groups are summed over; within a group one emitter is drawn by its power,
// or, when at most 32 triangles emit, by about what each sends to the place that it is drawn for. Of those, triangles
// that are seen under a large solid angle are drawn from evenly over that angle, others evenly over their area. Each
// light without area is a group, the emissive triangles are one, the environment is one. When there are more than
// OLX_MAX_LIGHT_GROUPS lights without area, they share one group from which one is drawn by power.
#define OLX_MAX_LIGHT_GROUPS 16

typedef struct olx_light_sample {
  olx_vec3 direction; // unit, from the surface to the light
  olx_vec3 target;    // the point on the light; for sun and environment far outside the scene
  float epsilon_end;  // how far short of target the shadow ray must stop
  bool infinite;      // target is a direction only: the shadow ray has no end
  bool delta;         // cannot be hit by chance: no MIS
  olx_vec3 emission;  // radiance (delta: what arrives, W/m^2 on a facing surface) divided by pdf; visibility not included
  float pdf;          // over solid angle at the surface; 1 for delta
} olx_light_sample;

olx_result olx_emitters_create(const olx_scene *scene, olx_emitters **emitters);
void olx_emitters_free(olx_emitters *emitters);

uint32_t olx_emitters_group_count(const olx_scene *scene);
// Whether samples of that group vary (area lights, environment) or are always the same (a single light without area).
bool olx_emitters_group_varies(const olx_scene *scene, uint32_t group);

// Draw a light from a group for a surface point. False when it cannot contribute (behind, dark).
bool olx_emitters_sample(const olx_scene *scene, uint32_t group, olx_vec3 position, olx_vec2 random,
                         float random_pick, olx_light_sample *sample);

// Density over solid angle at `position` with which olx_emitters_sample would have drawn the emitting `surface` seen
// from there along `direction`.
float olx_emitters_surface_pdf(const olx_scene *scene, const olx_surface *surface, olx_vec3 position,
                               olx_vec3 direction);

// Density over area with which points on a triangle are drawn by power: its share of the power over its area.
float olx_emitters_area_pdf(const olx_scene *scene, uint32_t triangle);

bool olx_environment_lit(const olx_scene *scene);
olx_vec3 olx_environment_radiance(const olx_scene *scene, olx_vec3 direction);
float olx_environment_pdf(const olx_scene *scene, olx_vec3 direction);

#endif
