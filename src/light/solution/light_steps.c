// Solves a scene's light in steps: finds the surfaces that probes see, distributes surfels over them, casts more rays
// where light varies more, and propagates light over the links until it converges. light_units.c runs the steps.
#include "light/solution/light_steps.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/result.h"
#include "light/links/learn_rays.h"
#include "light/links/link_batch.h"
#include "light/solution/final_gather.h"
#include "light/solution/light_checkpoint.h"
#include "light/solution/light_noise.h"
#include "light/solution/light_records.h"
#include "scene/bvh.h"
#include "scene/texel_samples.h"

enum {
  FIRST_RAYS = 64,         // per surfel in the first round
  LEAST_RAYS = 16,         // per surfel where memory is short
  FEW_BOUNCES = 4,         // bounces from which noise is estimated
  MOST_VIEW_SIDE = 1024,   // most rays along the side of a probe's view map
  LEAST_VIEW_SIDE = 32,    // least rays along the side of that map
  MOST_VIEW_RAYS = 1 << 24 // rays of all views, as far as the least side allows
};

// Finds the surfaces that probes see, by one ray for each 2 x 2 texels or by fewer (view_side).
typedef struct view_job {
  const olx_scene_light *light;
  const olx_vec3 *positions;
  uint32_t size;            // rays along the side of a probe's map
  olx_surfel_point *points; // size^2 per probe
  uint32_t *counts;         // number of points in each row of rays
} view_job;

