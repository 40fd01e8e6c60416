// Chooses the tiles of light field maps that a frame lights: those that have waited longest in relation to their
// distance.
#include "relight/relit_tiles.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/texels.h"

#include <stdlib.h>

enum { TILE_SAMPLES = 4, VARYING_ROUNDS = 4 };

static const float LEAST_RATE = 0.125f;

// ---- Creation

// Computes the mean distance and direction of what a few texels of a tile see.
static void look(const olx_relit_tiles *t, olx_relit_tile_state *state) {
  const olx_field *f = t->source;
  const olx_relit_tile *tile = &state->tile;
  olx_vec3 sum = {0};
  float distance = 0.0f, count = 0.0f;
  for (uint32_t i = 0; i < TILE_SAMPLES * TILE_SAMPLES; i++) {
    const uint32_t step = t->side / TILE_SAMPLES, x = tile->first_x + i % TILE_SAMPLES * step,
                   y = tile->first_y + i / TILE_SAMPLES * step;
    const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    if (olx_texel_is_sky(f, tile->probe, texel)) continue;
    const olx_vec3 direction = olx_texel_direction(x, y, f->n);
    sum = olx_add(sum, direction);
    distance += olx_texel_distance(f, tile->probe, texel);
    count += 1.0f;
  }
  state->direction = olx_length(sum) > 0.0f ? olx_normalize(sum) : olx_v3(0.0f, 1.0f, 0.0f);
  state->distance = count > 0.0f ? distance / count : t->near_metres; // other texels may still see a surface
}

static void make_tiles(olx_relit_tiles *t) {
  const uint32_t a_side = t->source->n / t->side;
  for (uint32_t i = 0; i < t->count; i++) {
    olx_relit_tile_state *state = &t->states[i];
    const uint32_t at = i % t->a_map;
    *state = (olx_relit_tile_state){.tile = {.probe = i / t->a_map,
                                             .first_x = at % a_side * t->side,
                                             .first_y = at / a_side * t->side,
                                             .rounds = UINT32_MAX}};
    if (!(t->source->probe_flags[state->tile.probe] & OLX_PROBE_BURIED)) look(t, state);
  }
}

static float near_distance(const olx_field_info *info, const olx_relight_settings *settings) {
  const float diagonal = olx_length(olx_sub(info->scene.bounds_max, info->scene.bounds_min));
  const float metres = settings->near_metres > 0.0f ? settings->near_metres : diagonal / 8.0f;
  return metres > 0.0f ? metres : 1.0f;
}

olx_result olx_relit_tiles_create(const olx_field *source, const olx_relight_settings *settings, olx_relit_tiles *t) {
  const uint32_t probes = source->info.probes.count, a_map = olx_relit_tiles_a_map(source->n), count = a_map * probes;
  *t = (olx_relit_tiles){.source = source,
                         .near_metres = near_distance(&source->info, settings),
                         .side = olx_relit_tile_side(source->n),
                         .a_map = a_map,
                         .count = count,
                         .states = olx_allocate(count, sizeof *t->states),
                         .due = olx_allocate(count, sizeof *t->due),
                         .chosen = olx_allocate(count, sizeof *t->chosen),
                         .part_frames = olx_allocate_zero((size_t)probes * (a_map + 1), sizeof *t->part_frames)};
  if (!t->states || !t->due || !t->chosen || !t->part_frames) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for the schedule of %u light field maps", probes);
  }
  make_tiles(t);
  return OLX_OK;
}

void olx_relit_tiles_free(olx_relit_tiles *t) {
  olx_release(t->states);
  olx_release(t->due);
  olx_release(t->chosen);
  olx_release(t->part_frames);
}

// ---- Waiting

static bool lacks_direct(const olx_relit_tiles *t, const olx_relit_tile_state *state) {
  return state->tile.rounds < t->rounds;
}

static bool waits(const olx_relit_tiles *t, olx_relit_time now, const olx_relit_tile_state *state) {
  return state->distance > 0.0f && (lacks_direct(t, state) || state->solution != now.solution);
}

void olx_relit_wake_tiles(olx_relit_tiles *t, olx_relit_time now, bool varying) {
  t->rounds = varying ? VARYING_ROUNDS : 1;
  for (uint32_t i = 0; i < t->count; i++) {
    olx_relit_tile_state *state = &t->states[i];
    if (!waits(t, now, state)) state->last_frame = now.frame;
    state->tile.rounds = 0;
  }
}

