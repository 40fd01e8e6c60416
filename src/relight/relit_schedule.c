// Keeps the turns of surfels, links and volume probes, and gives out those of a frame.
#include "relight/relit_schedule.h"

#include "core/hooks.h"
#include "core/result.h"
#include "relight/relit_tiles.h"

// Surfels get samples of direct light in turn, cyclically.
typedef struct surfel_samples {
  uint32_t count, next;
  uint32_t rounds; // number of samples that each needs
  uint64_t taken;  // by all, since lights were set
} surfel_samples;

// Links are followed in sweeps over all surfels.
typedef struct link_sweep {
  uint32_t next, swept; // swept: number of surfels whose links were followed in the current sweep
  bool shining, stale;  // the current sweep recomputes highlights; the next one must
  double change, sum;   // of light in this sweep
  bool settled;         // the last sweep changed too little to go on, or no lights have been set
} link_sweep;

// Probes of the volume wait when the light of surfels has changed.
typedef struct volume_probes {
  uint32_t count, next, waiting;
  uint32_t solution; // of surfels, for which they wait or from which they are lit
  uint32_t frame;    // the last one that lit some
} volume_probes;

struct olx_relit_schedule {
  const olx_relight_settings *settings;
  olx_relit_time now;
  uint32_t light_changes; // how often lights were set
  uint32_t rays;          // from a texel for a sample of its direct light, at most
  uint32_t surfel_rays;   // from a surfel
  surfel_samples surfels;
  link_sweep sweep;
  olx_relit_tiles tiles;
  volume_probes volume;
};

olx_result olx_relit_schedule_create(const olx_field *source, const olx_relight_settings *settings,
                                     olx_relit_schedule **schedule) {
  const olx_relight_header *header = source->relight.header;
  olx_relit_schedule *s = *schedule = olx_allocate_zero(1, sizeof *s);
  if (!s) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  s->settings = settings;
  s->surfels.count = header->surfels;
  s->sweep.settled = true;
  s->volume.count = header->volume_probes;
  return olx_relit_tiles_create(source, settings, &s->tiles);
}

void olx_relit_schedule_free(olx_relit_schedule *s) {
  if (!s) return;
  olx_relit_tiles_free(&s->tiles);
  olx_release(s);
}

void olx_relit_wake(olx_relit_schedule *s, uint32_t rays, uint32_t surfel_rays, bool varying) {
  s->light_changes++;
  s->rays = rays;
  s->surfel_rays = surfel_rays;
  s->surfels.rounds = varying ? OLX_RELIGHT_POINTS * 2 : OLX_RELIGHT_POINTS;
  s->surfels.taken = 0;
  s->sweep = (link_sweep){.next = s->sweep.next, .stale = true, .settled = s->surfels.count == 0};
  olx_relit_wake_tiles(&s->tiles, s->now, varying);
}

void olx_relit_begin_frame(olx_relit_schedule *s) { s->now.frame++; }

// ---- Surfels

static uint64_t samples_lacking(const surfel_samples *t) { return (uint64_t)t->rounds * t->count - t->taken; }

// Returns the number of surfels that lack samples.
static uint32_t dark_surfels(const surfel_samples *t) {
  const uint64_t lacking = samples_lacking(t);
  return lacking < t->count ? (uint32_t)lacking : t->count;
}

olx_relit_surfel_turns olx_relit_take_surfels(olx_relit_schedule *s) {
  surfel_samples *t = &s->surfels;
  const uint32_t dark = dark_surfels(t);
  const uint64_t affordable = s->surfel_rays ? s->settings->shadow_rays / 2 / s->surfel_rays : t->count,
                 most = affordable ? affordable : 1;
  if (dark == 0) return (olx_relit_surfel_turns){.count = 0};
  const uint32_t count = most < dark ? (uint32_t)most : dark, same = t->count - (uint32_t)(t->taken % t->count);
  const olx_relit_surfel_turns turns = {.first = t->next,
                                        .count = count,
                                        .round = (uint32_t)(t->taken / t->count),
                                        .before = count < same ? count : same};
  t->taken += count;
  // A frame with rays to spare has gone all the way round, past surfels that lack nothing.
  if (count == most) t->next = (uint32_t)(((uint64_t)t->next + count) % t->count);
  return turns;
}

