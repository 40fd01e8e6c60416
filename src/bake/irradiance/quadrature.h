// Integrates over the sphere of directions around a probe by deterministic quadrature, without random numbers or noise.
#ifndef OLX_BAKE_QUADRATURE_H
#define OLX_BAKE_QUADRATURE_H

#include "core/octahedral.h"

// The exponent of the cosine-power lobe that filters distances: a standard deviation of 0.17 rad, ten degrees. The
// visibility test needs this angular width, so finer maps keep it. Maps of fewer than OLX_MOMENTS_FULL_SIZE texels
// along a side cannot resolve it: their exponent falls with the number of texels.
#define OLX_MOMENTS_EXPONENT 35
#define OLX_MOMENTS_FULL_SIZE 32
#define OLX_MOMENTS_EXPONENT_LEAST 4
#define OLX_MOMENTS_CELLS 64 // distance cells along a side

// Tables that depend on sizes alone. A probe's directions lie in sample_size^2 texels, which are summed into cells^2
// cells of light and distance_cells^2 cells of distance.
typedef struct olx_quadrature {
  uint32_t sample_size, cells, distance_cells;
  float *sample_solid_angle;                                     // one per sample
  float *cell_solid_angle;                                       // one per cell of light
  float *moment_x, *moment_y, *moment_z;                         // directions integrated over each cell of light
  float *distance_x, *distance_y, *distance_z, *distance_weight; // direction and solid angle of each cell of distance
  uint32_t irradiance_size, lobe_exponent;
  uint32_t *tile_starts; // start of each block's list in `tiles`, and the end
  uint16_t *tiles;       // tiles of distance cells that a block's lobes reach
} olx_quadrature;

// Returns the sizes of a quadrature, without its tables.
olx_quadrature olx_quadrature_shape(uint32_t irradiance_size);
olx_result olx_quadrature_create(uint32_t irradiance_size, olx_quadrature *quadrature);
void olx_quadrature_free(olx_quadrature *quadrature);

// Texels along the sides of a block, for which sums run together.
enum { OLX_BLOCK_COLUMNS = 8, OLX_BLOCK_ROWS = 2 };
// Computes irradiance from the radiance of the cells, for row `row` of blocks (OLX_BLOCK_ROWS rows of texels) of a map
// of `size`^2 texels whose rows are `stride` texels apart.
void olx_quadrature_irradiance(const olx_quadrature *quadrature, const olx_vec3 *radiance, uint32_t size, uint32_t row,
                               olx_vec3 *map, uint32_t stride);

// Filters the mean and the mean square of distances (one pair per distance cell) with the lobe, for one row of blocks
// of the map of irradiance_size^2 texels.
void olx_quadrature_moments(const olx_quadrature *quadrature, const olx_vec2 *distances, uint32_t row, olx_vec2 *map,
                            uint32_t stride);

#endif
