// Finds the surfaces close to lamps without area, and samples the light that they reflect.
#include "light/near_lamps.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/lights.h"
#include "scene/bvh.h"
#include "scene/distribution.h"
#include "scene/scene_parts.h"

#include <stdlib.h>

enum {
  MOST_RAYS = 1024,   // rays of a lamp
  LEAST_RAYS = 64,    // rays of a lamp where there are many
  ALL_RAYS = 1 << 17, // rays of all lamps, as far as the least number allows
  SALT_LAMP = 0x4C414D50
};

// A surface is near a lamp within this share of the distance that seven eighths of the lamp's rays do not exceed: the
// shade around a lamp covers less, and its room more.
static const float NEAR_SHARE = 0.1f, ROOM_QUANTILE = 0.875f;
// The least distance at which the light of a point is computed, as a share of that radius.
static const float SOFT_SHARE = 0.25f;

static bool has_place(const olx_light *light) {
  return (light->type == OLX_LIGHT_POINT || light->type == OLX_LIGHT_SPOT) && olx_max3(light->emission) > 0.0f;
}

// What the rays of a lamp meet.
typedef struct lamp_view {
  olx_vec3 directions[MOST_RAYS];
  olx_ray_hit hits[MOST_RAYS];
  float distances[MOST_RAYS]; // sorted
  uint32_t rays;
  float solid_angle; // of one ray, sr
} lamp_view;

static int by_distance(const void *a, const void *b) {
  const float p = *(const float *)a, q = *(const float *)b;
  return p < q ? -1 : p > q;
}

static void look_around(const olx_scene *scene, const olx_light *light, uint32_t number, lamp_view *v) {
  const bool spot = light->type == OLX_LIGHT_SPOT;
  const float height = spot ? 1.0f - light->cosine_outer : 2.0f;
  const float sky = olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  v->solid_angle = 2.0f * OLX_PI * height / (float)v->rays;
  for (uint32_t i = 0; i < v->rays; i++) {
    const olx_vec2 random = olx_stratified2(i, olx_hash2(number, SALT_LAMP));
    const float z = 1.0f - height * random.x, r = sqrtf(olx_max(0.0f, 1.0f - z * z)), phi = 2.0f * OLX_PI * random.y;
    const olx_vec3 local = olx_v3(r * cosf(phi), r * sinf(phi), z);
    v->directions[i] = olx_normalize(spot ? olx_from_basis(local, light->direction) : local);
    const olx_ray ray = {light->position, v->directions[i], 0.0f, INFINITY};
    v->hits[i] = olx_bvh_intersect(scene->bvh, &ray);
    v->distances[i] = v->hits[i].triangle == OLX_NO_HIT ? sky : v->hits[i].t;
  }
  qsort(v->distances, v->rays, sizeof *v->distances, by_distance);
}

// Adds the points of a lamp's rays that end within `radius`.
static void add_points(olx_near_lamps *l, const olx_scene *scene, const olx_light *light, float radius,
                       const lamp_view *v) {
  for (uint32_t i = 0; i < v->rays; i++) {
    if (v->hits[i].triangle == OLX_NO_HIT || v->hits[i].t >= radius) continue;
    const olx_surface s = olx_surface_at(scene, &v->hits[i], v->directions[i]);
    olx_vec3 intensity = olx_scale(olx_mul(light->emission, olx_bsdf_matte(&s.bsdf).albedo), v->solid_angle / OLX_PI);
    if (light->type == OLX_LIGHT_SPOT) {
      const float cosine = olx_dot(v->directions[i], light->direction);
      intensity = olx_scale(intensity, olx_spot_falloff(light->cosine_inner, light->cosine_outer, cosine));
    }
    l->needs |= olx_input_of_material(s.material);
    const float weight = olx_luminance(intensity), soft = SOFT_SHARE * radius;
    if (!(weight > 0.0f)) continue;
    l->sums[l->count] = weight;
    l->points[l->count++] = (olx_lamp_point){olx_madd(s.position, s.geometric_normal, s.epsilon), s.geometric_normal,
                                             intensity, soft * soft};
  }
}

static void add_lamp(olx_near_lamps *l, const olx_scene *scene, uint32_t number, lamp_view *v) {
  const olx_light *light = &scene->lights[number];
  if (!has_place(light)) return;
  look_around(scene, light, number, v);
  l->rays += v->rays;
  const float radius = NEAR_SHARE * v->distances[(uint32_t)(ROOM_QUANTILE * (float)v->rays)];
  if (v->distances[0] >= radius) return;
  l->radius[number] = radius;
  add_points(l, scene, light, radius, v);
}

