// Filters classic maps from a cube map of radiance (docs/maths.md, "The baseline"): the octahedral map, irradiance, and
// radiance prefiltered for rough lobes; also integrates the table of reflectances, which is the same for every scene.
#ifndef OLX_BAKE_CLASSIC_FILTER_H
#define OLX_BAKE_CLASSIC_FILTER_H

#include "bake/irradiance/quadrature.h"
#include "core/parallel.h"
#include "field/classic_data.h"

enum {
  OLX_CUBE_FACES = 6,
  OLX_CLASSIC_CHAIN = 6,    // most levels of the averaged octahedral map: 256 to 8 texels a side
  OLX_CLASSIC_SAMPLES = 512 // samples of a rough lobe
};

// A face of a cube map: face 0 looks along +x, 1 along -x, 2 and 3 along +y and -y, 4 and 5 along +z and -z.
typedef struct olx_cube_face {
  olx_vec3 axis, right, up;
} olx_cube_face;
olx_cube_face olx_cube_face_of(uint32_t face);

// Returns the direction of a point on a face, not normalized: u and v from -1 to 1.
static inline olx_vec3 olx_cube_direction(const olx_cube_face *face, float u, float v) {
  return olx_madd(olx_madd(face->axis, face->right, u), face->up, v);
}

// A direction drawn from a lobe around +z, its weight, and the level of the chain whose texels are as wide as the
// distance between samples.
typedef struct olx_lobe_sample {
  olx_vec3 direction;
  float weight, level;
} olx_lobe_sample;

// The filtered maps of a cube map. Cube maps are stored face by face, row by row.
typedef struct olx_classic_filter {
  uint32_t size, cube_size, threads;
  uint32_t sharpness;
  olx_vec3 *cube;       // radiance, 6 * cube_size^2: set by the caller
  olx_vec3 *irradiance; // irradiance of `cube`: size^2
  uint32_t chain_levels;
  olx_vec3 *chain[OLX_CLASSIC_CHAIN];   // with border: the octahedral map, then averages, each of the level before
  olx_vec3 *levels[OLX_CLASSIC_LEVELS]; // prefiltered radiance, olx_classic_side^2; level 0 is the octahedral map
  // Tables that depend on sizes alone.
  olx_quadrature quadrature;
  olx_vec3 *cells;          // radiance of the quadrature's cells
  olx_vec3 *face_direction; // directions to a face's texels in its frame: along axis, right, up
  float *face_solid_angle;
  olx_lobe_sample *lobe[OLX_CLASSIC_LEVELS];
  uint32_t lobe_count[OLX_CLASSIC_LEVELS];
} olx_classic_filter;

// Returns the sharpness at which the filter's lobe is as wide as a texel of the octahedral map or of the cube map,
// whichever is coarser.
uint32_t olx_classic_sharpness(uint32_t size, uint32_t cube_size);

// Allocates maps and tables. The caller sets size, cube_size, sharpness and threads.
olx_result olx_classic_filter_create(olx_classic_filter *filter);
void olx_classic_filter_free(olx_classic_filter *filter);
// Computes all maps from filter->cube.
olx_result olx_classic_filter_run(olx_classic_filter *filter, olx_task *task);

// Integrates the scale and the bias of F0 for a cosine to the view direction and a roughness, by quadrature.
olx_vec2 olx_classic_integrate(float cosine, float roughness);
// Fills a table of OLX_CLASSIC_TABLE_ENTRIES entries, as the file stores it.
olx_result olx_classic_table_make(uint32_t *table, uint32_t threads);

#endif
