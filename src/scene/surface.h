// The surface at a ray's hit, with its textures evaluated.
#ifndef OLX_SCENE_SURFACE_H
#define OLX_SCENE_SURFACE_H

#include "core/bsdf.h"
#include "scene/ray.h"
#include "scene/scene_data.h"

typedef struct olx_surface {
  olx_vec3 position;         // computed from the triangle's corners rather than the ray, so that it is exact up to
                             // rounding
  olx_vec3 geometric_normal; // unit, towards the ray's origin: all tests of sides use it
  olx_vec3 shading_normal;   // unit, interpolated or mapped, on the same side; used only for shading
  bool back_face;            // the ray hit the back of the triangle, by its winding
  olx_vec3 base_color;
  float metallic;
  olx_bsdf bsdf;
  olx_vec3 emission; // towards the ray's origin: 0 on the dark side of a one-sided emitter
  float roughness;
  float epsilon;   // distance by which to move off the surface along the geometric normal, from the rounding of
                   // position
  olx_vec3 inward; // offset of at most epsilon towards the triangle's centre: rays start this far from its edges, where
                   // walls meet
  uint32_t triangle, material;
} olx_surface;

// Evaluates the surface at the hit of a ray with unit direction `direction`.
olx_surface olx_surface_at(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction);

// Evaluates the surface like olx_surface_at, faster when `previous` (may be NULL) lies on the same triangle: values
// that are constant over the triangle are copied.
olx_surface olx_surface_near(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction,
                             const olx_surface *previous);

// Has what olx_surface_at reads at many hits brought into the cache; nothing waits for it. Rays that end all over a
// scene read places of large arrays, each of which would otherwise be waited for.
void olx_surfaces_prefetch(const olx_scene *scene, const olx_ray_hit *hits, uint32_t count);

// Returns the interpolated vertex normal, without a normal map, at the hit of `surface`, on the same side.
olx_vec3 olx_surface_vertex_normal(const olx_scene *scene, const olx_ray_hit *hit, const olx_surface *surface);

// Returns whether the triangle's surface is opaque at those barycentric coordinates (alpha mask).
bool olx_surface_present(const olx_scene *scene, uint32_t triangle, float u, float v);
// Returns whether the surface stops a ray of light at a point. A surface of a blended material is a screen of fine holes
// for such rays: a hash of the point decides, and a share alpha of all points stops them.
bool olx_surface_stops_light(const olx_scene *scene, uint32_t triangle, float u, float v);
// Returns the share of light that the surface stops: alpha of a blended material, else 1 or 0.
float olx_surface_opacity(const olx_scene *scene, uint32_t triangle, float u, float v);

// Returns the radiance that leaves the triangle on an emitting side.
olx_vec3 olx_surface_emission(const olx_scene *scene, uint32_t triangle, float u, float v);

// Returns the error bound of points computed on the triangle: a share of its largest coordinate, never an absolute
// length.
float olx_surface_epsilon(const olx_scene *scene, uint32_t triangle);
// Returns the same bound for a single place, such as that of a lamp which lies exactly on a surface.
float olx_place_epsilon(const olx_scene *scene, olx_vec3 place);

// Returns a ray that leaves `position` on the side of the geometric normal that `direction` points to, without hitting
// its own surface.
olx_ray olx_surface_ray(const olx_surface *surface, olx_vec3 direction, float t_max);
// Returns a ray from the surface to another point, which ends `epsilon_end` before it; its direction is unit.
olx_ray olx_surface_ray_to(const olx_surface *surface, olx_vec3 point, float epsilon_end);

// Returns whether the surface at a hit emits on one of its sides, without evaluating the rest of it.
static inline bool olx_hit_emits(const olx_scene *scene, const olx_ray_hit *hit) {
  if (!(olx_max3(scene->materials[scene->material_index[hit->triangle]].emission) > 0.0f)) return false;
  return olx_max3(olx_surface_emission(scene, hit->triangle, hit->u, hit->v)) > 0.0f;
}

#endif
