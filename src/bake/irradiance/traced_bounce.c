// Links probes for bounces by rays: casts rays from what each probe sees, finds the probe that stored the surface at
// each ray's end, and looks up the light of earlier bounces there.
#include "bake/irradiance/traced_bounce.h"

#include "bake/arrays.h"
#include "bake/irradiance/gather_points.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"
#include "select/cage.h"

#define DARK UINT32_MAX         // the ray leaves the scene
#define UNSEEN (UINT32_MAX - 1) // no probe has stored what it met

enum { SALT_RAY = 0x54524143, NEARBY = 64 };

// How far a place may lie off the surface that a probe stored, as a share of its distance from the probe; and how much
// normals may differ.
static const float off_surface = 0.02f, least_normal = 0.5f;

static const olx_probe_list *probes_of(const olx_traced_bounce *t) { return &t->context->probes.irradiance; }

// Returns the gather point that represents a direction of the probe.
static uint32_t point_towards(const olx_quadrature *q, uint32_t x, uint32_t y) {
  const uint32_t per_quarter = olx_samples_per_cell(q) / 4, tiles = q->sample_size / OLX_GATHER_TILE;
  const uint32_t tile = y / OLX_GATHER_TILE * tiles + x / OLX_GATHER_TILE;
  uint32_t i = 0;
  for (uint32_t bit = 0; bit < 5; bit++) i |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
  return tile * (OLX_BATCH_POINTS / per_quarter) + i / per_quarter;
}

static olx_vec3 stored_direction(const olx_traced_bounce *t, uint32_t probe, uint32_t point) {
  const olx_quadrature *q = t->quadrature;
  const uint32_t per_quarter = olx_samples_per_cell(q) / 4, per_tile = OLX_BATCH_POINTS / per_quarter;
  const uint32_t key = olx_shade_key(t->shade, probe);
  const uint32_t i = point % per_tile * per_quarter + olx_picked_sample(key, point, per_quarter);
  return olx_sample_direction(q, key, olx_place_of(q, point / per_tile, i));
}

static olx_vec3 triangle_normal(const olx_scene *scene, uint32_t triangle, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
  const olx_vec3 n = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  return olx_dot(n, direction) > 0.0f ? olx_negate(n) : n;
}

// Where a ray ended.
typedef struct ray_end {
  olx_vec3 position, normal;
  uint32_t triangle;
} ray_end;

// Returns whether the probe stored, at that gather point, the surface at the ray's end: at the end's distance from the
// probe, measured along the stored surface.
static bool stores(const olx_traced_bounce *t, uint32_t probe, uint32_t point, const ray_end *end, olx_vec3 towards,
                   float distance) {
  const olx_ray_hit *hit = &t->hits[(size_t)probe * olx_gather_points(t->quadrature) + point];
  if (hit->triangle == OLX_NO_HIT) return false;
  if (hit->triangle == end->triangle) return true;
  const olx_vec3 direction = stored_direction(t, probe, point);
  const olx_vec3 normal = triangle_normal(t->shade->scene, hit->triangle, direction);
  if (olx_dot(normal, end->normal) < least_normal) return false;
  const float cosine = olx_dot(normal, towards);
  if (cosine > -0.01f) return false;
  const float stored = hit->t * olx_dot(normal, direction) / cosine;
  return fabsf(stored - distance) <= off_surface * distance;
}

