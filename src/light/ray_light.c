// Follows a ray through specular reflections to the first diffuse lobe that it chooses, and shades that lobe from the
// solved light.
#include "light/ray_light.h"

#include "light/surfels/light_surfels.h"
#include "scene/bvh.h"

enum { MOST_SPECULAR = 4 }; // surfaces that may pass a ray on; the next one counts as matte

// What a ray is shaded with.
typedef struct ray_shade {
  const olx_scene *scene;
  const olx_scene_light *light;
  const olx_near_lamps *lamps; // sampled apart from the ray; NULL: they are not
  bool averaged;               // light is that of many rays together: cells may stand for the points in them
  olx_sampler *sampler;
  uint64_t *rays;
} ray_shade;

// Returns the light that the diffuse lobe reflects. `dark` may be NULL.
static olx_vec3 diffuse_light(const ray_shade *s, float indirect, const olx_ray_hit *hit, const olx_surface *surface,
                              olx_vec3 reflectance, const float *dark) {
  if (olx_max3(reflectance) <= 0.0f) return olx_splat(0.0f);
  olx_vec3 sky = {0};
  const bool has_sky = s->averaged && olx_scene_light_sky(s->light, surface, &sky);
  const olx_direct_query query = {.kinds = has_sky ? OLX_DIRECT_BUT_SKY : OLX_DIRECT_ALL, .dark = dark};
  const olx_vec3 direct = olx_add(sky, olx_direct_irradiance_of(s->scene, surface, &query, s->sampler, s->rays));
  olx_surface smooth = *surface;
  smooth.shading_normal = olx_surface_vertex_normal(s->scene, hit, surface);
  const olx_vec3 irradiance = olx_madd(direct, olx_scene_light_irradiance_before(s->light, &smooth), indirect);
  return olx_scale(olx_mul(irradiance, reflectance), 1.0f / OLX_PI);
}

// Returns the light of sampled emitters that the specular lobe reflects, and that of surfaces near lamps where they are
// sampled apart from the ray and `more` surfaces may lie between emitter and origin.
static olx_vec3 specular_light(const ray_shade *s, const olx_shading *shading, bool more) {
  const olx_vec3 found = olx_direct_light_sampled(s->scene, shading, OLX_MIS_EACH_LOBE, s->sampler, s->rays).specular;
  if (!s->lamps || !more) return found;
  return olx_add(found, olx_lamp_light(s->lamps, s->scene, shading, s->sampler, s->rays).specular);
}

static olx_vec3 follow(const ray_shade *s, uint32_t bounces, const olx_ray *first, const olx_ray_hit *met) {
  olx_vec3 sum = {0}, throughput = olx_splat(1.0f), origin = first->origin;
  olx_lobe_ray lobe = {.direction = first->direction};
  olx_ray_hit hit = *met;
  const uint32_t most = bounces < MOST_SPECULAR ? bounces : MOST_SPECULAR;
  const float further = 1.0f - (float)olx_scene_light_describe(s->light).last_bounce;
  float indirect = 1.0f;
  for (uint32_t i = bounces; i < olx_scene_light_bounces(s->light); i++) indirect *= further;
  for (uint32_t passed = 0; passed <= most; passed++) {
    if (hit.triangle == OLX_NO_HIT) {
      return passed ? olx_add(sum, olx_mul(throughput, olx_sky_found(s->scene, &lobe))) : sum;
    }
    const olx_surface surface = olx_surface_at(s->scene, &hit, lobe.direction);
    if (passed) sum = olx_add(sum, olx_mul(throughput, olx_emission_found(s->scene, &surface, origin, &lobe)));
    if (passed == bounces) break;
    olx_shading shading = olx_shading_make(&surface, lobe.direction);
    // A mirror reflects no light of points, but the rays that it reflects find their surfaces.
    shading.dark = s->lamps && !(passed && lobe.pdf <= 0.0f) ? s->lamps->radius : NULL;
    shading.least_alpha = s->lamps ? OLX_LEAST_LAMP_ALPHA : 0.0f;
    if (shading.dark) {
      const olx_vec3 near = olx_lamp_light_found(s->lamps, s->scene, &surface, lobe.direction, hit.t, s->rays);
      sum = olx_add(sum, olx_mul(throughput, near));
    }
    const bool last = passed == most;
    const float share = shading.has_specular && !last ? shading.specular_share : 0.0f;
    if (share <= 0.0f || (shading.has_diffuse && olx_sampler_next(s->sampler) >= share)) {
      const olx_vec3 reflectance =
          olx_scale(last ? olx_shading_albedo(&shading) : shading.diffuse, 1.0f / (1.0f - share));
      const olx_vec3 light_back = diffuse_light(s, indirect, &hit, &surface, reflectance, shading.dark);
      return olx_add(sum, olx_mul(throughput, light_back));
    }
    indirect *= further;
    throughput = olx_scale(throughput, 1.0f / share);
    sum = olx_add(sum, olx_mul(throughput, specular_light(s, &shading, passed + 2 <= bounces)));
    lobe = olx_lobe_ray_specular(&shading, olx_sampler_next2(s->sampler));
    throughput = olx_mul(throughput, lobe.weight);
    if (olx_max3(throughput) <= 0.0f) break;
    const olx_ray ray = olx_surface_ray(&surface, lobe.direction, INFINITY);
    origin = surface.position;
    ++*s->rays;
    hit = olx_bvh_intersect(s->scene->light_bvh, &ray);
  }
  return sum;
}

olx_vec3 olx_ray_light(const olx_scene *scene, const olx_scene_light *light, uint32_t bounces, const olx_ray *ray,
                       const olx_ray_hit *hit, olx_sampler *sampler, uint64_t *rays) {
  const ray_shade s = {.scene = scene, .light = light, .sampler = sampler, .rays = rays};
  return follow(&s, bounces, ray, hit);
}

olx_vec3 olx_ray_light_but_near_lamps(const olx_scene *scene, const olx_scene_light *light, uint32_t bounces,
                                      const olx_ray *ray, const olx_ray_hit *hit, olx_sampler *sampler,
                                      uint64_t *rays) {
  const olx_near_lamps *lamps = &olx_scene_light_open(light).surfels->lamps;
  const ray_shade s = {scene, light, lamps->count ? lamps : NULL, true, sampler, rays};
  return follow(&s, bounces, ray, hit);
}

bool olx_scene_light_beam(const olx_scene *scene, const olx_scene_light *light, olx_vec3 position, olx_sampler *sampler,
                          olx_lamp_beam *beam, uint64_t *rays) {
  return olx_lamp_light_draw(&olx_scene_light_open(light).surfels->lamps, scene, position, sampler, beam, rays);
}
