// The layout of a cooked scene, shared by its writer and its reader. docs/cooked.md is the specification.
#ifndef OLX_SCENE_COOKED_FORMAT_H
#define OLX_SCENE_COOKED_FORMAT_H

#include "core/chunk_file.h"

#include <octalux/base.h>

#define OLX_COOKED_KIND                                                                                                \
  ((olx_file_kind){.magic = "\x89OXS\r\n\x1a\n", .version = 1, .noun = "cooked scene", .remedy = "; cook it again"})

enum { OLX_COOKED_MAX_TEXTURE_SIZE = 16384, OLX_COOKED_MAX_WARNING_BYTES = 1 << 24 };

// Bits of olx_cooked_info.probe_flags, olx_cooked_material.flags and olx_cooked_texture.flags.
enum { OLX_COOKED_PROBE_VOLUME = 1, OLX_COOKED_PROBE_COUNT = 2, OLX_COOKED_PLAYABLE = 4 };
enum {
  OLX_COOKED_EMITS_BOTH_SIDES = 1,
  OLX_COOKED_NORMAL_IS_HEIGHT = 2,
  OLX_COOKED_VERTEX_COLORS = 4,
  OLX_COOKED_SPECULAR_IN_ALPHA = 8,
  OLX_COOKED_BLENDED = 16
};
enum { OLX_COOKED_SECOND_UVS_SHIFT = 8, OLX_COOKED_SECOND_UVS = 31 << OLX_COOKED_SECOND_UVS_SHIFT };
enum { OLX_COOKED_SRGB = 1 };

typedef struct olx_cooked_info {
  uint32_t vertices, triangles, materials, textures, lights, cameras;
  uint32_t environment_width, environment_height; // 0 without an image
  float environment_radiance[3];
  float environment_rotation_radians;
  uint32_t pinned, forbidden;
  uint32_t probe_flags;
  uint32_t probes_count[3];
  float probes_min[3], probes_max[3];
  float playable_min[3], playable_max[3];
  float min_distance;
  uint32_t warning_count;
  uint64_t texel_code_bytes, warning_bytes;
} olx_cooked_info;

typedef struct olx_cooked_material {
  char name[128]; // padded with zeros
  float base_color[3];
  float metallic, roughness, specular_weight;
  float emission[3];
  float alpha, alpha_cutoff, normal_scale;
  uint32_t base_color_texture, alpha_texture, metallic_roughness_texture, emission_texture, normal_texture;
  uint32_t flags;
} olx_cooked_material;

// A texture. The code of its texels (texel_code.h) is stored in a separate chunk, texture after texture.
typedef struct olx_cooked_texture {
  uint32_t width, height;
  uint32_t channels; // 1 grey, 3 RGB, 4 RGBA
  uint32_t flags;
  uint64_t code_bytes;
} olx_cooked_texture;

typedef struct olx_cooked_light {
  uint32_t type; // 0 sun, 1 point, 2 spot
  float position[3], direction[3], emission[3];
  float cosine_inner, cosine_outer;
} olx_cooked_light;

typedef struct olx_cooked_camera {
  char name[64]; // padded with zeros
  float eye[3], target[3], up[3];
  float fov_y_degrees;
} olx_cooked_camera;

_Static_assert(sizeof(olx_cooked_info) == 144 && offsetof(olx_cooked_info, probes_min) == 72 &&
                   offsetof(olx_cooked_info, texel_code_bytes) == 128,
               "docs/cooked.md");
_Static_assert(sizeof(olx_cooked_material) == 200, "docs/cooked.md");
_Static_assert(sizeof(olx_cooked_texture) == 24, "docs/cooked.md");
_Static_assert(sizeof(olx_cooked_light) == 48, "docs/cooked.md");
_Static_assert(sizeof(olx_cooked_camera) == 104, "docs/cooked.md");

// The chunks of this version, in the order the writer lays them out.
typedef enum olx_cooked_chunk {
  OLX_COOKED_INFO = 0,
  OLX_COOKED_POSITIONS,
  OLX_COOKED_NORMALS,
  OLX_COOKED_UVS,
  OLX_COOKED_TRIANGLES,
  OLX_COOKED_TRIANGLE_MATERIALS,
  OLX_COOKED_MATERIALS,
  OLX_COOKED_TEXTURES,
  OLX_COOKED_TEXELS,
  OLX_COOKED_LIGHTS,
  OLX_COOKED_CAMERAS,
  OLX_COOKED_ENVIRONMENT,
  OLX_COOKED_PINNED,
  OLX_COOKED_FORBIDDEN,
  OLX_COOKED_WARNINGS,
  OLX_COOKED_REQUIRED,                     // number of chunks that every cooked scene has
  OLX_COOKED_ORIGIN = OLX_COOKED_REQUIRED, // present where the origin is not 0
  OLX_COOKED_SECOND_UVS_CHUNK,             // present where vertices have these attributes
  OLX_COOKED_COLORS,
  OLX_COOKED_TANGENTS,
  OLX_COOKED_CHUNKS
} olx_cooked_chunk;

void olx_cooked_shapes(const olx_cooked_info *info, olx_chunk_shape shapes[OLX_COOKED_CHUNKS]);

#endif
