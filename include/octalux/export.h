// Exports: fields packed for shipping, their maps as pictures, and their contents as models to look at; and scenes as
// models to draw beside them. Part of liboctalux-bake. A program that only packs links zstd, and neither Embree nor an
// importer's library.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_EXPORT_H
#define OCTALUX_EXPORT_H

#include <octalux/field.h>
#include <octalux/scene.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

// ---- Packing: a field (.olx) is compressed (.olxz) and restored to the last byte (docs/format.md, "Packed fields"). A
// packed field cannot be sampled; the runtime refuses it with a message.

typedef struct olx_pack_settings {
  uint32_t level;   // of zstd, 1 (fast) to 22 (small); default 19
  uint32_t threads; // 0, the default: as many as the machine has; the bytes do not depend on it
} olx_pack_settings;

olx_pack_settings olx_pack_settings_default(void);

#define OLX_PACKED_MOST_CHUNKS 255

// A chunk of a packed field.
typedef struct olx_packed_chunk {
  char type[5]; // its four characters; non-printable ones become '?'
  uint64_t field_bytes, packed_bytes;
} olx_packed_chunk;

typedef struct olx_packed_info {
  uint64_t field_bytes;  // of the restored field file
  uint64_t packed_bytes; // of the packed file
  uint32_t chunk_count;  // 1 to OLX_PACKED_MOST_CHUNKS
  olx_packed_chunk chunks[OLX_PACKED_MOST_CHUNKS];
} olx_packed_info;

// Packs the field at `field_path` into `path`, through a temporary file that is synced and renamed. Verifies the
// checksum of each chunk, but not what maps hold (olx_field_verify); after a failure `path` is as before. The bytes
// depend only on the field, the level and the version of zstd. Takes some 20 MiB of memory a thread, whatever the
// field's size. OLX_ERROR_ARGUMENT for settings out of range, OLX_ERROR_UNSUPPORTED for a field with more chunks than
// OLX_PACKED_MOST_CHUNKS, and the errors of olx_field_open for a damaged field. `info` may be NULL.
olx_result olx_field_pack(const char *field_path, const olx_pack_settings *settings, const char *path,
                          const olx_progress *progress, olx_packed_info *info);

typedef struct olx_unpack_settings {
  uint64_t most_bytes; // a larger field file is refused before space is reserved for it; default 2^35
  uint32_t threads;    // 0, the default: as many as the machine has
} olx_unpack_settings;

olx_unpack_settings olx_unpack_settings_default(void);

// Restores the field file that was packed into `packed_path`, through a temporary file that is synced and renamed.
// `path` may be NULL: then everything is checked and nothing written. Takes some 3 MiB of memory a thread, whatever the
// file says. OLX_ERROR_FORMAT or OLX_ERROR_CHECKSUM for a damaged file, OLX_ERROR_UNSUPPORTED for a field larger than
// settings->most_bytes. `info` may be NULL.
olx_result olx_field_unpack(const char *packed_path, const olx_unpack_settings *settings, const char *path,
                            const olx_progress *progress, olx_packed_info *info);

// Returns whether a file begins like a packed field; false when it cannot be read.
bool olx_is_packed_field(const char *path);

// Reads the description of a packed file and checks its header and its tables. Does not read the chunks.
olx_result olx_packed_describe(const char *path, olx_packed_info *info);

// ---- Maps as pictures.

