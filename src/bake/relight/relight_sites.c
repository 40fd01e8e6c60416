// Finds the surfels from which the indirect light of a probe's texels is interpolated, and their weights.
#include "bake/relight/relight_sites.h"

#include "bake/capture/texel_blocks.h"
#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

enum { CORNERS = 4, MOST_ENTRIES = 8, WHOLE = 255 };

// The surfels of a site and their weights at the corners of its block, before quantization.
typedef struct site_draft {
  uint32_t count;
  uint32_t surfel[CORNERS * OLX_NEIGHBOURS_MOST];
  float weight[CORNERS * OLX_NEIGHBOURS_MOST][CORNERS];
} site_draft;

typedef struct site {
  uint32_t count;
  olx_relight_entry entries[MOST_ENTRIES];
} site;

typedef struct block_sites {
  olx_relight_block block; // first_site: 0, or OLX_RELIGHT_NO_SITE
  uint32_t count;
  site sites[OLX_RELIGHT_BLOCK_SITES];
} block_sites;

typedef struct site_job {
  const olx_capture *capture;
  const olx_surfel_lookup *surfels;
  block_sites *blocks;
} site_job;

static void add_weight(site_draft *d, uint32_t surfel, uint32_t corner, float weight) {
  uint32_t at = 0;
  while (at < d->count && d->surfel[at] != surfel) at++;
  if (at == d->count) {
    d->surfel[d->count++] = surfel;
    memset(d->weight[at], 0, sizeof d->weight[at]);
  }
  d->weight[at][corner] += weight;
}

// Collects the weights of the surfels around a surface, or of the one that serves it where there are none. Negative
// weights, which extrapolate, are left out. Returns false when there is no surfel at all: the surface lies in a fold.
static bool weigh(const olx_surfel_lookup *lookup, const olx_surface *surface, uint32_t corner, site_draft *d) {
  const olx_surfel_weights weights = olx_surfel_weigh(lookup, surface, false);
  for (uint32_t i = 0; i < weights.count; i++) {
    if (weights.weight[i] > 0.0f) add_weight(d, weights.surfel[i], corner, weights.weight[i]);
  }
  if (weights.count > 0) return true;
  const uint64_t key = olx_cell_key(&lookup->surfels->grid, surface->position, surface->geometric_normal);
  const uint32_t near = olx_light_surfels_find(lookup->surfels, key, surface, INFINITY).surfel;
  if (near != OLX_CELL_NONE) add_weight(d, near, corner, 1.0f);
  return near != OLX_CELL_NONE;
}

static float sum_of(const float weight[CORNERS]) { return weight[0] + weight[1] + weight[2] + weight[3]; }

// Moves the heaviest surfels to the front; returns the number that is kept.
static uint32_t keep_heaviest(site_draft *d) {
  const uint32_t kept = d->count < MOST_ENTRIES ? d->count : MOST_ENTRIES;
  for (uint32_t i = 0; i < kept; i++) {
    uint32_t best = i;
    for (uint32_t k = i + 1; k < d->count; k++) {
      if (sum_of(d->weight[k]) > sum_of(d->weight[best])) best = k;
    }
    const uint32_t surfel = d->surfel[i];
    float weight[CORNERS];
    memcpy(weight, d->weight[i], sizeof weight);
    d->surfel[i] = d->surfel[best];
    memcpy(d->weight[i], d->weight[best], sizeof weight);
    d->surfel[best] = surfel;
    memcpy(d->weight[best], weight, sizeof weight);
  }
  return kept;
}

// Quantizes the weights at a corner to bytes whose sum is WHOLE: the rounding error goes to the first, the heaviest.
static void round_corner(const site_draft *d, uint32_t corner, site *s) {
  float sum = 0.0f;
  for (uint32_t i = 0; i < s->count; i++) sum += d->weight[i][corner];
  uint32_t left = WHOLE;
  for (uint32_t i = s->count; i-- > 0;) {
    const float share = sum > 0.0f ? d->weight[i][corner] / sum : 1.0f / (float)s->count;
    const uint32_t rounded = i == 0 ? left : (uint32_t)(share * WHOLE + 0.5f);
    const uint32_t taken = rounded < left ? rounded : left;
    s->entries[i].weights[corner] = (uint8_t)taken;
    left -= taken;
  }
}

static void finish_site(site_draft *d, site *s) {
  s->count = keep_heaviest(d);
  for (uint32_t i = 0; i < s->count; i++) s->entries[i].surfel = d->surfel[i];
  for (uint32_t corner = 0; corner < CORNERS && s->count > 0; corner++) round_corner(d, corner, s);
}

static void light_flat(const site_job *j, const olx_block_surfaces *s, block_sites *b) {
  static const uint32_t corners[CORNERS] = {0, OLX_BLOCK_SIDE - 1, OLX_BLOCK_TEXELS - OLX_BLOCK_SIDE,
                                            OLX_BLOCK_TEXELS - 1};
  site_draft draft = {.count = 0};
  for (uint32_t c = 0; c < CORNERS; c++) weigh(j->surfels, &s->surface[corners[c]], c, &draft);
  finish_site(&draft, &b->sites[b->count++]);
}

