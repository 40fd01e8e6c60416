// Creates a relighter, takes its lights, and runs its frames.
#include "shade/relighter_schedule.h"

#include "core/hooks.h"
#include "core/result.h"

#include <assert.h>
#include <string.h>

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
  const olx_field_info *info = &r->source->info;
  const float diagonal = olx_length(olx_sub(info->scene_max, info->scene_min));
  r->near_metres = r->settings.near_metres > 0.0f ? r->settings.near_metres : diagonal / 8.0f;
  if (!(r->near_metres > 0.0f)) r->near_metres = 1.0f;
  r->lights = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *r->lights);
  r->field_lights = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *r->field_lights);
  if (!r->lights || !r->field_lights) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  OLX_TRY(olx_relit_surfels_create(r));
  OLX_TRY(olx_relit_texels_create(r));
  return olx_relit_volume_create(r);
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
  r->sample = olx_sample_settings_default();
  r->settled = true;
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
  olx_relit_surfels_free(r);
  olx_relit_texels_free(r);
  olx_relit_volume_free(r);
  olx_release(r->lights);
  olx_release(r->field_lights);
  olx_release(r);
}

// ---- Lights

static bool is_light(const olx_light *l) {
  const bool finite = olx_finite(l->emission) && olx_is_position(l->position) && olx_finite(l->direction) &&
                      olx_finite(l->edge_u) && olx_finite(l->edge_v);
  if (!finite || l->emission.x < 0.0f || l->emission.y < 0.0f || l->emission.z < 0.0f) return false;
  if (l->type == OLX_LIGHT_SUN || l->type == OLX_LIGHT_SPOT) {
    if (fabsf(olx_length(l->direction) - 1.0f) > 1e-3f) return false;
  }
  return l->type != OLX_LIGHT_SPOT ||
         (l->cosine_outer >= -1.0f && l->cosine_outer <= l->cosine_inner && l->cosine_inner <= 1.0f);
}

// Marks everything as out of date after new lights. Previous light stays until it is replaced.
static void wake(olx_relight *r) {
  r->settled = false;
  r->stale = true;
  r->change = r->sum = 0.0;
  r->swept = 0;
  r->dark = r->source->relight.header->surfels;
  memset(r->rounds, 0, r->dark * sizeof *r->rounds);
  for (uint32_t i = 0; i < r->tile_count; i++) {
    olx_relit_tile *tile = &r->tiles[i];
    if (!olx_relit_tile_waits(r, tile)) tile->last_frame = r->frame;
    tile->rounds = 0;
  }
}

olx_result olx_relight_set_lights(olx_relight *r, const olx_light *lights, uint32_t count) {
  assert(r && (lights || count == 0));
  if (count > OLX_RELIT_MOST_LIGHTS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: %u lights: at most %d", count, OLX_RELIT_MOST_LIGHTS);
  }
  for (uint32_t i = 0; i < count; i++) {
    if ((uint32_t)lights[i].type > OLX_LIGHT_SKY || !is_light(&lights[i])) {
      return olx_fail(OLX_ERROR_ARGUMENT, "relight: light %u: its type, a number or a direction is out of range", i);
    }
  }
  if (count > 0) memcpy(r->lights, lights, count * sizeof *lights);
  r->light_count = count;
  r->field_light_count = 0;
  r->varying = false;
  for (uint32_t i = 0; i < count; i++) {
    if (olx_light_varies(&lights[i])) r->varying = true;
    else r->field_lights[r->field_light_count++] = olx_field_light_pack(&lights[i]);
  }
  r->field.surfaces.lights = r->field_lights;
  r->field.surfaces.light_count = r->field.info.light_count = r->field_light_count;
  r->field.info.scene_hash = 0;
  r->field.relit = true;
  r->light_changes++;
  wake(r);
  return OLX_OK;
}

// ---- A frame

uint32_t olx_relit_awake(const olx_relight *r) {
  const uint32_t waiting = olx_relit_tiles_waiting(r) + r->volume_waiting + r->dark;
  return waiting > 0 || r->settled ? waiting : 1;
}

olx_result olx_relight_frame(olx_relight *r, olx_vec3 eye, olx_relight_stats *stats) {
  assert(r);
  if (r->on_device) return olx_fail(OLX_ERROR_ARGUMENT, "relight: frames are made on a device");
  const double start = olx_seconds();
  const uint64_t rays = r->settings.shadow_rays;
  r->frame++;
  atomic_store(&r->shadow_rays, 0);
  // At least half of the rays are for texels while surfels still need some.
  const uint32_t lit = olx_relit_light_surfels(r, rays / 2);
  const uint32_t bounced = olx_relit_bounce(r);
  const uint64_t spent = atomic_load(&r->shadow_rays);
  olx_relit_schedule(r, eye, rays > spent ? rays - spent : 0);
  olx_relit_light_tiles(r);
  const uint32_t probes = olx_relit_light_volume(r);
  if (!stats) return OLX_OK;
  *stats = (olx_relight_stats){.surfels_lit = lit,
                               .surfels_gathered = bounced,
                               .texels = (uint64_t)r->scheduled_count * r->tile_side * r->tile_side,
                               .volume_probes = probes,
                               .shadow_rays = atomic_load(&r->shadow_rays),
                               .awake = olx_relit_awake(r),
                               .seconds = olx_seconds() - start};
  return OLX_OK;
}

const olx_field *olx_relight_field(const olx_relight *r) { return &r->field; }

olx_relight_state olx_relight_probe_state(const olx_relight *r, uint32_t probe) {
  olx_relight_state state = {0};
  if (probe >= r->field.info.probe_count) return state;
  for (uint32_t i = 0; i < r->tiles_a_probe; i++) {
    const olx_relit_tile *tile = &r->tiles[(size_t)probe * r->tiles_a_probe + i];
    const uint32_t changed = r->part_frames[(size_t)probe * (r->tiles_a_probe + 1) + i];
    const bool waits = olx_relit_tile_waits(r, tile);
    state.tiles_waiting += waits;
    if (changed > state.last_frame) state.last_frame = changed;
    if (waits && r->frame - tile->last_frame > state.waited) state.waited = r->frame - tile->last_frame;
  }
  return state;
}
