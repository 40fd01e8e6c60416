// Lights the probes of the irradiance volume from surfels, over the volume's own links.
#include "core/harmonics.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "field/harmonic_data.h"
#include "shade/relighter_schedule.h"

#include <string.h>

enum { PROBES_JOB = 64 };

// The factor of each band when radiance is convolved with the cosine (Ramamoorthi and Hanrahan 2001).
static const float cosine_band[OLX_VOLUME_BANDS] = {OLX_PI, 2.0f / 3.0f * OLX_PI, 0.25f * OLX_PI};

static uint32_t probe_count(const olx_relight *r) { return r->source->relight.header->volume_probes; }

olx_result olx_relit_volume_create(olx_relight *r) {
  const uint32_t count = probe_count(r);
  r->volume = olx_allocate((size_t)count * OLX_VOLUME_HALVES, sizeof *r->volume);
  r->volume_solution = olx_allocate_zero(count, sizeof *r->volume_solution);
  if (!r->volume || !r->volume_solution) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u volume probes", count);
  }
  if (count == 0) return OLX_OK;
  memcpy(r->volume, r->source->volume.irradiance, (size_t)count * OLX_VOLUME_HALVES * sizeof *r->volume);
  r->field.volume.irradiance = r->volume;
  return OLX_OK;
}

void olx_relit_volume_free(olx_relight *r) {
  olx_release(r->volume);
  olx_release(r->volume_solution);
}

static void light_probe(olx_relight *r, uint32_t probe) {
  const olx_relight_data *d = &r->source->relight;
  olx_vec3 sums[OLX_HARMONICS_MOST] = {{0}};
  for (uint32_t i = d->volume_starts[probe]; i < d->volume_starts[probe + 1]; i++) {
    const olx_relight_volume_link *link = &d->volume_links[i];
    const olx_vec3 light = olx_mul(olx_rgb9e5_unpack(link->weight), r->values[link->from]);
    const olx_vec2 at = {(float)link->direction[0] / 65535.0f, (float)link->direction[1] / 65535.0f};
    float values[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_octahedral_decode(at), values);
    for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) sums[k] = olx_madd(sums[k], light, values[k]);
  }
  for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) {
    const uint32_t band = k == 0 ? 0 : k < 4 ? 1 : 2;
    sums[k] = olx_scale(sums[k], cosine_band[band] / olx_harmonics_mean_square(k));
  }
  olx_harmonics_pack(sums, OLX_VOLUME_BANDS, r->volume + (size_t)OLX_VOLUME_HALVES * probe);
}

typedef struct volume_job {
  olx_relight *relight;
  uint32_t count; // of the queue
} volume_job;

static void light_some(void *user, uint32_t job) {
  const volume_job *j = user;
  const uint32_t end = (job + 1) * PROBES_JOB < j->count ? (job + 1) * PROBES_JOB : j->count;
  for (uint32_t i = job * PROBES_JOB; i < end; i++) light_probe(j->relight, j->relight->queue[i]);
}

uint32_t olx_relit_take_volume(olx_relight *r) {
  const uint32_t count = probe_count(r), most = r->settings.volume_probes;
  uint32_t found = 0, waiting = 0, i = r->next_volume;
  for (uint32_t k = 0; k < count; k++) {
    const bool waits = r->volume_solution[i] != r->solution;
    if (waits && found < most) {
      r->queue[found++] = i;
      r->volume_solution[i] = r->solution;
      r->next_volume = i + 1 < count ? i + 1 : 0;
    } else {
      waiting += waits;
    }
    i = i + 1 < count ? i + 1 : 0;
  }
  if (found > 0) r->volume_frame = r->frame;
  r->volume_waiting = waiting;
  return found;
}

uint32_t olx_relit_light_volume(olx_relight *r) {
  const uint32_t found = olx_relit_take_volume(r);
  volume_job j = {r, found};
  if (found == 0) return 0;
  olx_parallel_for((found + PROBES_JOB - 1) / PROBES_JOB, r->settings.threads, light_some, &j, NULL, 0);
  return found;
}