olx_result olx_near_lamps_create(olx_near_lamps *l, const olx_scene *scene) {
  uint32_t lamps = 0, rays = MOST_RAYS;
  *l = (olx_near_lamps){0};
  for (uint32_t i = 0; i < scene->light_count; i++) lamps += has_place(&scene->lights[i]);
  if (lamps == 0) return OLX_OK;
  while (rays > LEAST_RAYS && (uint64_t)rays * lamps > ALL_RAYS) rays /= 2;
  lamp_view *v = olx_allocate(1, sizeof *v);
  l->radius = olx_allocate_zero(scene->light_count, sizeof *l->radius);
  l->points = olx_allocate((size_t)lamps * rays, sizeof *l->points);
  l->sums = olx_allocate((size_t)lamps * rays + 1, sizeof *l->sums);
  if (v && l->radius && l->points && l->sums) {
    v->rays = rays;
    for (uint32_t i = 0; i < scene->light_count; i++) add_lamp(l, scene, i, v);
    const uint64_t cast = l->rays;
    if (l->count == 0 || !olx_distribution_build(l->sums, l->count, l->sums)) olx_near_lamps_free(l);
    l->rays = cast;
    olx_release(v);
    return OLX_OK;
  }
  olx_release(v);
  olx_near_lamps_free(l);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for surfaces near %u lamps", lamps);
}

void olx_near_lamps_free(olx_near_lamps *l) {
  olx_release(l->radius);
  olx_release(l->points);
  olx_release(l->sums);
  *l = (olx_near_lamps){0};
}

static bool draw(const olx_near_lamps *l, olx_vec3 position, float random, olx_light_sample *sample) {
  const uint32_t i = olx_distribution_draw(l->sums, l->count, random, NULL);
  const olx_lamp_point *p = &l->points[i];
  const olx_vec3 way = olx_sub(p->position, position);
  const float squared = olx_dot(way, way);
  if (!(squared > 0.0f)) return false;
  const olx_vec3 direction = olx_scale(way, 1.0f / sqrtf(squared));
  const float cosine = -olx_dot(direction, p->normal);
  if (cosine <= 0.0f) return false;
  const float share = cosine / (olx_max(squared, p->soft_squared) * olx_distribution_probability(l->sums, i));
  *sample = (olx_light_sample){.direction = direction,
                               .target = p->position,
                               .delta = true,
                               .emission = olx_scale(p->intensity, share),
                               .pdf = 1.0f};
  return true;
}

olx_lobes olx_near_lamps_light(const olx_near_lamps *l, const olx_scene *scene, const olx_shading *shading,
                               olx_sampler *sampler, uint64_t *rays) {
  olx_light_sample sample;
  if (l->count == 0 || !draw(l, shading->surface->position, olx_sampler_next(sampler), &sample)) return (olx_lobes){0};
  return olx_direct_light_of(scene, shading, &sample, rays);
}

olx_vec3 olx_near_lamps_irradiance(const olx_near_lamps *l, const olx_scene *scene, const olx_surface *surface,
                                   olx_sampler *sampler, uint64_t *rays) {
  if (l->count == 0) return olx_splat(0.0f);
  olx_surface white = *surface;
  white.bsdf = (olx_bsdf){.albedo = olx_splat(1.0f)};
  const olx_shading shading = olx_shading_make(&white, olx_negate(white.shading_normal));
  return olx_scale(olx_near_lamps_light(l, scene, &shading, sampler, rays).diffuse, OLX_PI);
}

bool olx_near_lamps_draw(const olx_near_lamps *l, const olx_scene *scene, olx_vec3 position, olx_sampler *sampler,
                         olx_lamp_beam *beam, uint64_t *rays) {
  olx_light_sample sample;
  if (l->count == 0 || !draw(l, position, olx_sampler_next(sampler), &sample)) return false;
  const olx_ray ray = {position, sample.direction, 0.0f, olx_length(olx_sub(sample.target, position))};
  ++*rays;
  if (olx_bvh_occluded(scene->bvh, &ray)) return false;
  *beam = (olx_lamp_beam){sample.direction, sample.emission};
  return true;
}
