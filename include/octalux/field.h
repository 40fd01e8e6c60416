// A baked light field: opening, describing and checking the .olx file (docs/format.md).
//
// A field holds light field probes (distance, normal, and the surface with its light for every direction), through
// which rays are traced and from which light of surfaces is read, and an irradiance volume for free space. It may also
// hold probe light: the radiance that each light field probe saw (McGuire et al. 2017, section 3), and irradiance
// probes (prefiltered irradiance and distance moments; section 5.2). With probe light it may hold classic maps:
// irradiance probes without visibility, the method that light field probes replace (docs/baking.md). It may hold the
// data for relighting (octalux/relight.h). It is immutable.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_FIELD_H
#define OCTALUX_FIELD_H

#include <octalux/base.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_field olx_field;

// Ways to find the probes that light a point, or the next probe through which a ray is traced. Those before
// OLX_SELECT_EXHAUSTIVE are baked into a field, one or several; the others need no data.
typedef enum olx_select {
  OLX_SELECT_CAGE = 0,   // McGuire et al. 2017, section 4.1: the corners of the grid cell, in the order (i + 3) mod 8
  OLX_SELECT_VORONOI,    // Wang 2018, section 4.1: the nearest probe, then its Delaunay neighbours
  OLX_SELECT_OCTREE,     // Wang 2018, section 4.2: a sparse voxel octree, up to four probes a leaf
  OLX_SELECT_BRICKS,     // cells of space that list the probes which see them (docs/maths.md)
  OLX_SELECT_EXHAUSTIVE, // every probe that sees the place that the ray has reached, nearest first: slow, the reference
  OLX_SELECT_BEST        // the first of bricks, cage, voronoi, octree that the field has, else exhaustive
} olx_select;

// Returns a selector's name: "cage", "voronoi", "octree", "bricks", "exhaustive" or "best".
const char *olx_select_name(olx_select select);

// How irradiance probes store irradiance. Their distance moments are always octahedral maps.
typedef enum olx_irradiance_form {
  OLX_IRRADIANCE_OCTAHEDRAL = 0, // an octahedral map (McGuire et al. 2017, section 5.2)
  OLX_IRRADIANCE_SH2,            // spherical harmonics of 2nd order: bands 0 and 1, four coefficients a channel
  OLX_IRRADIANCE_SH3             // of 3rd order: bands 0 to 2, nine coefficients (McGuire et al. 2017, section 7)
} olx_irradiance_form;

// Returns a form's name: "octahedral", "sh2" or "sh3".
const char *olx_irradiance_form_name(olx_irradiance_form form);

// A regular grid of probes, in metres. Probe (x, y, z) has index x + count[0] * (y + count[1] * z) and the position
// origin + (x, y, z) * spacing. spacing is 0 along an axis with one probe.
typedef struct olx_grid {
  olx_vec3 origin;
  olx_vec3 spacing;
  uint32_t count[3]; // each at least 1
} olx_grid;

// The light field probes of a field.
typedef struct olx_probes_info {
  uint32_t count;  // at least 1
  uint32_t buried; // those that are inside geometry, which no lookup uses
  bool has_grid;   // they lie on `grid`
  olx_grid grid;   // valid when has_grid, else all 0
} olx_probes_info;

// The maps of light field probes. Sizes in texels, here and below, are those of the square octahedral maps without
// their one-texel border.
typedef struct olx_maps_info {
  uint32_t size;               // texels along a side: a power of two, 8 to 2048
  uint32_t samples;            // radiance samples along a texel's side (2: four samples a texel)
  float distance_scale_metres; // stored distances times this are metres
  bool compressed;             // material and light of surfaces lie in tiles of blocks that graphics hardware decodes
  bool geometry_blocks;        // geometry is stored in blocks of 4 x 4 texels: planes, not distances and normals
} olx_maps_info;

// The irradiance probes of a field; all 0 of one that was baked without probe light.
typedef struct olx_irradiance_info {
  uint32_t probe_count;     // 0: baked without probe light
  uint32_t buried;          // those that are inside geometry, which no lookup uses
  olx_grid grid;            // the positions of probes
  uint32_t size;            // texels along a side of a probe's maps: a power of two, 8 to 256
  olx_irradiance_form form; // with spherical harmonics, the maps hold moments alone
} olx_irradiance_info;

// The classic maps of irradiance probes; all 0 of a field that was baked without them.
typedef struct olx_classic_info {
  uint32_t size;      // texels along a side of a map: a power of two, 32 to 256; 0: baked without
  uint32_t cube_size; // texels along a side of a face of their source cube maps
  float sharpness;    // exponent of the filter from cube maps to classic maps
} olx_classic_info;

// The irradiance volume.
typedef struct olx_volume_info {
  uint32_t probe_count; // 0: baked without
} olx_volume_info;

