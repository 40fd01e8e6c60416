// Radiance of a texel as its probe sees it, from the light that the texel stores (McGuire et al. 2017, section 3).
//
// Texels are looked at from other directions than the probe's. Specular lobes wider than a mirror's (roughness 0.1)
// therefore count as what they reflect on average over views; narrower ones are traced for the probe's view, because a
// mirror that is only seen blurred would look wrong.
#ifndef OLX_BAKE_TEXEL_RADIANCE_H
#define OLX_BAKE_TEXEL_RADIANCE_H

#include "light/scene_light.h"
#include "light/sampler.h"

// Returns whether the surface's specular lobe is traced for the probe's view.
bool olx_texel_is_mirror(const olx_bsdf *bsdf);

// What the surface reflects of `irradiance`, both lobes of surfaces that are not mirrors. `cosine`: of its normal and
// the view.
olx_vec3 olx_texel_reflected(const olx_bsdf *bsdf, float cosine, olx_vec3 irradiance);

// Where the light that mirrors reflect comes from.
typedef struct olx_lobe_source {
  const olx_scene *scene;
  const olx_scene_light *light; // NULL: paths through the scene
  uint32_t bounces;             // surfaces between emitter and mirror, at most
} olx_lobe_source;

// What the specular lobe of a mirror reflects along a ray that found it in `direction`, by one ray.
olx_vec3 olx_texel_mirrored(const olx_lobe_source *source, const olx_surface *surface, olx_vec3 direction,
                            olx_sampler *sampler, uint64_t *rays);

#endif