// Returns the texel among those of a mask that is nearest to a corner of its block.
static uint32_t nearest_to(uint32_t corner, uint32_t texels) {
  const int32_t x = corner & 1u ? OLX_BLOCK_SIDE - 1 : 0, y = corner & 2u ? OLX_BLOCK_SIDE - 1 : 0;
  uint32_t best = 0;
  int32_t least = INT32_MAX;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const int32_t across = (int32_t)(i % OLX_BLOCK_SIDE) - x, down = (int32_t)(i / OLX_BLOCK_SIDE) - y,
                  squared = across * across + down * down;
    if (!(texels >> i & 1u) || squared >= least) continue;
    least = squared;
    best = i;
  }
  return best;
}

// Lights a site of some of a block's texels. Each corner has the surfels of the texel nearest to it that is not in a
// fold; with no such texel the site stays empty.
static void light_site(const site_job *j, const olx_block_surfaces *s, uint32_t texels, site *found) {
  site_draft draft = {.count = 0};
  for (uint32_t c = 0; c < CORNERS; c++) {
    for (uint32_t left = texels; left != 0;) {
      const uint32_t i = nearest_to(c, left);
      if (weigh(j->surfels, &s->surface[i], c, &draft)) break;
      left &= ~(1u << i);
    }
  }
  finish_site(&draft, found);
}

// Creates a site for every surface among the texels. Where a block has more surfaces than sites, the rest share the
// site with the nearest normal.
static void light_parts(const site_job *j, uint32_t block, const olx_block_surfaces *s, block_sites *b) {
  uint32_t first[OLX_RELIGHT_BLOCK_SITES], texels[OLX_RELIGHT_BLOCK_SITES] = {0};
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    if (!(s->seen >> i & 1u)) continue;
    uint32_t at = 0;
    while (at < b->count && !olx_block_shares(j->capture, block, s, i, first[at])) at++;
    if (at == b->count && at < OLX_RELIGHT_BLOCK_SITES) first[b->count++] = i;
    if (at < OLX_RELIGHT_BLOCK_SITES) {
      texels[at] |= 1u << i;
    } else {
      at = 0;
      for (uint32_t k = 1; k < OLX_RELIGHT_BLOCK_SITES; k++) {
        const olx_vec3 normal = s->surface[i].shading_normal;
        if (olx_dot(s->surface[first[k]].shading_normal, normal) >
            olx_dot(s->surface[first[at]].shading_normal, normal))
          at = k;
      }
    }
    b->block.which |= at << 2 * i;
  }
  for (uint32_t at = 0; at < b->count; at++) light_site(j, s, texels[at], &b->sites[at]);
}

// Gives texels in a fold, whose site has no surfels, the site with surfels whose normal is nearest.
static void light_folds(const olx_block_surfaces *s, block_sites *b) {
  uint32_t of[OLX_RELIGHT_BLOCK_SITES] = {0};
  for (uint32_t i = OLX_BLOCK_TEXELS; i-- > 0;) {
    if (s->seen >> i & 1u) of[b->block.which >> 2 * i & 3u] = i; // first texel of each site
  }
  for (uint32_t empty = 0; empty < b->count; empty++) {
    if (b->sites[empty].count > 0) continue;
    const olx_vec3 normal = s->surface[of[empty]].shading_normal;
    uint32_t best = empty;
    for (uint32_t k = 0; k < b->count; k++) {
      if (b->sites[k].count == 0) continue;
      const bool first = b->sites[best].count == 0;
      const float better = olx_dot(s->surface[of[k]].shading_normal, normal);
      if (first || better > olx_dot(s->surface[of[best]].shading_normal, normal)) best = k;
    }
    b->sites[empty] = b->sites[best];
  }
}

static void light_block(const site_job *j, uint32_t block) {
  block_sites *b = &j->blocks[block];
  olx_block_surfaces s;
  olx_block_look(j->capture, block, &s);
  b->count = 0;
  b->block = (olx_relight_block){.first_site = s.seen ? 0 : OLX_RELIGHT_NO_SITE};
  if (olx_block_is_flat(j->capture, block, &s)) light_flat(j, &s, b);
  else light_parts(j, block, &s, b);
  light_folds(&s, b);
}

static void light_row(void *user, uint32_t row) {
  const site_job *j = user;
  const uint32_t blocks = j->capture->size / OLX_BLOCK_SIDE;
  for (uint32_t x = 0; x < blocks; x++) light_block(j, row * blocks + x);
}

