// Draws one of many point and spot lights for a place: a cluster of neighbours first, then a lamp of it.
#include "scene/many_lamps.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/lights.h"

#include <stdlib.h>

// A cluster has 16 lamps at most, or more where 1024 clusters would not hold all lamps.
enum { CLUSTER_LAMPS = 16, MOST_CLUSTERS = 1024 };
// The share of draws that takes any lamp. A lamp that gives all the light of a place has a standard deviation of at
// most sqrt(8 lamps) means a draw, whatever other lamps seem to send there.
static const float ANY_SHARE = 0.125f;
// A lamp closer than this share of the distance to its nearest neighbour counts as if it were that far away.
static const float SOFT_SHARE = 0.25f;
// Spots whose light may leave a cluster at more than this angle to its axis (radians) shine everywhere, for its weight.
// Together with 30 degrees, the most that a far cluster covers on one side, it is less than a half turn.
static const float WIDEST = 2.5f;

typedef struct lamp {
  olx_vec3 position, direction;
  float cosine_inner, cosine_outer;
  float strength;     // luminance of the intensity, as a share of the strongest lamp's
  float soft_squared; // square of the least distance at which it is weighed
  uint32_t light;     // its number in the scene
  bool spot;
} lamp;

typedef struct cluster {
  olx_vec3 center, axis;
  float radius_squared; // of a sphere around all its lamps
  float strength;       // sum
  float cosine, sine;   // of the largest angle to the axis at which its lamps shine
  uint32_t first, count;
  bool everywhere; // shines in all directions
} cluster;

struct olx_many_lamps {
  lamp *lamps;
  cluster *clusters;
  uint32_t count, cluster_count;
};

static bool has_place(const olx_light *light) {
  return light->type == OLX_LIGHT_POINT || light->type == OLX_LIGHT_SPOT;
}

static olx_result gather(const olx_scene *scene, olx_many_lamps *m) {
  float most = 0.0f;
  for (uint32_t i = 0; i < scene->light_count; i++) {
    if (!has_place(&scene->lights[i])) continue;
    most = olx_max(most, olx_luminance(scene->lights[i].emission));
    m->count++;
  }
  if (!(most > 0.0f)) {
    m->count = 0;
    return OLX_OK;
  }
  m->lamps = olx_allocate(m->count, sizeof *m->lamps);
  m->clusters = olx_allocate(m->count < MOST_CLUSTERS ? m->count : MOST_CLUSTERS, sizeof *m->clusters);
  if (!m->lamps || !m->clusters) return olx_fail(OLX_ERROR_MEMORY, "lights: no memory for %u lamps", m->count);
  for (uint32_t i = 0, next = 0; i < scene->light_count; i++) {
    const olx_light *light = &scene->lights[i];
    if (!has_place(light)) continue;
    m->lamps[next++] = (lamp){.position = light->position,
                              .direction = light->direction,
                              .cosine_inner = light->cosine_inner,
                              .cosine_outer = light->cosine_outer,
                              .strength = olx_luminance(light->emission) / most,
                              .light = i,
                              .spot = light->type == OLX_LIGHT_SPOT};
  }
  return OLX_OK;
}

static int compare(float p, float q, const void *a, const void *b) {
  if (p != q) return p < q ? -1 : 1;
  const uint32_t i = ((const lamp *)a)->light, k = ((const lamp *)b)->light;
  return i < k ? -1 : i > k;
}

static int by_x(const void *a, const void *b) {
  return compare(((const lamp *)a)->position.x, ((const lamp *)b)->position.x, a, b);
}

static int by_y(const void *a, const void *b) {
  return compare(((const lamp *)a)->position.y, ((const lamp *)b)->position.y, a, b);
}

static int by_z(const void *a, const void *b) {
  return compare(((const lamp *)a)->position.z, ((const lamp *)b)->position.z, a, b);
}

static void bounds_of(const lamp *lamps, uint32_t count, olx_vec3 *low, olx_vec3 *high) {
  *low = *high = lamps[0].position;
  for (uint32_t i = 1; i < count; i++) {
    *low = olx_min_each(*low, lamps[i].position);
    *high = olx_max_each(*high, lamps[i].position);
  }
}