uint32_t olx_relit_count_waiting(const olx_relit_tiles *t, olx_relit_time now) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < t->count; i++) count += waits(t, now, &t->states[i]);
  return count;
}

olx_relight_state olx_relit_map_state(const olx_relit_tiles *t, olx_relit_time now, uint32_t probe) {
  olx_relight_state found = {0};
  if (probe >= t->source->info.probes.count) return found;
  for (uint32_t i = 0; i < t->a_map; i++) {
    const olx_relit_tile_state *state = &t->states[(size_t)probe * t->a_map + i];
    const uint32_t changed = t->part_frames[(size_t)probe * (t->a_map + 1) + i], waited = now.frame - state->last_frame;
    const bool due = waits(t, now, state);
    found.tiles_waiting += due;
    if (changed > found.last_frame) found.last_frame = changed;
    if (due && waited > found.waited) found.waited = waited;
  }
  return found;
}

// ---- Turns

// Returns how often a tile is lit, relative to the nearest tiles.
static float rate_of(const olx_relit_tiles *t, const olx_relit_tile_state *state, olx_vec3 eye) {
  const olx_vec3 probe = t->source->probe_positions[state->tile.probe];
  const float distance = olx_length(olx_sub(olx_madd(probe, state->direction, state->distance), eye));
  float rate = 1.0f;
  for (float reach = t->near_metres; distance > reach && rate > LEAST_RATE; reach *= 2.0f) rate *= 0.5f;
  return rate;
}

static int by_urgency(const void *a, const void *b) {
  const olx_relit_due *p = a, *q = b;
  if (p->urgency != q->urgency) return p->urgency > q->urgency ? -1 : 1;
  return p->tile < q->tile ? -1 : p->tile > q->tile;
}

// Lists the tiles that wait in the order of their urgency, and returns their number.
static uint32_t list_due(olx_relit_tiles *t, olx_relit_time now, olx_vec3 eye) {
  uint32_t waiting = 0;
  for (uint32_t i = 0; i < t->count; i++) {
    const olx_relit_tile_state *state = &t->states[i];
    if (!waits(t, now, state)) continue;
    // Urgency grows without limit while a tile waits, so that every tile gets its turn.
    const float waited = (float)(now.frame - state->last_frame);
    t->due[waiting++] = (olx_relit_due){.urgency = waited * rate_of(t, state, eye), .tile = i};
  }
  if (waiting > 0) qsort(t->due, waiting, sizeof *t->due, by_urgency);
  return waiting;
}

// Counts the samples of a tile whose turn it is.
static void count_lit(olx_relit_tiles *t, olx_relit_time now, const olx_relit_due *due) {
  olx_relit_tile_state *state = &t->states[due->tile];
  uint32_t *parts = t->part_frames + (size_t)state->tile.probe * (t->a_map + 1);
  state->tile.rounds += due->lit;
  state->solution = now.solution;
  state->last_frame = now.frame;
  parts[due->tile % t->a_map] = now.frame;
  if (olx_relit_on_edge(&state->tile, t->side, t->source->n)) parts[t->a_map] = now.frame;
}

// Puts the chosen tiles that get direct light, or those that do not, behind `count` others; returns how many there are
// then.
static uint32_t put_chosen(olx_relit_tiles *t, olx_relit_time now, uint32_t chosen, bool lit, uint32_t count) {
  for (uint32_t i = 0; i < chosen; i++) {
    const olx_relit_due *due = &t->due[i];
    if (due->lit != lit) continue;
    t->chosen[count++] = t->states[due->tile].tile;
    count_lit(t, now, due);
  }
  return count;
}

olx_relit_tile_turns olx_relit_choose_tiles(olx_relit_tiles *t, olx_relit_time now, olx_vec3 eye, uint64_t most,
                                            uint64_t most_lit) {
  const uint32_t waiting = list_due(t, now, eye);
  uint32_t count = 0;
  for (uint32_t i = 0; i < waiting && count < most; i++) {
    const olx_relit_tile_state *state = &t->states[t->due[i].tile];
    const bool lit = lacks_direct(t, state) && (most_lit > 0 || count == 0);
    if (!lit && state->solution == now.solution) continue;
    most_lit -= lit && most_lit > 0;
    t->due[count++] = (olx_relit_due){.tile = t->due[i].tile, .lit = lit};
  }
  const uint32_t lit = put_chosen(t, now, count, true, 0);
  put_chosen(t, now, count, false, lit);
  return (olx_relit_tile_turns){t->chosen, count, lit, t->side};
}
