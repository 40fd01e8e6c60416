// The bytes of a field file, shared by its reader, its verifier and its writer. docs/format.md is the specification.
#ifndef OLX_FIELD_FIELD_FILE_H
#define OLX_FIELD_FIELD_FILE_H

#include "core/chunk_file.h"
#include "field/field_data.h"

#define OLX_FIELD_MAGIC "\x89OLX\r\n\x1a\n"
#define OLX_PACKED_MAGIC "\x89OLZ\r\n\x1a\n" // of a packed field (src/export), which the runtime refuses by name

enum {
  OLX_FIELD_VERSION = 2,
  OLX_FIELD_MAX_GRID_COUNT = 1 << 20 // along an axis: indices stay exact in a float
};

#define OLX_FIELD_KIND                                                                                                 \
  ((olx_file_kind){.magic = OLX_FIELD_MAGIC,                                                                           \
                   .version = OLX_FIELD_VERSION,                                                                       \
                   .noun = "field file",                                                                               \
                   .remedy = "; bake the scene again with this version"})

// Every length is at most this, in metres, so that squares are finite.
#define OLX_FIELD_MAX_LENGTH 1e18f
#define OLX_FIELD_MIN_SCALE 1e-18f

// What lies in blocks: bits of olx_file_info.form.
enum { OLX_FORM_SURFACES = 1, OLX_FORM_GEOMETRY = 2 };

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
  float last_bounce; // share of indirect light at texels that has bounces + 1 surfaces on its way
  uint32_t form; // OLX_FORM_*
} olx_file_info;

_Static_assert(sizeof(olx_file_info) == 160 && offsetof(olx_file_info, scene_min) == 48 &&
                   offsetof(olx_file_info, grid) == 72 && offsetof(olx_file_info, irradiance_grid) == 108 &&
                   offsetof(olx_file_info, scene_hash) == 144 && offsetof(olx_file_info, last_bounce) == 152 &&
                   offsetof(olx_file_info, form) == 156,
               "docs/format.md");
_Static_assert(sizeof(olx_vec3) == 12, "positions are read in place");

// The chunks of this version, in the order the writer lays them out.
typedef enum olx_chunk_kind {
  OLX_CHUNK_INFO = 0,
  OLX_CHUNK_PROBE_POSITIONS,
  OLX_CHUNK_PROBE_FLAGS,
  OLX_CHUNK_RADIANCE,
  OLX_CHUNK_NORMAL,   // of texels alone
  OLX_CHUNK_DISTANCE, // or geometry blocks
  OLX_CHUNK_LEAST,
  OLX_CHUNK_GREATEST,
  OLX_CHUNK_IRRADIANCE_POSITIONS,
  OLX_CHUNK_IRRADIANCE_FLAGS,
  OLX_CHUNK_IRRADIANCE,
  OLX_CHUNK_MOMENTS,
  // The surfaces that light field probes see, and their light: the first four as texels or as blocks.
  OLX_CHUNK_BASE,
  OLX_CHUNK_SPECULAR,
  OLX_CHUNK_DIRECT,
  OLX_CHUNK_INDIRECT,
  OLX_CHUNK_EMISSION,
  OLX_CHUNK_LIGHTS,
  OLX_CHUNK_REQUIRED, // how many a field with probe light has, and OLX_CHUNK_EMISSION_TILES at the end
  // Selectors: optional, because what a reader does not know it can do without.
  OLX_CHUNK_VORONOI = OLX_CHUNK_REQUIRED,
  OLX_CHUNK_OCTREE,
  OLX_CHUNK_BRICKS,
  // Classic maps: all of these or none.
  OLX_CHUNK_CLASSIC,
  OLX_CHUNK_CLASSIC_IRRADIANCE,
  OLX_CHUNK_CLASSIC_RADIANCE,
  OLX_CHUNK_CLASSIC_BOXES,
  // The irradiance volume: all of these or none.
  OLX_CHUNK_VOLUME,
  OLX_CHUNK_VOLUME_POSITIONS,
  OLX_CHUNK_VOLUME_IRRADIANCE,
  OLX_CHUNK_ORIGIN, // where the origin is not 0
  // Last in the file are those whose sizes a writer knows when all probes are written: emission, which is required, the
  // planes that geometry blocks name, and what relighting needs.
  OLX_CHUNK_EMISSION_TILES,
  OLX_CHUNK_PLANES,
  OLX_CHUNK_RELIGHT,
  OLX_CHUNK_KINDS
} olx_chunk_kind;

