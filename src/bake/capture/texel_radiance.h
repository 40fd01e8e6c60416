// Radiance of a texel as its probe sees it, from the light that the texel stores (McGuire et al. 2017, section 3).
//
// Rays meet texels from other directions than the probe's. Specular lobes wider than a mirror's (roughness 0.1)
// therefore count with their average over views; narrower ones are traced for the probe's view, because a mirror with a
// blurred picture in it would look wrong.
#ifndef OLX_BAKE_TEXEL_RADIANCE_H
#define OLX_BAKE_TEXEL_RADIANCE_H

#include "light/scene_light.h"
#include "scene/sampler.h"

// The widest lobe that is traced for the probe's view: a roughness of 0.1.
#define OLX_SHARP_ALPHA 0.01f

// Returns whether the surface's specular lobe is traced for the probe's view.
bool olx_texel_is_mirror(const olx_bsdf *bsdf);

// Returns what the surface reflects of `irradiance`, by both lobes where the surface is not a mirror. `cosine` is that
// of the angle between its normal and the view.
olx_vec3 olx_texel_reflected(const olx_bsdf *bsdf, float cosine, olx_vec3 irradiance);

// Where the light that mirrors reflect comes from.
typedef struct olx_lobe_source {
  const olx_scene *scene;
  const olx_scene_light *light; // NULL: paths through the scene
  uint32_t bounces;             // surfaces between emitter and mirror, at most
} olx_lobe_source;

// Returns what the specular lobe of a mirror reflects back along a ray of `direction`, by casting one ray.
olx_vec3 olx_texel_mirrored(const olx_lobe_source *source, const olx_surface *surface, olx_vec3 direction,
                            olx_sampler *sampler, uint64_t *rays);

#endif
