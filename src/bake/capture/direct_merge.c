// Merges direct light over squares of texels by an analysis of variance: where the variance between texels is what the
// variance within them explains, texels differ by noise alone.
#include "bake/capture/direct_merge.h"

#include "bake/capture/texel_blocks.h"

enum {
  MOST_SIDE = 8 * OLX_BLOCK_SIDE, // most texels along the side of a square that shares its mean
  SIDES_OF_MAP = 16               // least number of squares along the side of a map of 64 x 64 texels or more
};

// Parts are merged where the variance between them is below this multiple of the one that is expected of noise. Noise
// of 16 texels with 4 samples each exceeds it once in seven times, rare samples of a distant window hardly ever.
static const double MOST_VARIANCE = 1.5;
// Parts whose standard error is below this share of their mean are left alone: half shadows matter more than such
// noise.
static const double LEAST_NOISE = 0.2;

// Texels that are merged, or may be: a part of a square, or all of it.
typedef struct merged {
  olx_vec3 mean;
  double squares, count;     // as in olx_direct_estimate
  olx_vec3 position, normal; // of its first texel
  float footprint;
} merged;

// Merges parts where they differ by noise alone; returns whether they do.
static bool merge(const merged *parts, uint32_t part_count, merged *all) {
  double within = 0.0, between = 0.0, count = 0.0;
  olx_vec3 mean = {0};
  for (uint32_t i = 0; i < part_count; i++) count += parts[i].count;
  for (uint32_t i = 0; i < part_count; i++) {
    mean = olx_madd(mean, parts[i].mean, (float)(parts[i].count / count));
    within += parts[i].squares;
  }
  for (uint32_t i = 0; i < part_count; i++) {
    const double off = (double)olx_luminance(parts[i].mean) - (double)olx_luminance(mean);
    between += parts[i].count * off * off;
  }
  if (part_count < 2 || !(count > part_count)) return false; // nothing to merge, or nothing to judge noise by
  const double expected = within / (count - part_count);
  if (between > 0.0 && !(between / (part_count - 1) < MOST_VARIANCE * expected)) return false;
  const double error = expected * part_count / count, least = LEAST_NOISE * (double)olx_luminance(mean);
  if (between > 0.0 && error < least * least) return false;
  *all = parts[0];
  all->mean = mean;
  all->squares = within + between;
  all->count = count;
  return true;
}

typedef struct merge_job {
  const olx_capture *capture;
  olx_direct_estimate *estimates;
} merge_job;

static merged part_of(const merge_job *m, uint32_t texel, const olx_surface *surface) {
  const olx_direct_estimate *e = &m->estimates[texel];
  return (merged){.mean = e->mean,
                  .squares = (double)e->squares,
                  .count = e->count,
                  .position = surface->position,
                  .normal = surface->shading_normal,
                  .footprint = 2.0f * m->capture->hits[texel].t / (float)m->capture->size};
}

// Merges those texels of a block whose bits are set.
static bool merge_texels(const merge_job *m, uint32_t block, const olx_block_surfaces *s, uint32_t texels,
                         merged *all) {
  merged parts[OLX_BLOCK_TEXELS];
  uint32_t count = 0;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    if (texels >> i & 1u) parts[count++] = part_of(m, olx_block_texel(m->capture, block, i), &s->surface[i]);
  }
  return merge(parts, count, all);
}

// Merges the texels of each surface in a block that shows several.
static void merge_surfaces(const merge_job *m, uint32_t block, const olx_block_surfaces *s) {
  for (uint32_t rest = s->seen; rest;) {
    const uint32_t first = (uint32_t)__builtin_ctz(rest);
    uint32_t group = 0;
    for (uint32_t i = first; i < OLX_BLOCK_TEXELS; i++) {
      if (rest >> i & 1u && olx_block_shares(m->capture, block, s, first, i)) group |= 1u << i;
    }
    group |= 1u << first;
    rest &= ~group;
    merged all;
    if (!merge_texels(m, block, s, group, &all)) continue;
    for (uint32_t i = first; i < OLX_BLOCK_TEXELS; i++) {
      if (group >> i & 1u) m->estimates[olx_block_texel(m->capture, block, i)].mean = all.mean;
    }
  }
}

