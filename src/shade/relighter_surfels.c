// Lights surfels, and carries light over the links between them: every frame adds one reflection.
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"
#include "shade/relighter_schedule.h"

#include <string.h>

enum { LINKS_JOB = 1024, SALT_SURFEL = 0x53464C52 };

static uint32_t surfel_count(const olx_relight *r) { return r->source->relight.header->surfels; }

olx_result olx_relit_surfels_create(olx_relight *r) {
  const olx_relight_header *h = r->source->relight.header;
  const uint32_t jobs = (h->surfels + LINKS_JOB - 1) / LINKS_JOB;
  r->values = olx_allocate_zero(h->surfels, sizeof *r->values);
  r->direct = olx_allocate_zero(h->surfels, sizeof *r->direct);
  r->beams = olx_allocate_zero(h->surfels, sizeof *r->beams);
  r->highlights = olx_allocate_zero(h->surfels, sizeof *r->highlights);
  r->irradiance = olx_allocate(h->surfels, sizeof *r->irradiance);
  r->rounds = olx_allocate_zero(h->surfels, sizeof *r->rounds);
  r->queue = olx_allocate(h->surfels > h->volume_probes ? h->surfels : h->volume_probes, sizeof *r->queue);
  r->job_changes = olx_allocate(jobs, sizeof *r->job_changes);
  r->job_sums = olx_allocate(jobs, sizeof *r->job_sums);
  if (!r->values || !r->direct || !r->beams || !r->highlights || !r->irradiance || !r->rounds || !r->queue ||
      !r->job_changes || !r->job_sums) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u surfels", h->surfels);
  }
  for (uint32_t i = 0; i < h->surfels; i++) {
    r->irradiance[i] = olx_rgb9e5_unpack(r->source->relight.surfels[i].irradiance);
  }
  return OLX_OK;
}

void olx_relit_surfels_free(olx_relight *r) {
  olx_release(r->values);
  olx_release(r->direct);
  olx_release(r->beams);
  olx_release(r->highlights);
  olx_release(r->irradiance);
  olx_release(r->rounds);
  olx_release(r->queue);
  olx_release(r->job_changes);
  olx_release(r->job_sums);
}

// ---- Direct light

typedef struct direct_job {
  olx_relight *relight;
  uint32_t count; // of the queue
} direct_job;

static void light_batch(void *user, uint32_t job) {
  const direct_job *j = user;
  olx_relight *r = j->relight;
  const uint32_t first = job * OLX_RELIT_BATCH, left = j->count - first;
  olx_relit_batch batch = {.count = left < OLX_RELIT_BATCH ? left : OLX_RELIT_BATCH};
  for (uint32_t k = 0; k < batch.count; k++) {
    const uint32_t i = r->queue[first + k], round = r->rounds[i];
    const olx_relight_surfel *s = &r->source->relight.surfels[i];
    batch.position[k] = olx_load3(s->points[round % OLX_RELIGHT_POINTS]);
    batch.normal[k] = olx_normal_unpack((uint16_t)s->normal);
    batch.seed[k] = olx_hash2(i, SALT_SURFEL);
    batch.sequence[k] = round;
    batch.slot[k] = i;
  }
  olx_relit_direct(r, &batch);
  for (uint32_t k = 0; k < batch.count; k++) {
    const uint32_t i = batch.slot[k];
    const float share = 1.0f / (float)(r->rounds[i] + 1);
    r->direct[i] = olx_mix3(r->direct[i], batch.irradiance[k], share);
    r->beams[i] = olx_mix3(r->beams[i], batch.beam[k], share);
  }
}

uint32_t olx_relit_take_surfels(olx_relight *r, uint64_t rays) {
  const uint32_t count = surfel_count(r), each = olx_relit_rays(r), rounds = olx_relit_surfel_rounds(r);
  const uint64_t most = each ? rays / each : count;
  if (r->dark == 0) return 0;
  uint32_t found = 0, i = r->next_direct;
  for (uint32_t k = 0; k < count && (found < most || found == 0); k++) {
    if (r->rounds[i] < rounds) r->queue[found++] = i;
    i = i + 1 < count ? i + 1 : 0;
  }
  r->next_direct = i;
  return found;
}