// Finds the gather point of the probe that stores the light at the ray's end: the one in its direction or one beside
// it.
static bool find_point(const olx_traced_bounce *t, uint32_t probe, const ray_end *end, uint32_t *found) {
  const olx_quadrature *q = t->quadrature;
  const olx_vec3 offset = olx_sub(end->position, probes_of(t)->positions[probe]);
  const float distance = olx_length(offset);
  if (distance <= 0.0f || olx_dot(offset, end->normal) >= 0.0f) return false;
  const olx_vec3 towards = olx_scale(offset, 1.0f / distance);
  const olx_vec2 uv = olx_octahedral_encode(towards);
  // A gather point represents a square of 2 x 2 samples or more.
  const int32_t size = (int32_t)(2 * q->cells), step = (int32_t)q->sample_size / size;
  const int32_t cx = (int32_t)olx_min(uv.x * (float)size, (float)size - 1.0f),
                cy = (int32_t)olx_min(uv.y * (float)size, (float)size - 1.0f);
  static const int8_t beside[9][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  for (uint32_t i = 0; i < 9; i++) {
    int32_t x = cx + beside[i][0], y = cy + beside[i][1];
    olx_border_source(x, y, size, &x, &y);
    const uint32_t point = point_towards(q, (uint32_t)(x * step), (uint32_t)(y * step));
    if (!stores(t, probe, point, end, towards, distance)) continue;
    *found = probe * olx_gather_points(q) + point;
    return true;
  }
  return false;
}

// Finds the probes around a place, nearest first: those of the cage and its neighbours. Returns their number.
static uint32_t probes_nearby(const olx_traced_bounce *t, olx_vec3 position, uint32_t probes[NEARBY]) {
  const olx_cage cage = olx_cage_at(t->grid, position);
  float distance[NEARBY];
  uint32_t count = 0;
  for (uint32_t i = 0; i < NEARBY; i++) {
    const uint32_t offset[3] = {i & 3u, i >> 2 & 3u, i >> 4};
    uint32_t at[3];
    bool inside = true;
    for (uint32_t axis = 0; axis < 3; axis++) {
      at[axis] = cage.base[axis] + offset[axis] - 1u; // wraps to a huge number below 0
      inside = inside && at[axis] < t->grid->count[axis];
    }
    if (!inside) continue;
    const uint32_t probe = at[0] + t->grid->count[0] * (at[1] + t->grid->count[1] * at[2]);
    if (probes_of(t)->flags[probe] & OLX_PROBE_BURIED) continue;
    const olx_vec3 away = olx_sub(position, probes_of(t)->positions[probe]);
    const float squared = olx_dot(away, away);
    uint32_t k = count++;
    for (; k > 0 && distance[k - 1] > squared; k--) {
      distance[k] = distance[k - 1];
      probes[k] = probes[k - 1];
    }
    distance[k] = squared;
    probes[k] = probe;
  }
  return count;
}

static uint32_t find_link(olx_traced_bounce *t, const ray_end *end) {
  uint32_t probes[NEARBY], found;
  const uint32_t count = probes_nearby(t, end->position, probes);
  atomic_fetch_add_explicit(&t->rays, 1, memory_order_relaxed);
  for (uint32_t i = 0; i < count; i++) {
    if (find_point(t, probes[i], end, &found)) return found;
  }
  atomic_fetch_add_explicit(&t->unseen, 1, memory_order_relaxed);
  return UNSEEN;
}

// Casts one ray from each point of the batch, and stores its link.
static void link_rays(olx_traced_bounce *t, olx_shade_scratch *scratch, uint32_t number) {
  const olx_shade_batch *roots = &scratch->roots;
  const olx_scene *scene = t->shade->scene;
  uint32_t count = 0;
  for (uint32_t k = 0; k < roots->count; k++) {
    const olx_surface *s = &roots->surface[k];
    const olx_vec2 random = olx_stratified2(roots->sequence[k] * OLX_BOUNCE_RAYS + number, roots->seed[k]);
    const olx_vec3 direction = olx_normalize(olx_from_basis(olx_sample_cosine(random), s->shading_normal));
    if (olx_dot(direction, s->geometric_normal) <= 0.0f) continue;
    scratch->owner[count] = scratch->slot[k];
    scratch->rays[count++] = olx_surface_ray(s, direction, INFINITY);
  }
  olx_bvh_intersect_many(scene->light_bvh, scratch->rays, count, false, scratch->hits);
  atomic_fetch_add_explicit(&t->shade->rays, count, memory_order_relaxed);
  for (uint32_t i = 0; i < count; i++) {
    const olx_ray_hit *hit = &scratch->hits[i];
    if (hit->triangle == OLX_NO_HIT) continue;
    const olx_ray *ray = &scratch->rays[i];
    const ray_end end = {olx_madd(ray->origin, ray->direction, hit->t),
                         triangle_normal(scene, hit->triangle, ray->direction), hit->triangle};
    t->links[(size_t)scratch->owner[i] * OLX_BOUNCE_RAYS + number] = find_link(t, &end);
  }
}

static void link_job(void *user, uint32_t index) {
  olx_traced_bounce *t = user;
  const olx_quadrature *q = t->quadrature;
  const uint32_t points = olx_gather_points(q), batches = points / OLX_BATCH_POINTS, probe = index / batches;
  olx_shade_scratch *scratch = olx_shade_scratch_take(t->shade);
  if (!scratch) return;
  olx_shade_batch_begin(&scratch->roots, 1);
  const bool buried = (probes_of(t)->flags[probe] & OLX_PROBE_BURIED) != 0; // its maps are never read
  for (uint32_t k = 0; k < OLX_BATCH_POINTS; k++) {
    const uint32_t point = index % batches * OLX_BATCH_POINTS + k;
    const size_t global = (size_t)probe * points + point;
    for (uint32_t number = 0; number < OLX_BOUNCE_RAYS; number++) t->links[global * OLX_BOUNCE_RAYS + number] = DARK;
    if (buried || t->hits[global].triangle == OLX_NO_HIT) continue;
    const uint32_t root =
        olx_shade_append(t->shade, &scratch->roots, &t->hits[global], stored_direction(t, probe, point),
                         olx_hash3(probe, point / 4, SALT_RAY), point % 4);
    scratch->slot[root] = (uint32_t)global;
  }
  for (uint32_t number = 0; number < OLX_BOUNCE_RAYS; number++) link_rays(t, scratch, number);
  olx_shade_scratch_give(t->shade, scratch);
}

olx_result olx_traced_bounce_link(olx_traced_bounce *t) {
  const uint32_t batches = olx_gather_points(t->quadrature) / OLX_BATCH_POINTS;
  OLX_TRY(olx_bake_for(t->context, probes_of(t)->count * batches, link_job, t, OLX_BATCH_POINTS * OLX_BOUNCE_RAYS));
  return olx_shade_check_memory(t->shade);
}

olx_vec3 olx_traced_irradiance(const olx_traced_bounce *t, size_t point, uint32_t bounce) {
  const olx_vec3 *light = olx_traced_light(t, bounce);
  olx_vec3 sum = {0};
  uint32_t count = 0;
  for (uint32_t number = 0; number < OLX_BOUNCE_RAYS; number++) {
    const uint32_t link = t->links[point * OLX_BOUNCE_RAYS + number];
    count += link != UNSEEN;
    if (link < UNSEEN) sum = olx_add(sum, light[link]);
  }
  return count ? olx_scale(sum, OLX_PI / (float)count) : sum;
}

static uint32_t list_arrays(olx_traced_bounce *t, uint64_t points, olx_array_row rows[4]) {
  rows[0] = (olx_array_row){&t->links, points * OLX_BOUNCE_RAYS, sizeof *t->links, false};
  rows[1] = (olx_array_row){&t->direct, points, sizeof *t->direct, true};
  rows[2] = (olx_array_row){&t->light[0], points, sizeof *t->light[0], true};
  rows[3] = (olx_array_row){&t->light[1], points, sizeof *t->light[1], true};
  return 4;
}

uint64_t olx_traced_bounce_bytes(uint32_t probe_count, uint32_t gather_points) {
  olx_traced_bounce unmade = {0};
  olx_array_row rows[4];
  return olx_arrays_bytes(rows, list_arrays(&unmade, (uint64_t)probe_count * gather_points, rows));
}

olx_result olx_traced_bounce_create(olx_traced_bounce *t) {
  const size_t points = (size_t)probes_of(t)->count * olx_gather_points(t->quadrature);
  if (points >= UNSEEN) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: bounces cannot be traced between %u irradiance probes",
                    probes_of(t)->count);
  }
  atomic_init(&t->rays, 0);
  atomic_init(&t->unseen, 0);
  olx_array_row rows[4];
  if (olx_arrays_allocate(rows, list_arrays(t, points, rows))) return OLX_OK;
  olx_traced_bounce_free(t);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the bounces of %u irradiance probes", probes_of(t)->count);
}

void olx_traced_bounce_free(olx_traced_bounce *t) {
  olx_release(t->links);
  olx_release(t->direct);
  for (uint32_t i = 0; i < 2; i++) {
    olx_release(t->light[i]);
    t->light[i] = NULL;
  }
  t->links = NULL;
  t->direct = NULL;
}
