// Finds the direct light of surfels from samples at points of their cells. Surfels close together first learn where
// they see the sky, such as through a window.
#include "light/solution/light_direct.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/direct_light.h"

enum {
  LEAST_POINTS = 64,     // least points per cell at which direct light is sampled
  MOST_POINTS = 256,     // most points per cell at which direct light is sampled
  ALL_POINTS = 1 << 19,  // points at which direct light is sampled in all, within the bounds per cell
  REGION_LEVELS = 12,    // surfels learn together first in cells this many levels above their own
  REGION_LESSONS = 3,    // most rounds in which a region learns where the sky is seen
  REGION_SAMPLES = 8192, // samples of a region in a round
  POOL_LESSONS = 2,      // most rounds in which a pool learns more
  POOL_SAMPLES = 16,     // samples of a pool in a round for each of its surfels, within these bounds
  LEAST_POOL_SAMPLES = 64,
  MOST_POOL_SAMPLES = 1024,
  FADED = 4,        // a pool counts what its region learnt as this many samples that found light
  FOUND_EASILY = 4, // nothing more is learnt where there are more finds than samples over this
  UNIT_SURFELS = 1 << 15,
  SALT_DIRECT = 0x44495245,
  SALT_LAMPS = 0x4C4D5053,
  SALT_LESSON = 0x4C45534E
};

// The sun reaches a cell unevenly where the range of what it brings is above this share of the mean direct light.
static const float UNEVEN_RANGE = 0.25f;

// Surfels by the pools in which they also learn to guide rays (ray_guide.h), and pools by regions.
typedef struct surfel_order {
  uint32_t *pool_of, *region_of; // of each surfel
  uint32_t *by_pool, *by_region; // surfels in order of their pool, or region
  uint32_t *pools, *regions;     // where each begins there, and the end
  uint32_t pool_count, region_count;
} surfel_order;

typedef struct direct_job {
  olx_scene_light *light;
  const surfel_order *order;
  olx_sky_guide *skies; // of regions
  uint32_t points;      // points per cell
  uint32_t first, end;  // range of surfels
  uint64_t *rays;       // one per pool
} direct_job;

// What the points of a cell receive.
typedef struct cell_sum {
  olx_vec3 lamps, sky; // from lamps and emitting surfaces, and from the sky
  float least, most;   // of the luminance that suns bring
} cell_sum;

// Returns a sample of the irradiance that the sky brings to a surface.
static olx_vec3 sky_light(const olx_light_surfels *s, const olx_surface *surface, const olx_sampler *sampler,
                          olx_sky_guide *sky, uint64_t *rays) {
  olx_sampler guided = olx_sky_guide_sampler(sky, sampler);
  const olx_direct_query query = {.kinds = OLX_DIRECT_SKY, .sky = sky};
  return olx_direct_irradiance_of(s->scene, surface, &query, &guided, rays);
}

static void add_point(const olx_light_surfels *s, const olx_light_surfel *surfel, const olx_surfel_point *point,
                      uint32_t k, olx_sky_guide *sky, cell_sum *sum, uint64_t *rays) {
  const uint32_t seed = olx_hash3(s->seed ^ (uint32_t)surfel->cell, (uint32_t)(surfel->cell >> 32), SALT_DIRECT);
  const olx_surface surface = olx_surfel_point_surface(s->scene, point);
  olx_sampler sampler = {.seed = olx_hash2(seed, SALT_LAMPS), .index = k};
  const olx_direct_query of_lamps = {.kinds = OLX_DIRECT_BUT_SKY, .dark = s->lamps.radius};
  sum->lamps = olx_add(sum->lamps, olx_direct_irradiance_of(s->scene, &surface, &of_lamps, &sampler, rays));
  sum->sky = olx_add(sum->sky, sky_light(s, &surface, &(olx_sampler){.seed = seed, .index = k}, sky, rays));
  const float sun = olx_luminance(olx_direct_irradiance_of_suns(s->scene, &surface, rays));
  sum->least = olx_min(sum->least, sun);
  sum->most = olx_max(sum->most, sun);
}

// Returns OLX_SUN_MISSES, OLX_SUN_REACHES or both, for a cell whose direct light has the mean luminance `mean`.
static uint32_t reach_of(const cell_sum *sum, float mean) {
  if (sum->most <= 0.0f) return OLX_SUN_MISSES;
  return sum->most - sum->least > UNEVEN_RANGE * mean ? OLX_SUN_UNEVEN : OLX_SUN_REACHES;
}

