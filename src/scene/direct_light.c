// Estimates direct light at a surface by next-event estimation: samples of lights and rays drawn from the lobes share
// the work by Veach's power heuristic.
#include "scene/direct_light.h"

#include "scene/bvh.h"

olx_vec3 olx_shading_local(const olx_shading *s, olx_vec3 world) {
  return olx_v3(olx_dot(world, s->tangent), olx_dot(world, s->bitangent), olx_dot(world, s->normal));
}

static olx_vec3 to_world(const olx_shading *s, olx_vec3 local) {
  return olx_madd(olx_madd(olx_scale(s->tangent, local.x), s->bitangent, local.y), s->normal, local.z);
}

olx_shading olx_shading_make(const olx_surface *surface, olx_vec3 direction) {
  const olx_vec3 view = olx_negate(direction);
  const float cosine = olx_dot(surface->shading_normal, view);
  olx_shading s = {.surface = surface, .normal = surface->shading_normal};
  if (cosine < OLX_LEAST_VIEW_COSINE)
    s.normal = olx_normalize(olx_madd(s.normal, view, OLX_LEAST_VIEW_COSINE - cosine));
  olx_basis(s.normal, &s.tangent, &s.bitangent);
  s.view = olx_shading_local(&s, view);
  s.diffuse = olx_bsdf_diffuse(&surface->bsdf, s.view.z);
  const float diffuse = olx_luminance(s.diffuse);
  s.has_diffuse = diffuse > 0.0f;
  s.has_specular = olx_bsdf_has_specular(&surface->bsdf);
  if (s.has_specular) {
    // Keeps the probability away from 0 and 1 while both lobes exist, because the cosine to the half vector may differ
    // greatly from that to the normal.
    const float specular = olx_luminance(olx_fresnel(&surface->bsdf, s.view.z));
    s.specular_share = s.has_diffuse ? olx_clamp(specular / (specular + diffuse), 0.1f, 0.9f) : 1.0f;
  }
  return s;
}

olx_vec3 olx_shading_albedo(const olx_shading *s) {
  return olx_add(s->diffuse, olx_bsdf_specular_albedo(&s->surface->bsdf, s->view.z));
}

static float power_heuristic(float mine, float other) {
  const float ratio = other / mine; // divided first, because the squares could overflow
  return 1.0f / (1.0f + ratio * ratio);
}

static float either_pdf(const olx_shading *s, olx_vec3 light) {
  const float cosine = (1.0f - s->specular_share) * olx_max(light.z, 0.0f) * (1.0f / OLX_PI);
  const float alpha = s->surface->bsdf.alpha;
  if (!s->has_specular || alpha <= 0.0f) return cosine;
  return cosine + s->specular_share * olx_ggx_pdf(alpha, s->view, light);
}

// Reflects one light sample through both lobes, without visibility.
static olx_lobes reflect_sample(const olx_shading *s, olx_mis mis, const olx_light_sample *sample) {
  olx_lobes lobes = {0};
  const olx_vec3 light = olx_shading_local(s, sample->direction);
  if (light.z <= 0.0f || olx_dot(s->surface->geometric_normal, sample->direction) <= 0.0f) return lobes;
  const bool weighted = !sample->delta && mis != OLX_MIS_DELTA_ONLY;
  const float both = weighted && mis == OLX_MIS_ONE_LOBE ? power_heuristic(sample->pdf, either_pdf(s, light)) : 1.0f;
  if (s->has_diffuse) {
    const float cosine = light.z * (1.0f / OLX_PI);
    const float weight = weighted && mis == OLX_MIS_EACH_LOBE ? power_heuristic(sample->pdf, cosine) : both;
    lobes.diffuse = olx_scale(olx_mul(s->diffuse, sample->emission), cosine * weight);
  }
  olx_bsdf bsdf = s->surface->bsdf;
  if (s->has_specular && bsdf.alpha > 0.0f) {
    float weight = both;
    if (weighted && mis == OLX_MIS_EACH_LOBE) {
      weight = power_heuristic(sample->pdf, olx_ggx_pdf(bsdf.alpha, s->view, light));
    }
    if (sample->delta) bsdf.alpha = olx_max(bsdf.alpha, s->least_alpha);
    lobes.specular = olx_scale(olx_mul(olx_bsdf_specular(&bsdf, s->view, light), sample->emission), weight);
  }
  return lobes;
}

