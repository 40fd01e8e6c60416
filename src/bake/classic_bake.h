// Classic maps of irradiance probes: a cube map of what each sees, filtered (docs/baking.md, "Classic maps").
#ifndef OLX_BAKE_CLASSIC_BAKE_H
#define OLX_BAKE_CLASSIC_BAKE_H

#include "bake/bake_context.h"
#include "bake/classic_filter.h"
#include "bake/shade_batch.h"
#include "field/field_writer.h"

// One probe at a time.
typedef struct olx_classic_bake {
  olx_bake_context *context;
  olx_shade_context *shade;
  olx_classic_filter filter; // size, cube_size, sharpness and threads are the caller's to fill
  uint32_t bounces;
  uint32_t probe; // the number enters the random numbers
  olx_vec3 position;
  uint8_t *side;   // of each cube texel: which side of a box its surface could be, or none
  olx_vec3 *place; // where that is, from the scene's low corner; far away for the sky
  uint32_t *packed_irradiance, *packed_levels[OLX_CLASSIC_LEVELS];
} olx_classic_bake;

// The fields up to `bounces` are the caller's to fill.
olx_result olx_classic_bake_create(olx_classic_bake *bake);
// The memory that it holds, but for tables of less than a mebibyte. It need not be created.
uint64_t olx_classic_bake_bytes(const olx_classic_bake *bake);
void olx_classic_bake_free(olx_classic_bake *bake);

// Units of progress a probe takes, in rays.
uint64_t olx_classic_bake_units(const olx_classic_bake *bake);

// *record holds the probe's maps until the next one is made. Needs the irradiance of all bounces.
olx_result olx_classic_bake_probe(olx_classic_bake *bake, uint32_t probe, olx_vec3 position,
                                  olx_classic_record *record);

#endif
