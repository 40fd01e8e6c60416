// Scenes: triangles, materials, lights, environment and cameras, from glTF, OBJ, JSON descriptions (docs/scenes.md) or
// built in. Coordinates are right-handed, Y up, in metres. Part of liboctalux-bake.
//
// All positions in this and the other headers, of triangles, lights, cameras, probes and bounds, are relative to the
// scene's origin (olx_scene_info.origin). It is 0 in scenes that contain the origin of coordinates or lie near it,
// within 16 of their diagonals; otherwise it lies near the middle of the bounds. Only files have scene coordinates. So
// a scene 10^7 m away is baked and drawn as exactly as one at 0.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_SCENE_H
#define OCTALUX_SCENE_H

#include <octalux/base.h>
#include <octalux/field.h>
#include <octalux/light.h>
#include <octalux/relight.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_scene olx_scene;

typedef struct olx_camera {
  char name[64];
  olx_vec3 eye, target, up; // metres; `up` need be neither a unit vector nor perpendicular to the line of sight
  float fov_y_degrees;      // vertical field of view, above 0 and below 180
} olx_camera;

typedef struct olx_scene_info {
  uint64_t triangles, vertices;
  // `lights` counts lights without area and materials in use that emit, but not the environment.
  uint32_t materials, textures, lights, cameras;
  uint32_t warnings; // number of elements skipped or clamped at import
  double origin[3];  // in scene coordinates, metres
  olx_vec3 bounds_min, bounds_max;
  bool has_probe_volume; // the description names probes.min and probes.max
  bool has_probe_count;  // the description names probes.grid
  uint64_t hash;         // of geometry, materials, textures, lights and environment
} olx_scene_info;

// Limits on the size of a model or a whole scene. A file of a megabyte can describe gigabytes, so each of these is
// counted before memory or time is spent on it, and a file beyond a limit is refused with a message that names the
// file, the element, the number found and the limit. Raise a limit for a trusted file that needs more. A limit of 0
// means the default.
typedef struct olx_scene_limits {
  // Triangles of the scene, those of instances counted each time; the default of 2^26 takes about 6 GiB while they
  // are read.
  uint64_t triangles;
  // Texels of all images of the scene, 4 bytes each in memory, 12 of an environment; default 2^29.
  uint64_t texels;
  // Corners of one polygon of an OBJ file; its triangulation takes time in proportion to their square. Default 2048.
  uint32_t polygon_corners;
  // Materials of the scene, some 36 KiB each while an MTL file is read; default 8192.
  uint32_t materials;
  // Nodes and primitives of one glTF model, or objects, groups and changes of material of one OBJ model, some 3 KiB
  // each while it is read; default 32768.
  uint32_t nodes;
} olx_scene_limits;

// The instruction set with which rays are cast. Results differ slightly between these, so machines that must produce
// the same bytes must use the same one.
typedef enum olx_instructions {
  OLX_INSTRUCTIONS_BEST = 0, // the widest that this machine has
  OLX_INSTRUCTIONS_SSE2,
  OLX_INSTRUCTIONS_SSE42,
  OLX_INSTRUCTIONS_AVX,
  OLX_INSTRUCTIONS_AVX2,
  OLX_INSTRUCTIONS_AVX512
} olx_instructions;

typedef struct olx_scene_load_settings {
  olx_scene_limits limits;
  // Read files to which a model refers (buffers, material files, images) from anywhere. Otherwise they must lie in the
  // folder that contains the model's folder, or below it; links are followed first. Default false. A description, and
  // the files to which it refers, are read from anywhere.
  bool allow_outside;
  olx_instructions instructions; // default OLX_INSTRUCTIONS_BEST; OLX_ERROR_UNSUPPORTED where the processor lacks them
} olx_scene_load_settings;

olx_scene_load_settings olx_scene_load_settings_default(void);