// Returns the largest angle to `axis` at which one of the lamps shines, radians.
static float widest_angle(const lamp *lamps, uint32_t count, olx_vec3 axis) {
  float widest = 0.0f;
  for (uint32_t i = 0; i < count; i++) {
    if (!lamps[i].spot) return OLX_PI;
    const float off_axis = acosf(olx_clamp(olx_dot(axis, lamps[i].direction), -1.0f, 1.0f));
    widest = olx_max(widest, off_axis + acosf(olx_clamp(lamps[i].cosine_outer, -1.0f, 1.0f)));
  }
  return widest;
}

static cluster make_cluster(const lamp *lamps, uint32_t first, uint32_t count) {
  cluster c = {.first = first, .count = count};
  olx_vec3 low, high, sum = {0};
  bounds_of(lamps + first, count, &low, &high);
  c.center = olx_scale(olx_add(low, high), 0.5f);
  for (uint32_t i = first; i < first + count; i++) {
    const olx_vec3 away = olx_sub(lamps[i].position, c.center);
    c.radius_squared = olx_max(c.radius_squared, olx_max(olx_dot(away, away), lamps[i].soft_squared));
    c.strength += lamps[i].strength;
    sum = olx_add(sum, lamps[i].direction);
  }
  const float length = olx_length(sum);
  c.axis = length > 0.0f ? olx_scale(sum, 1.0f / length) : olx_v3(0.0f, 1.0f, 0.0f);
  const float widest = widest_angle(lamps + first, count, c.axis) + 1e-3f; // more than what rounding takes
  c.everywhere = widest > WIDEST;
  c.cosine = cosf(widest);
  c.sine = sinf(widest);
  return c;
}

// Gives the lamps of a small range their least distances. `least` is above 0 and below what positions resolve.
static void soften(lamp *lamps, uint32_t count, float least) {
  for (uint32_t i = 0; i < count; i++) {
    float nearest = INFINITY;
    for (uint32_t k = 0; k < count; k++) {
      const olx_vec3 way = olx_sub(lamps[k].position, lamps[i].position);
      if (k != i) nearest = olx_min(nearest, olx_dot(way, way));
    }
    lamps[i].soft_squared = olx_max(nearest < INFINITY ? olx_square(SOFT_SHARE) * nearest : 0.0f, olx_square(least));
  }
}

// Sorts lamps so that every range that halving makes holds neighbours.
static void sort(lamp *lamps, uint32_t count, float least) {
  if (count <= CLUSTER_LAMPS) {
    soften(lamps, count, least);
    return;
  }
  olx_vec3 low, high;
  bounds_of(lamps, count, &low, &high);
  const olx_vec3 size = olx_sub(high, low);
  const float longest = olx_max3(size);
  qsort(lamps, count, sizeof *lamps, size.x == longest ? by_x : size.y == longest ? by_y : by_z);
  sort(lamps, count / 2, least);
  sort(lamps + count / 2, count - count / 2, least);
}

static void divide(olx_many_lamps *m, uint32_t first, uint32_t count, uint32_t most) {
  if (count <= most) {
    m->clusters[m->cluster_count++] = make_cluster(m->lamps, first, count);
    return;
  }
  divide(m, first, count / 2, most);
  divide(m, first + count / 2, count - count / 2, most);
}

olx_result olx_many_lamps_create(const olx_scene *scene, olx_many_lamps **lamps) {
  *lamps = NULL;
  olx_many_lamps *m = olx_allocate_zero(1, sizeof *m);
  if (!m) return olx_fail(OLX_ERROR_MEMORY, "lights: no memory");
  const olx_result result = gather(scene, m);
  if (result != OLX_OK || m->count == 0) {
    olx_many_lamps_free(m);
    return result;
  }
  const olx_vec3 low = scene->bounds_min, high = scene->bounds_max;
  const float extent = olx_max(olx_length(low), olx_length(high));
  sort(m->lamps, m->count, olx_max(0x1p-24f * extent, 0x1p-40f));
  uint32_t most = CLUSTER_LAMPS;
  // Halves of a range differ by one lamp, and all of one depth are divided or none.
  while ((uint64_t)most * MOST_CLUSTERS / 2 < m->count) most *= 2;
  divide(m, 0, m->count, most);
  *lamps = m;
  return OLX_OK;
}

void olx_many_lamps_free(olx_many_lamps *m) {
  if (!m) return;
  olx_release(m->lamps);
  olx_release(m->clusters);
  olx_release(m);
}