// Returns the share of a sample's light that reaches the surface.
static float arriving(const olx_scene *scene, const olx_surface *surface, const olx_light_sample *sample) {
  const olx_ray ray = sample->infinite ? olx_surface_ray(surface, sample->direction, INFINITY)
                                       : olx_surface_ray_to(surface, sample->target, sample->epsilon_end);
  return olx_bvh_transmittance(scene->light_bvh, &ray);
}

static olx_lobes scale_lobes(olx_lobes lobes, float factor) {
  return (olx_lobes){olx_scale(lobes.diffuse, factor), olx_scale(lobes.specular, factor)};
}

static bool is_dark(const olx_shading *s, const olx_light_sample *sample) {
  if (!s->dark || !sample->delta || sample->infinite) return false;
  const olx_vec3 way = olx_sub(sample->target, s->surface->position);
  return olx_dot(way, way) < olx_square(s->dark[sample->light]);
}

olx_lobes olx_direct_light_of(const olx_scene *scene, const olx_shading *shading, const olx_light_sample *sample,
                              uint64_t *rays) {
  const olx_lobes lobes = reflect_sample(shading, OLX_MIS_DELTA_ONLY, sample);
  if (olx_max(olx_max3(lobes.diffuse), olx_max3(lobes.specular)) <= 0.0f) return lobes;
  ++*rays;
  return scale_lobes(lobes, arriving(scene, shading->surface, sample));
}

// Draws a light of a group; the sky's by the surface's guide. *random receives the numbers that the sky was drawn by.
static bool draw_light(const olx_scene *scene, const olx_shading *s, uint32_t group, olx_vec2 *random, float pick,
                       olx_light_sample *sample) {
  float density = 1.0f;
  if (s->sky && olx_emitters_group_is_sky(scene, group)) *random = olx_sky_guide_warp(s->sky, *random, &density);
  if (!olx_emitters_sample(scene, group, s->surface->position, *random, pick, sample)) return false;
  sample->pdf *= density;
  sample->emission = olx_scale(sample->emission, 1.0f / density);
  return true;
}

static bool is_counted(const olx_scene *scene, olx_direct_kinds kinds, uint32_t group) {
  return kinds == OLX_DIRECT_ALL || olx_emitters_group_is_sky(scene, group) == (kinds == OLX_DIRECT_SKY);
}

olx_lobes olx_direct_light_sampled(const olx_scene *scene, const olx_shading *shading, olx_mis mis,
                                   olx_sampler *sampler, uint64_t *rays) {
  olx_lobes sum = {0};
  const uint32_t groups = olx_emitters_group_count(scene);
  for (uint32_t group = 0; group < groups; group++) {
    if (!is_counted(scene, shading->kinds, group)) continue;
    olx_vec2 random = {0.5f, 0.5f};
    float pick = 0.5f;
    if (olx_emitters_group_varies(scene, group)) {
      random = olx_sampler_next2(sampler);
      pick = olx_sampler_next(sampler);
    }
    olx_light_sample sample;
    if (!draw_light(scene, shading, group, &random, pick, &sample)) continue;
    if (is_dark(shading, &sample) || (mis == OLX_MIS_DELTA_ONLY && !sample.delta)) continue;
    olx_lobes lobes = reflect_sample(shading, mis, &sample);
    if (olx_max(olx_max3(lobes.diffuse), olx_max3(lobes.specular)) <= 0.0f) continue;
    ++*rays;
    const float share = arriving(scene, shading->surface, &sample);
    if (!(share > 0.0f)) continue;
    lobes = scale_lobes(lobes, share);
    sum.diffuse = olx_add(sum.diffuse, lobes.diffuse);
    sum.specular = olx_add(sum.specular, lobes.specular);
    if (shading->sky && olx_emitters_group_is_sky(scene, group)) {
      olx_sky_guide_add(shading->sky, random, olx_luminance(olx_add(lobes.diffuse, lobes.specular)));
    }
  }
  return sum;
}

static olx_lobe_ray finish_ray(const olx_shading *s, olx_vec3 light, olx_vec3 weight, float pdf) {
  olx_lobe_ray ray = {.direction = to_world(s, light), .weight = weight, .pdf = pdf, .sky = s->sky};
  if (light.z <= 0.0f || olx_dot(s->surface->geometric_normal, ray.direction) <= 0.0f) ray.weight = olx_splat(0.0f);
  return ray;
}