// Returns the direct light of a surfel, from points that are spread over the area of its cell, because most points of
// the cell lie near probes.
static olx_surfel_lit light_cell(const direct_job *d, const olx_light_surfel *surfel, olx_sky_guide *sky,
                                 uint64_t *rays) {
  const olx_light_surfels *s = &d->light->surfels;
  const olx_surfel_point *points = s->points + surfel->first_point;
  float area = 0.0f, passed = 0.0f;
  for (uint32_t i = 0; i < surfel->point_count; i++) area += olx_surfel_point_area(&points[i]);
  cell_sum sum = {.least = INFINITY};
  for (uint32_t k = 0, i = 0; k < d->points; k++) {
    const float wanted = area * ((float)k + 0.5f) / (float)d->points;
    while (i + 1 < surfel->point_count && passed + olx_surfel_point_area(&points[i]) < wanted)
      passed += olx_surfel_point_area(&points[i++]);
    add_point(s, surfel, &points[i], k, sky, &sum, rays);
  }
  const olx_vec3 lamps = olx_scale(sum.lamps, 1.0f / (float)d->points),
                 from_sky = olx_scale(sum.sky, 1.0f / (float)d->points), all = olx_add(lamps, from_sky);
  return (olx_surfel_lit){all, from_sky, reach_of(&sum, olx_luminance(all))};
}

// Learns where surfels see the sky, from samples at points that are spread over them, until these find it easily.
static void learn_sky(const olx_light_surfels *s, const uint32_t *surfels, uint32_t count, uint32_t lessons,
                      uint32_t samples, olx_sky_guide *sky, uint64_t *rays) {
  const uint64_t cell = s->surfels[surfels[0]].cell;
  for (uint32_t lesson = 0; lesson < lessons; lesson++) {
    const uint32_t seed = olx_hash3(s->seed ^ (uint32_t)cell, (uint32_t)(cell >> 32), SALT_LESSON + lesson);
    const uint32_t before = sky->found;
    for (uint32_t k = 0; k < samples; k++) {
      const olx_vec2 at = olx_hammersley(k, samples);
      const olx_light_surfel *surfel = &s->surfels[surfels[(uint32_t)(at.x * (float)count)]];
      const uint32_t point = surfel->first_point + (uint32_t)(at.y * (float)surfel->point_count);
      const olx_surface surface = olx_surfel_point_surface(s->scene, &s->points[point]);
      (void)sky_light(s, &surface, &(olx_sampler){.seed = seed, .index = k}, sky, rays);
    }
    if (sky->found == before || FOUND_EASILY * (sky->found - before) > samples) return;
    olx_sky_guide_next(sky, 1u << 2 * lesson);
  }
}

static bool is_wanted(const direct_job *d, const uint32_t *surfels, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    if (surfels[i] >= d->first && surfels[i] < d->end) return true;
  }
  return false;
}

static void learn_region(void *user, uint32_t region) {
  const direct_job *d = user;
  const surfel_order *o = d->order;
  const uint32_t first = o->regions[region], count = o->regions[region + 1] - first;
  olx_sky_guide *sky = &d->skies[region];
  olx_sky_guide_begin(sky);
  // Rays are added to the count of the pool with the region's number: there are at least as many pools as regions.
  if (olx_environment_lit(d->light->scene) && is_wanted(d, o->by_region + first, count)) {
    learn_sky(&d->light->surfels, o->by_region + first, count, REGION_LESSONS, REGION_SAMPLES, sky, &d->rays[region]);
  }
}

static uint32_t pool_samples(uint32_t surfels) {
  if (surfels > MOST_POOL_SAMPLES / POOL_SAMPLES) return MOST_POOL_SAMPLES;
  return surfels < LEAST_POOL_SAMPLES / POOL_SAMPLES ? LEAST_POOL_SAMPLES : POOL_SAMPLES * surfels;
}

// Lights those surfels of a pool that are in the range. Where no sky is seen from its region, it does not look for it.
static void light_pool(void *user, uint32_t pool) {
  const direct_job *d = user;
  const olx_light_surfels *s = &d->light->surfels;
  const surfel_order *o = d->order;
  const uint32_t *surfels = o->by_pool + o->pools[pool], count = o->pools[pool + 1] - o->pools[pool];
  if (!is_wanted(d, surfels, count)) return;
  olx_sky_guide sky = d->skies[o->region_of[surfels[0]]];
  if (sky.found > 0) {
    olx_sky_guide_fade(&sky, FADED);
    learn_sky(s, surfels, count, POOL_LESSONS, pool_samples(count), &sky, &d->rays[pool]);
  }
  for (uint32_t i = 0; i < count; i++) {
    if (surfels[i] < d->first || surfels[i] >= d->end) continue;
    d->light->lit[surfels[i]] = light_cell(d, &s->surfels[surfels[i]], &sky, &d->rays[pool]);
  }
}

