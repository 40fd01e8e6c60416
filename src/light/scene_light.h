// The light of a scene, solved once in world space: irradiance on every surface that probes or their rays hit.
//
// Surfels (light_surfels.h) gather light over links (links.h). Between surfels it is interpolated by a weighted linear
// fit to those on the same surface that see the point; where these are few or differ much, the point casts rays of its
// own. The result depends on the scene, the probes and the settings alone, not on the number of threads.
#ifndef OLX_LIGHT_SCENE_LIGHT_H
#define OLX_LIGHT_SCENE_LIGHT_H

#include "light/links/kept_gathers.h"
#include "light/solution/light_settings.h"

olx_scene_light_settings olx_scene_light_settings_default(void);
// Returns the most memory that links take by default, in bytes; beyond it, rays leave no links.
uint64_t olx_scene_light_most_link_bytes(void);

// Solves the light of surfaces that are visible from the `count` positions with flags[i] == 0. Returns
// OLX_ERROR_INCOMPLETE where units of other partial bakes are missing.
olx_result olx_scene_light_create(const olx_scene *scene, const olx_scene_light_settings *settings,
                                  const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                  olx_scene_light **light);
// Makes a solution that nothing is known of yet. Positions and flags must stay valid while it is solved.
olx_result olx_scene_light_make(const olx_scene *scene, const olx_scene_light_settings *settings,
                                const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                olx_scene_light **light);
void olx_scene_light_free(olx_scene_light *light);

// Returns the most surfaces between emitter and lit surface, by the solution's settings.
uint32_t olx_scene_light_bounces(const olx_scene_light *light);

olx_scene_light_report olx_scene_light_describe(const olx_scene_light *light);

// Returns the indirect irradiance in W/m^2 on the side of the surface from which it was hit, about its vertex normal.
// Emitters and the sky seen directly are left out.
olx_vec3 olx_scene_light_irradiance(const olx_scene_light *light, const olx_surface *surface);

// Light that rays of a point's own found.
typedef struct olx_gathered_light {
  olx_vec3 irradiance; // indirect, W/m^2
  float error;         // the standard error expected of it, as a share of the light around; 0 where that is unknown
} olx_gathered_light;

// The two methods of olx_scene_light_irradiance. Interpolation returns false where surfels do not determine the light
// of the point; a gather casts 256 to 1,024 rays, the more the noisier light is there, which takes at least about fifty
// times as long. `row` keeps what they find; it may be NULL.
bool olx_scene_light_interpolate(const olx_scene_light *light, const olx_surface *surface, olx_vec3 *irradiance);
olx_gathered_light olx_scene_light_gather(const olx_scene_light *light, const olx_surface *surface,
                                          olx_gather_row *row);

// Returns the irradiance as by olx_scene_light_irradiance, with one bounce less. Together with the surface's direct
// light it is what a ray that ends at the surface brings to a place with as many bounces as the solution.
olx_vec3 olx_scene_light_irradiance_before(const olx_scene_light *light, const olx_surface *surface);

// Returns whether `irradiance` receives the mean irradiance in W/m^2 that the sky brings directly to the cell of a
// surface. It does not where no surfel serves the surface, or where the sky sends light from a few small places alone,
// which a mean over a cell would blur.
bool olx_scene_light_sky(const olx_scene_light *light, const olx_surface *surface, olx_vec3 *irradiance);

// Loads links and points into memory, where the solution was loaded without them. Returns OLX_ERROR_INCOMPLETE when
// some were damaged: the next run that solves the light recomputes them.
olx_result olx_scene_light_load_links(olx_scene_light *light);

// The parts of the solution, for relighting, which merges them (bake/relight/relight_bake.h). The solution owns them.
typedef struct olx_scene_light_parts {
  const olx_light_surfels *surfels;
  const olx_light_links *links;
  uint32_t visible;           // number of surfels on surfaces that probes see, which come first
  olx_surfel_direct direct;   // of all surfels
  const olx_vec3 *irradiance; // of all surfels, W/m^2
} olx_scene_light_parts;

olx_scene_light_parts olx_scene_light_open(const olx_scene_light *light);

#endif
