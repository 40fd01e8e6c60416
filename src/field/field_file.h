// The bytes of a field file, shared by its reader, its verifier and its writer. docs/format.md is the specification;
// field/field_chunks.h has a row for each kind of chunk.
#ifndef OLX_FIELD_FIELD_FILE_H
#define OLX_FIELD_FIELD_FILE_H

#include "core/chunk_file.h"
#include "field/field_data.h"

#define OLX_FIELD_MAGIC "\x89OLX\r\n\x1a\n"
#define OLX_PACKED_MAGIC "\x89OLZ\r\n\x1a\n" // magic of a packed field (src/export), which the runtime refuses by name

enum {
  OLX_FIELD_VERSION = 2,
  OLX_FIELD_MAX_GRID_COUNT = 1 << 20 // along an axis, so that indices stay exact in a float
};

#define OLX_FIELD_KIND                                                                                                 \
  ((olx_file_kind){.magic = OLX_FIELD_MAGIC,                                                                           \
                   .version = OLX_FIELD_VERSION,                                                                       \
                   .noun = "field file",                                                                               \
                   .remedy = "; bake the scene again with this version"})

// The greatest length in metres, so that squares are finite.
#define OLX_FIELD_MAX_LENGTH 1e18f
#define OLX_FIELD_MIN_SCALE 1e-18f

// Bits of olx_file_info.form: surfaces as maps of blocks, which are refused since tiles took their place; geometry as
// blocks; surfaces as tiles.
enum { OLX_FORM_BLOCKS = 1, OLX_FORM_GEOMETRY = 2, OLX_FORM_TILES = 4 };

typedef struct olx_file_grid {
  float origin[3], spacing[3];
  uint32_t count[3];
} olx_file_grid;

typedef struct olx_file_info {
  uint32_t probe_count, irradiance_probe_count;
  uint32_t buried_count, irradiance_buried_count;
  uint32_t has_grid;
  uint32_t radiance_size, irradiance_size;
  uint32_t irradiance_form; // olx_irradiance_form
  uint32_t select_mask;
  uint32_t bounces, samples;
  float distance_scale;
  float scene_min[3], scene_max[3];
  olx_file_grid grid, irradiance_grid;
  uint64_t scene_hash;
  float last_bounce; // share of the indirect light at texels that has met bounces + 1 surfaces on its way
  uint32_t form;     // OLX_FORM_*
} olx_file_info;

_Static_assert(sizeof(olx_file_info) == 160 && offsetof(olx_file_info, scene_min) == 48 &&
                   offsetof(olx_file_info, grid) == 72 && offsetof(olx_file_info, irradiance_grid) == 108 &&
                   offsetof(olx_file_info, scene_hash) == 144 && offsetof(olx_file_info, last_bounce) == 152 &&
                   offsetof(olx_file_info, form) == 156,
               "docs/format.md");
_Static_assert(sizeof(olx_vec3) == 12, "positions are read in place");

// The chunks of this version, in the order in which the writer stores them.
typedef enum olx_chunk_kind {
  OLX_CHUNK_INFO = 0,
  OLX_CHUNK_PROBE_POSITIONS,
  OLX_CHUNK_PROBE_FLAGS,
  OLX_CHUNK_RADIANCE,
  OLX_CHUNK_NORMAL,   // of texels only
  OLX_CHUNK_DISTANCE, // of texels, or geometry blocks
  OLX_CHUNK_LEAST,
  OLX_CHUNK_GREATEST,
  OLX_CHUNK_IRRADIANCE_POSITIONS,
  OLX_CHUNK_IRRADIANCE_FLAGS,
  OLX_CHUNK_IRRADIANCE,
  OLX_CHUNK_MOMENTS,
  // The surfaces that light field probes see, and their light; the first four are stored as texels or as tiles.
  OLX_CHUNK_BASE,
  OLX_CHUNK_SPECULAR,
  OLX_CHUNK_DIRECT,
  OLX_CHUNK_INDIRECT,
  OLX_CHUNK_EMISSION,
  OLX_CHUNK_LIGHTS,
  OLX_CHUNK_REQUIRED, // a field with probe light has so many, and OLX_CHUNK_EMISSION_TILES at the end
  // Selectors are optional, because a reader can skip those that it does not know.
  OLX_CHUNK_VORONOI = OLX_CHUNK_REQUIRED,
  OLX_CHUNK_OCTREE,
  OLX_CHUNK_BRICKS,
  // Classic maps (field/classic_data.h); a file has all of these chunks or none.
  OLX_CHUNK_CLASSIC,
  OLX_CHUNK_CLASSIC_IRRADIANCE,
  OLX_CHUNK_CLASSIC_RADIANCE,
  OLX_CHUNK_CLASSIC_BOXES,
  // The irradiance volume; a file has all of these chunks or none.
  OLX_CHUNK_VOLUME,
  OLX_CHUNK_VOLUME_POSITIONS,
  OLX_CHUNK_VOLUME_IRRADIANCE,
  OLX_CHUNK_ORIGIN, // present where the origin is not 0
  // The last chunks are those whose sizes are known only when all probes are written: emission, which is required, the
  // planes to which geometry blocks refer, the pools of blocks that tiles of surfaces name, in the order of
  // olx_surface_map, and the data for relighting.
  OLX_CHUNK_EMISSION_TILES,
  OLX_CHUNK_PLANES,
  OLX_CHUNK_BASE_POOL,
  OLX_CHUNK_SPECULAR_POOL,
  OLX_CHUNK_DIRECT_POOL,
  OLX_CHUNK_INDIRECT_POOL,
  OLX_CHUNK_RELIGHT,
  OLX_CHUNK_KINDS
} olx_chunk_kind;