// Loads `name`: "builtin:NAME", or the path of a .gltf, .glb, .obj, .json or .olxs file. A model to which a description
// refers is searched for beside it and in each folder, separated by ':', of the environment variable OCTALUX_SCENES. On
// success the caller must free *scene, on failure it is NULL. OLX_ERROR_UNSUPPORTED for another kind of name,
// OLX_ERROR_ARGUMENT for a built-in scene that does not exist, OLX_ERROR_EMPTY when there are no triangles.
olx_result olx_scene_load(const char *name, olx_scene **scene);
// Loads a scene by `settings`; NULL means the defaults. OLX_ERROR_UNSUPPORTED also when a limit was exceeded, or a file
// lies outside the allowed folders.
olx_result olx_scene_load_with(const char *name, const olx_scene_load_settings *settings, olx_scene **scene);

// Writes a whole scene as one .olxs file (docs/cooked.md), through a temporary file that is synced and renamed. It
// loads fast, has the same hash, and gives the same bakes and pictures to the last bit. file_bytes may be NULL.
olx_result olx_scene_cook(const olx_scene *scene, const char *path, uint64_t *file_bytes);
// Loads an .olxs file, with the default limits. A program that loads scenes only by this call needs Embree, but no
// importer's library. On success the caller must free *scene, on failure it is NULL. OLX_ERROR_FORMAT or
// OLX_ERROR_CHECKSUM for a damaged file, OLX_ERROR_VERSION for another version of the format.
olx_result olx_scene_load_cooked(const char *path, olx_scene **scene);

// Returns whether `path` leads to one of the files from which the scene was read (its description, models, buffers,
// images), by device and inode. olx_scene_cook and olx_bake refuse to write there.
bool olx_scene_was_read_from(const olx_scene *scene, const char *path);

// Frees a scene. NULL is allowed.
void olx_scene_free(olx_scene *scene);

olx_scene_info olx_scene_describe(const olx_scene *scene);

// Returns a warning about an element skipped or clamped at import, index < warnings; NULL for any other index. Valid as
// long as the scene.
const char *olx_scene_warning(const olx_scene *scene, uint32_t index);

// Returns a camera of the scene, index < cameras; for any other index one without a name and with all numbers 0.
olx_camera olx_scene_camera(const olx_scene *scene, uint32_t index);

// Finds the camera with a name; NULL finds the first one, or creates one that sees the whole scene where there is none.
// OLX_ERROR_ARGUMENT when no camera has the name.
olx_result olx_scene_find_camera(const olx_scene *scene, const char *name, olx_camera *camera);

// Computes the grid of a bake: the description's probe volume, or the bounds inset by half a cell. `count` replaces the
// description's counts; NULL keeps them (4 x 4 x 4 when there are none). OLX_ERROR_ARGUMENT
// for a count of 0, and for 2^32 probes or more.
olx_result olx_scene_probe_grid(const olx_scene *scene, const uint32_t count[3], olx_grid *grid);

// Returns the name of a built-in scene, index from 0; NULL past the last.
const char *olx_builtin_name(uint32_t index);

// ---- Relighting (octalux/relight.h) by a scene's lights and triangles.

// Converts the scene's lights for a relighter: at most `most` of them, rectangles and other emissive surfaces as
// triangles with the emission at their middles, the environment as a sky. *count receives the number of all lights.
// OLX_ERROR_UNSUPPORTED when there are more than `most`, or an image as environment. A relighter takes 256.
olx_result olx_scene_relight_lights(const olx_scene *scene, olx_light *lights, uint32_t most, uint32_t *count);

// Implements olx_occlusion; `scene` is the olx_scene whose triangles are tested.
void olx_scene_occlusion(void *scene, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded);

// ---- The contents of a scene, for renderers that draw it in their own way (viewer/).

#define OLX_NO_TEXTURE UINT32_MAX

// The number of bounces that means all light.
#define OLX_BOUNCES_INFINITE UINT32_MAX

// A texture of 8-bit RGBA texels. Row 0 begins at v = 0, the top of an image in glTF. It repeats beyond 0 to 1.
typedef struct olx_texture {
  uint32_t width, height;
  uint8_t *texels;
  bool srgb; // colour channels are sRGB-encoded (alpha never is)
} olx_texture;

