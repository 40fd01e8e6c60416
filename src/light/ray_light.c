// Follows a ray through specular reflections to the first diffuse lobe that it chooses, and shades that lobe from the
// solved light.
#include "light/ray_light.h"

#include "scene/bvh.h"

enum { MOST_SPECULAR = 4 }; // surfaces that may pass a ray on before it is dropped

// Returns the light that the diffuse lobe reflects.
static olx_vec3 diffuse_light(const olx_scene *scene, const olx_scene_light *light, float indirect,
                              const olx_ray_hit *hit, const olx_surface *surface, olx_vec3 reflectance,
                              olx_sampler *sampler, uint64_t *rays) {
  if (olx_max3(reflectance) <= 0.0f) return olx_splat(0.0f);
  const olx_vec3 direct = olx_direct_irradiance(scene, surface, sampler, rays);
  olx_surface smooth = *surface;
  smooth.shading_normal = olx_surface_vertex_normal(scene, hit, surface);
  const olx_vec3 irradiance = olx_madd(direct, olx_scene_light_irradiance_before(light, &smooth), indirect);
  return olx_scale(olx_mul(irradiance, reflectance), 1.0f / OLX_PI);
}

olx_vec3 olx_ray_light(const olx_scene *scene, const olx_scene_light *light, uint32_t bounces, const olx_ray *first,
                       const olx_ray_hit *met, olx_sampler *sampler, uint64_t *rays) {
  olx_vec3 sum = {0}, throughput = olx_splat(1.0f), origin = first->origin;
  olx_lobe_ray lobe = {.direction = first->direction};
  olx_ray_hit hit = *met;
  const uint32_t most = bounces < MOST_SPECULAR ? bounces : MOST_SPECULAR;
  const float further = 1.0f - (float)olx_scene_light_describe(light).last_bounce;
  float indirect = 1.0f;
  for (uint32_t i = bounces; i < olx_scene_light_bounces(light); i++) indirect *= further;
  for (uint32_t passed = 0; passed <= most; passed++) {
    if (hit.triangle == OLX_NO_HIT) {
      return passed ? olx_add(sum, olx_mul(throughput, olx_sky_found(scene, &lobe))) : sum;
    }
    const olx_surface surface = olx_surface_at(scene, &hit, lobe.direction);
    if (passed) sum = olx_add(sum, olx_mul(throughput, olx_emission_found(scene, &surface, origin, &lobe)));
    if (passed == bounces) break;
    const olx_shading shading = olx_shading_make(&surface, lobe.direction);
    const float share = shading.has_specular ? shading.specular_share : 0.0f;
    if (share <= 0.0f || (shading.has_diffuse && olx_sampler_next(sampler) >= share)) {
      const olx_vec3 reflectance = olx_scale(shading.diffuse, 1.0f / (1.0f - share));
      const olx_vec3 light_back = diffuse_light(scene, light, indirect, &hit, &surface, reflectance, sampler, rays);
      return olx_add(sum, olx_mul(throughput, light_back));
    }
    if (passed == most) break;
    indirect *= further;
    throughput = olx_scale(throughput, 1.0f / share);
    const olx_lobes lit = olx_direct_light_sampled(scene, &shading, OLX_MIS_EACH_LOBE, sampler, rays);
    sum = olx_add(sum, olx_mul(throughput, lit.specular));
    lobe = olx_lobe_ray_specular(&shading, olx_sampler_next2(sampler));
    throughput = olx_mul(throughput, lobe.weight);
    if (olx_max3(throughput) <= 0.0f) break;
    const olx_ray ray = olx_surface_ray(&surface, lobe.direction, INFINITY);
    origin = surface.position;
    ++*rays;
    hit = olx_bvh_intersect(scene->bvh, &ray);
  }
  return sum;
}
