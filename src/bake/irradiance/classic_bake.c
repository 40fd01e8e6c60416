// Bakes the classic maps of one irradiance probe: renders a cube map around the probe, filters it, and fits the box for
// parallax correction. "Classic" maps are prefiltered radiance and irradiance without visibility, the baseline.
#include "bake/irradiance/classic_bake.h"

#include "core/hooks.h"
#include "core/morton.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/texel_samples.h"

#include <string.h>

enum {
  TILE_SIDE = 32,   // cube texels along the side of a tile, which is one batch
  LIGHT_BLOCK = 16, // texels across which light samples are stratified
  SALT_BLOCK = 0x434C4153,
  SALT_SCATTER = 0x43534341
};

enum { NO_SIDE = 6 };

// Distance that represents the sky, along the axis of its cube face.
static const float far_away = 1e30f;

static uint32_t cube_texel(const olx_classic_bake *b, uint32_t tile, uint32_t i) {
  const uint32_t n = b->filter.cube_size, tiles = n / TILE_SIDE, face = tile / (tiles * tiles);
  const uint32_t x = tile % tiles * TILE_SIDE + olx_morton_coordinate(i);
  const uint32_t y = tile / tiles % tiles * TILE_SIDE + olx_morton_coordinate(i >> 1);
  return (face * n + y) * n + x;
}

static void cast_tile(const olx_classic_bake *b, olx_shade_scratch *scratch, uint32_t tile) {
  const uint32_t n = b->filter.cube_size;
  const float step = 2.0f / (float)n;
  const olx_vec2 offset = olx_texel_sample_offset();
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    const uint32_t texel = cube_texel(b, tile, i);
    const olx_cube_face face = olx_cube_face_of(texel / (n * n));
    const float u = ((float)(texel % n) + offset.x) * step - 1.0f,
                v = ((float)(texel / n % n) + offset.y) * step - 1.0f;
    scratch->directions[i] = olx_normalize(olx_cube_direction(&face, u, v));
    scratch->rays[i] = (olx_ray){b->position, scratch->directions[i], 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(b->shade->scene->light_bvh, scratch->rays, OLX_BATCH_POINTS, true, scratch->hits);
  atomic_fetch_add_explicit(&b->shade->rays, OLX_BATCH_POINTS, memory_order_relaxed);
}

// Draws rays through both lobes. A ray of the diffuse lobe samples lights only where it can hit one.
static uint32_t choose_paths(const olx_classic_bake *b, olx_shade_scratch *scratch) {
  olx_shade_batch *roots = &scratch->roots;
  uint32_t paths = 0;
  for (uint32_t k = 0; k < roots->count; k++) {
    olx_shade_path path = {.root = k, .from = k, .throughput = olx_splat(1.0f)};
    if (roots->reflects[k]) scratch->paths[0][paths++] = path;
    if (olx_max3(roots->diffuse[k]) <= 0.0f) continue;
    const float share = roots->scattered[k] = olx_shade_scattering(b->shade, &roots->surface[k]);
    if (share <= 0.0f) continue;
    if (share < 1.0f && olx_unit_float(olx_hash3(roots->seed[k], roots->sequence[k], SALT_SCATTER)) >= share) continue;
    path.diffuse = true;
    path.throughput = olx_splat(1.0f / share);
    scratch->paths[0][paths++] = path;
  }
  return paths;
}

// Lights a tile by the same method as light field probes, so that the methods differ only in how they use the light.
// Emission is left out, because direct lighting samples it.
static void light_tile(const olx_classic_bake *b, olx_shade_scratch *scratch, uint32_t tile) {
  olx_shade_batch *roots = &scratch->roots;
  olx_shade_batch_begin(roots, b->context->settings->light_samples);
  roots->sparing = true;
  roots->averages_lobes = true;
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    if (scratch->hits[i].triangle == OLX_NO_HIT) continue;
    const uint32_t seed = olx_hash3(b->probe, cube_texel(b, tile, i - i % LIGHT_BLOCK), SALT_BLOCK);
    const uint32_t root =
        olx_shade_append(b->shade, roots, &scratch->hits[i], scratch->directions[i], seed, i % LIGHT_BLOCK);
    scratch->slot[root] = i;
  }
  const uint32_t paths = choose_paths(b, scratch);
  olx_shade_direct(b->shade, scratch, roots);
  if (b->bounces > 0) olx_shade_diffuse(b->shade, roots, b->bounces - 1);
  olx_shade_reflections(b->shade, scratch, paths, b->bounces, OLX_REFLECT_LIGHTS | OLX_REFLECT_BOUNCES);
}

