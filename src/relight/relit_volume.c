// Lights the probes of the irradiance volume from surfels, over the volume's own links.
#include "relight/relit_volume.h"

#include "core/harmonics.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/result.h"
#include "field/harmonic_data.h"

#include <string.h>

enum { PROBES_JOB = 64 };

olx_result olx_relit_volume_create(const olx_field *source, olx_relit_volume *v) {
  const uint32_t count = source->relight.header->volume_probes;
  const size_t halves = (size_t)count * OLX_VOLUME_HALVES;
  *v = (olx_relit_volume){.data = &source->relight, .irradiance = olx_allocate(halves, sizeof *v->irradiance)};
  if (!v->irradiance) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u volume probes", count);
  if (count > 0) memcpy(v->irradiance, source->volume.irradiance, halves * sizeof *v->irradiance);
  return OLX_OK;
}

void olx_relit_volume_free(olx_relit_volume *v) { olx_release(v->irradiance); }

static void light_probe(olx_relit_volume *v, const olx_vec3 *surfels, uint32_t probe) {
  const olx_relight_data *d = v->data;
  olx_vec3 sums[OLX_HARMONICS_MOST] = {{0}};
  for (uint32_t i = d->volume_starts[probe]; i < d->volume_starts[probe + 1]; i++) {
    const olx_relight_volume_link *link = &d->volume_links[i];
    const olx_vec3 light = olx_mul(olx_rgb9e5_unpack(link->weight), surfels[link->from]);
    const olx_vec2 at = {(float)link->direction[0] / 65535.0f, (float)link->direction[1] / 65535.0f};
    float values[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_octahedral_decode(at), values);
    for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) sums[k] = olx_madd(sums[k], light, values[k]);
  }
  for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) {
    const uint32_t band = k == 0 ? 0 : k < 4 ? 1 : 2;
    sums[k] = olx_scale(sums[k], olx_harmonics_cosine(band) / olx_harmonics_mean_square(k));
  }
  olx_harmonics_pack(sums, OLX_VOLUME_BANDS, v->irradiance + (size_t)OLX_VOLUME_HALVES * probe);
}

typedef struct volume_job {
  olx_relit_volume *volume;
  const olx_vec3 *surfels;
  const olx_relit_volume_turns *turns;
} volume_job;

static void light_some(void *user, uint32_t job) {
  const volume_job *j = user;
  const uint32_t first = job * PROBES_JOB, left = j->turns->count - first, all = j->volume->data->header->volume_probes;
  for (uint32_t i = first; i < first + (left < PROBES_JOB ? left : PROBES_JOB); i++) {
    light_probe(j->volume, j->surfels, (uint32_t)(((uint64_t)j->turns->first + i) % all));
  }
}

void olx_relit_light_volume(olx_relit_volume *volume, uint32_t threads, const olx_vec3 *surfels,
                            const olx_relit_volume_turns *turns) {
  volume_job j = {volume, surfels, turns};
  const uint32_t jobs = (turns->count + PROBES_JOB - 1) / PROBES_JOB;
  if (jobs > 0) olx_parallel_for(jobs, threads, light_some, &j, NULL, 0);
}