// Merges the texels of a block. Returns whether they lie on one plane and share one mean now.
static bool merge_block(const merge_job *m, uint32_t x, uint32_t y, merged *all) {
  const olx_capture *c = m->capture;
  const uint32_t block = y / OLX_BLOCK_SIDE * (c->size / OLX_BLOCK_SIDE) + x / OLX_BLOCK_SIDE;
  olx_block_surfaces surfaces;
  olx_block_look(c, block, &surfaces);
  if (olx_block_is_flat(c, block, &surfaces)) return merge_texels(m, block, &surfaces, surfaces.seen, all);
  merge_surfaces(m, block, &surfaces);
  return false;
}

// Gives the texels of a square its mean.
static void share(const merge_job *m, uint32_t x, uint32_t y, uint32_t side, olx_vec3 mean) {
  for (uint32_t v = y; v < y + side; v++) {
    for (uint32_t u = x; u < x + side; u++) m->estimates[(size_t)v * m->capture->size + u].mean = mean;
  }
}

static bool lie_on_one_plane(const merged *a, const merged *b) {
  const olx_vec3 step = olx_sub(b->position, a->position);
  return fabsf(olx_dot(step, a->normal)) <= OLX_FLAT_FOOTPRINTS * a->footprint &&
         olx_dot(b->normal, a->normal) >= OLX_FLAT_COSINE;
}

// Merges the quarters of a square that are `whole`, as far as they lie on the plane of the first of them. Returns which
// were merged, one bit each; 0 when light differs between them.
static uint32_t merge_quarters(const merged quarters[4], uint32_t whole, merged *all) {
  const merged *first = whole ? &quarters[__builtin_ctz(whole)] : NULL;
  merged parts[4];
  uint32_t count = 0, which = 0;
  for (uint32_t i = 0; i < 4; i++) {
    if (!(whole >> i & 1u) || !lie_on_one_plane(first, &quarters[i])) continue;
    parts[count++] = quarters[i];
    which |= 1u << i;
  }
  return count > 1 && merge(parts, count, all) ? which : 0;
}

// Merges a square of texels that begins at (x, y), as far as it lies in the map. Returns false where that is not
// possible as a whole; by then its parts have shared their means, as far as they could be merged.
static bool merge_square(const merge_job *m, uint32_t x, uint32_t y, uint32_t side, merged *all) {
  if (x >= m->capture->size || y >= m->capture->size) return false;
  if (side == OLX_BLOCK_SIDE) return merge_block(m, x, y, all);
  const uint32_t half = side / 2;
  merged quarters[4];
  uint32_t whole = 0;
  for (uint32_t i = 0; i < 4; i++) {
    if (merge_square(m, x + i % 2 * half, y + i / 2 * half, half, &quarters[i])) whole |= 1u << i;
  }
  const uint32_t merged_ones = merge_quarters(quarters, whole, all);
  if (merged_ones == 15) return true;
  for (uint32_t i = 0; i < 4; i++) {
    if (!(whole >> i & 1u)) continue;
    const olx_vec3 mean = merged_ones >> i & 1u ? all->mean : quarters[i].mean;
    share(m, x + i % 2 * half, y + i / 2 * half, half, mean);
  }
  return false;
}

// Returns the number of texels along the side of the largest squares of a map.
static uint32_t side_of(uint32_t size) {
  uint32_t side = OLX_BLOCK_SIDE;
  while (side < MOST_SIDE && 2 * side * SIDES_OF_MAP <= size) side *= 2;
  return side;
}

static void merge_rows(void *user, uint32_t band) {
  const merge_job *m = user;
  const uint32_t side = side_of(m->capture->size);
  for (uint32_t x = 0; x < m->capture->size; x += side) {
    merged all;
    if (merge_square(m, x, band * side, side, &all)) share(m, x, band * side, side, all.mean);
  }
}

olx_result olx_direct_merge(const olx_capture *capture, olx_direct_estimate *estimates) {
  merge_job m = {capture, estimates};
  const uint32_t side = side_of(capture->size);
  return olx_bake_for(capture->context, (capture->size + side - 1) / side, merge_rows, &m, 0);
}