// Lists surfels in the order of a number that each has. starts[n] receives where those of number n begin.
static void sort_by(const uint32_t *number_of, uint32_t count, uint32_t numbers, uint32_t *surfels, uint32_t *starts) {
  for (uint32_t i = 0; i <= numbers; i++) starts[i] = 0;
  for (uint32_t i = 0; i < count; i++) starts[number_of[i] + 1]++;
  for (uint32_t i = 0; i < numbers; i++) starts[i + 1] += starts[i];
  for (uint32_t i = 0; i < count; i++) surfels[starts[number_of[i]]++] = i;
  for (uint32_t i = numbers; i > 0; i--) starts[i] = starts[i - 1];
  starts[0] = 0;
}

static void free_order(surfel_order *o) {
  olx_release(o->pool_of);
  olx_release(o->region_of);
  olx_release(o->by_pool);
  olx_release(o->by_region);
  olx_release(o->pools);
  olx_release(o->regions);
}

static olx_result make_order(surfel_order *o, const olx_light_surfels *s) {
  const uint32_t count = s->count;
  *o = (surfel_order){.pool_of = olx_allocate(count, sizeof *o->pool_of),
                      .region_of = olx_allocate(count, sizeof *o->region_of),
                      .by_pool = olx_allocate(count, sizeof *o->by_pool),
                      .by_region = olx_allocate(count, sizeof *o->by_region),
                      .pools = olx_allocate(count + 1, sizeof *o->pools),
                      .regions = olx_allocate(count + 1, sizeof *o->regions)};
  if (!o->pool_of || !o->region_of || !o->by_pool || !o->by_region || !o->pools || !o->regions)
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
  OLX_TRY(olx_pool_surfels(s, OLX_POOL_LEVELS, o->pool_of, &o->pool_count));
  OLX_TRY(olx_pool_surfels(s, REGION_LEVELS, o->region_of, &o->region_count));
  sort_by(o->pool_of, count, o->pool_count, o->by_pool, o->pools);
  sort_by(o->region_of, count, o->region_count, o->by_region, o->regions);
  return OLX_OK;
}

static olx_result fill_in_order(direct_job *d, uint64_t *rays) {
  const uint32_t threads = d->light->settings.threads, pools = d->order->pool_count;
  olx_task *task = d->light->settings.task;
  d->skies = olx_allocate(d->order->region_count, sizeof *d->skies);
  d->rays = olx_allocate_zero(pools, sizeof *d->rays);
  olx_result result =
      d->skies && d->rays ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for direct light");
  if (result == OLX_OK) result = olx_parallel_for(d->order->region_count, threads, learn_region, d, task, 0);
  if (result == OLX_OK) result = olx_parallel_for(pools, threads, light_pool, d, task, 0);
  for (uint32_t i = 0; result == OLX_OK && i < pools; i++) *rays += d->rays[i];
  olx_release(d->skies);
  olx_release(d->rays);
  return result;
}

static olx_result fill(olx_scene_light *l, uint32_t first, uint32_t end, uint64_t *rays) {
  surfel_order order;
  direct_job d = {.light = l, .order = &order, .points = LEAST_POINTS, .first = first, .end = end};
  while (d.points < MOST_POINTS && (uint64_t)d.points * l->surfels.count < ALL_POINTS) d.points *= 2;
  olx_result result = make_order(&order, &l->surfels);
  if (result == OLX_OK) result = fill_in_order(&d, rays);
  free_order(&order);
  return result;
}

static uint32_t round_of(const olx_scene_light *l) {
  (void)l;
  return 0;
}

static uint32_t units_of(const olx_scene_light *l) { return (l->surfels.count + UNIT_SURFELS - 1) / UNIT_SURFELS; }

static uint32_t first_of(const olx_scene_light *l, uint32_t unit) {
  return unit < units_of(l) ? unit * UNIT_SURFELS : l->surfels.count;
}

static void *array_of(olx_scene_light *l) {
  if (!l->lit) l->lit = olx_allocate_zero(l->surfels.count, sizeof *l->lit);
  return l->lit;
}

const olx_light_ranges olx_direct_ranges = {"direct", sizeof(olx_surfel_lit), round_of, units_of, first_of, array_of,
                                            fill};
