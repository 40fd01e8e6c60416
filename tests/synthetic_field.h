// Small valid field files with made-up maps, written by the field writer.
#ifndef SYNTHETIC_FIELD_H
#define SYNTHETIC_FIELD_H

#include "field/field_writer.h"
#include "field/geometry_map_encode.h"
#include "field/surface_encode.h"

typedef struct synthetic_shape {
  uint32_t grid[3], irradiance_grid[3]; // `irradiance_grid` and irradiance_n are 0 for no probe light
  uint32_t n, irradiance_n;
  uint32_t select_mask;     // selectors beside the cage: voronoi, and octree as for cornell
  uint32_t classic_size;    // texels along a side of classic maps, or 0 for none
  uint32_t relight_surfels; // surfels of the relighting data, or 0 for none
  olx_irradiance_form irradiance_form;
  bool compressed;      // surfaces stored as blocks
  bool geometry_blocks; // geometry stored as blocks
  double origin[3];     // origin that positions are relative to
} synthetic_shape;

// Make the header of a field of this shape: a box around the origin, probes one metre apart, every third probe buried.
// Release what it points to with synthetic_header_release.
olx_field_header synthetic_header(const synthetic_shape *shape);
void synthetic_header_release(olx_field_header *header);

uint8_t synthetic_flags(uint32_t probe);

// Makes the maps of a probe, without border. The distances contain sky, emitters and a texel at distance 0; those of
// every fourth probe also a block of nothing but sky, texels (8, 4) to (11, 7).
void synthetic_light_maps(uint32_t n, uint32_t probe, uint32_t *radiance, uint16_t *normal, uint16_t *distance);
// The texels of a probe's maps, in the form that the encoder of geometry blocks takes.
typedef struct synthetic_geometry {
  uint32_t n;
  const uint16_t *normal, *distance;
} synthetic_geometry;
olx_geometry_texel synthetic_geometry_texel(const void *geometry, uint32_t x, uint32_t y);

// Room for the surfaces of a probe whose maps have up to 256 x 256 texels.
typedef struct synthetic_surfaces_room {
  uint32_t base[256 * 256], direct[256 * 256], indirect[256 * 256], emission[256 * 256];
  uint16_t specular[256 * 256];
} synthetic_surfaces_room;
// Encodes such surfaces as tiles; maps point into `maker`, which is to be freed, from then on.
void synthetic_surface_tiles(uint32_t n, const uint16_t *distance, olx_surface_maker *maker, olx_surface_maps *maps);
// Makes the surfaces for these distances, which point into `room`. Odd probes emit in their last quarter alone.
olx_surface_maps synthetic_surface_maps(uint32_t n, uint32_t probe, const uint16_t *distance,
                                        synthetic_surfaces_room *room);
// A sun, a lamp and a spotlight.
enum { SYNTHETIC_LIGHTS = 3 };
extern const olx_field_light synthetic_lights[SYNTHETIC_LIGHTS];
void synthetic_irradiance_maps(uint32_t n, uint32_t probe, uint32_t *irradiance, uint32_t *moments);

// Makes the irradiance of a probe as harmonics, which ring, in place of a map.
void synthetic_harmonics(olx_irradiance_form form, uint32_t probe, uint16_t halves[OLX_HARMONICS_MOST_HALVES]);

// Room for the largest classic maps of a probe.
typedef struct synthetic_classic {
  uint32_t irradiance[64 * 64], radiance[OLX_CLASSIC_LEVELS][64 * 64];
} synthetic_classic;
// Makes classic maps of at most 64 x 64 texels, which point into `maps`.
olx_classic_record synthetic_classic_maps(uint32_t size, uint32_t probe, olx_vec3 position, synthetic_classic *maps);

// Makes the relighting data of a field of that shape without a volume: a valid structure (field/relight_data.h) with
// meaningless numbers. Give it to olx_release; NULL: out of memory.
void *synthetic_relight(const synthetic_shape *shape, size_t *size_bytes);

// Write all probes and the relighting data, without a commit.
olx_result synthetic_write_probes(olx_field_writer *writer, const synthetic_shape *shape);
olx_result synthetic_write(const char *path, const synthetic_shape *shape, uint64_t *file_bytes);

// Reads the bytes of a whole file, 64-byte aligned, to be given to olx_release; NULL when it cannot be read.
unsigned char *synthetic_read_file(const char *path, size_t *size_bytes);

#endif
