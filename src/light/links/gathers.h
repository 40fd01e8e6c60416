// Gathers the light of any surface by rays of its own.
#ifndef OLX_LIGHT_GATHERS_H
#define OLX_LIGHT_GATHERS_H

#include "light/links/kept_gathers.h"
#include "light/links/ray_ends.h"

// Returns the indirect irradiance in W/m^2 of a surface, about its shading normal, from OLX_GATHER_RAYS rays. They
// are drawn by a pool's density, or evenly when that is NULL. No ray adds more than a luminance of `most` W/m^2: rare
// bright hits would leave blotches. `row` keeps what the rays find; it may be NULL.
olx_vec3 olx_gather_at(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                       uint32_t seed, const olx_passed_light *light, float most, olx_gather_row *row);

#endif
