// What a field keeps so that its light can change (field/relight_data.h): the surfels of the solved light, few links
// between them, and the surfels from which the light of every texel and of the irradiance volume's probes is
// interpolated.
#ifndef OLX_BAKE_RELIGHT_BAKE_H
#define OLX_BAKE_RELIGHT_BAKE_H

#include "bake/relight_sites.h"
#include "field/field_writer.h"
#include "light/few_links.h"

// The links of places that are numbered one after the other; surfels' have no direction.
typedef struct olx_relight_rows {
  uint32_t *starts; // of the links of each place, and the end
  olx_relight_volume_link *links;
  uint64_t most; // links that there is room for
} olx_relight_rows;

typedef struct olx_relight_bake {
  olx_bake_context *context;
  const olx_scene_light *light;
  uint32_t seed;
  uint64_t rays; // cast
  uint32_t surfel_count;
  olx_relight_surfel *stored; // as the file has them
  olx_relight_rows surfels, volume;
  uint32_t volume_count;
  olx_relight_sites sites;
} olx_relight_bake;

// The fields up to `seed` are the caller's to fill. Makes the links of surfels few.
olx_result olx_relight_bake_create(olx_relight_bake *bake);
void olx_relight_bake_free(olx_relight_bake *bake);

// What is known before the first probe, as bytes and back: in place of creating it and of the volume's links.
void olx_relight_bake_save(const olx_relight_bake *bake, olx_byte_writer *to);
olx_result olx_relight_bake_load(olx_relight_bake *bake, olx_byte_reader *from);

// Links of the probes of the irradiance volume.
olx_result olx_relight_bake_volume(olx_relight_bake *bake, const olx_vec3 *positions, uint32_t count);
// Adds the sites of a light field probe: all probes, in order.
olx_result olx_relight_bake_probe(olx_relight_bake *bake, const olx_relight_sites *probe);
// To the file, when all surfaces are there.
olx_result olx_relight_bake_write(olx_relight_bake *bake, olx_field_writer *writer);

#endif
