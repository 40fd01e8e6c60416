// Creates a relighter, takes its lights, and runs its frames.
#include "relight/relighter.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/threads.h"

#include <assert.h>

olx_relight_settings olx_relight_settings_default(void) {
  return (olx_relight_settings){.shadow_rays = 262144,
                                .surfels = 131072,
                                .texels = 524288,
                                .volume_probes = 4096,
                                .light_samples = 1,
                                .sleep = 0.002f};
}

static olx_result check_settings(const olx_relight_settings *s) {
  if (s->shadow_rays < 1 || s->surfels < 1 || s->texels < 1 || s->volume_probes < 1) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: a budget of 0 a frame");
  }
  if (s->light_samples < 1 || s->light_samples > 64) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: light samples %u: must be from 1 to 64", s->light_samples);
  }
  if (!(s->sleep >= 0.0f && s->sleep <= 1.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: sleep %g is not in 0..1", (double)s->sleep);
  }
  if (!(s->near_metres >= 0.0f && isfinite(s->near_metres))) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: near distance %g metres", (double)s->near_metres);
  }
  return OLX_OK;
}

static olx_result build(olx_relight *r) {
  OLX_TRY(olx_relit_lights_create(&r->settings, &r->lights));
  OLX_TRY(olx_relit_schedule_create(r->source, &r->settings, &r->schedule));
  OLX_TRY(olx_relit_surfels_create(&r->source->relight, &r->surfels));
  OLX_TRY(olx_relit_maps_create(r->source, &r->maps));
  OLX_TRY(olx_relit_volume_create(r->source, &r->volume));
  r->field.surfaces.direct = r->maps.direct;
  r->field.surfaces.indirect = r->maps.indirect;
  if (r->source->volume.irradiance) r->field.volume.irradiance = r->volume.irradiance;
  return OLX_OK;
}

olx_result olx_relight_create(const olx_field *field, const olx_relight_settings *settings, olx_relight **relight) {
  assert(field && settings && relight);
  *relight = NULL;
  OLX_TRY(check_settings(settings));
  if (!field->relight.header) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: baked without what relighting needs (bake --relight)", field->name);
  }
  olx_relight *r = olx_allocate_zero(1, sizeof *r);
  if (!r) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  r->source = field;
  r->field = *field;
  r->settings = *settings;
  r->direct.lights = &r->lights;
  r->direct.source = field;
  r->direct.sample = olx_sample_settings_default();
  const olx_result result = build(r);
  if (result != OLX_OK) {
    olx_relight_free(r);
    return result;
  }
  *relight = r;
  return OLX_OK;
}

void olx_relight_free(olx_relight *r) {
  if (!r) return;
  olx_relit_lights_free(&r->lights);
  olx_relit_schedule_free(r->schedule);
  olx_relit_surfels_free(&r->surfels);
  olx_relit_maps_free(&r->maps);
  olx_relit_volume_free(&r->volume);
  olx_release(r);
}

olx_result olx_relight_set_lights(olx_relight *r, const olx_light *lights, uint32_t count) {
  assert(r && (lights || count == 0));
  OLX_TRY(olx_relit_lights_set(&r->lights, r->source, lights, count));
  r->field.surfaces.lights = r->lights.packed;
  r->field.surfaces.light_count = r->field.info.scene.light_count = r->lights.packed_count;
  r->field.info.scene.hash = 0;
  r->field.relit = true;
  olx_relit_wake(r->schedule, r->lights.rays, olx_relit_surfel_rays(&r->lights), r->lights.varying);
  return OLX_OK;
}

// ---- A frame

static uint32_t light_surfels(olx_relight *r) {
  const olx_relit_surfel_turns turns = olx_relit_take_surfels(r->schedule);
  olx_relit_light_surfels(&r->surfels, &r->direct, &turns);
  return turns.count;
}

static uint32_t bounce(olx_relight *r) {
  const olx_relit_link_turns turns = olx_relit_take_links(r->schedule);
  double change, sum;
  olx_relit_bounce(&r->surfels, r->settings.threads, &turns, &change, &sum);
  olx_relit_links_followed(r->schedule, &turns, change, sum);
  return turns.count;
}

// Returns the number of texels that were lit.
static uint64_t light_tiles(olx_relight *r, olx_vec3 eye) {
  const olx_relit_tile_turns turns = olx_relit_take_tiles(r->schedule, eye, atomic_load(&r->direct.shadow_rays));
  olx_relit_light_tiles(&r->maps, &r->direct, r->surfels.irradiance, &turns);
  return (uint64_t)turns.count * turns.side * turns.side;
}

static uint32_t light_volume(olx_relight *r) {
  const olx_relit_volume_turns turns = olx_relit_take_volume(r->schedule);
  olx_relit_light_volume(&r->volume, r->settings.threads, r->surfels.values, &turns);
  return turns.count;
}

static void run_frame(olx_relight *r, olx_vec3 eye, olx_relight_stats *stats) {
  const double start = olx_seconds();
  olx_relit_begin_frame(r->schedule);
  atomic_store(&r->direct.shadow_rays, 0);
  stats->surfels_lit = light_surfels(r);
  stats->surfels_gathered = bounce(r);
  stats->texels = light_tiles(r, eye);
  stats->volume_probes = light_volume(r);
  stats->shadow_rays = atomic_load(&r->direct.shadow_rays);
  stats->awake = olx_relit_awake(r->schedule);
  stats->seconds = olx_seconds() - start;
}

olx_result olx_relight_frame(olx_relight *r, olx_vec3 eye, olx_relight_stats *stats) {
  assert(r);
  if (r->on_device) return olx_fail(OLX_ERROR_ARGUMENT, "relight: frames are made on a device");
  OLX_TRY(olx_check_cancelled());
  olx_relight_stats own;
  olx_task task; // without progress: once begun, a frame cannot be cancelled, so that turns taken are turns lit
  olx_task_begin(&task, NULL, "relighting", 1);
  run_frame(r, eye, stats ? stats : &own);
  olx_task_end(&task);
  return OLX_OK;
}

const olx_field *olx_relight_field(const olx_relight *r) { return &r->field; }

olx_relight_state olx_relight_probe_state(const olx_relight *r, uint32_t probe) {
  return olx_relit_probe_state(r->schedule, probe);
}

// ---- Frames on a device

olx_relit_schedule *olx_relit_hand_over(olx_relight *r) {
  r->on_device = true;
  return r->schedule;
}

bool olx_relit_has_begun(const olx_relight *r) { return r->on_device || olx_relit_frames(r->schedule) > 0; }
