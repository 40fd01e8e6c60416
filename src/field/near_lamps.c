// Finds the surfaces close to lamps without area, and draws from the light that they reflect.
#include "field/near_lamps.h"

#include "core/distribution.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/lights.h"

#include <stdlib.h>

enum { SALT_LAMP = 0x4C414D50 };

// A surface is near a lamp within this share of the distance that seven eighths of the lamp's rays to surfaces do not
// exceed: the shade around a lamp covers less, and its room more. Rays into the sky say nothing of the room's size.
static const float NEAR_SHARE = 0.1f, ROOM_QUANTILE = 0.875f;
// Places closer to a point than this share of that radius get its light from rays that they cast, too.
static const float SOFT_SHARE = 0.25f;
// The most rays that end nearby at unknown surfaces, as a share of those that end nearby.
static const float MOST_UNKNOWN = 0.125f;

static bool has_place(const olx_light *light) {
  return (light->type == OLX_LIGHT_POINT || light->type == OLX_LIGHT_SPOT) && olx_max3(light->emission) > 0.0f;
}

// What the rays of a lamp meet.
typedef struct lamp_sights {
  olx_vec3 directions[OLX_LAMP_RAYS];
  olx_lamp_sight sights[OLX_LAMP_RAYS];
  float distances[OLX_LAMP_RAYS]; // of the rays that meet surfaces, sorted
  uint32_t rays, hits;            // hits: number of those distances
  float solid_angle;              // of one ray, sr
} lamp_sights;

static int by_distance(const void *a, const void *b) {
  const float p = *(const float *)a, q = *(const float *)b;
  return p < q ? -1 : p > q;
}

static void look_around(const olx_light *light, uint32_t number, const olx_lamp_view *view, lamp_sights *s) {
  const bool spot = light->type == OLX_LIGHT_SPOT;
  const float height = spot ? 1.0f - light->cosine_outer : 2.0f;
  s->solid_angle = 2.0f * OLX_PI * height / (float)s->rays;
  for (uint32_t i = 0; i < s->rays; i++) {
    const olx_vec2 random = olx_stratified2(i, olx_hash2(number, SALT_LAMP));
    const float z = 1.0f - height * random.x, r = sqrtf(olx_max(0.0f, 1.0f - z * z)), phi = 2.0f * OLX_PI * random.y;
    const olx_vec3 local = olx_v3(r * cosf(phi), r * sinf(phi), z);
    s->directions[i] = olx_normalize(spot ? olx_from_basis(local, light->direction) : local);
  }
  view->look(view->user, light->position, s->directions, s->rays, s->sights);
  s->hits = 0;
  for (uint32_t i = 0; i < s->rays; i++) {
    if (s->sights[i].distance < INFINITY) s->distances[s->hits++] = s->sights[i].distance;
  }
  qsort(s->distances, s->hits, sizeof *s->distances, by_distance);
}

// Returns whether the surfaces that most rays end at within `radius` are known.
static bool knows(const lamp_sights *s, float radius) {
  uint32_t near = 0, unknown = 0;
  for (uint32_t i = 0; i < s->rays; i++) {
    near += s->sights[i].distance < radius;
    unknown += s->sights[i].distance < radius && !s->sights[i].known;
  }
  return (float)unknown <= MOST_UNKNOWN * (float)near;
}

// Adds the points of a lamp's rays that end within `radius`.
static void add_points(olx_near_lamps *l, const olx_light *light, float radius, const lamp_sights *s) {
  for (uint32_t i = 0; i < s->rays; i++) {
    const olx_lamp_sight *sight = &s->sights[i];
    if (!(sight->distance < radius) || !sight->known) continue;
    olx_vec3 intensity = olx_scale(olx_mul(light->emission, sight->albedo), s->solid_angle / OLX_PI);
    if (light->type == OLX_LIGHT_SPOT) {
      const float cosine = olx_dot(s->directions[i], light->direction);
      intensity = olx_scale(intensity, olx_spot_falloff(light->cosine_inner, light->cosine_outer, cosine));
    }
    l->needs |= sight->needs;
    const float weight = olx_luminance(intensity), soft = SOFT_SHARE * radius;
    const float facing = fabsf(olx_dot(s->directions[i], sight->normal)) / olx_square(sight->distance);
    if (!(weight > 0.0f)) continue;
    l->sums[l->count] = weight;
    l->points[l->count++] =
        (olx_lamp_point){sight->position, sight->normal, intensity, soft * soft, weight * facing / s->solid_angle};
    l->light += weight;
  }
}

static void add_lamp(olx_near_lamps *l, const olx_light *light, uint32_t number, const olx_lamp_view *view,
                     lamp_sights *s) {
  if (!has_place(light)) return;
  look_around(light, number, view, s);
  l->rays += s->rays;
  if (s->hits == 0) return;
  const float radius = NEAR_SHARE * s->distances[(uint32_t)(ROOM_QUANTILE * (float)s->hits)];
  if (s->distances[0] >= radius || !knows(s, radius)) return;
  l->radius[number] = radius;
  l->reach = olx_max(l->reach, SOFT_SHARE * radius);
  add_points(l, light, radius, s);
}

// Returns the number of rays of each lamp.
static uint32_t rays_a_lamp(const olx_lamp_view *view, uint32_t lamps) {
  uint32_t rays = view->rays;
  while (rays > OLX_LEAST_LAMP_RAYS && (uint64_t)rays * lamps > view->all_rays) rays /= 2;
  return rays;
}

