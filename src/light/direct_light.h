// Light that reaches a surface straight from emitters, by next-event estimation with multiple importance sampling
// (Veach's power heuristic): lights are sampled here, lobes by the caller that follows the sampled ray (the path tracer
// goes on with it, olx_direct_light only looks whether it finds an emitter).
#ifndef OLX_LIGHT_DIRECT_LIGHT_H
#define OLX_LIGHT_DIRECT_LIGHT_H

#include "light/sampler.h"
#include "scene/emitters.h"

// A surface made ready for shading from one direction.
typedef struct olx_shading {
  const olx_surface *surface;
  olx_vec3 normal; // the shading normal, bent towards the eye where it faces away from it
  olx_vec3 tangent, bitangent;
  olx_vec3 view;    // to the eye, in the frame
  olx_vec3 diffuse; // reflectance of the diffuse lobe for this eye: outgoing radiance is this times irradiance / pi
  bool has_diffuse, has_specular;
  float specular_share; // probability with which a path that follows one lobe only takes the specular one
} olx_shading;

// direction: of the ray that found the surface, unit.
olx_shading olx_shading_make(const olx_surface *surface, olx_vec3 direction);

// Radiance through the two lobes of a surface.
typedef struct olx_lobes {
  olx_vec3 diffuse, specular;
} olx_lobes;

// Which other estimator the light samples share the work with.
typedef enum olx_mis {
  OLX_MIS_EACH_LOBE, // a ray drawn from each lobe
  OLX_MIS_ONE_LOBE,  // one ray, drawn from either lobe with specular_share
  OLX_MIS_DELTA_ONLY // none: lights without area alone are sampled
} olx_mis;

// Draw one light of every group and send it a shadow ray.
olx_lobes olx_direct_light_sampled(const olx_scene *scene, const olx_shading *shading, olx_mis mis,
                                   olx_sampler *sampler, uint64_t *rays);

// A ray drawn from the surface's lobes.
typedef struct olx_lobe_ray {
  olx_vec3 direction;
  olx_vec3 weight; // BRDF times cosine over pdf; 0: the ray need not be followed
  float pdf;       // over solid angle; 0 for a mirror, which no light sample can find
} olx_lobe_ray;

olx_lobe_ray olx_lobe_ray_diffuse(const olx_shading *shading, olx_vec2 random);
olx_lobe_ray olx_lobe_ray_specular(const olx_shading *shading, olx_vec2 random);
// Draws a ray from either lobe, chosen by `choice` in [0, 1); its weight is that of both lobes.
olx_lobe_ray olx_lobe_ray_either(const olx_shading *shading, float choice, olx_vec2 random);

// Whether rays drawn from lobes can find light at all: there are area lights or an environment.
bool olx_emitters_can_be_hit(const olx_scene *scene);

// Emission that a ray drawn from a lobe found at `found`, or in the sky, weighted against light sampling from
// `position`.
olx_vec3 olx_emission_found(const olx_scene *scene, const olx_surface *found, olx_vec3 position,
                            const olx_lobe_ray *ray);
olx_vec3 olx_sky_found(const olx_scene *scene, const olx_lobe_ray *ray);

// All of the direct light: light samples and one ray a lobe.
olx_lobes olx_direct_light(const olx_scene *scene, const olx_shading *shading, olx_sampler *sampler, uint64_t *rays);

// Irradiance in W/m^2 that comes straight from emitters and the sky, about surface->shading_normal, whatever the
// surface reflects and wherever the eye is: one light sample a group, and one ray.
olx_vec3 olx_direct_irradiance(const olx_scene *scene, const olx_surface *surface, olx_sampler *sampler,
                               uint64_t *rays);

#endif
