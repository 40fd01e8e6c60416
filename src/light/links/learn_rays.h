// Trains a ray guide on the rays that surfels have cast without one.
#ifndef OLX_LIGHT_LEARN_RAYS_H
#define OLX_LIGHT_LEARN_RAYS_H

#include "light/links/light_bounces.h"
#include "light/links/ray_guide.h"

// Has each pool learn from the links of its surfels, for surfaces that carry `direct` + `irradiance`.
olx_result olx_rays_learn(olx_ray_guide *guide, const olx_light_surfels *surfels, const olx_light_links *links,
                          const olx_surfel_direct *direct, const olx_vec3 *irradiance);

#endif
