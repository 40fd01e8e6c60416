// A scene in memory: flat arrays of triangles, materials, textures and lights, and the ray caster over them.
#ifndef OLX_SCENE_SCENE_DATA_H
#define OLX_SCENE_SCENE_DATA_H

#include "core/vec.h"

#include <octalux/scene.h>

#define OLX_NO_TEXTURE UINT32_MAX

// 8-bit RGBA texels, rows from v = 0 upwards as glTF has them (the importer flips OBJ's). Wraps around.
typedef struct olx_texture {
  uint32_t width, height;
  uint8_t *texels;
  bool srgb; // colour channels are sRGB-encoded (alpha never is)
} olx_texture;

typedef struct olx_material {
  char name[128];
  olx_vec3 base_color; // linear, at most 0.95 (clamped at import, texture included at lookup)
  float metallic, roughness;
  float specular_weight; // 0: exactly Lambertian; 1: a dielectric with F0 = 0.04
  olx_vec3 emission;     // radiance
  bool emits_both_sides;
  float alpha_cutoff;    // surfaces whose alpha lies below are absent; 0: never
  float alpha;           // factor of the texture's alpha
  uint32_t base_color_texture;         // RGB colour, A alpha
  uint32_t alpha_texture;              // A channel of its own (MTL map_d, in R), or none
  uint32_t metallic_roughness_texture; // G roughness, B metallic
  uint32_t emission_texture;
  uint32_t normal_texture; // tangent space
  float normal_scale;
  bool rectangle_light;  // the surface of a lamp: "*" of a description does not mean it
  bool normal_is_height; // the normal texture is a height map (MTL bump), scaled by normal_scale
} olx_material;

typedef enum olx_light_type { OLX_LIGHT_SUN, OLX_LIGHT_POINT, OLX_LIGHT_SPOT } olx_light_type;

// Lights without area. Rectangles become emissive triangles at import.
typedef struct olx_light {
  olx_light_type type;
  olx_vec3 position;  // point, spot
  olx_vec3 direction; // of travel, unit: sun, spot
  olx_vec3 emission;  // sun: irradiance on a surface facing it; point, spot: radiant intensity
  float cosine_inner, cosine_outer; // spot: full light inside, none outside, smooth between
} olx_light;

// Light from infinitely far away: a constant radiance, times an image when there is one.
typedef struct olx_environment {
  olx_vec3 radiance; // constant part; with an image, its gain in each channel
  uint32_t width, height;
  float *texels; // RGB, latitude-longitude, row 0 at +y; NULL without image
  float rotation_radians;
} olx_environment;

typedef struct olx_box {
  olx_vec3 min, max;
} olx_box;

// What the description demands of probes, whoever places them.
typedef struct olx_probe_rules {
  olx_vec3 *pinned; // probes that are always there
  olx_box *forbidden; // boxes that no other probe may stand in
  uint32_t pinned_count, forbidden_count;
  bool has_playable;
  olx_box playable;   // the box that matters
  float min_distance; // metres from other probes and from surfaces
} olx_probe_rules;

typedef struct olx_bvh olx_bvh;
typedef struct olx_emitters olx_emitters;

struct olx_scene {
  uint32_t vertex_count, triangle_count;
  olx_vec3 *positions, *normals; // a vertex; normals unit
  olx_vec2 *uvs;
  uint32_t *indices;        // three a triangle
  uint32_t *material_index; // one a triangle
  uint32_t material_count, texture_count, light_count, camera_count;
  olx_material *materials;
  olx_texture *textures;
  olx_light *lights;
  olx_camera *cameras;
  olx_environment environment;
  uint32_t area_light_count; // rectangles of the description and emissive materials in use, for the count of lights
  bool has_probe_volume, has_probe_count;
  olx_vec3 probes_min, probes_max;
  uint32_t probes_count[3];
  olx_probe_rules probe_rules;
  olx_vec3 bounds_min, bounds_max;
  uint64_t hash;
  char **warnings;
  uint32_t warning_count;
  olx_bvh *bvh;           // bvh.h
  olx_emitters *emitters; // emitters.h
};

// Record a warning (printf-style) and log it. After 32 of one kind of trouble importers count instead of repeating.
void olx_scene_warn(olx_scene *scene, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