static float weigh_lamp(const lamp *l, olx_vec3 position) {
  const olx_vec3 way = olx_sub(position, l->position);
  const float squared = olx_dot(way, way), weight = l->strength / olx_max(squared, l->soft_squared);
  if (!l->spot || !(squared > 0.0f)) return weight;
  return weight * olx_spot_falloff(l->cosine_inner, l->cosine_outer, olx_dot(way, l->direction) / sqrtf(squared));
}

static float weigh_lamps(const olx_many_lamps *m, const cluster *c, olx_vec3 position) {
  float sum = 0.0f;
  for (uint32_t i = c->first; i < c->first + c->count; i++) sum += weigh_lamp(&m->lamps[i], position);
  return sum;
}

// Returns whether a cluster may shine in a direction, `way`; `squared` is its squared length.
static bool may_shine(const cluster *c, olx_vec3 way, float squared) {
  if (c->everywhere) return true;
  const float sine = olx_min(sqrtf(c->radius_squared / squared), 1.0f), cosine = sqrtf(1.0f - sine * sine);
  return olx_dot(way, c->axis) >= (c->cosine * cosine - c->sine * sine) * sqrtf(squared);
}

static float weigh_cluster(const olx_many_lamps *m, const cluster *c, olx_vec3 position) {
  const olx_vec3 way = olx_sub(position, c->center);
  const float squared = olx_dot(way, way);
  if (!(squared > 4.0f * c->radius_squared)) return weigh_lamps(m, c, position);
  return may_shine(c, way, squared) ? c->strength / squared : 0.0f;
}

// Returns which of some weights, whose sum is above 0, `random` * sum draws. *rest receives a number in [0, 1).
static uint32_t draw_weight(const float *weights, uint32_t count, float sum, float random, float *rest) {
  float left = random * sum;
  uint32_t drawn = 0;
  for (uint32_t i = 0; i < count; i++) {
    if (weights[i] <= 0.0f) continue;
    drawn = i;
    if (left < weights[i]) break;
    left -= weights[i];
  }
  *rest = olx_clamp(left / weights[drawn], 0.0f, 0x1.fffffep-1f);
  return drawn;
}

// Returns the lamp of a cluster, the sum of whose lamps is above 0, that `random` draws.
static uint32_t draw_of_cluster(const olx_many_lamps *m, const cluster *c, olx_vec3 position, float sum, float random) {
  float left = random * sum;
  uint32_t drawn = c->first;
  for (uint32_t i = c->first; i < c->first + c->count; i++) {
    const float weight = weigh_lamp(&m->lamps[i], position);
    if (weight <= 0.0f) continue;
    drawn = i;
    if (left < weight) break;
    left -= weight;
  }
  return drawn;
}

// Returns the number of the cluster that holds a lamp.
static uint32_t cluster_of(const olx_many_lamps *m, uint32_t number) {
  uint32_t low = 0, high = m->cluster_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    if (m->clusters[middle].first <= number) low = middle;
    else high = middle;
  }
  return low;
}

float olx_many_lamps_draw(const olx_many_lamps *m, olx_vec3 position, float random, uint32_t *light) {
  float weights[MOST_CLUSTERS], sum = 0.0f;
  for (uint32_t i = 0; i < m->cluster_count; i++) sum += weights[i] = weigh_cluster(m, &m->clusters[i], position);
  const bool any = random < ANY_SHARE;
  if (!any && !(sum > 0.0f)) return 0.0f;
  uint32_t drawn = (uint32_t)(olx_min(random / ANY_SHARE, 0x1.fffffep-1f) * (float)m->count);
  float rest = 0.0f;
  const float weighed = (random - ANY_SHARE) / (1.0f - ANY_SHARE);
  const uint32_t of = any ? cluster_of(m, drawn) : draw_weight(weights, m->cluster_count, sum, weighed, &rest);
  const float within = weigh_lamps(m, &m->clusters[of], position);
  if (!any && !(within > 0.0f)) return 0.0f;
  if (!any) drawn = draw_of_cluster(m, &m->clusters[of], position, within, rest);
  *light = m->lamps[drawn].light;
  const float even_share = ANY_SHARE / (float)m->count;
  if (!(within > 0.0f) || !(sum > 0.0f)) return even_share;
  return even_share + (1.0f - ANY_SHARE) * weights[of] / sum * weigh_lamp(&m->lamps[drawn], position) / within;
}
