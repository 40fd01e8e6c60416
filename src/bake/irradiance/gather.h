// Irradiance probes: gathers what each probe sees into cells, and computes its maps from them.
#ifndef OLX_BAKE_GATHER_H
#define OLX_BAKE_GATHER_H

#include "bake/irradiance/gather_state.h"
#include "field/field_writer.h"

// Allocates tables and maps; the caller sets everything else. `bounces` is the index of the last bounce.
olx_result olx_gather_create(olx_gather *gather, const olx_grid *grid, uint32_t irradiance_size, uint32_t bounces);
void olx_gather_free(olx_gather *gather);

// Returns the peak memory of gathering, in bytes: from the solution (`solved`) or by bounces, with a fit of irradiance
// (`fits`) or without. The gather need not be created.
uint64_t olx_gather_bytes(const olx_gather *gather, uint32_t irradiance_size, uint32_t bounces, bool solved, bool fits);

// Units of progress of all gathering, in rays.
uint64_t olx_gather_units(const olx_gather *gather, uint32_t bounces, bool solved);

// Casts the rays of all probes and stores hits, distances and, without `light`, direct light.
olx_result olx_gather_look(olx_gather *gather);
// Looks up the solved light at all hits.
olx_result olx_gather_solved(olx_gather *gather);
// Computes the irradiance maps of bounce `bounce`, for the next bounce and for shading; with `light`, bounce 0 is all
// light.
olx_result olx_gather_irradiance(olx_gather *gather, uint32_t bounce);
// Fits the irradiance maps of bounce `bounce` to surfaces.
olx_result olx_gather_fit(olx_gather *gather, uint32_t bounce);
// Prepares the final maps, once all light is gathered and before the first is packed.
olx_result olx_gather_finish(olx_gather *gather);
// Packs the final maps of a probe, corrected by the last fit, as olx_field_writer_irradiance takes them: irradiance,
// then moments in the second half of `record`.
olx_result olx_gather_pack(olx_gather *gather, uint32_t probe, uint32_t *record);
// Returns the number of words of a record. Only the quadrature must be known.
size_t olx_gather_record_words(const olx_gather *gather);

#endif
