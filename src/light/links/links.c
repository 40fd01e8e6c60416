// Casts the rays of surfels, and records where each ends.
#include "light/links/links.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "light/links/kept_rays.h"

#include <string.h>

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

static void add_point(cast_job *c, olx_point_list *list, const olx_surfel_point *point) {
  if (list->count == list->capacity) {
    const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
    olx_surfel_point *larger = olx_allocate(capacity, sizeof *larger);
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

static uint32_t seed_of(const olx_light_surfels *s, uint32_t surfel) {
  const uint64_t cell = s->surfels[surfel].cell;
  return olx_hash3(s->seed ^ (uint32_t)cell, (uint32_t)(cell >> 32), SALT_RAY);
}

olx_vec2 olx_links_ray_point(const olx_light_surfels *surfels, uint32_t surfel, uint32_t ray) {
  return olx_stratified2(ray, seed_of(surfels, surfel));
}

// The rays of a surfel in a batch: evenly drawn, or as many in each bin as a guide draws there.
typedef struct ray_plan {
  const olx_ray_pool *pool;   // NULL: evenly
  float worth;                // of each ray, in rays of even density
  uint32_t rays, seed, first; // first: index in the sequence of all batches
  olx_bin_sequence sequence;
  uint16_t bins[OLX_GUIDE_BINS]; // rays in each bin; evenly drawn ones are all in the first
} ray_plan;

static ray_plan plan_of(const olx_light_surfels *s, const olx_link_batch *batch, uint32_t surfel) {
  ray_plan plan = {.pool = olx_link_is_guided(batch) ? &batch->guide->pools[batch->guide->pool_of[surfel]] : NULL,
                   .worth = olx_link_worth(batch, surfel),
                   .rays = batch->rays,
                   .seed = seed_of(s, surfel),
                   .first = batch->first_ray};
  plan.sequence = olx_bin_sequence_make(plan.seed);
  if (plan.pool) olx_guide_divide(plan.pool, batch->rays, plan.bins);
  else plan.bins[0] = (uint16_t)batch->rays;
  return plan;
}

static olx_ray_draw draw_of(const ray_plan *plan, olx_ray_place place) {
  if (plan->pool) return olx_ray_draw_in_bin(&plan->sequence, place.bin, plan->first + place.number);
  const uint32_t index = plan->first + place.number;
  return (olx_ray_draw){olx_stratified2(index, plan->seed), plan->seed, index};
}

// Returns the factor on the light of each ray of a bin: bins count alike, however many rays each has.
static float factor_of(const ray_plan *plan, uint32_t bin) {
  if (!plan->pool) return plan->worth;
  return plan->worth * (float)plan->rays / (float)(OLX_GUIDE_BINS * plan->bins[bin]);
}

// Rays that are cast together.
typedef struct ray_packet {
  uint32_t count;
  olx_ray_place places[OLX_LINK_PACKET];
  olx_ray_draw draws[OLX_LINK_PACKET];
  float factors[OLX_LINK_PACKET]; // on the light that they bring
  olx_ray_end ends[OLX_LINK_PACKET];
} ray_packet;

// Draws the next rays of a plan, from a place on, which moves behind them.
static void draw_packet(const ray_plan *plan, olx_ray_place *next, ray_packet *packet) {
  packet->count = 0;
  for (; next->bin < OLX_GUIDE_BINS; next->bin++, next->number = 0) {
    for (; next->number < plan->bins[next->bin]; next->number++) {
      if (packet->count == OLX_LINK_PACKET) return;
      const uint32_t i = packet->count++;
      packet->places[i] = *next;
      packet->draws[i] = draw_of(plan, *next);
      packet->factors[i] = factor_of(plan, next->bin);
      packet->ends[i] = olx_ray_end_none();
    }
  }
}

// Returns a hash of everything that the rays of a surfel are drawn from, but for the surfel itself and the number of
// rays.
static uint64_t check_of(const cast_job *c, const ray_plan *plan) {
  const uint64_t numbers[] = {(uint64_t)plan->seed << 1 | (c->lists != NULL),
                              (uint64_t)plan->first << 1 | (plan->pool != NULL)};
  return olx_content_hash(numbers, sizeof numbers);
}

// Fills in the ends of the packet's rays that were cast for another scene and still hold.
static void take_former(const cast_job *c, olx_former_surfel *former, ray_packet *packet) {
  uint64_t reused = 0;
  for (uint32_t i = 0; former->unit && i < packet->count; i++) {
    const olx_former_ray ray = olx_former_ray_at(former, packet->places[i]);
    olx_ray_end *end = &packet->ends[i];
    if (!ray.holds) continue;
    *end = (olx_ray_end){.link = ray.link, .needs = ray.kept.needs, .cast = ray.kept.cast, .known = true};
    end->crossed = ray.kept.crossed;
    end->near = ray.kept.near;
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) end->fixed[k] = ray.kept.fixed[k];
    if (olx_ray_end_is_unserved(end)) end->point = *ray.point;
    reused += ray.kept.cast;
  }
  if (reused) atomic_fetch_add_explicit(c->keeping.reused, reused, memory_order_relaxed);
}

static void keep_end(const cast_job *c, size_t at, const olx_ray_end *end) {
  olx_kept_ray *ray = &c->keeping.kept->rays[at];
  ray->needs = end->needs;
  ray->crossed = end->crossed;
  ray->weight = end->link.weight;
  ray->cast = (uint32_t)end->cast;
  ray->near = end->near;
  for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) ray->fixed[k] = end->fixed[k];
}