// ---- Links

olx_relit_link_turns olx_relit_take_links(olx_relit_schedule *s) {
  link_sweep *w = &s->sweep;
  const uint32_t all = s->surfels.count, left = all - w->swept, most = s->settings->surfels;
  const bool dark = dark_surfels(&s->surfels) > 0;
  if (w->settled) return (olx_relit_link_turns){.count = 0};
  if (w->swept == 0) {
    w->shining = w->stale;
    w->stale = dark;
  }
  const olx_relit_link_turns turns = {.first = w->next,
                                      .count = most < left ? most : left,
                                      .ends = most >= left,
                                      .dark = dark,
                                      .stale = w->stale,
                                      .shines = w->shining,
                                      .light_changes = s->light_changes};
  w->next = (uint32_t)(((uint64_t)w->next + turns.count) % all);
  w->swept = turns.ends ? 0 : w->swept + turns.count;
  return turns;
}

void olx_relit_links_followed(olx_relit_schedule *s, const olx_relit_link_turns *turns, double change, double sum) {
  link_sweep *w = &s->sweep;
  if (w->settled || turns->light_changes != s->light_changes) return;
  w->change += change;
  w->sum += sum;
  if (!turns->ends) return;
  const bool changed = w->change > (double)s->settings->sleep * w->sum;
  if (changed || turns->dark) s->now.solution++;
  w->settled = !changed && !turns->dark && !turns->stale;
  w->change = w->sum = 0.0;
}

// ---- Tiles and the volume

olx_relit_tile_turns olx_relit_take_tiles(olx_relit_schedule *s, olx_vec3 eye, uint64_t spent) {
  const uint64_t texels = (uint64_t)s->tiles.side * s->tiles.side, cost = texels * s->rays,
                 rays = s->settings->shadow_rays, left = rays > spent ? rays - spent : 0;
  return olx_relit_choose_tiles(&s->tiles, s->now, eye, (s->settings->texels + texels - 1) / texels,
                                cost ? left / cost : s->tiles.count);
}

olx_relit_volume_turns olx_relit_take_volume(olx_relit_schedule *s) {
  volume_probes *v = &s->volume;
  if (v->solution != s->now.solution) v->waiting = v->count;
  v->solution = s->now.solution;
  const uint32_t most = s->settings->volume_probes;
  const olx_relit_volume_turns turns = {v->next, most < v->waiting ? most : v->waiting};
  if (turns.count == 0) return turns;
  v->waiting -= turns.count;
  v->next = (uint32_t)(((uint64_t)v->next + turns.count) % v->count);
  v->frame = s->now.frame;
  return turns;
}

// ---- The state

uint32_t olx_relit_frames(const olx_relit_schedule *s) { return s->now.frame; }

uint32_t olx_relit_light_changes(const olx_relit_schedule *s) { return s->light_changes; }

uint32_t olx_relit_tiles_waiting(const olx_relit_schedule *s) { return olx_relit_count_waiting(&s->tiles, s->now); }

uint32_t olx_relit_awake(const olx_relit_schedule *s) {
  const uint32_t waiting = olx_relit_tiles_waiting(s) + s->volume.waiting + dark_surfels(&s->surfels);
  return waiting > 0 || s->sweep.settled ? waiting : 1;
}

olx_relight_state olx_relit_probe_state(const olx_relit_schedule *s, uint32_t probe) {
  return olx_relit_map_state(&s->tiles, s->now, probe);
}

const uint32_t *olx_relit_part_frames(const olx_relit_schedule *s) { return s->tiles.part_frames; }

uint32_t olx_relit_volume_frame(const olx_relit_schedule *s) { return s->volume.frame; }
