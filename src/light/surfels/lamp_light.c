// Lets lamps look around in a scene of triangles, and lights surfaces of it from what is near lamps.
#include "light/surfels/lamp_light.h"

#include "scene/bvh.h"
#include "scene/scene_parts.h"

enum { ALL_RAYS = 1 << 17 };

static void look(const void *user, olx_vec3 from, const olx_vec3 *directions, uint32_t count, olx_lamp_sight *sights) {
  const olx_scene *scene = user;
  const float epsilon = olx_place_epsilon(scene, from); // a surface that the lamp lies on is not in its way
  for (uint32_t i = 0; i < count; i++) {
    const olx_ray ray = {from, directions[i], epsilon, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->light_bvh, &ray);
    sights[i] = (olx_lamp_sight){.distance = INFINITY};
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface s = olx_surface_at(scene, &hit, directions[i]);
    sights[i] = (olx_lamp_sight){.distance = hit.t,
                                 .known = true,
                                 .position = olx_madd(s.position, s.geometric_normal, s.epsilon),
                                 .normal = s.geometric_normal,
                                 .albedo = olx_bsdf_lamp_albedo(&s.bsdf),
                                 .needs = olx_input_of_material(s.material)};
  }
}

olx_result olx_lamp_light_create(olx_near_lamps *lamps, const olx_scene *scene, const olx_light *lights,
                                 uint32_t count) {
  const olx_lamp_view view = {.look = look, .user = scene, .all_rays = ALL_RAYS, .rays = OLX_LAMP_RAYS};
  return olx_near_lamps_create(lamps, lights, count, &view);
}

olx_lobes olx_lamp_light(const olx_near_lamps *l, const olx_scene *scene, const olx_shading *shading,
                         olx_sampler *sampler, uint64_t *rays) {
  olx_lamp_ray ray;
  if (l->count == 0 || !olx_near_lamps_draw(l, shading->surface->position, olx_sampler_next(sampler), &ray)) {
    return (olx_lobes){0};
  }
  const olx_light_sample sample = {
      .direction = ray.direction, .target = ray.target, .delta = true, .emission = ray.irradiance, .pdf = 1.0f};
  return olx_direct_light_of(scene, shading, &sample, rays);
}

olx_vec3 olx_lamp_irradiance(const olx_near_lamps *l, const olx_scene *scene, const olx_surface *surface,
                             olx_sampler *sampler, uint64_t *rays) {
  if (l->count == 0) return olx_splat(0.0f);
  olx_surface white = *surface;
  white.bsdf = (olx_bsdf){.albedo = olx_splat(1.0f)};
  const olx_shading shading = olx_shading_make(&white, olx_negate(white.shading_normal));
  return olx_scale(olx_lamp_light(l, scene, &shading, sampler, rays).diffuse, OLX_PI);
}

olx_vec3 olx_lamp_light_found(const olx_near_lamps *l, const olx_scene *scene, const olx_surface *surface,
                              olx_vec3 direction, float distance, uint64_t *rays) {
  olx_vec3 sum = {0};
  if (!(distance < l->reach)) return sum;
  const olx_lamp_sight end = {.distance = distance,
                              .position = surface->position,
                              .normal = surface->geometric_normal,
                              .albedo = olx_bsdf_lamp_albedo(&surface->bsdf)};
  for (uint32_t i = 0; i < scene->light_count; i++) {
    const olx_light *light = &scene->lights[i];
    const olx_vec3 found = olx_near_lamps_found(l, light, i, &end, direction);
    if (!(olx_max3(found) > 0.0f)) continue;
    const olx_ray ray = olx_surface_ray_to(surface, light->position, olx_place_epsilon(scene, light->position));
    ++*rays;
    sum = olx_madd(sum, found, olx_bvh_transmittance(scene->light_bvh, &ray));
  }
  return sum;
}

bool olx_lamp_light_draw(const olx_near_lamps *l, const olx_scene *scene, olx_vec3 position, olx_sampler *sampler,
                         olx_lamp_beam *beam, uint64_t *rays) {
  olx_lamp_ray drawn;
  if (l->count == 0 || !olx_near_lamps_draw(l, position, olx_sampler_next(sampler), &drawn)) return false;
  const olx_ray ray = {position, drawn.direction, 0.0f, olx_length(olx_sub(drawn.target, position))};
  ++*rays;
  if (olx_bvh_occluded(scene->light_bvh, &ray)) return false;
  *beam = (olx_lamp_beam){drawn.direction, drawn.irradiance};
  return true;
}
