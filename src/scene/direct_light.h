// Direct light of a surface, by next-event estimation with multiple importance sampling (Veach's power heuristic).
// Lights are sampled here; rays from lobes are followed by the caller (the path tracer continues along the ray,
// olx_direct_light only tests whether it hits an emitter).
#ifndef OLX_SCENE_DIRECT_LIGHT_H
#define OLX_SCENE_DIRECT_LIGHT_H

#include "scene/emitters.h"
#include "scene/sampler.h"
#include "scene/sky_guide.h"

// Which emitters count.
typedef enum olx_direct_kinds { OLX_DIRECT_ALL, OLX_DIRECT_BUT_SKY, OLX_DIRECT_SKY } olx_direct_kinds;

// A surface prepared for shading from one direction.
typedef struct olx_shading {
  const olx_surface *surface;
  olx_vec3 normal; // the shading normal, bent towards the viewer where it faces away
  olx_vec3 tangent, bitangent;
  olx_vec3 view;    // towards the viewer, in the frame
  olx_vec3 diffuse; // reflectance of the diffuse lobe for this view: outgoing radiance is this times irradiance / pi
  bool has_diffuse, has_specular;
  float specular_share;   // probability that a path which follows one lobe takes the specular one
  const float *dark;      // metres: a light of the scene does not light the surface within its radius; NULL: all do
  olx_sky_guide *sky;     // guides samples of the sky and learns from them; NULL: none does
  float least_alpha;      // the specular lobe reflects delta samples with at least this alpha, unless it is a mirror
  olx_direct_kinds kinds; // emitters whose direct light counts
} olx_shading;

// Prepares a surface for shading. `direction` is the unit direction of the ray that found the surface.
olx_shading olx_shading_make(const olx_surface *surface, olx_vec3 direction);
// Returns the reflectance of both lobes in uniform light.
olx_vec3 olx_shading_albedo(const olx_shading *shading);
// Returns a direction in the frame of the surface, whose normal is +z.
olx_vec3 olx_shading_local(const olx_shading *shading, olx_vec3 world);

// Radiance through the two lobes of a surface.
typedef struct olx_lobes {
  olx_vec3 diffuse, specular;
} olx_lobes;

// The sampling technique with which light samples are combined.
typedef enum olx_mis {
  OLX_MIS_EACH_LOBE, // one ray drawn from each lobe
  OLX_MIS_ONE_LOBE,  // one ray, drawn from the specular lobe with probability specular_share
  OLX_MIS_DELTA_ONLY // none: only lights without area are sampled
} olx_mis;

// Draws one light of every group and casts a shadow ray to it.
olx_lobes olx_direct_light_sampled(const olx_scene *scene, const olx_shading *shading, olx_mis mis,
                                   olx_sampler *sampler, uint64_t *rays);

// Returns the light of one delta sample, with a shadow ray.
olx_lobes olx_direct_light_of(const olx_scene *scene, const olx_shading *shading, const olx_light_sample *sample,
                              uint64_t *rays);

// A ray drawn from the surface's lobes.
typedef struct olx_lobe_ray {
  olx_vec3 direction;
  olx_vec3 weight;    // BRDF times cosine over pdf; 0: the ray contributes nothing
  float pdf;          // over solid angle; 0 for a mirror, which light samples cannot find
  olx_sky_guide *sky; // of the surface; NULL: none
} olx_lobe_ray;

olx_lobe_ray olx_lobe_ray_diffuse(const olx_shading *shading, olx_vec2 random);
olx_lobe_ray olx_lobe_ray_specular(const olx_shading *shading, olx_vec2 random);
// Draws a ray from one lobe, which `choice` in [0, 1) selects; its weight is for the sum of both lobes.
olx_lobe_ray olx_lobe_ray_either(const olx_shading *shading, float choice, olx_vec2 random);

// Returns whether rays drawn from lobes can hit light at all: whether there are area lights or an environment.
bool olx_emitters_can_be_hit(const olx_scene *scene);

// Returns the emission that a ray drawn from a lobe found at `found`, or in the sky, weighted by multiple importance
// sampling against light samples from `position`.
olx_vec3 olx_emission_found(const olx_scene *scene, const olx_surface *found, olx_vec3 position,
                            const olx_lobe_ray *ray);
olx_vec3 olx_sky_found(const olx_scene *scene, const olx_lobe_ray *ray);

// Estimates the direct light of the emitters that count: by light samples and by one ray per lobe.
olx_lobes olx_direct_light(const olx_scene *scene, const olx_shading *shading, olx_sampler *sampler, uint64_t *rays);

// Which direct light a caller wants.
typedef struct olx_direct_query {
  olx_direct_kinds kinds;
  const float *dark;  // as in olx_shading
  olx_sky_guide *sky; // as in olx_shading
} olx_direct_query;

// Returns the direct irradiance in W/m^2 about surface->shading_normal, independent of the material and the view: one
// light sample per group, and one ray.
olx_vec3 olx_direct_irradiance_of(const olx_scene *scene, const olx_surface *surface, const olx_direct_query *query,
                                  olx_sampler *sampler, uint64_t *rays);
// Returns the direct irradiance in W/m^2 that suns bring, which is the same in every call. It is 0 where a scene has so
// many suns that they share their samples (OLX_MAX_LIGHT_GROUPS).
olx_vec3 olx_direct_irradiance_of_suns(const olx_scene *scene, const olx_surface *surface, uint64_t *rays);
// Returns the direct irradiance of all emitters. `sky` may be NULL.
olx_vec3 olx_direct_irradiance(const olx_scene *scene, const olx_surface *surface, olx_sky_guide *sky,
                               olx_sampler *sampler, uint64_t *rays);

#endif