void olx_relit_surfels_lit(olx_relight *r, uint32_t count) {
  const uint32_t rounds = olx_relit_surfel_rounds(r);
  for (uint32_t k = 0; k < count; k++) r->dark -= ++r->rounds[r->queue[k]] == rounds;
}

uint32_t olx_relit_light_surfels(olx_relight *r, uint64_t rays) {
  const uint32_t found = olx_relit_take_surfels(r, rays);
  const uint32_t jobs = (found + OLX_RELIT_BATCH - 1) / OLX_RELIT_BATCH;
  direct_job j = {r, found};
  if (jobs > 0) olx_parallel_for(jobs, r->settings.threads, light_batch, &j, NULL, 0);
  olx_relit_surfels_lit(r, found);
  return found;
}

// ---- Bounces

static void sum_light(olx_relight *r) {
  for (uint32_t i = 0; i < surfel_count(r); i++) r->values[i] = olx_add(r->direct[i], r->irradiance[i]);
}

bool olx_relit_take_links(olx_relight *r, olx_relit_sweep_part *part) {
  const uint32_t all = surfel_count(r), left = all - r->swept;
  *part = (olx_relit_sweep_part){.first = r->next_bounce};
  if (r->settled) return false;
  if (r->swept == 0) {
    r->shining = r->stale;
    r->stale = r->dark > 0;
  }
  part->shines = r->shining;
  part->count = r->settings.surfels < left ? r->settings.surfels : left;
  part->dark = r->dark > 0;
  part->ends = part->count == left;
  r->next_bounce = all ? (uint32_t)(((uint64_t)r->next_bounce + part->count) % all) : 0;
  r->swept = part->ends ? 0 : r->swept + part->count;
  return true;
}

void olx_relit_links_followed(olx_relight *r, const olx_relit_sweep_part *part, double change, double sum) {
  r->change += change;
  r->sum += sum;
  if (!part->ends) return;
  const bool changed = r->change > (double)r->settings.sleep * r->sum;
  if (changed || part->dark) r->solution++;
  r->settled = !changed && !part->dark && !r->stale;
  r->change = r->sum = 0.0;
}

typedef struct bounce_job {
  olx_relight *relight;
  uint32_t first, count; // surfels, from `first` on, cyclically
  bool shines;
} bounce_job;

static olx_vec3 gather(const olx_relight *r, uint32_t surfel) {
  const olx_relight_data *d = &r->source->relight;
  olx_vec3 sum = r->highlights[surfel];
  for (uint32_t i = d->link_starts[surfel]; i < d->link_starts[surfel + 1]; i++) {
    const olx_relight_link *link = &d->links[i];
    sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(link->weight), r->values[olx_relight_link_from(link)]));
  }
  return sum;
}

static void bounce_some(void *user, uint32_t job) {
  const bounce_job *j = user;
  olx_relight *r = j->relight;
  const uint32_t end = (job + 1) * LINKS_JOB < j->count ? (job + 1) * LINKS_JOB : j->count;
  double change = 0.0, sum = 0.0;
  for (uint32_t k = job * LINKS_JOB; k < end; k++) {
    const uint32_t i = (uint32_t)(((uint64_t)j->first + k) % surfel_count(r));
    if (j->shines) r->highlights[i] = olx_relit_highlights(r, i);
    const olx_vec3 light = gather(r, i);
    change += (double)olx_luminance(olx_max_each(olx_sub(light, r->irradiance[i]), olx_sub(r->irradiance[i], light)));
    sum += (double)olx_luminance(olx_add(light, r->direct[i]));
    r->irradiance[i] = light;
  }
  r->job_changes[job] = change;
  r->job_sums[job] = sum;
}

uint32_t olx_relit_bounce(olx_relight *r) {
  olx_relit_sweep_part part;
  if (!olx_relit_take_links(r, &part)) return 0;
  const uint32_t jobs = (part.count + LINKS_JOB - 1) / LINKS_JOB;
  sum_light(r);
  bounce_job j = {r, part.first, part.count, part.shines};
  if (jobs > 0) olx_parallel_for(jobs, r->settings.threads, bounce_some, &j, NULL, 0);
  double change = 0.0, sum = 0.0;
  for (uint32_t i = 0; i < jobs; i++) {
    change += r->job_changes[i];
    sum += r->job_sums[i];
  }
  olx_relit_links_followed(r, &part, change, sum);
  sum_light(r);
  return part.count;
}
