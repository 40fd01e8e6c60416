// Lights surfels, and carries light over the links between them: every frame adds one reflection.
#include "relight/relit_surfels.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"

enum { LINKS_JOB = 1024 };

olx_result olx_relit_surfels_create(const olx_relight_data *data, olx_relit_surfels *s) {
  const uint32_t count = data->header->surfels, jobs = (count + LINKS_JOB - 1) / LINKS_JOB;
  *s = (olx_relit_surfels){.data = data,
                           .direct = olx_allocate_zero(count, sizeof *s->direct),
                           .irradiance = olx_allocate(count, sizeof *s->irradiance),
                           .values = olx_allocate_zero(count, sizeof *s->values),
                           .beams = olx_allocate_zero(count, sizeof *s->beams),
                           .close = olx_allocate_zero(count, sizeof *s->close),
                           .near = olx_allocate_zero(count, sizeof *s->near),
                           .highlights = olx_allocate_zero(count, sizeof *s->highlights),
                           .job_changes = olx_allocate(jobs, sizeof *s->job_changes),
                           .job_sums = olx_allocate(jobs, sizeof *s->job_sums)};
  if (!s->direct || !s->irradiance || !s->values || !s->beams || !s->close || !s->near || !s->highlights ||
      !s->job_changes || !s->job_sums) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u surfels", count);
  }
  for (uint32_t i = 0; i < count; i++) s->irradiance[i] = olx_rgb9e5_unpack(data->surfels[i].irradiance);
  return OLX_OK;
}

void olx_relit_surfels_free(olx_relit_surfels *s) {
  olx_release(s->direct);
  olx_release(s->irradiance);
  olx_release(s->values);
  olx_release(s->beams);
  olx_release(s->close);
  olx_release(s->near);
  olx_release(s->highlights);
  olx_release(s->job_changes);
  olx_release(s->job_sums);
}

// Returns the surfel whose turn is number `turn`, from `first` on, cyclically.
static uint32_t surfel_of(const olx_relit_surfels *s, uint32_t first, uint32_t turn) {
  return (uint32_t)(((uint64_t)first + turn) % s->data->header->surfels);
}

// ---- Direct light

typedef struct direct_job {
  olx_relit_surfels *surfels;
  olx_relit_direct *direct;
  const olx_relit_surfel_turns *turns;
} direct_job;

static void light_batch(void *user, uint32_t job) {
  const direct_job *j = user;
  olx_relit_surfels *s = j->surfels;
  const olx_relit_surfel_turns *turns = j->turns;
  const uint32_t first = job * OLX_RELIT_BATCH, left = turns->count - first;
  olx_relit_batch batch = {.count = left < OLX_RELIT_BATCH ? left : OLX_RELIT_BATCH, .apart = true};
  for (uint32_t k = 0; k < batch.count; k++) {
    const uint32_t i = surfel_of(s, turns->first, first + k), round = turns->round + (first + k >= turns->before);
    const olx_relight_surfel *surfel = &s->data->surfels[i];
    batch.position[k] = olx_load3(surfel->points[round % OLX_RELIGHT_POINTS]);
    batch.normal[k] = olx_normal_unpack((uint16_t)surfel->normal);
    batch.seed[k] = olx_hash2(i, OLX_SALT_SURFEL);
    batch.sequence[k] = round;
    batch.slot[k] = i;
  }
  olx_relit_light(j->direct, &batch);
  for (uint32_t k = 0; k < batch.count; k++) {
    const uint32_t i = batch.slot[k];
    const float share = 1.0f / (float)(batch.sequence[k] + 1);
    s->direct[i] = olx_mix3(s->direct[i], batch.irradiance[k], share);
    s->beams[i] = olx_mix3(s->beams[i], batch.beam[k], share);
    s->close[i] = olx_mix3(s->close[i], batch.close[k], share);
    s->near[i] = olx_mix3(s->near[i], batch.near[k], share);
  }
}

void olx_relit_light_surfels(olx_relit_surfels *surfels, olx_relit_direct *direct,
                             const olx_relit_surfel_turns *turns) {
  direct_job j = {surfels, direct, turns};
  const uint32_t jobs = (turns->count + OLX_RELIT_BATCH - 1) / OLX_RELIT_BATCH;
  if (jobs > 0) olx_parallel_for(jobs, direct->lights->settings->threads, light_batch, &j, NULL, 0);
}

// ---- Bounces

// Sums the light that links carry, or, with that of lamps close by, all light.
static void sum_light(olx_relit_surfels *s, bool all) {
  for (uint32_t i = 0; i < s->data->header->surfels; i++) {
    s->values[i] = olx_add(s->direct[i], s->irradiance[i]);
    if (all) s->values[i] = olx_add(s->values[i], s->close[i]);
  }
}

typedef struct bounce_job {
  olx_relit_surfels *surfels;
  const olx_relit_link_turns *turns;
} bounce_job;

static olx_vec3 gather(const olx_relit_surfels *s, uint32_t surfel) {
  const olx_relight_data *d = s->data;
  olx_vec3 sum = olx_add(s->highlights[surfel], s->near[surfel]);
  for (uint32_t i = d->link_starts[surfel]; i < d->link_starts[surfel + 1]; i++) {
    const olx_relight_link *link = &d->links[i];
    sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(link->weight), s->values[olx_relight_link_from(link)]));
  }
  return sum;
}

static void bounce_some(void *user, uint32_t job) {
  const bounce_job *j = user;
  olx_relit_surfels *s = j->surfels;
  const uint32_t end = (job + 1) * LINKS_JOB < j->turns->count ? (job + 1) * LINKS_JOB : j->turns->count;
  double change = 0.0, sum = 0.0;
  for (uint32_t k = job * LINKS_JOB; k < end; k++) {
    const uint32_t i = surfel_of(s, j->turns->first, k);
    if (j->turns->shines) s->highlights[i] = olx_relit_highlights(s, i);
    const olx_vec3 light = gather(s, i);
    change += (double)olx_luminance(olx_max_each(olx_sub(light, s->irradiance[i]), olx_sub(s->irradiance[i], light)));
    sum += (double)olx_luminance(olx_add(light, s->direct[i]));
    s->irradiance[i] = light;
  }
  s->job_changes[job] = change;
  s->job_sums[job] = sum;
}

void olx_relit_bounce(olx_relit_surfels *s, uint32_t threads, const olx_relit_link_turns *turns, double *change,
                      double *sum) {
  const uint32_t jobs = (turns->count + LINKS_JOB - 1) / LINKS_JOB;
  *change = *sum = 0.0;
  if (jobs == 0) return;
  bounce_job j = {s, turns};
  sum_light(s, false);
  olx_parallel_for(jobs, threads, bounce_some, &j, NULL, 0);
  for (uint32_t i = 0; i < jobs; i++) {
    *change += s->job_changes[i];
    *sum += s->job_sums[i];
  }
  sum_light(s, true);
}
