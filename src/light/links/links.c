// Casts the rays of surfels, and records where each ends.
#include "light/links/links.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "light/links/kept_rays.h"

enum { SURFELS_PER_JOB = 8, SALT_RAY = 0x52415953, SALT_UNSERVED = 0x554E5356 };

typedef struct cast_job {
  olx_ray_caster caster;
  olx_link_batch *batch;
  olx_fixed_light *fixed;
  olx_point_list *lists; // one per job, or NULL
  uint64_t *rays;        // one per job
  olx_cast_keeping keeping;
  atomic_bool *out_of_memory;
} cast_job;

static void add_point(cast_job *c, olx_point_list *list, const olx_surface_point *point) {
  if (list->count == list->capacity) {
    const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
    olx_surface_point *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) {
      atomic_store(c->out_of_memory, true);
      return;
    }
    for (uint32_t i = 0; i < list->count; i++) larger[i] = list->points[i];
    olx_release(list->points);
    list->points = larger;
    list->capacity = capacity;
  }
  list->points[list->count++] = *point;
}

// How the rays of a surfel are drawn: by a pool's density, or evenly without one.
typedef struct ray_plan {
  const olx_ray_pool *pool;
  float factor; // on what all rays bring
  uint32_t seed;
} ray_plan;

static olx_ray_draw draw_of(const ray_plan *plan, uint32_t index) {
  olx_vec2 point = olx_stratified2(index, plan->seed);
  float density = 1.0f;
  if (plan->pool) point = olx_guide_warp(plan->pool, point, &density);
  return (olx_ray_draw){point, plan->factor / density, plan->factor, plan->seed, index};
}

// Casts up to OLX_LINK_PACKET rays of a surfel, from index `first` on, but for those whose ends are known.
static void cast_packet(const olx_ray_caster *caster, const olx_surface *surface, const ray_plan *plan, uint32_t first,
                        uint32_t count, olx_ray_end *ends) {
  olx_ray_draw draws[OLX_LINK_PACKET];
  for (uint32_t i = 0; i < count; i++) draws[i] = draw_of(plan, first + i);
  olx_ray_ends_cast(caster, surface, draws, count, ends);
}

// Adds the light that a ray brings without its link, and returns its luminance times pi.
static float add_fixed(olx_fixed_light *fixed, const olx_ray_end *end) {
  float luminance = 0.0f;
  for (uint32_t i = 0; i < OLX_CHAIN_MOST; i++) {
    fixed->sum[i] = olx_madd(fixed->sum[i], end->fixed[i], OLX_PI);
    luminance += OLX_PI * olx_luminance(end->fixed[i]);
  }
  fixed->square += luminance * luminance;
  return luminance;
}

static uint32_t seed_of(const olx_light_surfels *s, uint32_t surfel) {
  const uint64_t cell = s->surfels[surfel].cell;
  return olx_hash3(s->seed ^ (uint32_t)cell, (uint32_t)(cell >> 32), SALT_RAY);
}

void olx_link_go_on(const olx_light_surfels *surfels, olx_link_batch *batch, size_t i, const olx_surface *surface,
                    olx_fixed_light *fixed, uint64_t *rays) {
  const uint32_t surfel = olx_link_surfel(batch, (uint32_t)(i / batch->rays)), ray = (uint32_t)(i % batch->rays);
  olx_link *link = &batch->links[i];
  const uint32_t seed = olx_hash2(seed_of(surfels, surfel), SALT_UNSERVED);
  const olx_vec3 weight = olx_rgb9e5_unpack(link->weight);
  const olx_ray_end end = olx_ray_end_go_on(surfels, surface, olx_link_chain(link), weight, seed, ray, rays);
  const float luminance = add_fixed(&fixed[surfel], &end);
  if (batch->fixed) batch->fixed[i] += luminance;
  *link = end.link;
}

olx_vec2 olx_links_ray_point(const olx_light_surfels *surfels, uint32_t surfel, uint32_t ray) {
  return olx_stratified2(ray, seed_of(surfels, surfel));
}

