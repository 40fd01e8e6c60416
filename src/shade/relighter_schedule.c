// Chooses the tiles of light field maps that a frame lights: those that have waited longest in relation to their
// distance.
#include "shade/relighter_schedule.h"

#include <stdlib.h>

static const float LEAST_RATE = 0.125f;

static bool lacks_direct(const olx_relight *r, const olx_relit_tile *tile) {
  return tile->rounds < olx_relit_texel_rounds(r);
}

bool olx_relit_tile_waits(const olx_relight *r, const olx_relit_tile *tile) {
  return tile->distance > 0.0f && (lacks_direct(r, tile) || tile->solution != r->solution);
}

uint32_t olx_relit_tiles_waiting(const olx_relight *r) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < r->tile_count; i++) count += olx_relit_tile_waits(r, &r->tiles[i]);
  return count;
}

// Returns how often a tile is lit, relative to the nearest tiles.
static float rate_of(const olx_relight *r, const olx_relit_tile *tile, olx_vec3 eye) {
  const olx_vec3 place = olx_madd(r->source->probe_positions[tile->probe], tile->direction, tile->distance);
  const float distance = olx_length(olx_sub(place, eye));
  float rate = 1.0f;
  for (float reach = r->near_metres; distance > reach && rate > LEAST_RATE; reach *= 2.0f) rate *= 0.5f;
  return rate;
}

static int by_urgency(const void *a, const void *b) {
  const olx_relit_due *p = a, *q = b;
  if (p->urgency != q->urgency) return p->urgency > q->urgency ? -1 : 1;
  return p->tile < q->tile ? -1 : p->tile > q->tile;
}

void olx_relit_schedule(olx_relight *r, olx_vec3 eye, uint64_t rays) {
  const uint64_t texels = (uint64_t)r->tile_side * r->tile_side, cost = texels * olx_relit_rays(r);
  const uint64_t most = (r->settings.texels + texels - 1) / texels;
  uint32_t waiting = 0;
  for (uint32_t i = 0; i < r->tile_count; i++) {
    const olx_relit_tile *tile = &r->tiles[i];
    if (!olx_relit_tile_waits(r, tile)) continue;
    // Urgency grows without limit while a tile waits, so that every tile gets its turn.
    const float waited = (float)(r->frame - tile->last_frame);
    r->due[waiting++] = (olx_relit_due){waited * rate_of(r, tile, eye), i};
  }
  if (waiting > 0) qsort(r->due, waiting, sizeof *r->due, by_urgency);
  r->scheduled_count = 0;
  for (uint32_t i = 0; i < waiting && r->scheduled_count < most; i++) {
    const olx_relit_tile *tile = &r->tiles[r->due[i].tile];
    const bool affordable = rays >= cost || r->scheduled_count == 0, lit = lacks_direct(r, tile) && affordable;
    if (!lit && tile->solution == r->solution) continue;
    if (lit) rays -= rays < cost ? rays : cost;
    r->lit[r->scheduled_count] = lit;
    r->scheduled[r->scheduled_count++] = r->due[i].tile;
  }
}