// The values of a map, linear, as 32-bit floats. A texel of a light field probe holds the surface that the ray through
// its middle meets.
typedef enum olx_map {
  // Maps of light field probes.
  OLX_MAP_DISTANCE = 0,    // metres, infinite for the sky
  OLX_MAP_EMITTER,         // 1 where the texel sees an emitter or the sky, else 0
  OLX_MAP_NORMAL,          // unit vector on the probe's side; arbitrary for the sky
  OLX_MAP_BASE_COLOR,      // 0 to 1
  OLX_MAP_ROUGHNESS,       // perceptual, 0 to 1
  OLX_MAP_METALLIC,        // 0 to 1
  OLX_MAP_SPECULAR_WEIGHT, // 0 to 1
  OLX_MAP_DIRECT,          // irradiance directly from emitters, W/m^2
  OLX_MAP_INDIRECT,        // irradiance from surfaces, W/m^2
  OLX_MAP_EMISSION,        // radiance of emitters and of the sky, W/(sr m^2)
  OLX_MAP_RADIANCE,        // as the probe saw it, W/(sr m^2); needs probe light
  // Maps of irradiance probes, in a field with probe light.
  OLX_MAP_IRRADIANCE,           // of a surface that faces in that direction, W/m^2; spherical harmonics are evaluated
  OLX_MAP_MEAN_DISTANCE,        // metres; the sky counts as the distance scale
  OLX_MAP_MEAN_SQUARE_DISTANCE, // square metres
  OLX_MAP_CLASSIC_IRRADIANCE,   // W/m^2; these six need classic maps (irradiance probes without visibility)
  OLX_MAP_CLASSIC_RADIANCE_0,   // prefiltered for a roughness of 0, W/(sr m^2)
  OLX_MAP_CLASSIC_RADIANCE_1,   // for 1/4
  OLX_MAP_CLASSIC_RADIANCE_2,   // for 1/2
  OLX_MAP_CLASSIC_RADIANCE_3,   // for 3/4
  OLX_MAP_CLASSIC_RADIANCE_4,   // for 1
  // Map of the irradiance volume's probes: their spherical harmonics, evaluated in 32 x 32 directions.
  OLX_MAP_VOLUME_IRRADIANCE, // W/m^2
  OLX_MAP_COUNT
} olx_map;

// Returns a map's name, "distance", "emitter", ... like the enumerators; "unknown" for any other value.
const char *olx_map_name(olx_map map);

// The arrangement of directions in a picture, row 0 at the top. Each pixel holds the texel of the map into which the
// direction of the pixel's middle falls.
typedef enum olx_map_projection {
  OLX_PROJECTION_OCTAHEDRAL = 0, // the map as it is stored, n x n texels without border (docs/format.md, "Maps")
  OLX_PROJECTION_LATLONG,        // 2 n x n: +y at the top, -x at the left edge, +x in the middle, +z three quarters
                                 // across, as environments of scenes have it
  OLX_PROJECTION_CUBE            // n x 6 n: the faces +x, -x, +y, -y, +z, -z below one another, each as OpenGL's cube
                                 // maps have it
} olx_map_projection;

// Returns a projection's name: "octahedral", "latlong" or "cube".
const char *olx_map_projection_name(olx_map_projection projection);

typedef struct olx_map_picture {
  olx_map map;
  olx_map_projection projection;
  uint32_t probe; // index among the map's kind of probes
  uint32_t size;  // n of latlong and cube, 1 to 2048; 0, the default: the map's own for latlong, half of it for cube.
                  // Octahedral: 0, or the map's own
} olx_map_picture;

// Writes a map as an .exr with channels R, G, B (of normals x, y, z), or Y for a single number, through a temporary
// file that is synced and renamed. *width and *height receive the size in pixels; either may be NULL.
// OLX_ERROR_ARGUMENT for a map or a probe that the field does not have, and for a size out of range.
olx_result olx_export_map(const olx_field *field, const olx_map_picture *picture, const char *path, uint32_t *width,
                          uint32_t *height);

// ---- A model of a field's contents.

// The numbers of written nodes and elements.
typedef struct olx_gltf_counts {
  uint32_t probes, irradiance_probes; // nodes
  uint32_t volume_probes, volume_cells;
  uint32_t bricks, divided_bricks;
} olx_gltf_counts;

// Writes probes, irradiance volume and bricks as a .gltf (2.0, embedded buffers) to look at, in metres of scene
// coordinates, so that it lies over the scene. Below one node are
// - "light field probes" and "irradiance probes": a node for each, an octahedron at its position, red inside geometry
// - "irradiance volume": the octahedra of its probes in one mesh, coloured by their mean irradiance over pi, cut at 1;
//   and the edges of its cells
// - "bricks": the edges of bricks that list a probe, whole and divided bricks apart
// What a field does not have is left out. Written through a temporary file that is synced and renamed, or to a stream.
// `counts` may be NULL.
olx_result olx_export_gltf(const olx_field *field, const char *path, olx_gltf_counts *counts);

// ---- Irradiance volumes of other engines: light for moving objects and surfaces on a regular grid of ambient cubes
// (Mitchell 2006), in the layout that Bevy's irradiance volumes read (docs/exporting.md, "An irradiance volume").

#define OLX_CUBES_MOST_TEXELS 2048       // of the texture, along each axis
#define OLX_CUBES_MOST_VOXELS (1u << 20) // of a volume