// Reserves room for `more` elements of an array beyond `count`.
static olx_result grow(void *array, uint32_t count, uint32_t *most, uint64_t more, size_t size_bytes) {
  void **data = array;
  if (count + more <= *most) return OLX_OK;
  const uint64_t wanted = count + more > 2 * (uint64_t)*most ? count + more : 2 * (uint64_t)*most;
  if (count + more > OLX_RELIGHT_MOST) return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: maps too large for one field");
  void *larger = olx_allocate(wanted, size_bytes);
  if (!larger) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for sites");
  if (count > 0) memcpy(larger, *data, count * size_bytes);
  olx_release(*data);
  *data = larger;
  *most = (uint32_t)wanted;
  return OLX_OK;
}

static olx_result append(olx_relight_sites *s, const block_sites *blocks, uint32_t count) {
  uint64_t sites = 0, entries = 0;
  for (uint32_t i = 0; i < count; i++) {
    sites += blocks[i].count;
    for (uint32_t k = 0; k < blocks[i].count; k++) entries += blocks[i].sites[k].count;
  }
  OLX_TRY(grow(&s->blocks, s->block_count, &s->block_most, count, sizeof *s->blocks));
  OLX_TRY(grow(&s->starts, s->site_count, &s->site_most, sites + 1, sizeof *s->starts));
  OLX_TRY(grow(&s->entries, s->entry_count, &s->entry_most, entries, sizeof *s->entries));
  for (uint32_t i = 0; i < count; i++) {
    olx_relight_block block = blocks[i].block;
    if (block.first_site != OLX_RELIGHT_NO_SITE) block.first_site = s->site_count;
    s->blocks[s->block_count++] = block;
    for (uint32_t k = 0; k < blocks[i].count; k++) {
      const site *from = &blocks[i].sites[k];
      s->starts[s->site_count++] = s->entry_count;
      for (uint32_t e = 0; e < from->count; e++) s->entries[s->entry_count++] = from->entries[e];
    }
  }
  s->starts[s->site_count] = s->entry_count;
  return OLX_OK;
}

olx_result olx_relight_sites_add(olx_relight_sites *sites, const olx_capture *capture,
                                 const olx_surfel_lookup *surfels) {
  const uint32_t rows = capture->size / OLX_BLOCK_SIDE;
  site_job j = {.capture = capture, .surfels = surfels, .blocks = olx_allocate((size_t)rows * rows, sizeof *j.blocks)};
  if (!j.blocks) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for sites");
  olx_result result = olx_bake_for(capture->context, rows, light_row, &j, 0);
  if (result == OLX_OK) result = append(sites, j.blocks, rows * rows);
  olx_release(j.blocks);
  return result;
}

// Indices of appended sites and entries continue those of the existing ones.
olx_result olx_relight_sites_append(olx_relight_sites *s, const olx_relight_sites *more) {
  OLX_TRY(grow(&s->blocks, s->block_count, &s->block_most, more->block_count, sizeof *s->blocks));
  OLX_TRY(grow(&s->starts, s->site_count, &s->site_most, more->site_count + UINT64_C(1), sizeof *s->starts));
  OLX_TRY(grow(&s->entries, s->entry_count, &s->entry_most, more->entry_count, sizeof *s->entries));
  for (uint32_t i = 0; i < more->block_count; i++) {
    olx_relight_block block = more->blocks[i];
    if (block.first_site != OLX_RELIGHT_NO_SITE) block.first_site += s->site_count;
    s->blocks[s->block_count++] = block;
  }
  for (uint32_t i = 0; i <= more->site_count; i++) s->starts[s->site_count + i] = s->entry_count + more->starts[i];
  if (more->entry_count) memcpy(s->entries + s->entry_count, more->entries, more->entry_count * sizeof *s->entries);
  s->site_count += more->site_count;
  s->entry_count += more->entry_count;
  return OLX_OK;
}

void olx_relight_sites_save(const olx_relight_sites *s, olx_byte_writer *to) {
  const uint32_t counts[] = {s->block_count, s->site_count, s->entry_count};
  olx_bytes_put(to, counts, 3, sizeof *counts);
  olx_bytes_put(to, s->blocks, s->block_count, sizeof *s->blocks);
  olx_bytes_put(to, s->starts, s->site_count + (size_t)1, sizeof *s->starts);
  olx_bytes_put(to, s->entries, s->entry_count, sizeof *s->entries);
}

olx_result olx_relight_sites_load(olx_relight_sites *s, olx_byte_reader *from) {
  uint32_t counts[3] = {0};
  olx_bytes_copy(from, counts, 3, sizeof *counts);
  *s = (olx_relight_sites){.block_count = counts[0], .site_count = counts[1], .entry_count = counts[2]};
  s->blocks = olx_bytes_take(from, s->block_count, sizeof *s->blocks);
  s->starts = olx_bytes_take(from, s->site_count + (size_t)1, sizeof *s->starts);
  s->entries = olx_bytes_take(from, s->entry_count, sizeof *s->entries);
  return from->failed ? olx_fail(OLX_ERROR_FORMAT, "relight: sites of a probe do not hold what they should") : OLX_OK;
}

void olx_relight_sites_free(olx_relight_sites *s) {
  olx_release(s->blocks);
  olx_release(s->starts);
  olx_release(s->entries);
  *s = (olx_relight_sites){0};
}
