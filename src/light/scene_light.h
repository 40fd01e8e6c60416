// The light of a scene, solved once, in world space: irradiance on every surface that probes or their rays meet.
//
// Surfels (light_surfels.h) gather it over links (links.h); between them it is interpolated by a weighted linear fit to
// those that lie on the same surface and see the point; where these are few or differ much, the point casts rays of its
// own. The result depends on the scene, the probes and the settings alone, not on the number of threads.
#ifndef OLX_LIGHT_SCENE_LIGHT_H
#define OLX_LIGHT_SCENE_LIGHT_H

#include "light/light_settings.h"

olx_scene_light_settings olx_scene_light_settings_default(void);
// The memory that links take at most: where it does not suffice, surfels get fewer rays.
uint64_t olx_scene_light_most_link_bytes(void);

// Solves the light of surfaces that are seen from the `count` positions with flags[i] == 0. OLX_ERROR_INCOMPLETE where
// units of other parts are missing.
olx_result olx_scene_light_create(const olx_scene *scene, const olx_scene_light_settings *settings,
                                  const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                  olx_scene_light **light);
void olx_scene_light_free(olx_scene_light *light);

// Surfaces between emitter and lit surface that the solution's settings name.
uint32_t olx_scene_light_bounces(const olx_scene_light *light);

olx_scene_light_report olx_scene_light_describe(const olx_scene_light *light);

// Indirect irradiance in W/m^2 on the side of the surface that it was looked at from, for its vertex normal. Emitters
// and the sky seen directly are left out.
olx_vec3 olx_scene_light_irradiance(const olx_scene_light *light, const olx_surface *surface);

// Two ways to find that irradiance. Interpolation fails where the light of the point does not follow from surfels; a
// gather casts 256 rays, which takes about fifty times as long.
bool olx_scene_light_interpolate(const olx_scene_light *light, const olx_surface *surface, olx_vec3 *irradiance);
olx_vec3 olx_scene_light_gather(const olx_scene_light *light, const olx_surface *surface);

// Irradiance as olx_scene_light_irradiance gives it, with one bounce less. Together with the surface's direct light it
// is what a ray that ends there brings to a place whose light has bounced as often as the solution's.
olx_vec3 olx_scene_light_irradiance_before(const olx_scene_light *light, const olx_surface *surface);

// Brings links and points into memory, where the solution was loaded without them. OLX_ERROR_INCOMPLETE when some were
// damaged: they are made again by whoever solves the light next.
olx_result olx_scene_light_load_links(olx_scene_light *light);

// What the solution consists of, for relighting, which merges it (bake/relight_bake.h). It belongs to the solution.
typedef struct olx_scene_light_parts {
  const olx_light_surfels *surfels;
  const olx_light_links *links;
  const olx_surfel_lookup *lookup;     // of visible surfels
  const olx_vec3 *direct, *irradiance; // of all surfels, W/m^2
} olx_scene_light_parts;

olx_scene_light_parts olx_scene_light_open(const olx_scene_light *light);

#endif