// Records which side of a box around the probe the surface could belong to, if it faces along an axis.
static void note_side(const olx_classic_bake *b, uint32_t texel, const olx_surface *surface) {
  const float normal[3] = {surface->geometric_normal.x, surface->geometric_normal.y, surface->geometric_normal.z};
  b->place[texel] = olx_sub(surface->position, b->shade->scene->bounds_min);
  for (uint32_t axis = 0; axis < 3; axis++) {
    // At most one coordinate of a unit vector exceeds this bound, up to rounding.
    if (fabsf(normal[axis]) >= 0.7f) b->side[texel] = (uint8_t)(2 * axis + (normal[axis] < 0.0f));
  }
}

static void cube_job(void *user, uint32_t tile) {
  const olx_classic_bake *b = user;
  olx_shade_scratch *scratch = olx_shade_scratch_take(b->shade);
  if (!scratch) return;
  cast_tile(b, scratch, tile);
  light_tile(b, scratch, tile);
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    const uint32_t texel = cube_texel(b, tile, i);
    b->filter.cube[texel] = olx_splat(0.0f);
    b->side[texel] = NO_SIDE;
    b->place[texel] = olx_scale(olx_cube_face_of(texel / (b->filter.cube_size * b->filter.cube_size)).axis, far_away);
  }
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const uint32_t texel = cube_texel(b, tile, scratch->slot[k]);
    b->filter.cube[texel] = scratch->roots.radiance[k];
    note_side(b, texel, &scratch->roots.surface[k]);
  }
  olx_shade_scratch_give(b->shade, scratch);
}

// A side that covers less than this share of the sphere is ignored.
static const float least_share = 0.01f;
// Share of the surfaces of a side that may lie farther out than the side; twice this share of all that is seen may lie
// beyond it, as in a view through a door.
static const float share_outside = 0.1f;

enum { BINS = 4096 };

// Returns the solid angle of everything that is seen beyond a side at `place`.
static float seen_beyond(const olx_classic_bake *b, uint32_t side, float place, float tolerance) {
  const uint32_t face = b->filter.cube_size * b->filter.cube_size;
  float sum = 0.0f;
  for (uint32_t texel = 0; texel < OLX_CUBE_FACES * face; texel++) {
    const float at = olx_component(b->place[texel], side / 2), beyond = side & 1u ? at - place : place - at;
    if (beyond > tolerance) sum += b->filter.face_solid_angle[texel % face];
  }
  return sum;
}

// Finds the distance of the outer surfaces that could belong to side `side`. The outer ones count rather than most of
// them, because objects in a room hide its walls. Returns false when too much is seen beyond the side for it to enclose
// the room.
static bool outer_side(const olx_classic_bake *b, uint32_t side, float extent, float *place) {
  const uint32_t face = b->filter.cube_size * b->filter.cube_size;
  float weight[BINS] = {0}, moment[BINS] = {0}, total = 0.0f;
  for (uint32_t texel = 0; texel < OLX_CUBE_FACES * face; texel++) {
    if (b->side[texel] != side) continue;
    const float share = b->filter.face_solid_angle[texel % face], at = olx_component(b->place[texel], side / 2);
    const uint32_t bin = (uint32_t)olx_clamp(at / extent * BINS, 0.0f, BINS - 1);
    weight[bin] += share;
    moment[bin] += share * at;
    total += share;
  }
  if (total < least_share * 4.0f * OLX_PI) return false;
  const bool high = side & 1u;
  float sum = 0.0f;
  uint32_t bin = high ? BINS - 1 : 0;
  // Searches from the outermost bin inwards; the bin that is found is not empty, because the sum grew there.
  while (sum + weight[bin] < share_outside * total) {
    sum += weight[bin];
    bin = high ? bin - 1 : bin + 1;
  }
  const float found = moment[bin] / weight[bin];
  if (seen_beyond(b, side, found, 2.0f * extent / BINS) > 2.0f * share_outside * total) return false;
  *place = found;
  return true;
}