typedef struct olx_cubes_settings {
  uint32_t size[3];     // voxels along x, y and z; all 0, the default: from spacing_metres
  float spacing_metres; // side of a voxel, or 0, the default: 1/32 of the longest side of the scene's bounds; with
                        // `size` 0
  bool fit;             // fit the voxels to the surfaces that probes see; default true
  bool zstd;            // compress the texels by Zstandard, which a loader undoes; default false
  uint32_t threads;     // 0, the default: as many as the machine has; the bytes do not depend on it
} olx_cubes_settings;

olx_cubes_settings olx_cubes_settings_default(void);

// The transform of a volume takes the unit cube about 0 to its box: translation + scale * p.
typedef struct olx_cubes_info {
  uint32_t size[3];      // voxels along x, y and z; the texture has size[0] x 2 size[1] x 3 size[2] texels
  double translation[3]; // metres of scene coordinates, y up: the middle of the box
  double scale[3];       // metres: its sides
  uint32_t inside;       // voxels whose centres are not in free space
  uint32_t points;       // on surfaces, to which the voxels were fitted or compared
  // Relative MSE of look-ups at these points, sum (a - b)^2 / sum b^2: of what was captured at the voxels' centres, and
  // of what was written.
  double captured_error, written_error;
  uint64_t file_bytes;
} olx_cubes_info;

// Writes a field's indirect light as a KTX 2.0 file: a 3D texture of RGB9E5 texels without mipmaps. Each holds
// irradiance over pi in W/(sr m^2), which is the radiance of a white surface. Voxel (x, y, z) is in the texels (x, y,
// z) of six parts: those of the axes x, y and z begin at 0, size[2] and 2 size[2] along z, and in each of them surfaces
// that face along the axis begin at 0 along y, and those that face against it at size[1]. The key "octalux.volume" has
// the transform as JSON.
//
// The engine interpolates between voxels whatever lies between them. So voxels are fitted: look-ups come closest, by
// least squares, to the light that light field probes store for surfaces and that the irradiance volume has in free
// space. Voxels inside geometry get the light of their neighbours, and of the surfaces around them.
//
// With settings->spacing_metres the box has the scene's bounds, enlarged about their middle to whole voxels; with
// settings->size it has those bounds, and voxels of any shape. Both have a margin of 1/1024 of the longest side, so
// that surfaces at the bounds are inside. Written through a temporary file that is synced and renamed, or to a stream.
// OLX_ERROR_ARGUMENT for a field without an irradiance volume, for sizes out of range, and when no voxel has its centre
// in free space. `info` may be NULL.
olx_result olx_export_ktx2(const olx_field *field, const olx_cubes_settings *settings, const char *path,
                           const olx_progress *progress, olx_cubes_info *info);

// ---- Scenes and files for other renderers, such as browsers (docs/web.md).

// Writes the contents of a scene as a .glb (glTF 2.0): triangles by material, with embedded textures; emission,
// specular weight and lights without area by KHR_materials_emissive_strength, KHR_materials_specular and
// KHR_lights_punctual; cameras. Positions are in metres relative to the scene's origin, so that the model lies over the
// scene's field. The scene's "extras" have its hash, its origin and the radiance of its sky. Textures are PNG; colours
// of opaque surfaces are JPEG of quality 92 where that takes less than half as much, as photographs do. Height maps,
// alpha textures of their own and images of environments are left out. Written through a temporary file that is synced
// and renamed, and compressed by gzip where the path ends in ".gz". OLX_ERROR_UNSUPPORTED beyond 4 GiB, the most for
// a .glb. file_bytes may be NULL.
olx_result olx_export_scene(const olx_scene *scene, const char *path, uint64_t *file_bytes);

// Writes a copy of a file compressed by gzip, which browsers unpack, through a temporary file that is synced and
// renamed. file_bytes, which may be NULL, receives the size of the copy. The bytes depend only on the file and the
// version of zlib.
olx_result olx_export_gzip(const char *from, const char *path, uint64_t *file_bytes);

// Writes the part of a field that diffuse light needs, compressed by gzip, through a temporary file that is synced and
// renamed: positions, geometry, indirect light, bricks and the irradiance volume, each filtered so that gzip leaves
// less of it (docs/web.md). The browser package reads it and draws no reflections; olx_field_open refuses it.
// file_bytes, which may be NULL, receives the size of the file.
olx_result olx_export_diffuse_gzip(const olx_field *field, const char *path, uint64_t *file_bytes);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
