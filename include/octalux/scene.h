// Scenes: triangles, materials, lights, environment and cameras, from glTF, OBJ, JSON descriptions (docs/scenes.md) or
// built in. Right-handed, Y up, metres. Part of liboctalux-bake.
//
// Positions are relative to the scene's origin (olx_scene_info.origin) wherever this and the other headers give or take
// them: of triangles, lights, cameras, probes, bounds. It is 0 in scenes that hold the origin of coordinates or lie
// near it, within 16 of their diagonals; else near the middle of the bounds. Only files have scene coordinates. So a
// scene 10^7 m away is baked and drawn as exactly as one at 0.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_SCENE_H
#define OCTALUX_SCENE_H

#include <octalux/base.h>
#include <octalux/field.h>
#include <octalux/relight.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_scene olx_scene;

typedef struct olx_camera {
  char name[64];
  olx_vec3 eye, target, up;
  float fov_y_degrees; // vertical field of view
} olx_camera;

typedef struct olx_scene_info {
  uint64_t triangles, vertices;
  uint32_t materials, textures, lights, cameras;
  uint32_t warnings; // things skipped or clamped at import
  double origin[3];  // in scene coordinates, metres
  olx_vec3 bounds_min, bounds_max;
  bool has_probe_volume; // the description names probes.min and probes.max
  uint64_t hash;         // of geometry, materials, textures, lights and environment
} olx_scene_info;

// Limits on what a model or a whole scene takes. A file of a megabyte can describe gigabytes, so each of these is
// counted before memory or time is spent on it, and a file that goes beyond one is refused with a message that names
// the file, the element, the number found and the limit. Raise a limit for a file that is trusted and needs more. A
// limit of 0 is the default.
typedef struct olx_scene_limits {
  uint64_t
      triangles;   // of the scene, those of instances counted each time; default 2^26, about 6 GiB while they are read
  uint64_t texels; // of all images of the scene, 4 bytes each in memory (an environment 12); default 2^29
  uint32_t
      polygon_corners; // of one polygon of an OBJ file, whose triangulation takes their square in time; default 2048
  uint32_t materials;  // of the scene, some 36 KiB each while an MTL file is read; default 8192
  uint32_t nodes;      // of one model: glTF nodes and primitives, or OBJ objects, groups and changes of material, of
                       // which each takes some 3 KiB while it is read; default 32768
} olx_scene_limits;

// Instructions by which rays are cast. What they find differs a little between these sets, so that machines which are
// to make the same bytes have to use the same one.
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
  // Read files that a model names (buffers, material files, images) wherever they lie. Without it they must lie in the
  // folder that the model's folder is in, or below that; links are followed first. Default false. What a description
  // names, and a description itself, is read from anywhere.
  bool allow_outside;
  olx_instructions instructions; // default OLX_INSTRUCTIONS_BEST; OLX_ERROR_UNSUPPORTED where the processor does not have them
} olx_scene_load_settings;

olx_scene_load_settings olx_scene_load_settings_default(void);

// Load `name`: "builtin:NAME", or the path of a .gltf, .glb, .obj, .json or .olxs file. A model named by a description
// is looked for beside it and in each folder of the environment variable OCTALUX_SCENES. On success *scene is the
// caller's.
olx_result olx_scene_load(const char *name, olx_scene **scene);
// Loads a scene by `settings`; NULL stands for the defaults. OLX_ERROR_UNSUPPORTED: a limit was exceeded, or a file
// lies outside.
olx_result olx_scene_load_with(const char *name, const olx_scene_load_settings *settings, olx_scene **scene);

// Write everything in a scene as one .olxs file (docs/cooked.md): beside, synced, renamed. It loads fast, has the same
// hash, and gives the same bakes and pictures to the last bit. file_bytes may be NULL.
olx_result olx_scene_cook(const olx_scene *scene, const char *path, uint64_t *file_bytes);
// Load an .olxs file. A program that loads scenes by this call alone needs Embree, but no importer's library.
olx_result olx_scene_load_cooked(const char *path, olx_scene **scene);

// Whether `path` leads to one of the files that the scene was read from (its description, models, buffers, images), by
// device and inode. olx_scene_cook and olx_bake refuse to write there.
bool olx_scene_was_read_from(const olx_scene *scene, const char *path);

// NULL is allowed.
void olx_scene_free(olx_scene *scene);

olx_scene_info olx_scene_describe(const olx_scene *scene);

// A warning about something that was skipped or clamped at import, index < warnings; NULL for another index. Lives as
// long as the scene.
const char *olx_scene_warning(const olx_scene *scene, uint32_t index);

// A camera of the scene, index < cameras; one without a name, all of whose numbers are 0, for another index.
olx_camera olx_scene_camera(const olx_scene *scene, uint32_t index);

// Finds the camera of that name; NULL finds the first, or, in a scene without cameras, makes one that sees the whole
// scene.
olx_result olx_scene_find_camera(const olx_scene *scene, const char *name, olx_camera *camera);

