// Casts the final rays of surfels, whose ends are looked up in the solved light at once, and adds them to what links
// brought.
#include "light/solution/final_gather.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/solution/light_noise.h"

enum { SURFELS_PER_JOB = 4 };

// Makes the sums of visible surfels, and fills them with what links brought.
static olx_result begin(olx_scene_light *l) {
  const uint32_t count = l->surfels.count;
  const olx_surfel_direct direct = olx_light_direct(l);
  float *variance = olx_allocate(count, sizeof *variance);
  l->gathered = olx_allocate(l->visible, sizeof *l->gathered);
  l->final_rays = olx_allocate(l->visible, sizeof *l->final_rays);
  olx_result result =
      variance && l->gathered && l->final_rays
          ? olx_bounces_variance(&l->links, count, l->settings.threads, &direct, l->irradiance, variance)
          : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
  for (uint32_t i = 0; result == OLX_OK && i < l->visible; i++) {
    const float worth = l->links.worth[i];
    l->gathered[i] = (olx_ray_sum){olx_scale(l->irradiance[i], worth), variance[i] * worth * worth, worth};
  }
  olx_release(variance);
  return result;
}

// Returns the most rays per surfel with which a round keeps to its bound.
static uint32_t most_rays(const olx_scene_light *l) {
  uint32_t most = OLX_LIGHT_MOST_RAYS;
  for (; most > l->first_rays; most /= 2) {
    uint64_t rays = 0;
    for (uint32_t i = 0; i < l->visible; i++) rays += olx_light_rays_wanted(l, i, most);
    if (rays <= l->settings.most_final_rays) break;
  }
  return most;
}

olx_result olx_final_gather_plan(olx_scene_light *l, uint32_t round, bool *any) {
  l->gathering = round;
  if (!l->gathered) OLX_TRY(begin(l));
  const uint32_t most = most_rays(l);
  for (uint32_t i = 0; i < l->visible; i++) {
    l->final_rays[i] = olx_light_rays_wanted(l, i, most);
    *any |= l->final_rays[i] > 0;
  }
  return OLX_OK;
}

// Returns the end of the unit that begins with a surfel.
static uint32_t unit_end(const olx_scene_light *l, uint32_t first) {
  uint32_t rays = 0, end = first;
  while (end < l->visible && rays < OLX_LIGHT_UNIT_RAYS) rays += l->final_rays[end++];
  return end;
}

static uint32_t first_of(const olx_scene_light *l, uint32_t unit) {
  uint32_t first = 0;
  while (unit-- > 0) first = unit_end(l, first);
  return first;
}

static uint32_t units_of(const olx_scene_light *l) {
  uint32_t units = 0;
  for (uint32_t first = 0; first < l->visible; units++) first = unit_end(l, first);
  return units;
}

static void *array_of(olx_scene_light *l) {
  if (!l->found) l->found = olx_allocate_zero(l->visible, sizeof *l->found);
  return l->found;
}

static uint32_t round_of(const olx_scene_light *l) { return l->gathering; }

typedef struct final_job {
  olx_scene_light *light;
  uint32_t first, end; // range of surfels
  uint64_t *rays;      // one per job
} final_job;

static void gather_some(void *user, uint32_t job) {
  const final_job *f = user;
  olx_scene_light *l = f->light;
  const olx_passed_light light = {olx_light_direct(l), l->passed_on, l->settings.bounces};
  const uint32_t first = f->first + job * SURFELS_PER_JOB;
  const uint32_t end = first + SURFELS_PER_JOB < f->end ? first + SURFELS_PER_JOB : f->end;
  const uint32_t first_ray = (OLX_LIGHT_REFINEMENTS + l->gathering + 1) * OLX_LIGHT_MOST_RAYS;
  for (uint32_t i = first; i < end; i++) {
    const uint32_t count = l->final_rays[i];
    if (count == 0) continue;
    l->found[i] = olx_links_add_up(&l->surfels, i, &l->guide, first_ray, count, &light, &f->rays[job]);
  }
}

static olx_result cast(olx_scene_light *l, uint32_t first, uint32_t end, uint64_t *rays) {
  const uint32_t jobs = (end - first + SURFELS_PER_JOB - 1) / SURFELS_PER_JOB;
  final_job f = {.light = l, .first = first, .end = end, .rays = olx_allocate_zero(jobs, sizeof *f.rays)};
  if (!f.rays) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", end - first);
  const olx_result result = olx_parallel_for(jobs, l->settings.threads, gather_some, &f, l->settings.task, 0);
  for (uint32_t i = 0; i < jobs; i++) *rays += f.rays[i];
  olx_release(f.rays);
  return result;
}

const olx_light_ranges olx_final_ranges = {"final", sizeof(olx_ray_sum), round_of, units_of, first_of, array_of, cast};

void olx_final_gather_settle(olx_scene_light *l) {
  for (uint32_t i = 0; i < l->visible; i++) {
    olx_ray_sum *all = &l->gathered[i];
    const olx_ray_sum *found = &l->found[i];
    if (found->worth <= 0.0f) continue;
    *all = (olx_ray_sum){olx_add(all->light, found->light), all->squares + found->squares, all->worth + found->worth};
    l->irradiance[i] = olx_scale(all->light, 1.0f / all->worth);
  }
  olx_release(l->found);
  l->found = NULL;
}

void olx_final_gather_free(olx_scene_light *l) {
  olx_release(l->gathered);
  olx_release(l->found);
  olx_release(l->final_rays);
}