olx_lobe_ray olx_lobe_ray_diffuse(const olx_shading *shading, olx_vec2 random) {
  const olx_vec3 light = olx_sample_cosine(random);
  return finish_ray(shading, light, shading->diffuse, light.z * (1.0f / OLX_PI));
}

olx_lobe_ray olx_lobe_ray_specular(const olx_shading *shading, olx_vec2 random) {
  const olx_bsdf *bsdf = &shading->surface->bsdf;
  float weight, half_cosine;
  const olx_vec3 light = olx_ggx_sample(bsdf->alpha, shading->view, random, &weight, &half_cosine);
  const float pdf = bsdf->alpha > 0.0f ? olx_ggx_pdf(bsdf->alpha, shading->view, light) : 0.0f;
  return finish_ray(shading, light, olx_scale(olx_fresnel(bsdf, half_cosine), weight), pdf);
}

olx_lobe_ray olx_lobe_ray_either(const olx_shading *shading, float choice, olx_vec2 random) {
  if (!shading->has_specular) return olx_lobe_ray_diffuse(shading, random);
  if (!shading->has_diffuse) return olx_lobe_ray_specular(shading, random);
  const olx_bsdf *bsdf = &shading->surface->bsdf;
  const bool specular = choice < shading->specular_share;
  olx_lobe_ray ray = specular ? olx_lobe_ray_specular(shading, random) : olx_lobe_ray_diffuse(shading, random);
  if (olx_max3(ray.weight) <= 0.0f) return ray;
  if (bsdf->alpha <= 0.0f) {
    // A mirror under a diffuse lobe: no direction belongs to both, so each ray contributes to its own lobe alone.
    const float share = specular ? shading->specular_share : 1.0f - shading->specular_share;
    ray.weight = olx_scale(ray.weight, 1.0f / share);
    ray.pdf *= share;
    return ray;
  }
  const olx_vec3 light = olx_shading_local(shading, ray.direction);
  ray.pdf = either_pdf(shading, light);
  const olx_vec3 brdf_cosine =
      olx_madd(olx_bsdf_specular(bsdf, shading->view, light), shading->diffuse, olx_max(light.z, 0.0f) / OLX_PI);
  ray.weight = ray.pdf > 0.0f ? olx_scale(brdf_cosine, 1.0f / ray.pdf) : olx_splat(0.0f);
  return ray;
}

static bool can_be_hit(const olx_scene *scene, olx_direct_kinds kinds) {
  const uint32_t groups = olx_emitters_group_count(scene);
  for (uint32_t group = 0; group < groups; group++) {
    if (is_counted(scene, kinds, group) && olx_emitters_group_varies(scene, group)) return true;
  }
  return false;
}

bool olx_emitters_can_be_hit(const olx_scene *scene) { return can_be_hit(scene, OLX_DIRECT_ALL); }

olx_vec3 olx_emission_found(const olx_scene *scene, const olx_surface *found, olx_vec3 position,
                            const olx_lobe_ray *ray) {
  if (olx_max3(found->emission) <= 0.0f) return olx_splat(0.0f);
  if (ray->pdf <= 0.0f) return found->emission;
  const float light_pdf = olx_emitters_surface_pdf(scene, found, position, ray->direction);
  return olx_scale(found->emission, power_heuristic(ray->pdf, light_pdf));
}

olx_vec3 olx_sky_found(const olx_scene *scene, const olx_lobe_ray *ray) {
  if (!olx_environment_lit(scene)) return olx_splat(0.0f);
  const olx_vec3 radiance = olx_environment_radiance(scene, ray->direction);
  if (ray->pdf <= 0.0f) return radiance;
  const float pdf = olx_environment_pdf(scene, ray->direction);
  if (!ray->sky) return olx_scale(radiance, power_heuristic(ray->pdf, pdf));
  const olx_vec2 point = olx_environment_random(scene, ray->direction);
  const float share = power_heuristic(ray->pdf, pdf * olx_sky_guide_density(ray->sky, point));
  const olx_vec3 light = olx_scale(radiance, share);
  olx_sky_guide_add(ray->sky, point, olx_luminance(olx_mul(ray->weight, light)));
  return light;
}