static ray_plan plan_of(const olx_light_surfels *s, const olx_link_batch *batch, uint32_t surfel) {
  return (ray_plan){.pool = batch->guide ? &batch->guide->pools[batch->guide->pool_of[surfel]] : NULL,
                    .factor = olx_link_worth(batch, surfel),
                    .seed = seed_of(s, surfel)};
}

// Returns a hash of everything that the rays of a surfel are drawn from, but for the surfel itself.
static uint64_t check_of(const cast_job *c, const ray_plan *plan) {
  if (!c->keeping.kept) return 0;
  const uint64_t numbers[] = {plan->pool ? olx_content_hash(plan->pool, sizeof *plan->pool) : 0,
                              (uint64_t)plan->seed << 1 | (c->lists != NULL)};
  return olx_content_hash(numbers, sizeof numbers);
}

static uint64_t check_of_packet(uint64_t check, uint32_t first, uint32_t count) {
  const uint64_t numbers[] = {check, (uint64_t)first << 32 | count};
  return olx_content_hash(numbers, sizeof numbers);
}

// Fills in the ends of the packet's rays that were cast for another scene and still hold.
static void take_former(const cast_job *c, uint32_t surfel, uint32_t packet, uint64_t check, uint32_t count,
                        olx_ray_end *ends) {
  olx_former_packet former = olx_former_rays_find(c->keeping.former, surfel, packet, check);
  uint64_t reused = 0;
  for (uint32_t i = 0; former.unit && i < count; i++) {
    const olx_former_ray ray = olx_former_packet_next(&former);
    if (!ray.holds) continue;
    ends[i] = (olx_ray_end){.link = ray.link, .needs = ray.kept.needs, .cast = ray.kept.cast, .known = true};
    ends[i].crossed = ray.kept.crossed;
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) ends[i].fixed[k] = ray.kept.fixed[k];
    if (olx_ray_end_is_unserved(&ends[i])) ends[i].point = *ray.point;
    reused += ray.kept.cast;
  }
  if (reused) atomic_fetch_add_explicit(c->keeping.reused, reused, memory_order_relaxed);
}

static void keep_end(const cast_job *c, size_t at, const olx_ray_end *end) {
  olx_kept_ray *ray = &c->keeping.kept->rays[at];
  ray->needs = end->needs;
  ray->crossed = end->crossed;
  ray->cast = (uint32_t)end->cast;
  for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) ray->fixed[k] = end->fixed[k];
}

static void cast_surfel(cast_job *c, uint32_t n, uint32_t job) {
  const olx_light_surfels *s = c->caster.surfels;
  olx_link_batch *batch = c->batch;
  const uint32_t number = olx_link_surfel(batch, n);
  const olx_light_surfel *surfel = &s->surfels[number];
  const olx_surface surface = olx_surface_point_surface(s->scene, &surfel->point);
  const ray_plan plan = plan_of(s, batch, number);
  const uint64_t check = check_of(c, &plan);
  const uint32_t packets = (batch->rays + OLX_LINK_PACKET - 1) / OLX_LINK_PACKET;
  for (uint32_t k = 0; k < packets; k++) {
    const uint32_t first = k * OLX_LINK_PACKET, left = batch->rays - first;
    const uint32_t count = left < OLX_LINK_PACKET ? left : OLX_LINK_PACKET;
    olx_ray_end ends[OLX_LINK_PACKET];
    for (uint32_t i = 0; i < count; i++) ends[i] = olx_ray_end_none();
    if (c->keeping.kept) {
      const uint64_t own = check_of_packet(check, batch->first_ray + first, count);
      c->keeping.kept->checks[(size_t)n * packets + k] = own;
      take_former(c, number, k, own, count, ends);
    }
    cast_packet(&c->caster, &surface, &plan, batch->first_ray + first, count, ends);
    for (uint32_t i = 0; i < count; i++) {
      const size_t at = (size_t)n * batch->rays + first + i;
      batch->links[at] = ends[i].link;
      const float fixed = add_fixed(&c->fixed[number], &ends[i]);
      if (batch->fixed) batch->fixed[at] = fixed;
      if (c->lists && olx_ray_end_is_unserved(&ends[i])) add_point(c, &c->lists[job], &ends[i].point);
      c->rays[job] += ends[i].cast;
      if (c->keeping.kept) keep_end(c, at, &ends[i]);
    }
  }
}

