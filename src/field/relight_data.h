// The data that a field stores so that its light can change (docs/format.md, "Relighting"): surfels, which are points
// on the scene's surfaces that receive light and reflect it; links, which say from which surfels light arrives at each;
// and the surfels that light the texels of light field probes and the probes of the irradiance volume. The structure
// lies in the file as it is read; src/bake builds it.
#ifndef OLX_FIELD_RELIGHT_DATA_H
#define OLX_FIELD_RELIGHT_DATA_H

#include "core/vec.h"

#include <octalux/base.h>

enum {
  OLX_RELIGHT_BLOCK_SITES = 4, // of a block, at most
  OLX_RELIGHT_MOST_SURFELS = 1u << 24,
  OLX_RELIGHT_MOST = 1u << 28, // the most of anything else that the structure counts
};

// The header with which RLIT begins; the arrays of olx_relight_data follow in their order.
typedef struct olx_relight_header {
  uint32_t surfels, links, sites, entries, volume_links;
  uint32_t blocks, volume_probes; // in the whole field
  uint32_t zero[9];
} olx_relight_header;

_Static_assert(sizeof(olx_relight_header) == 64, "docs/format.md");

typedef struct olx_relight_surfel {
  float points[OLX_RELIGHT_POINTS][3]; // metres, a little off the surface
  uint32_t normal;                     // olx_normal_pack
  uint32_t irradiance;                 // RGB9E5, W/m^2: indirect light, as baked
  // What its surface reflects, where 255 is 1: the luminance of the diffuse and of the specular reflectance, averaged
  // over views, the luminance of F0, and alpha, the square of roughness.
  uint8_t diffuse, specular, f0, alpha;
} olx_relight_surfel;

_Static_assert(sizeof(olx_relight_surfel) == OLX_RELIGHT_SURFEL_WORDS * sizeof(uint32_t), "docs/format.md");

// A link carries light from one surfel to another: the irradiance at its source, direct and indirect, times the weight.
typedef struct olx_relight_link {
  uint32_t
      from_straight; // bits 0 to 23: the surfel; above: the weight's share that met no specular surface, 255 is all
  uint32_t weight;   // RGB9E5
} olx_relight_link;

static inline uint32_t olx_relight_link_from(const olx_relight_link *link) { return link->from_straight & 0xFFFFFFu; }

// A block of 4 x 4 texels of a light field map. Texel i, row by row, has the site first_site + (which >> 2 i & 3).
typedef struct olx_relight_block {
  uint32_t first_site; // or OLX_RELIGHT_NO_SITE
  uint32_t which;
} olx_relight_block;

// A surfel whose indirect light counts for a site, with a weight at each corner of the block: the first and the last
// texel of its first row, then of its last row. At each corner, the weights of a site's entries sum to 255; between
// corners, weights are interpolated.
typedef struct olx_relight_entry {
  uint32_t surfel;
  uint8_t weights[4];
} olx_relight_entry;

// A link to a probe of the irradiance volume: the radiance that arrives is the irradiance at `from` times the weight,
// which includes the solid angle.
typedef struct olx_relight_volume_link {
  uint32_t from;
  uint32_t weight;       // RGB9E5
  uint16_t direction[2]; // towards the surfel: octahedral, 65535 is 1
} olx_relight_volume_link;

_Static_assert(sizeof(olx_relight_volume_link) == 12, "docs/format.md");

// Pointers into the structure; every number is in range once olx_relight_structure_open has passed.
typedef struct olx_relight_data {
  const olx_relight_header *header; // NULL: the field cannot be relit
  const olx_relight_surfel *surfels;
  const uint32_t *link_starts; // where each surfel's links begin, and the end
  const olx_relight_link *links;
  const olx_relight_block *blocks; // row by row, probe after probe
  const uint32_t *entry_starts;    // where each site's entries begin, and the end
  const olx_relight_entry *entries;
  const uint32_t *volume_starts; // where each volume probe's links begin, and the end
  const olx_relight_volume_link *volume_links;
} olx_relight_data;

// Returns the size in bytes of the structure that a header describes.
uint64_t olx_relight_structure_bytes(const olx_relight_header *header);

// Points into a structure and checks all of it. `name` begins the message.
olx_result olx_relight_structure_open(const void *data, size_t size_bytes, const char *name, olx_relight_data *relight);

#endif
