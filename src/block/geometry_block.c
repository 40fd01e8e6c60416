// Bounds the distances in geometry blocks, from which pyramids are built, and checks the blocks of a file. The header
// decodes single planes.
#include "block/geometry_block.h"

// The rounding error of m . q, in units of |m|_1.
static const float ROUNDING = 0x1p-20f;

static void include(olx_block_bounds *bounds, olx_vec3 plane, olx_vec2 uv) {
  const float inverse = olx_dot(plane, olx_octahedral_point(uv));
  const float slack = (fabsf(plane.x) + fabsf(plane.y) + fabsf(plane.z)) * ROUNDING;
  bounds->least = olx_min(bounds->least, olx_max(inverse - slack, 0.0f));
  bounds->greatest = olx_max(bounds->greatest, inverse + slack);
}

// Extends bounds by a plane over a square of texels. A plane is affine on each of the two triangles into which a fold
// divides a square, and a fold goes from corner to corner, so the corners decide.
static void include_square(olx_block_bounds *bounds, olx_vec3 plane, uint32_t x, uint32_t y, uint32_t side,
                           uint32_t n) {
  for (uint32_t corner = 0; corner < 4; corner++) {
    const float u = (float)(x + (corner & 1u) * side), v = (float)(y + (corner >> 1) * side);
    include(bounds, plane, (olx_vec2){u / (float)n, v / (float)n});
  }
}

olx_block_bounds olx_geometry_bounds(const olx_geometry_block *block, const olx_plane_pool *pool,
                                     olx_block_place place) {
  olx_block_bounds bounds = {INFINITY, 0.0f};
  const uint32_t x = OLX_BLOCK_SIDE * place.x, y = OLX_BLOCK_SIDE * place.y;
  if (block->words[3] >> 30 == OLX_GEOMETRY_ONE) {
    include_square(&bounds, olx_geometry_plane(block, pool, place, 0), x, y, OLX_BLOCK_SIDE, place.n);
    return bounds;
  }
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const olx_vec3 plane = olx_geometry_plane(block, pool, place, i);
    include_square(&bounds, plane, x + i % OLX_BLOCK_SIDE, y + i / OLX_BLOCK_SIDE, 1, place.n);
  }
  return bounds;
}

uint32_t olx_geometry_nearest_code(const olx_geometry_block *block, const olx_plane_pool *pool, olx_block_place place) {
  return (olx_float_bits(olx_geometry_bounds(block, pool, place).greatest) + 1) >> 1 & 0x3FFFFFFFu;
}

// Returns whether a float is finite and not subnormal, since devices may flush subnormal floats to 0.
static bool is_plain(uint32_t word) {
  const uint32_t exponent = word >> 23 & 255u;
  return exponent != 255 && (exponent != 0 || (word & 0x7FFFFFFFu) == 0);
}

static const char *check_one(const uint32_t *w) {
  if (w[3] != 0) return "reserved bits";
  return is_plain(w[0]) && is_plain(w[1]) && is_plain(w[2]) ? NULL : "a plane that is not finite, or subnormal";
}

static const char *check_pooled(const olx_geometry_block *block, uint32_t pool_count) {
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const uint32_t first = block->words[0], at = olx_geometry_pooled(block, i);
    if (at < first || at >= pool_count) return "a plane that is not in the pool";
  }
  return NULL;
}

const char *olx_geometry_check(const olx_geometry_block *block, uint32_t pool_count) {
  switch (block->words[3] >> 30) {
  case OLX_GEOMETRY_ONE: return check_one(block->words);
  case OLX_GEOMETRY_TWO: return block->words[2] >> 30 == 0 ? NULL : "reserved bits";
  case OLX_GEOMETRY_POOL: return check_pooled(block, pool_count);
  default: return "unknown form";
  }
}
