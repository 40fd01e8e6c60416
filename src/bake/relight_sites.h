// Sites: places at which the indirect light of texels is interpolated from surfels. Texels of a block that lie on one
// surface share a site.
#ifndef OLX_BAKE_RELIGHT_SITES_H
#define OLX_BAKE_RELIGHT_SITES_H

#include "bake/capture.h"
#include "field/relight_data.h"
#include "light/scene_light.h"
#include "work/byte_stream.h"

// The sites of all probes that were captured so far. The arrays grow as probes are added.
typedef struct olx_relight_sites {
  olx_relight_block *blocks;
  uint32_t *starts; // of each site's entries, and the end
  olx_relight_entry *entries;
  uint32_t block_count, block_most, site_count, site_most, entry_count, entry_most;
} olx_relight_sites;

// Appends those of the probe that was captured last. Fails when memory is out or when there are more than a file holds.
olx_result olx_relight_sites_add(olx_relight_sites *sites, const olx_capture *capture, const olx_scene_light *light);
// Appends those of another, which were added or loaded by themselves.
olx_result olx_relight_sites_append(olx_relight_sites *sites, const olx_relight_sites *more);
// As bytes, and back: `sites` is empty before.
void olx_relight_sites_save(const olx_relight_sites *sites, olx_byte_writer *to);
olx_result olx_relight_sites_load(olx_relight_sites *sites, olx_byte_reader *from);
void olx_relight_sites_free(olx_relight_sites *sites);

#endif
