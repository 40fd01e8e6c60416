// The planes that 4 x 4 texels of a light field map see, in 16 bytes (docs/maths.md, "Blocks").
//
// A plane that does not pass through the probe is the set of points p, relative to the probe, with m . p = 1; m points
// away from the probe and is 1 / h long, where h is the plane's distance. m = 0 is the sky. Points in front of a plane
// have m . p < 1, so no division is needed to decide on which side a point lies, and C and GLSL decide alike to the
// last bit. At the point q of the octahedron |x| + |y| + |z| = 1 the plane has the inverse depth 1 / |p|_1 = m . q,
// which is affine in the coordinates of the map on each face.
//
// A block holds one plane in floats, or two coded ones with a bit for each texel, or the numbers of coded planes in a
// pool. Any 16 bytes decode without harm; the baker never writes blocks that olx_geometry_check refuses.
// Its twin is shaders/lib/geometry_block.glsl.
#ifndef OLX_BLOCK_GEOMETRY_BLOCK_H
#define OLX_BLOCK_GEOMETRY_BLOCK_H

#include "core/pack.h"

#include "shaders/octalux_shared.h"

enum { OLX_BLOCK_TEXELS = OLX_BLOCK_SIDE * OLX_BLOCK_SIDE };

// A block; all zeros are sky.
typedef struct olx_geometry_block {
  uint32_t words[4];
} olx_geometry_block;

// A plane in 54 of 64 bits, coded relative to the place of its block.
typedef struct olx_plane_code {
  uint32_t words[2];
} olx_plane_code;

// The planes of blocks that need more than two.
typedef struct olx_plane_pool {
  const olx_plane_code *planes;
  uint32_t count;
} olx_plane_pool;

// The place of a block in a map with n texels a side, n a power of two from 8 to 2048; x and y count blocks.
typedef struct olx_block_place {
  uint32_t n, x, y;
} olx_block_place;

// Bounds on the inverse depths of all points that a block's texels see; 0 is infinitely far away.
typedef struct olx_block_bounds {
  float least, greatest;
} olx_block_bounds;

static inline olx_vec3 olx_plane_decode(olx_plane_code code, olx_block_place place) {
  const uint32_t low = code.words[0], high = code.words[1];
  const int32_t a = (int32_t)(low << 15) >> 15, b = (int32_t)low >> 17, c = (int32_t)(high << 17) >> 17;
  const int32_t n = (int32_t)place.n, x = 8 * (int32_t)place.x + 4 - n, z = 8 * (int32_t)place.y + 4 - n;
  const int32_t sign_x = x < 0 ? -1 : 1, sign_z = z < 0 ? -1 : 1;
  // This is m on the face of the octahedron where x, y and z are positive, or where x and z are positive and y is not.
  const int32_t middle = 4 * a - b * x - c * z, along_x = sign_x * b * n, along_z = sign_z * c * n;
  const bool upper = sign_x * x + sign_z * z <= n;
  const float scale = olx_bits_float(((high >> 15 & 127u) + OLX_PLANE_EXPONENT) << 23);
  return olx_v3((float)(sign_x * (middle + along_x)) * scale,
                (float)(upper ? middle : -(middle + along_x + along_z)) * scale,
                (float)(sign_z * (middle + along_z)) * scale);
}

// Returns the number of a texel's plane in the pool, for a block that refers to the pool; else OLX_NO_PLANE. Texels
// count row by row.
static inline uint32_t olx_geometry_pooled(const olx_geometry_block *block, uint32_t texel) {
  if (block->words[3] >> 30 != OLX_GEOMETRY_POOL) return OLX_NO_PLANE;
  return block->words[0] + (block->words[1 + texel / 8] >> 4 * (texel % 8) & 15u);
}

// Returns the plane that a texel sees; `pooled` is the plane numbered by olx_geometry_pooled, or zeros.
static inline olx_vec3 olx_geometry_plane_of(const olx_geometry_block *block, olx_plane_code pooled,
                                             olx_block_place place, uint32_t texel) {
  const uint32_t *w = block->words, mode = w[3] >> 30;
  if (mode == OLX_GEOMETRY_ONE) return olx_v3(olx_bits_float(w[0]), olx_bits_float(w[1]), olx_bits_float(w[2]));
  if (mode == OLX_GEOMETRY_TWO) {
    const uint32_t which = w[2 + texel / 8] >> (22 + texel % 8) & 1u;
    pooled = (olx_plane_code){{w[which], w[2 + which]}};
  }
  return olx_plane_decode(pooled, place);
}

static inline olx_vec3 olx_geometry_plane(const olx_geometry_block *block, const olx_plane_pool *pool,
                                          olx_block_place place, uint32_t texel) {
  const uint32_t at = olx_geometry_pooled(block, texel);
  return olx_geometry_plane_of(block, at < pool->count ? pool->planes[at] : (olx_plane_code){{0, 0}}, place, texel);
}

// Returns a value below 1 in front of the plane, 1 on it, and above 1 behind it.
static inline float olx_plane_depth(olx_vec3 plane, olx_vec3 point) { return olx_dot(plane, point); }

// Returns the unit normal on the probe's side; 0 for the sky.
static inline olx_vec3 olx_plane_normal(olx_vec3 plane) { return olx_normalize(olx_negate(plane)); }

// Returns the distance to the plane along a unit direction; infinite where the plane is not met.
static inline float olx_plane_distance(olx_vec3 plane, olx_vec3 direction) {
  const float inverse = olx_dot(plane, direction);
  return inverse > 0.0f ? 1.0f / inverse : INFINITY;
}

// Returns the point of the octahedron in the middle of a block's texel.
static inline olx_vec3 olx_block_texel_point(olx_block_place place, uint32_t texel) {
  const float inverse_n = 1.0f / (float)place.n;
  const uint32_t x = OLX_BLOCK_SIDE * place.x + texel % OLX_BLOCK_SIDE,
                 y = OLX_BLOCK_SIDE * place.y + texel / OLX_BLOCK_SIDE;
  return olx_octahedral_point((olx_vec2){((float)x + 0.5f) * inverse_n, ((float)y + 0.5f) * inverse_n});
}

// Bounds the inverse depths decoded anywhere in the block, not only at the middles of texels.
olx_block_bounds olx_geometry_bounds(const olx_geometry_block *block, const olx_plane_pool *pool,
                                     olx_block_place place);

// Returns a bound of a block with planes in the pool, from its last word, a shorter float rounded up: no point that its
// texels see has a greater inverse depth.
static inline float olx_geometry_nearest(const olx_geometry_block *block) {
  return olx_bits_float(block->words[3] << 2 >> 1);
}

// Codes that bound for the planes of the pool.
uint32_t olx_geometry_nearest_code(const olx_geometry_block *block, const olx_plane_pool *pool, olx_block_place place);

// Returns what is invalid about a block of a file, in words, or NULL.
const char *olx_geometry_check(const olx_geometry_block *block, uint32_t pool_count);

#endif