// The textures of a material, as bits.
typedef enum olx_texture_slot {
  OLX_SLOT_BASE_COLOR = 1,
  OLX_SLOT_ALPHA = 2,
  OLX_SLOT_METALLIC_ROUGHNESS = 4,
  OLX_SLOT_EMISSION = 8,
  OLX_SLOT_NORMAL = 16
} olx_texture_slot;

typedef struct olx_material {
  char name[128];
  olx_vec3 base_color; // linear, at most 0.95 (clamped at import; the product with a texture, at lookup)
  float metallic, roughness;
  float specular_weight; // 0: exactly Lambertian; 1: a dielectric with F0 = 0.04
  olx_vec3 emission;     // radiance
  bool emits_both_sides;
  float alpha_cutoff;                  // surfaces with a smaller alpha are absent; 0: none are
  bool blended;                        // a share 1 - alpha of light passes; alpha_cutoff decides what probes see
  float alpha;                         // multiplies the texture's alpha
  uint32_t base_color_texture;         // RGB colour, A alpha
  uint32_t alpha_texture;              // an alpha channel of its own (MTL map_d, in R), or none
  uint32_t metallic_roughness_texture; // G roughness, B metallic
  uint32_t emission_texture;
  uint32_t normal_texture; // tangent space: x along increasing u, y along decreasing v
  float normal_scale;
  bool rectangle_light;   // the surface of a lamp, which "*" of a description does not match
  bool normal_is_height;  // the normal texture is a height map (MTL bump) in texels, scaled by normal_scale
  bool vertex_colors;     // the colours of vertices multiply the base colour
  bool specular_in_alpha; // A of metallic_roughness_texture multiplies the specular weight
  uint32_t second_uvs;    // olx_texture_slot bits of the textures that are looked up by second_uvs
} olx_material;

// Light from infinitely far away: a constant radiance, multiplied by an image where there is one.
typedef struct olx_environment {
  olx_vec3 radiance; // constant part; with an image, its gain in each channel
  uint32_t width, height;
  float *texels; // RGB, latitude-longitude, row 0 at +y; column 0 begins at -x, the middle is +x; NULL without image
  float rotation_radians; // added to the azimuth of a direction, atan2(z, x), before the image is looked up
} olx_environment;

// The triangles and all else of a scene. Every triangle is visible, and blocks light, from both sides, as far as its
// material is opaque; the order of its corners defines its front, the side that emits.
typedef struct olx_scene_content {
  uint32_t vertex_count, triangle_count, material_count, texture_count, light_count, camera_count;
  const olx_vec3 *positions, *normals; // one a vertex; normals are unit vectors where a triangle uses them
  const olx_vec2 *uvs;
  const olx_vec2 *second_uvs; // NULL: no material uses them
  const olx_vec4 *colors;     // linear RGB that multiplies base colours, and alpha, all 0 to 1; NULL: all 1
  const olx_vec4 *
      tangents; // unit x, y, z along increasing u; w: +1 or -1, the side of cross(normal, tangent) that v decreases to,
                // or 0: follows from uvs. NULL: all follow from uvs
  const uint32_t *indices;        // three a triangle
  const uint32_t *material_index; // one a triangle
  const olx_material *materials;
  const olx_texture *textures;
  const olx_light *lights; // suns, points and spots; lamps with an area are triangles of emissive materials
  const olx_camera *cameras;
  const olx_environment *environment;
  double origin[3]; // see olx_scene_info
  olx_vec3 bounds_min, bounds_max;
  uint64_t hash; // see olx_scene_info
} olx_scene_content;

// Returns the content of a scene; its arrays belong to the scene and are valid as long as it.
olx_scene_content olx_scene_get_content(const olx_scene *scene);

// Loads only the content of an .olxs file, without the structures for casting rays: the program needs neither Embree
// nor an importer's library. On success the caller must free *content, on failure it is NULL.
olx_result olx_scene_content_load(const char *path, olx_scene_content **content);
// Frees the content of olx_scene_content_load, and no other. NULL is allowed.
void olx_scene_content_free(olx_scene_content *content);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
