// The kinds of chunks in a field file: one row each in the table of field_chunks.c, which says what shape it has, when
// the description calls for it, and how it is opened and verified. A new kind takes an enumerator (field/field_file.h),
// a row, and a file with its functions.
#ifndef OLX_FIELD_FIELD_CHUNKS_H
#define OLX_FIELD_FIELD_CHUNKS_H

#include "field/field_file.h"

// One of the forms in which a chunk may be stored.
typedef struct olx_chunk_form {
  uint32_t type, element_bytes;
  uint32_t elements;                                   // of a record, where their number is the same in every field,
  uint64_t (*elements_of)(const olx_field_info *info); // or NULL; neither: a record of any size
  // Of chunks that a description calls for: offset in olx_field of the pointer to the first byte, and offset in
  // olx_bytes_info of the member that counts the bytes. 0 without.
  size_t data, bytes;
} olx_chunk_form;

// When the description calls for a chunk, which then is not flagged optional.
typedef struct olx_chunk_need {
  bool (*holds)(const olx_field_info *info);
  const char *otherwise; // what the description has instead, for the message that refuses a chunk it does not call for
} olx_chunk_need;

// Parts of a field that are optional: their chunks are all present, or none is.
typedef enum olx_field_part {
  OLX_PART_NONE = 0, // the description decides alone
  OLX_PART_CLASSIC,
  OLX_PART_VOLUME,
  OLX_PART_RELIGHT,
  OLX_PART_ORIGIN,
  OLX_FIELD_PARTS
} olx_field_part;

typedef struct olx_chunk_traits {
  olx_chunk_form form, other;
  bool (*is_other)(const olx_field_info *info);       // whether it is stored in the second form; NULL: never
  uint64_t (*records_of)(const olx_field_info *info); // NULL: any number
  const olx_chunk_need *need;                         // NULL: optional
  olx_field_part part;                                // the part of the field to which it belongs
  bool on_device;                                     // a Vulkan device holds it as it is in the file
  // Finds the chunk, and those that go with it, and checks what the runtime relies on; NULL where its size is all.
  // Chunks that the description determines are found before, and rows are opened in order.
  olx_result (*open)(olx_field *field);
  // Checks that a record of a chunk that is present holds only what a writer produces; NULL where open has checked it.
  olx_result (*verify)(const olx_field *field, uint32_t record);
} olx_chunk_traits;

extern const olx_chunk_traits olx_chunk_kinds[OLX_CHUNK_KINDS];

// Returns the form of a chunk in fields of that description.
const olx_chunk_form *olx_chunk_form_of(const olx_field_info *info, olx_chunk_kind kind);

olx_result olx_probe_positions_open(olx_field *field);
olx_result olx_probe_flags_open(olx_field *field);
olx_result olx_irradiance_positions_open(olx_field *field);
olx_result olx_irradiance_flags_open(olx_field *field);
olx_result olx_lights_open(olx_field *field);
olx_result olx_emission_tiles_open(olx_field *field);
olx_result olx_planes_open(olx_field *field);
olx_result olx_pools_open(olx_field *field); // of all kinds of maps
olx_result olx_origin_open(olx_field *field);
// Selectors are present where the description names them.
olx_result olx_voronoi_open(olx_field *field);
olx_result olx_octree_open(olx_field *field);
olx_result olx_brick_chunk_open(olx_field *field);
// All chunks of classic maps, of the volume, and for relighting, which must come after the volume.
olx_result olx_classic_open(olx_field *field);
olx_result olx_field_volume_open(olx_field *field);
olx_result olx_relight_open(olx_field *field);

olx_result olx_probe_flags_verify(const olx_field *field, uint32_t probe);
olx_result olx_radiance_verify(const olx_field *field, uint32_t probe);
olx_result olx_geometry_verify(const olx_field *field, uint32_t probe); // normals and pyramids as well
olx_result olx_irradiance_flags_verify(const olx_field *field, uint32_t probe);
olx_result olx_irradiance_verify(const olx_field *field, uint32_t probe);
olx_result olx_moments_verify(const olx_field *field, uint32_t probe);
// All maps of surfaces, and tiles of emission: borders and contents.
olx_result olx_surfaces_verify(const olx_field *field, uint32_t probe);
olx_result olx_surface_contents_verify(const olx_field *field, uint32_t probe);
olx_result olx_voronoi_chunk_verify(const olx_field *field, uint32_t record);
olx_result olx_octree_chunk_verify(const olx_field *field, uint32_t record);
olx_result olx_classic_table_verify(const olx_field *field, uint32_t record);
olx_result olx_classic_irradiance_verify(const olx_field *field, uint32_t probe);
olx_result olx_classic_radiance_verify(const olx_field *field, uint32_t probe);
olx_result olx_volume_verify(const olx_field *field, uint32_t probe);

#endif
