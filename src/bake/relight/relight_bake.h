// Computes what a field stores so that its light can change (field/relight_data.h): the surfels of the solved light, a
// few links between them, and the surfels from which the light of every texel and of the irradiance volume's probes is
// interpolated.
#ifndef OLX_BAKE_RELIGHT_BAKE_H
#define OLX_BAKE_RELIGHT_BAKE_H

#include "bake/relight/few_links.h"
#include "bake/relight/relight_sites.h"
#include "field/field_writer.h"
#include "light/scene_light.h"

enum {
  OLX_RELIGHT_MOST_LINKS = 256, // per place
  OLX_RELIGHT_PLACES = 1 << 14  // whose links are found at a time
};

// The links of consecutively numbered places; links of surfels have no direction.
typedef struct olx_relight_rows {
  uint32_t *starts; // start of each place's links, and the end
  olx_relight_volume_link *links;
  uint64_t most; // capacity in links
} olx_relight_rows;

typedef struct olx_relight_bake {
  olx_bake_context *context;
  const olx_scene_light *light;
  uint32_t seed;
  uint64_t rays;            // rays cast
  olx_surfel_lookup lookup; // of visible surfels
  uint32_t surfel_count;
  olx_relight_surfel *stored; // encoded as in the file
  olx_relight_rows surfels, volume;
  uint32_t volume_count;
  olx_relight_sites sites;
} olx_relight_bake;

// Reduces the links of surfels to a few each. The caller sets the fields up to `seed`.
olx_result olx_relight_bake_create(olx_relight_bake *bake);
void olx_relight_bake_free(olx_relight_bake *bake);

// Serializes what is known before the first probe. Loading replaces olx_relight_bake_create and
// olx_relight_bake_volume.
void olx_relight_bake_save(const olx_relight_bake *bake, olx_byte_writer *to);
olx_result olx_relight_bake_load(olx_relight_bake *bake, olx_byte_reader *from);

// Finds the links of the irradiance volume's probes.
olx_result olx_relight_bake_volume(olx_relight_bake *bake, const olx_vec3 *positions, uint32_t count);
// Builds the lookup of visible surfels.
olx_result olx_relight_bake_look_up(olx_relight_bake *bake);
// Adds the sites of a light field probe. The caller adds all probes, in order.
olx_result olx_relight_bake_probe(olx_relight_bake *bake, const olx_relight_sites *probe);
// Writes the structure to the file, once the sites of all probes are added.
olx_result olx_relight_bake_write(olx_relight_bake *bake, olx_field_writer *writer);

#endif