static void view_row(void *user, uint32_t row) {
  const view_job *v = user;
  const uint32_t size = v->size, probe = row / size, y = row % size;
  const olx_vec2 offset = olx_texel_sample_offset();
  olx_ray rays[MOST_VIEW_SIDE] = {0};
  olx_ray_hit hits[MOST_VIEW_SIDE];
  for (uint32_t x = 0; x < size; x++) {
    const olx_vec2 uv = {((float)x + offset.x) / (float)size, ((float)y + offset.y) / (float)size};
    rays[x] = (olx_ray){v->positions[probe], olx_octahedral_decode(uv), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(v->light->scene->bvh, rays, size, true, hits);
  olx_surfel_point *points = v->points + (size_t)row * size;
  uint32_t count = 0;
  for (uint32_t x = 0; x < size; x++) {
    if (hits[x].triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(v->light->scene, &hits[x], rays[x].direction);
    const float footprint = hits[x].t * 2.5f / (float)v->light->settings.map_size;
    points[count++] = olx_surfel_point_make(&v->light->surfels.grid, &surface, &hits[x], footprint);
  }
  v->counts[row] = count;
}

// Returns the number of rays along the side of a probe's view: fewer for large maps, and for many probes, because they
// see the same surfaces.
static uint32_t view_side(uint32_t map_size, uint32_t probes) {
  uint32_t side = map_size / 2 < MOST_VIEW_SIDE ? map_size / 2 : MOST_VIEW_SIDE;
  while (side > LEAST_VIEW_SIDE && (uint64_t)side * side * probes > MOST_VIEW_RAYS) side /= 2;
  return side;
}

static olx_result look_around(olx_scene_light *l, const olx_vec3 *positions, uint32_t count) {
  const uint32_t size = view_side(l->settings.map_size, count), rows = size * count;
  view_job v = {.light = l,
                .positions = positions,
                .size = size,
                .points = olx_allocate((size_t)rows * size, sizeof *v.points),
                .counts = olx_allocate(rows, sizeof *v.counts)};
  olx_result result = v.points && v.counts ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for views");
  if (result == OLX_OK) result = olx_parallel_for(rows, l->settings.threads, view_row, &v, l->settings.task, 0);
  uint32_t kept = 0;
  for (uint32_t row = 0; result == OLX_OK && row < rows; row++) {
    for (uint32_t i = 0; i < v.counts[row]; i++) v.points[kept++] = v.points[(size_t)row * size + i];
  }
  l->report.rays += (uint64_t)rows * size;
  if (result == OLX_OK) result = olx_light_surfels_add(&l->surfels, v.points, kept);
  olx_release(v.points);
  olx_release(v.counts);
  return result;
}

static olx_result find_surfaces(olx_scene_light *l, const olx_vec3 *positions, const uint8_t *flags, uint32_t count) {
  olx_vec3 *open = olx_allocate(count, sizeof *open);
  if (!open) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u probes", count);
  uint32_t kept = 0;
  for (uint32_t i = 0; i < count; i++) {
    if (flags[i] == 0) open[kept++] = positions[i];
  }
  const olx_result result = look_around(l, open, kept);
  olx_release(open);
  return result;
}

// Grows the arrays that hold data for each surfel.
static olx_result grow_links(olx_scene_light *l, uint32_t from) {
  const uint32_t count = l->surfels.count;
  olx_fixed_light *fixed = olx_allocate_zero(count, sizeof *fixed);
  float *worth = olx_allocate_zero(count, sizeof *worth);
  for (uint32_t i = 0; fixed && i < from; i++) fixed[i] = l->links.fixed[i];
  olx_release(l->links.fixed);
  olx_release(l->links.worth);
  l->links.fixed = fixed;
  l->links.worth = worth;
  return fixed && worth ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
}

// Adds a batch whose rays are cast next, with others of the same round.
static void add_batch(olx_scene_light *l, const olx_link_batch *batch) {
  l->rounds_of[l->links.batch_count] = l->round;
  l->batches[l->links.batch_count] = *batch;
  l->batches[l->links.batch_count++].folder = l->settings.link_folder;
  l->report.links += (size_t)batch->count * batch->rays;
}

// Relinks rays of the last batch that ended without a surfel: to the surfel that is there now, or by continuing the
// ray. The patch records the results.
static void link_to_new(olx_scene_light *l, olx_link_patch *patch) {
  olx_link_batch *batch = &l->batches[l->links.batch_count - 1];
  uint32_t from = 0;
  for (size_t i = 0; i < (size_t)batch->count * batch->rays; i++) {
    olx_link *link = &batch->links[i];
    if (i % batch->rays == 0 && i > 0) olx_link_batch_passed(batch, (uint32_t)(i / batch->rays) - 1, &from);
    if (olx_link_end(link) != OLX_LINK_UNSERVED) continue;
    const olx_surfel_point *point = &l->unserved.points[patch->count];
    const olx_surface surface = olx_surfel_point_surface(l->scene, point);
    const olx_surfel_found found = olx_light_surfels_find(&l->surfels, point->key, &surface, INFINITY);
    if (found.surfel != OLX_CELL_NONE) link->end = (link->end & ~OLX_LINK_NOWHERE) | found.surfel;
    else olx_link_go_on(&l->surfels, batch, i, &surface, l->links.fixed, &l->report.rays);
    patch->links[patch->count] = *link;
    patch->fixed[patch->count++] = batch->fixed[i];
  }
  olx_link_batch_rest(batch, 0, batch->count);
}

// Prepares the first rays of the surfels from index `from` on.
static olx_result begin_first_rays(olx_scene_light *l, uint32_t from) {
  const olx_link_batch batch = {.first_surfel = from, .count = l->surfels.count - from, .rays = l->first_rays};
  OLX_TRY(grow_links(l, from));
  l->served = l->surfels.count;
  add_batch(l, &batch);
  return OLX_OK;
}

// Adds surfels on surfaces that rays of the last round hit and no probe sees.
static olx_result add_hidden(olx_scene_light *l) {
  olx_link_patch *patch = &l->patches[l->round];
  if (l->unserved.count == 0) return OLX_OK;
  patch->links = olx_allocate(l->unserved.count, sizeof *patch->links);
  patch->fixed = olx_allocate(l->unserved.count, sizeof *patch->fixed);
  if (!patch->links || !patch->fixed) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for links");
  OLX_TRY(olx_light_surfels_add(&l->surfels, l->unserved.points, l->unserved.count));
  link_to_new(l, patch);
  return OLX_OK;
}

static void count_rays(olx_scene_light *l) {
  for (uint32_t i = 0; i < l->surfels.count; i++) l->links.worth[i] = 0.0f;
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    const olx_link_batch *batch = &l->batches[k];
    for (uint32_t n = 0; n < batch->count; n++) {
      const uint32_t surfel = olx_link_surfel(batch, n);
      l->links.worth[surfel] += olx_link_worth(batch, surfel) * (float)batch->rays;
    }
  }
}

static olx_result begin_direct(olx_scene_light *l) {
  const uint32_t count = l->surfels.count;
  l->irradiance = olx_allocate_zero(count, sizeof *l->irradiance);
  l->passed_on = olx_allocate_zero(count, sizeof *l->passed_on);
  l->noise = olx_allocate_zero(count, sizeof *l->noise);
  l->report.hidden_surfels = count - l->visible;
  if (l->irradiance && l->passed_on && l->noise) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
}

// Returns the share of the last bounce: the light that surfels receive beyond what they pass on, weighted by their
// share of the surface.
static double last_bounce(const olx_scene_light *l) {
  double last = 0.0, all = 0.0;
  for (uint32_t i = 0; i < l->visible; i++) {
    const double side = (double)l->surfels.surfels[i].side, indirect = (double)olx_luminance(l->irradiance[i]);
    last += side * side * ((double)olx_luminance(l->direct[i]) + indirect - (double)olx_luminance(l->passed_on[i]));
    all += side * side * indirect;
  }
  return all > 0.0 ? fmin(fmax(last / all, 0.0), 1.0) : 0.0;
}

// Solves at most `bounces` of the bounces that the settings request.
static olx_result solve(olx_scene_light *l, uint32_t bounces) {
  const uint32_t asked = l->settings.bounces;
  count_rays(l);
  olx_light_checkpoint checkpoint;
  const olx_surfel_direct direct = olx_light_direct(l);
  const olx_bounce_keeper keeper = olx_light_checkpoint_begin(&checkpoint, l, bounces > FEW_BOUNCES);
  OLX_TRY(olx_bounces_solve(&l->links, l->surfels.count, l->settings.threads, &direct,
                            bounces < asked ? bounces : asked, l->settings.store ? &keeper : NULL, l->irradiance,
                            l->passed_on, &l->report.bounces));
  l->report.last_bounce = last_bounce(l);
  return OLX_OK;
}

// Returns the most rays per surfel for which there is memory; 0 when there is none.
static uint32_t most_rays(const olx_scene_light *l) {
  for (uint32_t most = OLX_LIGHT_MOST_RAYS; most >= l->first_rays; most /= 2) {
    uint64_t links = l->report.links;
    for (uint32_t i = 0; i < l->visible; i++) links += olx_light_rays_wanted(l, i, most);
    if (links <= l->settings.most_links) return most;
  }
  return 0;
}

// Adds one batch for each number of rays that surfels need. Each round takes another part of the sequence of rays.
static olx_result add_guided_batches(olx_scene_light *l, uint32_t round) {
  const uint32_t most = most_rays(l);
  for (uint32_t rays = l->first_rays; rays <= most; rays *= 2) {
    uint32_t *numbers = olx_allocate(l->surfels.count, sizeof *numbers), count = 0;
    if (!numbers) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", l->surfels.count);
    for (uint32_t i = 0; i < l->visible; i++) {
      if (olx_light_rays_wanted(l, i, most) == rays) numbers[count++] = i;
    }
    if (count == 0) {
      olx_release(numbers);
      continue;
    }
    add_batch(l, &(olx_link_batch){.surfels = numbers,
                                   .count = count,
                                   .first_ray = (round + 1) * OLX_LIGHT_MOST_RAYS,
                                   .rays = rays,
                                   .guide = &l->guide});
  }
  return OLX_OK;
}

static olx_result learn(olx_scene_light *l) {
  const olx_surfel_direct direct = olx_light_direct(l);
  OLX_TRY(olx_rays_learn(&l->guide, &l->surfels, &l->links, &direct, l->irradiance));
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    olx_link_batch_release_fixed(&l->batches[k]);
  }
  return olx_light_noise_measure(l);
}

// Plans a round of dividing cells, or finishes where light does not vary too much between records.
static olx_result divide(olx_scene_light *l, uint32_t division) {
  bool any = false;
  if (division < (OLX_LIGHT_DIVISIONS) && l->visible > 0) OLX_TRY(olx_light_records_plan(l, division, &any));
  l->phase = any ? OLX_LIGHT_DIVIDING : OLX_LIGHT_FINISHED;
  l->report.records = l->records.places.count;
  return OLX_OK;
}

// Plans a round of rays that leave no links, or goes on where noise is below the bound.
static olx_result gather(olx_scene_light *l, uint32_t gathering) {
  bool any = false;
  if (gathering < OLX_LIGHT_GATHERINGS && l->report.noise > (double)l->settings.noise) {
    OLX_TRY(olx_final_gather_plan(l, gathering, &any));
  }
  if (!any) return divide(l, 0);
  l->phase = OLX_LIGHT_GATHERING;
  return OLX_OK;
}

static olx_result finish(olx_scene_light *l) {
  if (l->settings.bounces > FEW_BOUNCES) {
    OLX_TRY(solve(l, l->settings.bounces));
    OLX_TRY(olx_light_noise_measure(l));
  }
  return gather(l, 0);
}

// Adds rays until the measured noise is below the bound: the required number cannot be predicted well from few rays.
static olx_result refine(olx_scene_light *l, uint32_t refinement) {
  const uint32_t batches = l->links.batch_count;
  l->phase = OLX_LIGHT_REFINING;
  if (refinement < OLX_LIGHT_REFINEMENTS) OLX_TRY(add_guided_batches(l, refinement));
  return l->links.batch_count == batches ? finish(l) : OLX_OK;
}

static olx_result settle_exploring(olx_scene_light *l) {
  const uint32_t from = l->served;
  if (l->round == 0) l->visible = from;
  if (l->round < OLX_LIGHT_HIDDEN_ROUNDS) OLX_TRY(add_hidden(l));
  olx_release(l->unserved.points);
  l->unserved = (olx_point_list){0};
  l->round++;
  if (l->round <= OLX_LIGHT_HIDDEN_ROUNDS && from < l->surfels.count) return begin_first_rays(l, from);
  l->round = OLX_LIGHT_HIDDEN_ROUNDS + 1;
  l->phase = OLX_LIGHT_DIRECT;
  return begin_direct(l);
}

// What direct light says of the surfels of a pool.
typedef struct pool_direct {
  uint32_t sun; // where the sun reaches their points
  uint32_t count;
  double sky; // sum of the luminance of the sky's irradiance
} pool_direct;

// Of an even sky, rays sample the light themselves where surfels receive at least this share of what the whole
// hemisphere would send: samples find it easily there, and a mean over a cell may be far off behind a window's frame.
static const double SEEN_SHARE = 0.125;

static uint8_t marks_of(const olx_scene_light *l, const pool_direct *pool) {
  const double whole = (double)OLX_PI * (double)olx_environment_mean(l->scene);
  const bool sees_sky = pool->sky > 0.0 && pool->sky >= SEEN_SHARE * whole * pool->count;
  return (uint8_t)((pool->sun == OLX_SUN_UNEVEN ? OLX_SURFEL_UNEVEN : 0) | (sees_sky ? OLX_SURFEL_SEES_SKY : 0));
}

// Marks the cells that the sun reaches in part, or may do so, and those that see much of the sky. All cells of a larger
// one, whose surfels learn together, are judged as one. If a cell's own few points decided, a mean would be kept where
// it is too small because all points happen to miss the sun, but replaced where it is too large because all of them
// happen to meet it.
static olx_result mark(olx_scene_light *l) {
  const uint32_t count = l->surfels.count;
  uint8_t *marks = l->surfels.marks = olx_allocate(count, sizeof *marks);
  pool_direct *pools = olx_allocate_zero(l->guide.pool_count, sizeof *pools);
  if (!marks || !pools) {
    olx_release(pools);
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
  }
  for (uint32_t i = 0; i < count; i++) {
    pool_direct *pool = &pools[l->guide.pool_of[i]];
    pool->sun |= l->lit[i].sun;
    pool->sky += (double)olx_luminance(l->lit[i].sky);
    pool->count++;
  }
  for (uint32_t i = 0; i < count; i++) marks[i] = marks_of(l, &pools[l->guide.pool_of[i]]);
  olx_release(pools);
  return OLX_OK;
}

// Gives surfels the direct light that was found.
static olx_result take_direct(olx_scene_light *l) {
  const uint32_t count = l->surfels.count;
  l->direct = olx_allocate(count, sizeof *l->direct);
  const bool even_sky = olx_environment_is_even(l->scene);
  if (even_sky) l->sky = olx_allocate(count, sizeof *l->sky);
  if (!l->direct || (even_sky && !l->sky))
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
  for (uint32_t i = 0; i < count; i++) {
    l->direct[i] = l->lit[i].light;
    if (l->sky) l->sky[i] = l->lit[i].sky;
  }
  OLX_TRY(mark(l));
  olx_release(l->lit);
  l->lit = NULL;
  return OLX_OK;
}

static olx_result settle_direct(olx_scene_light *l) {
  OLX_TRY(olx_ray_guide_create(&l->guide, &l->surfels));
  OLX_TRY(take_direct(l));
  OLX_TRY(solve(l, FEW_BOUNCES));
  OLX_TRY(learn(l));
  return refine(l, 0);
}

static olx_result settle_refining(olx_scene_light *l) {
  OLX_TRY(solve(l, FEW_BOUNCES));
  OLX_TRY(olx_light_noise_measure(l));
  l->round++;
  return refine(l, l->round - OLX_LIGHT_HIDDEN_ROUNDS - 1);
}

static olx_result settle_gathering(olx_scene_light *l) {
  olx_final_gather_settle(l);
  OLX_TRY(olx_light_noise_measure(l));
  return gather(l, l->gathering + 1);
}

static olx_result settle_dividing(olx_scene_light *l) {
  olx_light_records_settle(l);
  return divide(l, l->records.round + 1);
}

olx_result olx_scene_light_settle(olx_scene_light *l) {
  const olx_scene_light_phase phase = l->phase;
  if (phase == OLX_LIGHT_EXPLORING) return settle_exploring(l);
  if (phase == OLX_LIGHT_DIRECT) return settle_direct(l);
  if (phase == OLX_LIGHT_REFINING) return settle_refining(l);
  return phase == OLX_LIGHT_GATHERING ? settle_gathering(l) : settle_dividing(l);
}

olx_result olx_scene_light_begin(olx_scene_light *l) {
  OLX_TRY(olx_light_surfels_create(&l->surfels, l->scene, l->settings.spacing, l->settings.seed, l->settings.threads));
  l->surfels.task = l->settings.task;
  OLX_TRY(find_surfaces(l, l->positions, l->flags, l->probe_count));
  l->first_rays = FIRST_RAYS;
  while (l->first_rays > LEAST_RAYS && (uint64_t)l->first_rays * l->surfels.count > l->settings.most_links / 2)
    l->first_rays /= 2;
  if (l->surfels.count > 0) return begin_first_rays(l, 0);
  OLX_TRY(grow_links(l, 0));
  l->round = OLX_LIGHT_HIDDEN_ROUNDS + 1;
  l->phase = OLX_LIGHT_DIRECT;
  return begin_direct(l);
}

void olx_scene_light_clear(olx_scene_light *l) {
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    olx_link_batch_release(&l->batches[k]);
    olx_release((void *)l->batches[k].surfels);
  }
  for (uint32_t round = 0; round < OLX_LIGHT_HIDDEN_ROUNDS; round++) {
    olx_release(l->patches[round].links);
    olx_release(l->patches[round].fixed);
  }
  olx_release(l->unserved.points);
  olx_release(l->links.fixed);
  olx_release(l->links.worth);
  olx_release(l->direct);
  olx_release(l->sky);
  olx_release(l->lit);
  olx_release(l->irradiance);
  olx_release(l->passed_on);
  olx_release(l->noise);
  olx_final_gather_free(l);
  olx_ray_guide_free(&l->guide);
  olx_light_records_free(&l->records);
  olx_light_surfels_free(&l->surfels);
  *l = (olx_scene_light){.scene = l->scene,
                         .settings = l->settings,
                         .positions = l->positions,
                         .flags = l->flags,
                         .probe_count = l->probe_count};
  l->links.batches = l->batches;
}
