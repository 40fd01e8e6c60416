// Gathers the light of any surface by rays of its own.
#ifndef OLX_LIGHT_GATHERS_H
#define OLX_LIGHT_GATHERS_H

#include "light/links/kept_gathers.h"
#include "light/links/ray_ends.h"

// Returns the indirect irradiance in W/m^2 of a surface, about its shading normal, from OLX_GATHER_RAYS rays. They
// are drawn by a pool's density, or evenly when that is NULL. Rare bright hits would leave blotches, so no ray adds more
// than a share `most` of a luminance: of `around` in W/m^2, the light that is known nearby, or of what all other rays
// bring if that is more, because what is nearby may be in the dark. `row` keeps what the rays find; it may be NULL.
olx_vec3 olx_gather_at(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                       uint32_t seed, const olx_passed_light *light, float most, float around, olx_gather_row *row);

#endif
