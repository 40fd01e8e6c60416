// Estimates how many bytes the file of a field takes before it is baked (docs/baking.md, "What a bake takes").
#ifndef OLX_PLACE_FIELD_BYTES_H
#define OLX_PLACE_FIELD_BYTES_H

#include "field/field_writer.h"
#include "place/cost/planned_maps.h"

// Bytes in proportion to texels that depend on what probes see: planes of fine surfaces, tiles of emission, and blocks
// of tiles of surfaces.
typedef struct olx_texel_bytes {
  double planes, emission, surfaces; // of a texel, on average
} olx_texel_bytes;

// Estimates them from at most 1,024 tiles of 8 x 8 texels, spread evenly over all maps, as the bake will store them.
olx_result olx_texel_bytes_sample(const olx_planned_maps *maps, uint32_t threads, olx_texel_bytes *bytes);

// Estimates the bytes of the irradiance volume that a bake of maps of map_size^2 texels makes, with olx_bake_settings.
// volume_cells of `most_cells`; 0 where it makes none.
double olx_expected_volume_bytes(const olx_scene *scene, uint32_t map_size, uint32_t most_cells);

// Returns the expected size of the file that the header describes, which has neither bricks nor a volume yet. The data
// for relighting is not included.
uint64_t olx_expected_bytes(const olx_field_header *header, double volume_bytes, const olx_texel_bytes *texels);

#endif