// The data for relighting.
typedef struct olx_relight_info {
  uint32_t surfels; // 0: baked without
  uint32_t links;   // between surfels
} olx_relight_info;

// The light in a field's maps.
typedef struct olx_bounces_info {
  uint32_t count; // --bounces of the bake: light in the maps is direct light and this many further bounces
  float last; // share of the indirect light at texels that has count + 1 surfaces between emitter and texel, 0 to 1. It
              // is left out where rays end, because the surface that a ray lights is one more; 0 when not known
} olx_bounces_info;

// The scene of which a field was baked.
typedef struct olx_baked_scene_info {
  olx_vec3 bounds_min, bounds_max; // metres
  uint32_t light_count;            // lights that have no area
  uint64_t hash;                   // of geometry, materials, textures, lights and environment; 0 of a relit field
} olx_baked_scene_info;

// The bytes that each part of a field takes in its file; 0 of a part that it does not hold.
typedef struct olx_bytes_info {
  uint64_t file; // the whole file
  // The surfaces that light field probes see: base colour and reflectance, irradiance directly from emitters,
  // irradiance from surfaces, and emission with the sky.
  uint64_t material, direct, indirect, emission;
  // Geometry of the same surfaces: blocks with their planes, or normals and distances; and the pyramids over distances.
  uint64_t geometry, normal, distance, pyramid;
  uint64_t radiance;            // as light field probes saw it
  uint64_t irradiance, moments; // of irradiance probes
  uint64_t classic;
  uint64_t volume; // with its cells
  uint64_t relight;
  uint64_t selectors;                     // the sum of `select`
  uint64_t select[OLX_SELECT_EXHAUSTIVE]; // of each selector
} olx_bytes_info;

// The contents of a field.
typedef struct olx_field_info {
  olx_probes_info probes;
  olx_maps_info maps;
  olx_irradiance_info irradiance;
  olx_classic_info classic;
  olx_volume_info volume;
  olx_relight_info relight;
  uint32_t select_mask; // bit (1 << olx_select) for each selector that is baked in; may be 0
  olx_bounces_info bounces;
  olx_baked_scene_info scene;
  olx_bytes_info bytes;
} olx_field_info;

// Maps a field file into memory and checks its structure: every offset and size, and the checksums of header, chunk
// table and description, but not the maps (olx_field_verify). OLX_ERROR_FILE when it cannot be read, OLX_ERROR_FORMAT
// or OLX_ERROR_CHECKSUM when it is damaged, OLX_ERROR_VERSION for another version of the format, OLX_ERROR_UNSUPPORTED
// for a packed field (octalux/export.h) and for contents that this build does not know. On success the caller must
// close *field; on failure it is NULL. Takes milliseconds for maps of any size; the data for relighting is read in
// full. Until the field is closed nothing may shorten or change the file in place; replacing it by another file, as
// every output of Octalux does, is safe.
olx_result olx_field_open(const char *path, olx_field **field);

// Opens a field file that is already in memory, 64-byte aligned (else OLX_ERROR_ARGUMENT), like olx_field_open; `data`
// must outlive the field.
olx_result olx_field_open_memory(const void *data, size_t size_bytes, olx_field **field);

// Reads the description of a field file of format version 1. Such a file cannot be opened, because its texels hold no
// surfaces: the scene must be baked again. All of info->bytes except info->bytes.file are 0, as are the members that
// optional chunks describe. OLX_ERROR_VERSION for a file of another version.
olx_result olx_field_describe_version_1(const char *path, olx_field_info *info);

// Closes a field. NULL is allowed.
void olx_field_close(olx_field *field);

olx_field_info olx_field_describe(const olx_field *field);

// Returns the origin in metres of scene coordinates to which all positions of the field are relative, and all positions
// that the runtime's functions take and return. It is 0 unless the scene lies far from 0. A host subtracts it, in
// double precision, from the eye and from positions that it passes as floats; nothing else differs.
void olx_field_origin(const olx_field *field, double origin[3]);

// Returns the position in metres of a light field probe, index < probes.count; NaN for any other index.
olx_vec3 olx_field_probe_position(const olx_field *field, uint32_t index);
// Returns whether a light field probe was found buried (inside geometry) by the bake; true for an index without a
// probe.
bool olx_field_probe_buried(const olx_field *field, uint32_t index);
// Returns whether an irradiance probe was found buried (inside geometry), index < irradiance.probe_count; true for
// any other index.
bool olx_field_irradiance_probe_buried(const olx_field *field, uint32_t index);

// Reads every byte: checksums, zero padding, and the contents of the maps (no NaN, no negative distance, only possible
// moments). Returns OLX_OK, or the first failure, with its place in olx_last_error.
olx_result olx_field_verify(const olx_field *field);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