// Returns the emission that a ray drawn from a lobe finds, weighted by multiple importance sampling.
static olx_vec3 follow(const olx_scene *scene, const olx_shading *shading, const olx_lobe_ray *lobe, uint64_t *rays) {
  if (olx_max3(lobe->weight) <= 0.0f) return olx_splat(0.0f);
  const olx_ray ray = olx_surface_ray(shading->surface, lobe->direction, INFINITY);
  ++*rays;
  const olx_ray_hit hit = olx_bvh_intersect(scene->light_bvh, &ray);
  const bool is_sky = hit.triangle == OLX_NO_HIT;
  if (shading->kinds == (is_sky ? OLX_DIRECT_BUT_SKY : OLX_DIRECT_SKY)) return olx_splat(0.0f);
  if (is_sky) return olx_mul(lobe->weight, olx_sky_found(scene, lobe));
  if (!olx_hit_emits(scene, &hit)) return olx_splat(0.0f);
  const olx_surface found = olx_surface_at(scene, &hit, lobe->direction);
  return olx_mul(lobe->weight, olx_emission_found(scene, &found, shading->surface->position, lobe));
}

olx_lobes olx_direct_light(const olx_scene *scene, const olx_shading *shading, olx_sampler *sampler, uint64_t *rays) {
  olx_lobes sum = olx_direct_light_sampled(scene, shading, OLX_MIS_EACH_LOBE, sampler, rays);
  if (!can_be_hit(scene, shading->kinds)) return sum;
  if (shading->has_diffuse) {
    const olx_lobe_ray ray = olx_lobe_ray_diffuse(shading, olx_sampler_next2(sampler));
    sum.diffuse = olx_add(sum.diffuse, follow(scene, shading, &ray, rays));
  }
  if (shading->has_specular) {
    const olx_lobe_ray ray = olx_lobe_ray_specular(shading, olx_sampler_next2(sampler));
    sum.specular = olx_add(sum.specular, follow(scene, shading, &ray, rays));
  }
  return sum;
}

static olx_surface whiten(const olx_surface *surface) {
  olx_surface white = *surface;
  white.bsdf = (olx_bsdf){.albedo = olx_splat(1.0f)};
  return white;
}

olx_vec3 olx_direct_irradiance_of(const olx_scene *scene, const olx_surface *surface, const olx_direct_query *query,
                                  olx_sampler *sampler, uint64_t *rays) {
  const olx_surface white = whiten(surface);
  olx_shading shading = olx_shading_make(&white, olx_negate(white.shading_normal));
  shading.kinds = query->kinds;
  shading.dark = query->dark;
  shading.sky = query->sky;
  return olx_scale(olx_direct_light(scene, &shading, sampler, rays).diffuse, OLX_PI);
}

olx_vec3 olx_direct_irradiance(const olx_scene *scene, const olx_surface *surface, olx_sky_guide *sky,
                               olx_sampler *sampler, uint64_t *rays) {
  return olx_direct_irradiance_of(scene, surface, &(olx_direct_query){.sky = sky}, sampler, rays);
}

static bool has_single_sun(const olx_scene *scene, uint32_t groups) {
  for (uint32_t group = 0; group < groups; group++) {
    if (olx_emitters_group_is_a_sun(scene, group)) return true;
  }
  return false;
}

olx_vec3 olx_direct_irradiance_of_suns(const olx_scene *scene, const olx_surface *surface, uint64_t *rays) {
  const uint32_t groups = olx_emitters_group_count(scene);
  if (!has_single_sun(scene, groups)) return olx_splat(0.0f);
  const olx_surface white = whiten(surface);
  const olx_shading shading = olx_shading_make(&white, olx_negate(white.shading_normal));
  olx_vec3 sum = {0};
  for (uint32_t group = 0; group < groups; group++) {
    olx_light_sample sample;
    if (!olx_emitters_group_is_a_sun(scene, group)) continue;
    if (!olx_emitters_sample(scene, group, surface->position, (olx_vec2){0}, 0.0f, &sample)) continue;
    sum = olx_madd(sum, olx_direct_light_of(scene, &shading, &sample, rays).diffuse, OLX_PI);
  }
  return sum;
}