static void keep_plan(const cast_job *c, uint32_t n, uint64_t check, const ray_plan *plan) {
  olx_kept_rays *kept = c->keeping.kept;
  kept->checks[n] = check;
  if (kept->bins) memcpy(kept->bins + (size_t)n * OLX_GUIDE_BINS, plan->bins, sizeof plan->bins);
}

// Adds the light that a ray brings without its link, and returns its luminance times pi.
static float add_fixed(olx_fixed_light *fixed, const olx_ray_end *end, float factor, float near_factor) {
  float luminance = 0.0f;
  for (uint32_t i = 0; i < OLX_CHAIN_MOST; i++) {
    olx_vec3 light = olx_scale(end->fixed[i], factor);
    if (i == 0) light = olx_madd(light, end->near, near_factor);
    fixed->sum[i] = olx_madd(fixed->sum[i], light, OLX_PI);
    luminance += OLX_PI * olx_luminance(light);
  }
  fixed->square += luminance * luminance;
  return luminance;
}

static olx_link scale_link(olx_link link, float factor) {
  if (factor != 1.0f) link.weight = olx_rgb9e5_pack(olx_scale(olx_rgb9e5_unpack(link.weight), factor));
  return link;
}

// Records what the rays of a packet found, as rays `first` to `first` + packet->count - 1 of surfel n of the batch.
static void record(cast_job *c, uint32_t job, uint32_t n, uint32_t first, const ray_plan *plan,
                   const ray_packet *packet) {
  olx_link_batch *batch = c->batch;
  for (uint32_t i = 0; i < packet->count; i++) {
    const size_t at = (size_t)n * batch->rays + first + i;
    const olx_ray_end *end = &packet->ends[i];
    batch->links[at] = scale_link(end->link, packet->factors[i]);
    const float fixed = add_fixed(&c->fixed[olx_link_surfel(batch, n)], end, packet->factors[i], plan->worth);
    if (batch->fixed) batch->fixed[at] = fixed;
    if (c->lists && olx_ray_end_is_unserved(end)) add_point(c, &c->lists[job], &end->point);
    c->rays[job] += end->cast;
    if (c->keeping.kept) keep_end(c, at, end);
  }
}

static void cast_surfel(cast_job *c, uint32_t n, uint32_t job) {
  const olx_light_surfels *s = c->caster.surfels;
  const uint32_t number = olx_link_surfel(c->batch, n);
  const olx_surface surface = olx_surfel_point_surface(s->scene, &s->surfels[number].point);
  const ray_plan plan = plan_of(s, c->batch, number);
  const uint64_t check = check_of(c, &plan);
  olx_former_surfel former = olx_former_rays_find(c->keeping.former, number, check);
  olx_ray_place next = {0};
  ray_packet packet;
  if (c->keeping.kept) keep_plan(c, n, check, &plan);
  for (uint32_t first = 0; first < c->batch->rays; first += packet.count) {
    draw_packet(&plan, &next, &packet);
    take_former(c, &former, &packet);
    olx_ray_ends_cast(&c->caster, &surface, packet.draws, packet.count, packet.ends);
    record(c, job, n, first, &plan, &packet);
  }
}

void olx_link_go_on(const olx_light_surfels *surfels, olx_link_batch *batch, size_t i, const olx_surface *surface,
                    olx_fixed_light *fixed, uint64_t *rays) {
  const uint32_t surfel = olx_link_surfel(batch, (uint32_t)(i / batch->rays)), ray = (uint32_t)(i % batch->rays);
  olx_link *link = &batch->links[i];
  const uint32_t seed = olx_hash2(seed_of(surfels, surfel), SALT_UNSERVED);
  const olx_vec3 weight = olx_rgb9e5_unpack(link->weight);
  const olx_ray_end end = olx_ray_end_go_on(surfels, surface, olx_link_chain(link), weight, seed, ray, rays);
  const float luminance = add_fixed(&fixed[surfel], &end, 1.0f, 0.0f);
  if (batch->fixed) batch->fixed[i] += luminance;
  *link = end.link;
}

olx_ray_sum olx_links_add_up(const olx_light_surfels *surfels, uint32_t surfel, const olx_ray_guide *guide,
                             uint32_t first, uint32_t count, const olx_passed_light *light, uint64_t *rays) {
  const olx_ray_caster caster = {.surfels = surfels};
  const olx_link_batch batch = {.guide = guide, .first_ray = first, .rays = count};
  const ray_plan plan = plan_of(surfels, &batch, surfel);
  const olx_surface surface = olx_surfel_point_surface(surfels->scene, &surfels->surfels[surfel].point);
  olx_ray_sum sum = {.worth = plan.worth * (float)count};
  double mean = 0.0, square = 0.0;
  olx_ray_place next = {0};
  ray_packet packet;
  for (uint32_t done = 0; done < count; done += packet.count) {
    draw_packet(&plan, &next, &packet);
    olx_ray_ends_cast(&caster, &surface, packet.draws, packet.count, packet.ends);
    for (uint32_t i = 0; i < packet.count; i++) {
      const olx_vec3 brought = olx_ray_end_light(&packet.ends[i], packet.factors[i], plan.worth, light);
      const double luminance = (double)olx_luminance(brought);
      sum.light = olx_add(sum.light, brought);
      mean += luminance / count;
      square += luminance * luminance;
      *rays += packet.ends[i].cast;
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