olx_result olx_near_lamps_create(olx_near_lamps *l, const olx_light *lights, uint32_t count,
                                 const olx_lamp_view *view) {
  uint32_t lamps = 0;
  *l = (olx_near_lamps){0};
  for (uint32_t i = 0; i < count; i++) lamps += has_place(&lights[i]);
  if (lamps == 0) return OLX_OK;
  const uint32_t rays = rays_a_lamp(view, lamps);
  lamp_sights *s = olx_allocate(1, sizeof *s);
  l->radius = olx_allocate_zero(count, sizeof *l->radius);
  l->points = olx_allocate((size_t)lamps * rays, sizeof *l->points);
  l->sums = olx_allocate((size_t)lamps * rays + 1, sizeof *l->sums);
  if (s && l->radius && l->points && l->sums) {
    s->rays = rays;
    for (uint32_t i = 0; i < count; i++) add_lamp(l, &lights[i], i, view, s);
    const uint64_t cast = l->rays;
    for (uint32_t i = 0; i < l->count; i++) l->points[i].density /= l->light;
    if (l->count == 0 || !olx_distribution_build(l->sums, l->count, l->sums)) olx_near_lamps_free(l);
    l->rays = cast;
    olx_release(s);
    return OLX_OK;
  }
  olx_release(s);
  olx_near_lamps_free(l);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for surfaces near %u lamps", lamps);
}

void olx_near_lamps_free(olx_near_lamps *l) {
  olx_release(l->radius);
  olx_release(l->points);
  olx_release(l->sums);
  *l = (olx_near_lamps){0};
}

const olx_lamp_point *olx_near_lamps_pick(const olx_near_lamps *l, float random, float *probability) {
  const uint32_t i = olx_distribution_draw(l->sums, l->count, random, NULL);
  *probability = olx_distribution_probability(l->sums, i);
  return &l->points[i];
}

// A point as a place sees it.
typedef struct seen_point {
  const olx_lamp_point *point;
  olx_vec3 direction;
  float squared, cosine; // squared distance, and cosine at the point
  float probability;     // of the point
} seen_point;

static bool draw_point(const olx_near_lamps *l, olx_vec3 position, float random, seen_point *seen) {
  seen->point = olx_near_lamps_pick(l, random, &seen->probability);
  const olx_vec3 way = olx_sub(seen->point->position, position);
  seen->squared = olx_dot(way, way);
  if (!(seen->squared > 0.0f)) return false;
  seen->direction = olx_scale(way, 1.0f / sqrtf(seen->squared));
  seen->cosine = -olx_dot(seen->direction, seen->point->normal);
  return seen->cosine > 0.0f;
}

static olx_lamp_ray ray_to(const seen_point *seen, float share) {
  return (olx_lamp_ray){.direction = seen->direction,
                        .target = seen->point->position,
                        .irradiance = olx_scale(seen->point->intensity, share * seen->cosine / seen->probability)};
}

bool olx_near_lamps_draw_soft(const olx_near_lamps *l, olx_vec3 position, float random, olx_lamp_ray *ray) {
  seen_point seen;
  if (!draw_point(l, position, random, &seen)) return false;
  *ray = ray_to(&seen, 1.0f / olx_max(seen.squared, seen.point->soft_squared));
  return true;
}

// Returns the share of a surface's light that rays bring to a place at this squared distance from it: their share by
// the balance heuristic, as if a solid angle of pi got them evenly, which falls to none with the distance. What is left
// to the points is bounded by the surface's radiance and by the light of a point at sqrt(soft_squared).
static float share_of_rays(float squared, float cosine, float density, float soft_squared) {
  if (!(squared < soft_squared)) return 0.0f;
  const float of_rays = cosine * (1.0f / OLX_PI), of_points = density * squared; // times the squared distance
  return (1.0f - squared / soft_squared) * of_rays / (of_rays + of_points);
}

bool olx_near_lamps_draw(const olx_near_lamps *l, olx_vec3 position, float random, olx_lamp_ray *ray) {
  seen_point seen;
  if (!draw_point(l, position, random, &seen)) return false;
  const olx_lamp_point *p = seen.point;
  const float rays = share_of_rays(seen.squared, seen.cosine, p->density, p->soft_squared);
  *ray = ray_to(&seen, (1.0f - rays) / seen.squared);
  return true;
}

olx_vec3 olx_near_lamps_found(const olx_near_lamps *l, const olx_light *light, uint32_t number,
                              const olx_lamp_sight *end, olx_vec3 direction) {
  const olx_vec3 dark = olx_splat(0.0f), way = olx_sub(light->position, end->position);
  const float radius = l->radius[number], away = olx_dot(way, way), squared = olx_square(end->distance);
  const float cosine = -olx_dot(direction, end->normal), height = olx_dot(way, end->normal);
  if (!(away < olx_square(radius)) || !(cosine > 0.0f) || !(height > 0.0f)) return dark; // also without a radius
  float strength = height / (away * sqrtf(away) * OLX_PI);
  if (light->type == OLX_LIGHT_SPOT) {
    const float along = -olx_dot(way, light->direction) / sqrtf(away);
    strength *= olx_spot_falloff(light->cosine_inner, light->cosine_outer, along);
  }
  const olx_vec3 radiance = olx_scale(olx_mul(light->emission, end->albedo), strength);
  const float density = olx_luminance(radiance) / l->light;
  if (!olx_finite(radiance)) return dark;
  return olx_scale(radiance, share_of_rays(squared, cosine, density, olx_square(SOFT_SHARE * radius)));
}
