// Gathers the light of any surface by rays of its own: as many in each bin of directions as a guide says, each drawn
// from its bin and its number there alone, so that rays stay the same where a guide changes slightly.
#include "light/links/gathers.h"

#include "core/chunk_file.h"

#include <string.h>

enum { MOST_KINDS = UINT8_MAX + 1 };

// The rays of a gather, bin by bin.
typedef struct gather {
  uint16_t bins[OLX_GUIDE_BINS]; // rays in each bin
  olx_ray_end ends[OLX_GATHER_RAYS];
} gather;

// Returns a hash of everything that the rays of a gather are drawn from, but for how many there are in each bin.
static uint64_t check_of(const olx_surface *surface, uint32_t seed) {
  const uint64_t numbers = (uint64_t)surface->triangle << 32 | seed;
  const olx_vec3 place[] = {surface->position, surface->geometric_normal, surface->shading_normal,
                            olx_splat(surface->epsilon)};
  const uint64_t hashes[] = {olx_content_hash(&numbers, sizeof numbers), olx_content_hash(place, sizeof place)};
  return olx_content_hash(hashes, sizeof hashes);
}

// ---- What is kept

// A kept gather, with its rays by number.
typedef struct former_gather {
  olx_kept_gather kept;
  olx_gather_kind kinds[MOST_KINDS];
  uint16_t now[OLX_GATHER_RAYS]; // each ray's number now; OLX_GATHER_RAYS: it is not reused
} former_gather;

// Returns whether a ray of a gather still holds, and gives its link the surfel's number of now.
static bool still_holds(const olx_gather_row *row, const olx_gather_kind *kind, const olx_light_surfels *surfels,
                        olx_link *link) {
  if (kind->needs & row->changed || olx_link_end(link) == OLX_LINK_UNSERVED) return false;
  if (row->earlier && olx_brick_sets_meet(&kind->crossed, &row->earlier->changed)) return false;
  return olx_link_still_ends(link, NULL, row->earlier, surfels);
}

// Takes a ray over, without the light that it brings without its link, where it still holds.
static void take_ray(olx_gather_row *row, const olx_light_surfels *surfels, former_gather *former, uint32_t before,
                     uint32_t now, olx_ray_end *end) {
  olx_link link = former->kept.links[before];
  if (former->kept.kinds[before] >= former->kept.kind_count) return;
  const olx_gather_kind *kind = &former->kinds[former->kept.kinds[before]];
  if (!still_holds(row, kind, surfels, &link)) return;
  *end = (olx_ray_end){.link = link, .needs = kind->needs, .crossed = kind->crossed, .known = true};
  former->now[before] = (uint16_t)now;
}

static void take_lights(const former_gather *former, olx_ray_end *ends) {
  for (uint32_t i = 0; i < former->kept.light_count; i++) {
    const olx_gather_light *light = &former->kept.lights[i];
    const uint32_t now = light->ray < OLX_GATHER_RAYS ? former->now[light->ray] : OLX_GATHER_RAYS;
    if (now == OLX_GATHER_RAYS) continue;
    *(light->surfaces < OLX_CHAIN_MOST ? &ends[now].fixed[light->surfaces] : &ends[now].near) = light->light;
  }
}

// Fills in the ends of rays that were cast for another scene and still hold.
static void take_former(olx_gather_row *row, uint64_t check, const olx_light_surfels *surfels, gather *g) {
  former_gather former;
  if (!olx_gather_row_find(row, check, &former.kept)) return;
  if (!olx_gather_read_kinds(&former.kept, former.kinds)) return;
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) former.now[i] = OLX_GATHER_RAYS;
  uint32_t before = 0, now = 0;
  for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
    for (uint32_t i = 0; i < former.kept.bins[bin] && i < g->bins[bin]; i++) {
      take_ray(row, surfels, &former, before + i, now + i, &g->ends[now + i]);
      row->reused += g->ends[now + i].known;
    }
    before += former.kept.bins[bin];
    now += g->bins[bin];
  }
  take_lights(&former, g->ends);
}

// The kinds of a gather's rays, which are found by their hashes. The last kind is for all that find no other.
typedef struct kind_table {
  olx_gather_kind kinds[MOST_KINDS];
  uint32_t count;
  uint16_t slots[2 * MOST_KINDS]; // a kind's number plus one; zero: none
} kind_table;

