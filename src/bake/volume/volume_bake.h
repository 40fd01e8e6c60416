// The irradiance volume of a bake: cells are made from geometry before the file is laid out, and lit when light has
// been solved.
#ifndef OLX_BAKE_VOLUME_BAKE_H
#define OLX_BAKE_VOLUME_BAKE_H

#include "bake/bake_context.h"
#include "bake/volume/volume_cells.h"
#include "field/field_writer.h"
#include "light/scene_light.h"
#include "work/unit_store.h"

typedef struct olx_volume_bake {
  olx_bake_context *context;
  uint32_t seed;
  olx_volume_cells cells; // made first
} olx_volume_bake;

// Returns whether a bake with such settings makes a volume, where there is free space.
bool olx_volume_is_baked(const olx_bake_settings *settings);

// Makes the cells, and measures the share of surfaces in sight of probes at which there is none.
olx_result olx_volume_bake_create(olx_volume_bake *bake, olx_bake_stats *stats);
// Computes the light of the probes by units of the store, and writes it to the file; `writer` is NULL where no file is
// written. Joining does not need `light`.
olx_result olx_volume_bake_write(olx_volume_bake *bake, const olx_scene_light *light, olx_unit_store *store,
                                 olx_field_writer *writer, olx_bake_stats *stats);
// Units of the stage "volume".
uint32_t olx_volume_bake_units(const olx_volume_bake *bake);
void olx_volume_bake_free(olx_volume_bake *bake);

#endif
