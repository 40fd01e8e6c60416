// Bakes the classic maps of irradiance probes: a cube map of what each probe sees, filtered (docs/baking.md, "Classic
// maps").
#ifndef OLX_BAKE_CLASSIC_BAKE_H
#define OLX_BAKE_CLASSIC_BAKE_H

#include "bake/bake_context.h"
#include "bake/capture/shade_batch.h"
#include "bake/irradiance/classic_filter.h"
#include "field/field_writer.h"

// The classic maps of one probe at a time.
typedef struct olx_classic_bake {
  olx_bake_context *context;
  olx_shade_context *shade;
  olx_classic_filter filter; // the caller sets size, cube_size, sharpness and threads
  uint32_t bounces;
  uint32_t probe; // index of the probe, which seeds its random numbers
  olx_vec3 position;
  uint8_t *side;   // for each cube texel, the side of a box that its surface could belong to, or none
  olx_vec3 *place; // position of each texel's surface, relative to the scene's low corner; far away for the sky
  uint32_t *packed_irradiance, *packed_levels[OLX_CLASSIC_LEVELS];
} olx_classic_bake;

// Allocates the maps. The caller sets the fields up to `bounces`.
olx_result olx_classic_bake_create(olx_classic_bake *bake);
// Returns the bytes that a classic bake holds, except for tables of less than 1 MiB. The bake need not be created.
uint64_t olx_classic_bake_bytes(const olx_classic_bake *bake);
void olx_classic_bake_free(olx_classic_bake *bake);

// Units of progress of one probe, in rays.
uint64_t olx_classic_bake_units(const olx_classic_bake *bake);

// Bakes the maps of a probe; *record is valid until the next call. Needs the irradiance of all bounces.
olx_result olx_classic_bake_probe(olx_classic_bake *bake, uint32_t probe, olx_vec3 position,
                                  olx_classic_record *record);

#endif