// Radiance as light field probes saw it, and irradiance probes: a field has all of these, or no irradiance probes.
static inline bool olx_chunk_is_probe_light(olx_chunk_kind kind) {
  return kind == OLX_CHUNK_RADIANCE || (kind >= OLX_CHUNK_IRRADIANCE_POSITIONS && kind <= OLX_CHUNK_MOMENTS);
}

// Whether the chunk is there because of the description alone, and not flagged optional.
static inline bool olx_chunk_is_required(const olx_field_info *info, olx_chunk_kind kind) {
  if (olx_chunk_is_probe_light(kind)) return info->irradiance_probe_count > 0;
  if (kind == OLX_CHUNK_NORMAL) return !info->geometry_blocks;
  if (kind == OLX_CHUNK_PLANES) return info->geometry_blocks;
  return kind < OLX_CHUNK_REQUIRED || kind == OLX_CHUNK_EMISSION_TILES;
}

// The chunk of a selector, or OLX_CHUNK_KINDS for the cage, which needs none.
static inline olx_chunk_kind olx_select_chunk(olx_select select) {
  return select == OLX_SELECT_CAGE ? OLX_CHUNK_KINDS : OLX_CHUNK_VORONOI + (uint32_t)select - OLX_SELECT_VORONOI;
}

// What each chunk must be, given the description of the field. Those of selectors are single records of any size: 0
// bytes here; so are classic maps where there are none. The description does not say how many lights and tiles of
// emission there are, how many planes, nor what relighting needs: the sizes of these chunks are 0 here.
void olx_chunk_shapes(const olx_field_info *info, olx_chunk_shape shapes[OLX_CHUNK_KINDS]);

// Bytes that no description foresees, as they are expected in a field with maps of radiance_size^2 texels: planes of
// fine surfaces, tiles of emission and bricks in proportion to the texels, and the irradiance volume
// (docs/studies/storage.md).
uint64_t olx_expected_extra_bytes(uint64_t probes, uint32_t radiance_size);

// Whether a Vulkan device holds a chunk of that kind as it is (src/vulkan/gpu_field.c).
bool olx_chunk_is_on_device(olx_chunk_kind kind);

// The file behind a field, for core/chunk_file.h.
static inline olx_chunk_file olx_field_file(const olx_field *field) {
  return (olx_chunk_file){.data = field->data, .size_bytes = field->size_bytes, .name = field->name};
}

olx_file_info olx_field_info_store(const olx_field_info *info);
olx_field_info olx_field_info_load(const olx_file_info *stored);

// Whether a description is one a field may have: sizes, counts, grids, finite numbers. `failure` is the result when it
// is not; `name` begins the message.
olx_result olx_field_info_check(const olx_field_info *info, const char *name, olx_result failure);
// Whether what a description says of classic maps can be.
olx_result olx_classic_info_check(const olx_field_info *info, const char *name, olx_result failure);
// The description in a file whose header and table are sound: its chunk's size and checksum, and all that
// olx_field_info_check judges.
olx_result olx_field_info_read(const olx_chunk_file *file, olx_field_info *info);
// Whether a light is one that a field may hold; `index` is for the message.
olx_result olx_field_light_check(const olx_field_light *light, uint32_t index, const char *name, olx_result failure);
// Finds the surfaces and the lights of an open field and checks all that readers rely on.
olx_result olx_surfaces_open(olx_field *field);
// A row of a map of blocks as texels, border included, for those who cannot read blocks. Light is RGB9E5; base colours
// are the bytes of their roots, red lowest; of specular the low byte is roughness, the high byte olx_reflectance_pack.
void olx_surface_row(const olx_field *field, olx_surface_map map, uint32_t probe, uint32_t row, void *texels);
// Whether the surfaces of a probe, and all tiles of emission, hold what a writer makes of them.
olx_result olx_surfaces_verify(const olx_field *field, uint32_t probe);
// Finds the classic maps of an open field, if it has any, and checks their structure.
olx_result olx_classic_open(olx_field *field);
// Finds the irradiance volume of an open field, if it has one, and checks its structure.
olx_result olx_field_volume_open(olx_field *field);
// Finds what relighting needs, if the field has it, and checks it. The volume must be open.
olx_result olx_relight_open(olx_field *field);
// Whether the irradiance of a probe of the volume is what a writer makes of it.
olx_result olx_volume_verify(const olx_field *field, uint32_t probe);
// Whether positions are finite and, with a grid, stand on it.
olx_result olx_positions_check(const olx_vec3 *positions, uint32_t count, const olx_grid *grid, const char *kind,
                               const char *name, olx_result failure);

#endif