// The grid a bake uses: the description's probe volume, or the bounds inset by half a cell. `count` replaces the
// description's counts; NULL keeps them (4 x 4 x 4 when there are none).
olx_result olx_scene_probe_grid(const olx_scene *scene, const uint32_t count[3], olx_grid *grid);

// Names of the built-in scenes, index from 0; NULL past the last.
const char *olx_builtin_name(uint32_t index);

// ---- Relighting (octalux/relight.h) by a scene's lights and triangles.

// Lights as a relighter takes them: at most `most` of them, rectangles and other surfaces that shine as triangles, the
// environment as a sky. *count receives how many there are. OLX_ERROR_UNSUPPORTED when there are more, or an image for
// an environment.
olx_result olx_scene_relight_lights(const olx_scene *scene, olx_relight_light *lights, uint32_t most, uint32_t *count);

// An olx_occlusion; `scene` is the olx_scene whose triangles lie on the rays.
void olx_scene_occlusion(void *scene, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded);

// ---- What a scene consists of, for renderers that draw it their own way (viewer/).

#define OLX_NO_TEXTURE UINT32_MAX

// A number of bounces: all of the light.
#define OLX_BOUNCES_INFINITE UINT32_MAX

// 8-bit RGBA texels, rows from v = 0 upwards as glTF has them. Wraps around.
typedef struct olx_texture {
  uint32_t width, height;
  uint8_t *texels;
  bool srgb; // colour channels are sRGB-encoded (alpha never is)
} olx_texture;

// Textures of a material, as bits.
typedef enum olx_texture_slot {
  OLX_SLOT_BASE_COLOR = 1,
  OLX_SLOT_ALPHA = 2,
  OLX_SLOT_METALLIC_ROUGHNESS = 4,
  OLX_SLOT_EMISSION = 8,
  OLX_SLOT_NORMAL = 16
} olx_texture_slot;

typedef struct olx_material {
  char name[128];
  olx_vec3 base_color; // linear, at most 0.95 (clamped at import; a texture times it, where it is looked up)
  float metallic, roughness;
  float specular_weight; // 0: exactly Lambertian; 1: a dielectric with F0 = 0.04
  olx_vec3 emission;     // radiance
  bool emits_both_sides;
  float alpha_cutoff;                  // surfaces whose alpha lies below are absent; 0: never
  float alpha;                         // factor of the texture's alpha
  uint32_t base_color_texture;         // RGB colour, A alpha
  uint32_t alpha_texture;              // A channel of its own (MTL map_d, in R), or none
  uint32_t metallic_roughness_texture; // G roughness, B metallic
  uint32_t emission_texture;
  uint32_t normal_texture; // tangent space: x along increasing u, y along decreasing v
  float normal_scale;
  bool rectangle_light;  // the surface of a lamp: "*" of a description does not mean it
  bool normal_is_height; // the normal texture is a height map (MTL bump) in texels, scaled by normal_scale
  bool vertex_colors;    // the colours of vertices multiply the base colour
  uint32_t second_uvs;   // olx_texture_slot bits of the textures that are looked up by second_uvs
} olx_material;

typedef enum olx_light_type { OLX_LIGHT_SUN = 0, OLX_LIGHT_POINT = 1, OLX_LIGHT_SPOT = 2 } olx_light_type;

// Lights without area. Rectangles become emissive triangles at import.
typedef struct olx_light {
  olx_light_type type;
  olx_vec3 position;                // point, spot
  olx_vec3 direction;               // of travel, unit: sun, spot
  olx_vec3 emission;                // sun: irradiance on a surface facing it; point, spot: radiant intensity
  float cosine_inner, cosine_outer; // spot: full light inside, none outside, smooth between
} olx_light;

// Light from infinitely far away: a constant radiance, times an image when there is one.
typedef struct olx_environment {
  olx_vec3 radiance; // constant part; with an image, its gain in each channel
  uint32_t width, height;
  float *texels; // RGB, latitude-longitude, row 0 at +y; column 0 begins at -x, the middle is +x; NULL without image
  float rotation_radians;
} olx_environment;

// Every triangle is seen, and blocks light, from both sides; the order of its corners says which is in front, and
// decides who emits.
typedef struct olx_scene_content {
  uint32_t vertex_count, triangle_count, material_count, texture_count, light_count, camera_count;
  const olx_vec3 *positions, *normals; // a vertex; normals unit where a triangle uses them
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
  const olx_light *lights;
  const olx_camera *cameras;
  const olx_environment *environment;
  double origin[3]; // as olx_scene_info has it
  olx_vec3 bounds_min, bounds_max;
  uint64_t hash; // as olx_scene_info has it
} olx_scene_content;

// Everything lies in the scene, and lives as long as it.
olx_scene_content olx_scene_get_content(const olx_scene *scene);

// The content of an .olxs file alone, without what casts rays: the program needs neither Embree nor any importer's
// library. On success *content is the caller's to free.
olx_result olx_scene_content_load(const char *path, olx_scene_content **content);
// NULL is allowed. Only for what olx_scene_content_load gave.
void olx_scene_content_free(olx_scene_content *content);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
