// Integrals over the sphere of directions around a probe by exact quadrature: no random numbers, no noise.
#ifndef OLX_BAKE_QUADRATURE_H
#define OLX_BAKE_QUADRATURE_H

#include "core/octahedral.h"

// The exponent of the cosine-power lobe that filters distances (a deviation of 0.17, ten degrees). Visibility needs a
// width in angle, so finer maps keep it. Maps of less than OLX_MOMENTS_FULL_SIZE texels a side cannot hold it: theirs
// goes down with the number of texels.
#define OLX_MOMENTS_EXPONENT 35
#define OLX_MOMENTS_FULL_SIZE 32
#define OLX_MOMENTS_EXPONENT_LEAST 4
#define OLX_MOMENTS_CELLS 64 // of distance, along a side

// What depends on sizes alone. A probe's directions lie in sample_size^2 texels, which are summed into cells^2 cells of
// light and distance_cells^2 cells of distance.
typedef struct olx_quadrature {
  uint32_t sample_size, cells, distance_cells;
  float *sample_solid_angle;                                     // a sample
  float *cell_solid_angle;                                       // a cell of light
  float *moment_x, *moment_y, *moment_z;                         // a cell: its directions, integrated over it
  float *distance_x, *distance_y, *distance_z, *distance_weight; // a cell of distance: direction and solid angle
  uint32_t irradiance_size, lobe_exponent;
  uint32_t *tile_starts; // of each block of output texels in `tiles`, and the end
  uint16_t *tiles;       // tiles of distance cells that a block's lobes reach
} olx_quadrature;

// The sizes of a quadrature, without its tables.
olx_quadrature olx_quadrature_shape(uint32_t irradiance_size);
olx_result olx_quadrature_create(uint32_t irradiance_size, olx_quadrature *quadrature);
void olx_quadrature_free(olx_quadrature *quadrature);

// Irradiance for every direction of a map of `size`^2 texels, row `row` of blocks (OLX_BLOCK_ROWS rows of texels), from
// the radiance of the cells. The map lies `stride` texels a row.
enum { OLX_BLOCK_COLUMNS = 8, OLX_BLOCK_ROWS = 2 };
void olx_quadrature_irradiance(const olx_quadrature *quadrature, const olx_vec3 *radiance, uint32_t size, uint32_t row,
                               olx_vec3 *map, uint32_t stride);

// Mean and mean square of the distances (one pair a distance cell), filtered with the lobe; as above, for the map of
// irradiance_size.
void olx_quadrature_moments(const olx_quadrature *quadrature, const olx_vec2 *distances, uint32_t row, olx_vec2 *map,
                            uint32_t stride);

#endif
