// A scene in memory: flat arrays of triangles, materials, textures and lights, and the ray caster over them.
#ifndef OLX_SCENE_SCENE_DATA_H
#define OLX_SCENE_SCENE_DATA_H

#include "core/vec.h"

#include <octalux/scene.h>

typedef struct olx_box {
  olx_vec3 min, max;
} olx_box;

// Returns whether a point lies in a box or on its faces.
static inline bool olx_box_holds(const olx_box *box, olx_vec3 p) {
  return p.x >= box->min.x && p.y >= box->min.y && p.z >= box->min.z && p.x <= box->max.x && p.y <= box->max.y &&
         p.z <= box->max.z;
}

// The description's rules for probes, for every placement method.
typedef struct olx_probe_rules {
  olx_vec3 *pinned;   // probes that are always placed
  olx_box *forbidden; // boxes in which no other probe may be placed
  uint32_t pinned_count, forbidden_count;
  bool has_playable;
  olx_box playable;   // box of interest
  float min_distance; // metres from other probes and from surfaces
} olx_probe_rules;

// The greatest albedo, so that light converges.
#define OLX_MOST_ALBEDO 0.95f

typedef struct olx_bvh olx_bvh;
typedef struct olx_emitters olx_emitters;

struct olx_scene {
  olx_scene_load_settings load; // settings that the scene is loaded by; limits of 0 mean their defaults
  // All positions below are relative to this origin: local_frame.h.
  double origin[3];
  olx_box made_of; // bounds of all triangles that were added, when is_made
  bool is_made;
  uint32_t vertex_count, triangle_count;
  olx_vec3 *positions, *normals; // one per vertex; normals are unit
  olx_vec2 *uvs, *second_uvs;    // second_uvs, colors and tangents are NULL until a mesh has them
  olx_vec4 *colors, *tangents;
  uint32_t *indices;        // three per triangle
  uint32_t *material_index; // one per triangle
  uint32_t material_count, texture_count, light_count, camera_count;
  olx_material *materials;
  olx_texture *textures;
  olx_light *lights;
  olx_camera *cameras;
  olx_environment environment;
  uint32_t area_light_count; // rectangle lights of the description plus emissive materials in use
  bool has_probe_volume, has_probe_count;
  olx_vec3 probes_min, probes_max;
  uint32_t probes_count[3];
  olx_probe_rules probe_rules;
  olx_vec3 bounds_min, bounds_max;
  uint64_t hash;
  char **warnings;
  uint32_t warning_count;
  uint32_t skipping_meshes;         // of the model being read: meshes with skipped triangles
  uint64_t unreported_triangles;    // skipped ones of those meshes that no warning names
  struct olx_scene_source *sources; // sources.h
  uint32_t source_count;
  olx_bvh *bvh, *light_bvh; // bvh.h
  olx_emitters *emitters;   // emitters.h
};

// Returns the position of corner `i`, 0 to 2, of a triangle.
static inline olx_vec3 olx_scene_corner(const olx_scene *scene, uint32_t triangle, uint32_t i) {
  return scene->positions[scene->indices[3 * (size_t)triangle + i]];
}

// After so many warnings of one kind importers count them instead of repeating them.
#define OLX_MOST_WARNINGS_OF_A_KIND 32u

// Records a warning (printf-style), to be logged when the scene is loaded.
void olx_scene_warn(olx_scene *scene, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
