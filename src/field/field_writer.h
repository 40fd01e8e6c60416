// Writes a field file piece by piece, so that a bake never holds a whole field in memory.
#ifndef OLX_FIELD_FIELD_WRITER_H
#define OLX_FIELD_FIELD_WRITER_H

#include "field/field_file.h"
#include "field/geometry_map.h"

typedef struct olx_field_writer olx_field_writer;

// What must be known before the first map is written: positions, and all of olx_field_info except counts of bytes.
typedef struct olx_field_header {
  olx_field_info info; // the writer fills in counts of bytes and of buried probes
  double origin[3];    // positions are relative to this point
  const olx_vec3 *probe_positions, *irradiance_positions;
  const void *select_data[OLX_SELECT_STORED]; // of each selector in info.select_mask except the cage
  size_t select_bytes[OLX_SELECT_STORED];
  const olx_field_light *lights; // without area; NULL when there are none
  uint32_t light_count;
  const void *volume; // the structure of the irradiance volume (field/volume_data.h), of info.volume.probe_count probes
  size_t volume_bytes; // of the structure; 0 without a volume
  const olx_vec3 *volume_positions;
  bool relight;                  // the data for relighting will be written last; its size is not known before
  const uint32_t *classic_table; // of classic maps, OLX_CLASSIC_TABLE_ENTRIES; NULL where info.classic.size is 0
} olx_field_header;

// The surfaces that a light field probe sees, row by row, without border, in the codes that field/texels.h reads.
// According to info.maps.compressed, the first four are maps of n * n texels that are 0 for the sky, or NULL, with
// tiles in their place, in the order of olx_surface_map (field/surface_encode.h).
typedef struct olx_surface_maps {
  const void *base, *specular, *direct, *indirect;
  const olx_tiled_maps *tiled; // NULL with texels
  const uint32_t *emission;    // n * n texels, 0 where the distance marks no emitter
} olx_surface_maps;

// The classic maps of an irradiance probe, packed, without border.
typedef struct olx_classic_record {
  const uint32_t *irradiance;
  const uint32_t *radiance[OLX_CLASSIC_LEVELS];
  olx_classic_box box;
} olx_classic_record;

// The offset of every chunk in the file that a header describes.
typedef struct olx_field_layout {
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  bool present[OLX_CHUNK_KINDS];
  uint64_t offsets[OLX_CHUNK_KINDS];
  uint32_t chunk_count;
  uint64_t file_bytes;
  uint64_t device_bytes; // of the chunks that a Vulkan device holds as they are; 0 for a field for the CPU alone
} olx_field_layout;

// Computes the layout that the writer will use, for callers that need sizes before there is anything to write. Needs
// header->info without positions.
void olx_field_lay_out(const olx_field_header *header, olx_field_layout *layout);

// Lays the file out and creates it beside `path`. Positions are copied; the data of selectors is written at once.
olx_result olx_field_writer_create(const char *path, const olx_field_header *header, olx_field_writer **writer);

// Writes the maps of one light field probe, in order of index, without border (n * n texels, row by row). Borders and
// the pyramid are computed here from the stored values. `radiance` is NULL where the header has no irradiance probes.
olx_result olx_field_writer_probe(olx_field_writer *writer, uint32_t index, uint8_t flags, const uint32_t *radiance,
                                  const uint16_t *normal, const uint16_t *distance);

// Writes the maps of one light field probe with its geometry in blocks, where info.maps.geometry_blocks is set, in
// order of index. Planes are copied.
olx_result olx_field_writer_probe_blocks(olx_field_writer *writer, uint32_t index, uint8_t flags,
                                         const uint32_t *radiance, const olx_geometry_map *geometry);

// Writes the surfaces of one light field probe, in order of index.
olx_result olx_field_writer_surface(olx_field_writer *writer, uint32_t index, const olx_surface_maps *maps);

// Writes the maps of one irradiance probe, in order of index, without border. According to info.irradiance.form,
// `irradiance` is a map of R11G11B10F or the result of olx_harmonics_pack.
olx_result olx_field_writer_irradiance(olx_field_writer *writer, uint32_t index, uint8_t flags, const void *irradiance,
                                       const uint32_t *moments);

// Writes the classic maps of one irradiance probe, in order of index, where info.classic.size is not 0.
olx_result olx_field_writer_classic(olx_field_writer *writer, uint32_t index, const olx_classic_record *record);

// Writes the data for relighting (field/relight_data.h), where the header announces it: once, after all surfaces.
olx_result olx_field_writer_relight(olx_field_writer *writer, const void *data, size_t size_bytes);

// Writes the irradiance of all probes of the volume, OLX_VOLUME_HALVES each, where the header has a volume.
olx_result olx_field_writer_volume(olx_field_writer *writer, const uint16_t *irradiance);
// Sets the share of the indirect light at texels that has met bounces + 1 surfaces on its way, 0 to 1. Without this
// call, the header's value is stored.
void olx_field_writer_last_bounce(olx_field_writer *writer, float share);

// Writes checksums, syncs the file and renames it into place. Frees the writer in any case. All probes must have been
// written.
olx_result olx_field_writer_commit(olx_field_writer *writer, uint64_t *file_bytes);
// Discards the file and frees the writer. NULL is allowed.
void olx_field_writer_discard(olx_field_writer *writer);

#endif
