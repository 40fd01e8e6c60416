// What a ray finds: the surface at a hit with its textures looked up.
#ifndef OLX_SCENE_SURFACE_H
#define OLX_SCENE_SURFACE_H

#include "core/bsdf.h"
#include "scene/ray.h"
#include "scene/scene_data.h"

typedef struct olx_surface {
  olx_vec3 position;         // computed from the triangle's corners, not from the ray, and so exact to rounding
  olx_vec3 geometric_normal; // unit, towards where the ray came from: all tests of sides use it
  olx_vec3 shading_normal;   // unit, interpolated or mapped, on the same side; only shades
  bool back_face;            // the ray came from the side away from the triangle's winding
  olx_vec3 base_color;
  float metallic;
  olx_bsdf bsdf;
  olx_vec3 emission; // towards where the ray came from: 0 on the dark side of a one-sided emitter
  float roughness;
  float epsilon;   // length by which to move off the surface along the geometric normal, from the rounding of position
  olx_vec3 inward; // at most epsilon long, to the triangle's middle: rays start so far from its edges, where walls meet
  uint32_t triangle, material;
} olx_surface;

// Everything at the hit of a ray with direction `direction` (unit).
olx_surface olx_surface_at(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction);

// Finds the surface as olx_surface_at does, faster when `previous` (may be NULL) lies on the same triangle: what does
// not vary over the triangle is taken from there.
olx_surface olx_surface_near(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction,
                             const olx_surface *previous);

// The normal between those of the triangle's corners, without a normal map, at the hit that `surface` is of; on its
// side.
olx_vec3 olx_surface_vertex_normal(const olx_scene *scene, const olx_ray_hit *hit, const olx_surface *surface);

// The albedo at another hit on the material of `surface`, when its colour alone varies; false when other things do.
bool olx_surface_albedo(const olx_scene *scene, const olx_ray_hit *hit, const olx_surface *surface, olx_vec3 *albedo);

// Whether the triangle's surface is there at those barycentric coordinates (alpha mask).
bool olx_surface_present(const olx_scene *scene, uint32_t triangle, float u, float v);

// Radiance that leaves the triangle on a side that shines.
olx_vec3 olx_surface_emission(const olx_scene *scene, uint32_t triangle, float u, float v);

// Length by which points computed on the triangle may be off: a share of its largest coordinate, never an absolute
// length.
float olx_surface_epsilon(const olx_scene *scene, uint32_t triangle);

// A ray that leaves `position` on the side of the geometric normal that `direction` points to, without meeting its own
// surface.
olx_ray olx_surface_ray(const olx_surface *surface, olx_vec3 direction, float t_max);
// A ray from the surface to another point, stopping short of it by `epsilon_end`; direction is unit.
olx_ray olx_surface_ray_to(const olx_surface *surface, olx_vec3 point, float epsilon_end);

// Whether the triangle's material emits at all, somewhere on it: cheaper to know than the emission of a place.
static inline bool olx_triangle_may_emit(const olx_scene *scene, uint32_t triangle) {
  return olx_max3(scene->materials[scene->material_index[triangle]].emission) > 0.0f;
}

#endif