static olx_classic_box find_box(const olx_classic_bake *b) {
  const olx_scene *scene = b->shade->scene;
  const olx_vec3 size = olx_sub(scene->bounds_max, scene->bounds_min);
  const float extent[3] = {size.x, size.y, size.z};
  float low[3] = {0.0f, 0.0f, 0.0f}, high[3] = {extent[0], extent[1], extent[2]};
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (extent[axis] <= 0.0f) continue;
    outer_side(b, 2 * axis, extent[axis], &low[axis]);
    outer_side(b, 2 * axis + 1, extent[axis], &high[axis]);
  }
  return (olx_classic_box){
      olx_min_each(olx_add(scene->bounds_min, olx_v3(low[0], low[1], low[2])), b->position),
      olx_max_each(olx_add(scene->bounds_min, olx_v3(high[0], high[1], high[2])), b->position),
  };
}

static void pack_map(const olx_vec3 *map, uint32_t side, uint32_t *packed) {
  for (uint32_t i = 0; i < side * side; i++) packed[i] = olx_r11g11b10f_pack(map[i]);
}

static uint32_t tile_count(const olx_classic_bake *b) {
  const uint32_t tiles = b->filter.cube_size / TILE_SIDE;
  return OLX_CUBE_FACES * tiles * tiles;
}

uint64_t olx_classic_bake_units(const olx_classic_bake *b) { return (uint64_t)tile_count(b) * OLX_BATCH_POINTS; }

olx_result olx_classic_bake_probe(olx_classic_bake *b, uint32_t probe, olx_vec3 position, olx_classic_record *record) {
  b->probe = probe;
  b->position = position;
  OLX_TRY(olx_bake_for(b->context, tile_count(b), cube_job, b, OLX_BATCH_POINTS));
  OLX_TRY(olx_shade_check_memory(b->shade));
  OLX_TRY(olx_classic_filter_run(&b->filter, &b->context->task));
  const uint32_t size = b->filter.size;
  pack_map(b->filter.irradiance, size, b->packed_irradiance);
  *record = (olx_classic_record){.irradiance = b->packed_irradiance, .box = find_box(b)};
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    pack_map(b->filter.levels[level], olx_classic_side(size, level), b->packed_levels[level]);
    record->radiance[level] = b->packed_levels[level];
  }
  return OLX_OK;
}

uint64_t olx_classic_bake_bytes(const olx_classic_bake *b) {
  const uint64_t face = (uint64_t)b->filter.cube_size * b->filter.cube_size;
  return OLX_CUBE_FACES * face * (sizeof *b->filter.cube + sizeof *b->side + sizeof *b->place) +
         face * (sizeof *b->filter.face_direction + sizeof *b->filter.face_solid_angle);
}

olx_result olx_classic_bake_create(olx_classic_bake *b) {
  const size_t texels = OLX_CUBE_FACES * (size_t)b->filter.cube_size * b->filter.cube_size, size = b->filter.size;
  OLX_TRY(olx_classic_filter_create(&b->filter));
  b->side = olx_allocate(texels, sizeof *b->side);
  b->place = olx_allocate(texels, sizeof *b->place);
  b->packed_irradiance = olx_allocate(size * size, sizeof(uint32_t));
  bool complete = b->side && b->place && b->packed_irradiance;
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    const size_t side = olx_classic_side(b->filter.size, level);
    b->packed_levels[level] = olx_allocate(side * side, sizeof(uint32_t));
    complete = complete && b->packed_levels[level];
  }
  if (complete) return OLX_OK;
  olx_classic_bake_free(b);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for classic maps of %zu texels", size);
}

void olx_classic_bake_free(olx_classic_bake *b) {
  olx_classic_filter_free(&b->filter);
  olx_release(b->side);
  olx_release(b->place);
  olx_release(b->packed_irradiance);
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) olx_release(b->packed_levels[level]);
  *b = (olx_classic_bake){0};
}
