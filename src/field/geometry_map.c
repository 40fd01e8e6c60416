// Bounds the distances that geometry blocks hold, from bounds on their inverse depths: a point q of the octahedron at
// inverse depth w is |q| / w away.
#include "field/geometry_map.h"

// The relative error that rounding may add to a bound on distances.
static const float ROUNDING = 0x1p-20f;

// Bounds on the length |q| of the unnormalised octahedral directions over a block. A fold goes from corner to corner,
// so |q| is greatest at a corner; it is no less than its component along the direction of the block's middle, and that
// component is least at a corner.
typedef struct lengths {
  float least, greatest;
} lengths;

static lengths lengths_of(olx_block_place place) {
  const float inverse_n = 1.0f / (float)place.n;
  const olx_vec3 middle = olx_octahedral_decode(
      (olx_vec2){(float)(OLX_BLOCK_SIDE * place.x + 2) * inverse_n, (float)(OLX_BLOCK_SIDE * place.y + 2) * inverse_n});
  lengths l = {INFINITY, 0.0f};
  for (uint32_t corner = 0; corner < 4; corner++) {
    const uint32_t x = OLX_BLOCK_SIDE * (place.x + (corner & 1u)), y = OLX_BLOCK_SIDE * (place.y + (corner >> 1));
    const olx_vec3 q = olx_octahedral_point((olx_vec2){(float)x * inverse_n, (float)y * inverse_n});
    l.least = olx_min(l.least, olx_dot(q, middle));
    l.greatest = olx_max(l.greatest, olx_length(q));
  }
  return l;
}

// Rounds a magnitude down to a half float. What is finite stays finite.
static uint16_t half_below(float f) {
  const uint16_t code = olx_half_pack(olx_min(f, OLX_HALF_MOST));
  return (uint16_t)(code - (olx_half_unpack(code) > f));
}

static uint16_t half_above(float f) {
  const uint16_t code = olx_half_pack(f);
  return (uint16_t)(code + (olx_half_unpack(code) < f));
}

olx_distance_bounds olx_block_distances(const olx_geometry_block *block, const olx_plane_pool *pool,
                                        olx_block_place place, float scale) {
  const olx_block_bounds inverse = olx_geometry_bounds(block, pool, place);
  const lengths l = lengths_of(place);
  const float least = l.least * (1.0f - ROUNDING) / inverse.greatest / scale,
              greatest = l.greatest * (1.0f + ROUNDING) / inverse.least / scale;
  return (olx_distance_bounds){inverse.greatest > 0.0f ? half_below(least) : 0x7C00u, half_above(greatest)};
}

olx_pyramid_base olx_pyramid_over_blocks(const olx_geometry_map *map, uint32_t n, float scale, uint16_t *least,
                                         uint16_t *greatest) {
  const uint32_t side = n / OLX_BLOCK_SIDE;
  for (uint32_t i = 0; i < side * side; i++) {
    const olx_block_place place = {n, i % side, i / side};
    const olx_distance_bounds bounds = olx_block_distances(&map->blocks[i], &map->pool, place, scale);
    least[i] = bounds.least;
    greatest[i] = bounds.greatest;
  }
  return (olx_pyramid_base){least, greatest, side, 2};
}
