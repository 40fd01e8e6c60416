// Irradiance probes: what each sees, gathered into cells, and the maps that are made of it.
#ifndef OLX_BAKE_GATHER_H
#define OLX_BAKE_GATHER_H

#include "bake/gather_state.h"
#include "field/field_writer.h"

// Everything but the tables and maps is the caller's to fill. `bounces` is the number of the last bounce.
olx_result olx_gather_create(olx_gather *gather, const olx_grid *grid, uint32_t irradiance_size, uint32_t bounces);
void olx_gather_free(olx_gather *gather);

// The memory that gathering takes at most at once, from the solution (`solved`) or by bounces, with a fit of irradiance
// (`fits`) or without. The gather need not be created.
uint64_t olx_gather_bytes(const olx_gather *gather, uint32_t irradiance_size, uint32_t bounces, bool solved, bool fits);

// Units of progress that the whole of gathering takes, in rays.
uint64_t olx_gather_units(const olx_gather *gather, uint32_t bounces, bool solved);

// What all probes see, and distances; without `light` also direct light.
olx_result olx_gather_look(olx_gather *gather);
// Light of all that probes see, from the solution.
olx_result olx_gather_solved(olx_gather *gather);
// The irradiance of bounce `bounce`, for the next to gather from and for shading; with `light`, of all light, bounce 0.
olx_result olx_gather_irradiance(olx_gather *gather, uint32_t bounce);
// Fits that irradiance, made before, to the surfaces.
olx_result olx_gather_fit(olx_gather *gather, uint32_t bounce);
// Before the final maps are packed, when all light is gathered.
olx_result olx_gather_finish(olx_gather *gather);
// The final maps of a probe, corrected by the last fit, as olx_field_writer_irradiance takes them: irradiance, then
// moments in the second half of `record`.
olx_result olx_gather_pack(olx_gather *gather, uint32_t probe, uint32_t *record);
// Words of a record. Only the quadrature must be known.
size_t olx_gather_record_words(const olx_gather *gather);

#endif
