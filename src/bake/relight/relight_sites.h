// Sites: places at which the indirect light of texels is interpolated from surfels. Texels of a block that lie on one
// surface share a site.
#ifndef OLX_BAKE_RELIGHT_SITES_H
#define OLX_BAKE_RELIGHT_SITES_H

#include "bake/capture/capture.h"
#include "field/relight_data.h"
#include "light/surfels/surfel_lookup.h"
#include "work/byte_stream.h"

// The sites of all probes captured so far. The arrays grow as probes are added.
typedef struct olx_relight_sites {
  olx_relight_block *blocks;
  uint32_t *starts; // start of each site's entries, and the end
  olx_relight_entry *entries;
  uint32_t block_count, block_most, site_count, site_most, entry_count, entry_most;
} olx_relight_sites;

// Appends the sites of the latest captured probe; `surfels` finds the surfels around them. Fails when memory runs out,
// or when there are more sites than a file can hold.
olx_result olx_relight_sites_add(olx_relight_sites *sites, const olx_capture *capture,
                                 const olx_surfel_lookup *surfels);
// Appends the sites of another list.
olx_result olx_relight_sites_append(olx_relight_sites *sites, const olx_relight_sites *more);
// Serializes sites, and loads them into an empty list.
void olx_relight_sites_save(const olx_relight_sites *sites, olx_byte_writer *to);
olx_result olx_relight_sites_load(olx_relight_sites *sites, olx_byte_reader *from);
void olx_relight_sites_free(olx_relight_sites *sites);

#endif