// Returns the number of a ray's kind, which it may add.
static uint8_t kind_of(kind_table *table, const olx_ray_end *end) {
  const olx_gather_kind wanted = {end->needs, end->crossed};
  uint32_t slot = olx_content_hash(&wanted, sizeof wanted) % (2 * MOST_KINDS);
  for (; table->slots[slot] != 0; slot = (slot + 1) % (2 * MOST_KINDS)) {
    const uint32_t kind = table->slots[slot] - 1u;
    if (memcmp(&table->kinds[kind], &wanted, sizeof wanted) == 0) return (uint8_t)kind;
  }
  if (table->count < MOST_KINDS - 1) {
    table->kinds[table->count++] = wanted;
    table->slots[slot] = (uint16_t)table->count;
  } else {
    table->kinds[MOST_KINDS - 1] = (olx_gather_kind){.needs = UINT64_MAX};
    table->count = MOST_KINDS;
  }
  return (uint8_t)(table->count - 1);
}

static void keep(olx_gather_row *row, uint64_t check, const gather *g) {
  olx_link links[OLX_GATHER_RAYS];
  kind_table table;
  uint8_t kinds[OLX_GATHER_RAYS], bricks[MOST_KINDS * OLX_KIND_BYTES];
  olx_gather_light lights[OLX_GATHER_RAYS * (OLX_CHAIN_MOST + 1)];
  uint64_t needs[MOST_KINDS];
  olx_kept_gather kept = {
      .bins = g->bins, .links = links, .kinds = kinds, .needs = needs, .bricks = bricks, .lights = lights};
  table.count = 0;
  memset(table.slots, 0, sizeof table.slots);
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) {
    links[i] = g->ends[i].link;
    kinds[i] = kind_of(&table, &g->ends[i]);
    for (uint32_t k = 0; k <= OLX_CHAIN_MOST; k++) {
      const olx_vec3 light = k < OLX_CHAIN_MOST ? g->ends[i].fixed[k] : g->ends[i].near;
      if (olx_max3(light) == 0.0f) continue;
      lights[kept.light_count++] = (olx_gather_light){(uint16_t)i, (uint16_t)k, light};
    }
  }
  kept.kind_count = table.count;
  for (uint32_t i = 0; i < table.count; i++) {
    needs[i] = table.kinds[i].needs;
    kept.brick_count += olx_gather_write_bricks(&table.kinds[i].crossed, bricks + kept.brick_count, &needs[i]);
  }
  olx_gather_row_keep(row, check, &kept);
}

// ---- Gathering

static void cast_rays(const olx_ray_caster *caster, const olx_surface *surface, uint32_t seed, gather *g) {
  olx_ray_draw draws[OLX_LINK_PACKET];
  const olx_bin_sequence sequence = olx_bin_sequence_make(seed);
  uint32_t drawn = 0, first = 0;
  for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
    for (uint32_t i = 0; i < g->bins[bin]; i++) {
      draws[drawn++] = olx_ray_draw_in_bin(&sequence, bin, i);
      if (drawn < OLX_LINK_PACKET) continue;
      olx_ray_ends_cast(caster, surface, draws, drawn, g->ends + first);
      first += drawn;
      drawn = 0;
    }
  }
  olx_ray_ends_cast(caster, surface, draws, drawn, g->ends + first);
}

// Adds up the light of all rays: the mean over bins of the mean over each bin's rays.
static olx_vec3 add_up(const gather *g, const olx_passed_light *light, float most, float around) {
  olx_vec3 brought[OLX_GATHER_RAYS], sum = {0};
  float luminance[OLX_GATHER_RAYS], all = 0.0f;
  uint32_t rays = 0;
  for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
    const float share = 1.0f / (float)(OLX_GUIDE_BINS * g->bins[bin]);
    for (uint32_t i = 0; i < g->bins[bin]; i++, rays++) {
      brought[rays] = olx_ray_end_light(&g->ends[rays], share, 1.0f / OLX_GATHER_RAYS, light);
      luminance[rays] = olx_luminance(brought[rays]);
      all += luminance[rays];
    }
  }
  for (uint32_t i = 0; i < rays; i++) {
    const float bound = most * olx_max(around, all - luminance[i]);
    sum = olx_madd(sum, brought[i], luminance[i] > bound ? bound / luminance[i] : 1.0f);
  }
  return sum;
}

olx_vec3 olx_gather_at(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                       uint32_t seed, const olx_passed_light *light, float most, float around, olx_gather_row *row) {
  olx_watched_surfels watched;
  olx_ray_caster caster = {.surfels = surfels};
  const uint64_t check = row ? check_of(surface, seed) : 0;
  gather g;
  olx_guide_divide(pool, OLX_GATHER_RAYS, g.bins);
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) g.ends[i] = olx_ray_end_none();
  if (row) {
    olx_ray_caster_watch(&caster, &watched);
    take_former(row, check, surfels, &g);
  }
  cast_rays(&caster, surface, seed, &g);
  if (row) {
    keep(row, check, &g);
    row->rays += OLX_GATHER_RAYS;
  }
  return add_up(&g, light, most, around);
}