olx_ray_sum olx_links_add_up(const olx_light_surfels *surfels, uint32_t surfel, const olx_ray_guide *guide,
                             uint32_t first, uint32_t count, const olx_passed_light *light, uint64_t *rays) {
  const olx_ray_caster c = {.surfels = surfels};
  const olx_link_batch batch = {.guide = guide};
  const ray_plan plan = plan_of(surfels, &batch, surfel);
  const olx_surface surface = olx_surface_point_surface(surfels->scene, &surfels->surfels[surfel].point);
  olx_ray_sum sum = {.worth = plan.factor * (float)count};
  double mean = 0.0, square = 0.0;
  for (uint32_t done = 0; done < count; done += OLX_LINK_PACKET) {
    const uint32_t packet = count - done < OLX_LINK_PACKET ? count - done : OLX_LINK_PACKET;
    olx_ray_end ends[OLX_LINK_PACKET] = {0};
    cast_packet(&c, &surface, &plan, first + done, packet, ends);
    for (uint32_t i = 0; i < packet; i++) {
      const olx_vec3 brought = olx_ray_end_light(&ends[i], light);
      const double luminance = (double)olx_luminance(brought);
      sum.light = olx_add(sum.light, brought);
      mean += luminance / count;
      square += luminance * luminance;
      *rays += ends[i].cast;
    }
  }
  sum.squares = (float)fmax(0.0, square - count * mean * mean);
  return sum;
}

static void cast_some(void *user, uint32_t job) {
  cast_job c = *(const cast_job *)user;
  olx_watched_surfels watched;
  const uint32_t first = job * SURFELS_PER_JOB;
  const uint32_t end = first + SURFELS_PER_JOB < c.batch->count ? first + SURFELS_PER_JOB : c.batch->count;
  if (c.keeping.kept) olx_ray_caster_watch(&c.caster, &watched);
  for (uint32_t n = first; n < end; n++) cast_surfel(&c, n, job);
  olx_link_batch_rest(c.batch, first, end);
}

// Concatenates the lists of jobs, in the order of jobs.
static olx_result join_lists(const olx_point_list *lists, uint32_t jobs, olx_point_list *all) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < jobs; i++) count += lists[i].count;
  *all = (olx_point_list){.points = olx_allocate(count, sizeof *all->points), .capacity = count};
  if (!all->points) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", count);
  for (uint32_t i = 0; i < jobs; i++) {
    for (uint32_t k = 0; k < lists[i].count; k++) all->points[all->count++] = lists[i].points[k];
  }
  return OLX_OK;
}

olx_result olx_links_cast(const olx_light_surfels *surfels, olx_link_batch *batch, olx_fixed_light *fixed,
                          olx_point_list *unserved, const olx_cast_keeping *keeping, uint64_t *rays) {
  const uint32_t jobs = (batch->count + SURFELS_PER_JOB - 1) / SURFELS_PER_JOB;
  atomic_bool out_of_memory = false;
  cast_job c = {.caster = {.surfels = surfels, .ends_unserved = unserved != NULL},
                .batch = batch,
                .out_of_memory = &out_of_memory,
                .fixed = fixed,
                .lists = unserved ? olx_allocate_zero(jobs, sizeof *c.lists) : NULL,
                .rays = olx_allocate_zero(jobs, sizeof *c.rays)};
  if (keeping) c.keeping = *keeping;
  olx_result result = OLX_OK;
  if (!c.rays || (unserved && !c.lists)) result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for casting rays");
  if (result == OLX_OK) result = olx_parallel_for(jobs, surfels->threads, cast_some, &c, surfels->task, 0);
  if (result == OLX_OK && atomic_load(&out_of_memory)) {
    result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for points of surfaces");
  }
  if (result == OLX_OK && unserved) result = join_lists(c.lists, jobs, unserved);
  for (uint32_t i = 0; c.rays && i < jobs; i++) *rays += c.rays[i];
  for (uint32_t i = 0; c.lists && i < jobs; i++) olx_release(c.lists[i].points);
  olx_release(c.lists);
  olx_release(c.rays);
  return result;
}