// Returns whether the description alone requires the chunk, which then is not flagged optional.
bool olx_chunk_is_required(const olx_field_info *info, olx_chunk_kind kind);

// Returns the chunk of a selector, or OLX_CHUNK_KINDS for the cage, which needs none.
static inline olx_chunk_kind olx_select_chunk(olx_select select) {
  return select == OLX_SELECT_CAGE ? OLX_CHUNK_KINDS : OLX_CHUNK_VORONOI + (uint32_t)select - OLX_SELECT_VORONOI;
}

// Computes the shape of each chunk from the description of the field. A selector's chunk is one record of any size, and
// its shape has 0 bytes; so do classic maps in a field without them. The counts of lights, tiles of emission and
// planes, and the size of the data for relighting, are not in the description: their shapes have 0 bytes too.
void olx_chunk_shapes(const olx_field_info *info, olx_chunk_shape shapes[OLX_CHUNK_KINDS]);

// Returns whether a Vulkan device holds chunks of that kind as they are in the file (src/vulkan/vulkan_field.c).
bool olx_chunk_is_on_device(olx_chunk_kind kind);

// Describes the file behind a field to core/chunk_file.h.
static inline olx_chunk_file olx_field_file(const olx_field *field) {
  return (olx_chunk_file){.data = field->data, .size_bytes = field->size_bytes, .name = field->name};
}

olx_file_info olx_field_info_store(const olx_field_info *info);
olx_field_info olx_field_info_load(const olx_file_info *stored);

// Checks that a field may have this description: sizes, counts, grids, finite numbers. On failure it returns `failure`;
// `name` begins the message.
olx_result olx_field_info_check(const olx_field_info *info, const char *name, olx_result failure);
// Checks the part of a description that concerns classic maps.
olx_result olx_classic_info_check(const olx_field_info *info, const char *name, olx_result failure);
// Reads the description from a file whose header and table are sound. Checks its chunk's size and checksum, and all
// that olx_field_info_check checks.
olx_result olx_field_info_read(const olx_chunk_file *file, olx_field_info *info);
// Checks that a field may hold this light; `index` is for the message.
olx_result olx_field_light_check(const olx_field_light *light, uint32_t index, const char *name, olx_result failure);
// Decodes a row of a map of tiles into texels, border included, for readers that cannot decode blocks. Light becomes
// RGB9E5. Base colours become the bytes of their square roots, red lowest. Specular has roughness in its low byte and
// olx_reflectance_pack in its high byte.
void olx_surface_row(const olx_field *field, olx_surface_map map, uint32_t probe, uint32_t row, void *texels);
// Decodes a row of texels, 0 to 3, of `count` blocks of a pool from `first` on, in the same codes.
void olx_pool_row(const olx_field *field, olx_surface_map map, uint32_t first, uint32_t count, uint32_t row,
                  void *texels);
// Checks that positions are finite and, with a grid, lie on it.
olx_result olx_positions_check(const olx_vec3 *positions, uint32_t count, const olx_grid *grid, const char *kind,
                               const char *name, olx_result failure);

#endif
