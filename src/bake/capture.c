#include "bake/capture.h"

#include "bake/morton.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"

enum { SALT_TEXEL = 0x54455845, SALT_CHOICE = 0x43484F49, SALT_SCATTER = 0x53434154 };

// Above this reflectance towards the probe every sample of a texel casts a reflection; below it one does for all, and below
// the next one in one texel of two.
static const float strong_reflectance = 0.25f, weak_reflectance = 0.1f;

static uint32_t texel_index(const olx_capture *c, uint32_t tile, uint32_t i) {
  const uint32_t tiles = c->size / c->tile_side;
  const uint32_t x = tile % tiles * c->tile_side + olx_morton_coordinate(i);
  const uint32_t y = tile / tiles * c->tile_side + olx_morton_coordinate(i >> 1);
  return y * c->size + x;
}

static void cast(const olx_capture *c, olx_shade_scratch *scratch, uint32_t count) {
  olx_bvh_intersect_many(c->shade->scene->bvh, scratch->rays, count, true, scratch->hits);
  atomic_fetch_add_explicit(&c->shade->rays, count, memory_order_relaxed);
}

// The normal of a triangle on the side that a ray comes from.
static olx_vec3 facing_normal(const olx_scene *scene, uint32_t triangle, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], p = scene->positions[corner[2]];
  const olx_vec3 n = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(p, a)));
  return olx_dot(n, direction) > 0.0f ? olx_negate(n) : n;
}

static bool emits_towards(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction) {
  if (olx_max3(scene->materials[scene->material_index[hit->triangle]].emission) <= 0.0f) return false;
  return olx_max3(olx_surface_at(scene, hit, direction).emission) > 0.0f;
}

// Distance, normal and emitter mark, by a ray through each texel's centre.
static void capture_geometry(const olx_capture *c, olx_shade_scratch *scratch, uint32_t tile) {
  const olx_scene *scene = c->shade->scene;
  const uint32_t texels = c->tile_side * c->tile_side;
  for (uint32_t i = 0; i < texels; i++) {
    const uint32_t texel = texel_index(c, tile, i);
    const olx_vec3 direction = olx_texel_direction(texel % c->size, texel / c->size, c->size);
    scratch->rays[i] = (olx_ray){c->position, direction, 0.0f, INFINITY};
  }
  cast(c, scratch, texels);
  uint32_t last_triangle = OLX_NO_HIT;
  uint16_t last_normal = 0;
  for (uint32_t i = 0; i < texels; i++) {
    const uint32_t texel = texel_index(c, tile, i);
    const olx_ray_hit *hit = &scratch->hits[i];
    const olx_vec3 direction = scratch->rays[i].direction;
    if (hit->triangle == OLX_NO_HIT) {
      c->distance[texel] = olx_half_pack(INFINITY);
      c->normal[texel] = olx_normal_pack(olx_negate(direction));
      continue;
    }
    // A probe sees one side of a triangle.
    if (hit->triangle != last_triangle) last_normal = olx_normal_pack(facing_normal(scene, hit->triangle, direction));
    last_triangle = hit->triangle;
    c->normal[texel] = last_normal;
    const uint16_t mark = emits_towards(scene, hit, direction) ? 0x8000u : 0;
    c->distance[texel] = (uint16_t)(olx_half_pack(hit->t / c->distance_scale) | mark);
  }
}

// Off the middle, because from a probe that stands symmetrically in a room the middles' rays would meet edges of walls
// exactly, where neither wall is certain.
static const olx_vec2 sample_offset = {0.5078125f, 0.48828125f};

// Rays through the middles of samples^2 parts of each texel, and the parts' shares of solid angle.
static uint32_t make_sample_rays(const olx_capture *c, olx_shade_scratch *scratch, uint32_t tile) {
  const uint32_t texels = c->tile_side * c->tile_side, side = c->samples;
  const float step = 1.0f / (float)(c->size * side);
  uint32_t count = 0;
  for (uint32_t i = 0; i < texels; i++) {
    const uint32_t texel = texel_index(c, tile, i), x = texel % c->size * side, y = texel / c->size * side;
    for (uint32_t sy = 0; sy < side; sy++) {
      for (uint32_t sx = 0; sx < side; sx++, count++) {
        const olx_vec3 q = olx_octahedral_point(
            (olx_vec2){((float)(x + sx) + sample_offset.x) * step, ((float)(y + sy) + sample_offset.y) * step});
        const float inverse = 1.0f / olx_length(q);
        scratch->weights[count] = inverse * inverse * inverse;
        scratch->rays[count] = (olx_ray){c->position, olx_scale(q, inverse), 0.0f, INFINITY};
      }
    }
  }
  return count;
}

// Chooses which of a texel's points [first, end) of the batch cast reflections; returns the count of paths.
static uint32_t choose_reflections(olx_shade_scratch *scratch, uint32_t first, uint32_t end, uint32_t paths) {
  const olx_shade_batch *roots = &scratch->roots;
  uint32_t specular = 0;
  float strongest = 0.0f;
  for (uint32_t k = first; k < end; k++) {
    const olx_bsdf *b = &roots->surface[k].bsdf;
    if (!roots->reflects[k]) continue;
    specular++;
    strongest = olx_max(strongest, olx_max3(olx_fresnel(b, olx_dot(roots->surface[k].shading_normal, roots->view[k]))));
  }
  if (specular == 0) return paths;
  const bool all = strongest > strong_reflectance;
  const uint32_t hash = olx_hash2(roots->seed[first], SALT_CHOICE);
  const bool weak = strongest < weak_reflectance;
  if (weak && hash >> 31) return paths;
  uint32_t chosen = hash % specular;
  for (uint32_t k = first; k < end; k++) {
    if (!roots->reflects[k]) continue;
    if (!all && chosen-- != 0) continue;
    const float weight = all ? 1.0f : weak ? 2.0f * (float)specular : (float)specular;
    scratch->paths[0][paths++] = (olx_shade_path){.root = k, .from = k, .throughput = olx_splat(weight)};
  }
  return paths;
}

// One ray a texel through the diffuse lobe, where it can find a light.
static uint32_t choose_scattering(olx_shade_scratch *scratch, uint32_t first, uint32_t end, uint32_t paths) {
  if (!scratch->roots.shares_diffuse || first == end) return paths;
  const uint32_t chosen = first + olx_hash2(scratch->roots.seed[first], SALT_SCATTER) % (end - first);
  if (olx_max3(scratch->roots.diffuse[chosen]) <= 0.0f) return paths;
  scratch->paths[0][paths] =
      (olx_shade_path){.root = chosen, .from = chosen, .diffuse = true, .throughput = olx_splat((float)(end - first))};
  return paths + 1;
}

// Irradiance looked up at every fourth texel of a tile, between which the others interpolate.
enum { LATTICE_STEP = 4, LATTICE_MOST = 32 / LATTICE_STEP + 1 };
#define NO_POINT UINT32_MAX

typedef struct lattice {
  uint32_t side; // look-ups along a side
  uint32_t point[LATTICE_MOST * LATTICE_MOST];
  bool known[LATTICE_MOST * LATTICE_MOST];
  olx_vec3 irradiance[LATTICE_MOST * LATTICE_MOST];
} lattice;

static uint32_t lattice_texel(uint32_t i, uint32_t tile_side) {
  return i * LATTICE_STEP < tile_side ? i * LATTICE_STEP : tile_side - 1;
}

static void lattice_begin(const olx_capture *c, const olx_shade_scratch *scratch, uint32_t per_texel, lattice *l) {
  uint32_t first_point[OLX_BATCH_POINTS]; // of each texel, in rows
  l->side = c->tile_side / LATTICE_STEP + 1;
  for (uint32_t i = 0; i < c->tile_side * c->tile_side; i++) first_point[i] = NO_POINT;
  for (uint32_t k = scratch->roots.count; k-- > 0;) {
    const uint32_t i = scratch->slot[k] / per_texel;
    first_point[olx_morton_coordinate(i >> 1) * c->tile_side + olx_morton_coordinate(i)] = k;
  }
  for (uint32_t i = 0; i < l->side * l->side; i++) {
    const uint32_t x = lattice_texel(i % l->side, c->tile_side), y = lattice_texel(i / l->side, c->tile_side);
    l->point[i] = first_point[y * c->tile_side + x];
    l->known[i] = false;
  }
}

// Whether irradiance changes little, and smoothly, between two points.
static bool much_alike(const olx_surface *a, const olx_surface *b, float distance) {
  const olx_vec3 step = olx_sub(a->position, b->position);
  return olx_dot(step, step) < olx_square(distance) && olx_dot(a->shading_normal, b->shading_normal) > 0.995f;
}

// Interpolates irradiance at point `k` of texel (x, y) of the tile; false when too little around it is alike.
static bool interpolate(const olx_capture *c, const olx_shade_scratch *scratch, lattice *l, uint32_t k, uint32_t x,
                        uint32_t y, olx_vec3 *irradiance) {
  const olx_shade_batch *roots = &scratch->roots;
  const uint32_t i = x / LATTICE_STEP, j = y / LATTICE_STEP;
  const uint32_t x0 = i * LATTICE_STEP, x1 = lattice_texel(i + 1, c->tile_side);
  const uint32_t y0 = j * LATTICE_STEP, y1 = lattice_texel(j + 1, c->tile_side);
  const float fx = x1 > x0 ? (float)(x - x0) / (float)(x1 - x0) : 0.0f,
              fy = y1 > y0 ? (float)(y - y0) / (float)(y1 - y0) : 0.0f;
  olx_vec3 sum = {0};
  float weights = 0.0f;
  for (uint32_t corner = 0; corner < 4; corner++) {
    const float weight = (corner & 1 ? fx : 1.0f - fx) * (corner & 2 ? fy : 1.0f - fy);
    const uint32_t at = (j + (corner >> 1)) * l->side + i + (corner & 1);
    if (weight <= 0.0f || l->point[at] == NO_POINT) continue;
    if (!much_alike(&roots->surface[k], &roots->surface[l->point[at]], c->shade->lattice_distance)) continue;
    if (!l->known[at]) {
      l->irradiance[at] = olx_shade_irradiance(c->shade, roots, l->point[at], c->bounces - 1);
      l->known[at] = true;
    }
    sum = olx_madd(sum, l->irradiance[at], weight);
    weights += weight;
  }
  if (weights < 0.5f) return false;
  *irradiance = olx_scale(sum, 1.0f / weights);
  return true;
}

// The diffuse reflection of the last bounce. Neighbours on one smooth surface interpolate between few look-ups.
static void add_diffuse(const olx_capture *c, olx_shade_scratch *scratch, uint32_t per_texel) {
  olx_shade_batch *roots = &scratch->roots;
  if (c->tile_side < 2 * LATTICE_STEP) {
    olx_shade_diffuse(c->shade, roots, c->bounces - 1);
    return;
  }
  lattice l;
  lattice_begin(c, scratch, per_texel, &l);
  uint32_t last = NO_POINT; // that was looked up off the lattice
  olx_vec3 last_irradiance = {0};
  for (uint32_t k = 0; k < roots->count; k++) {
    if (olx_max3(roots->diffuse[k]) <= 0.0f) continue;
    const uint32_t i = scratch->slot[k] / per_texel;
    olx_vec3 irradiance;
    if (!interpolate(c, scratch, &l, k, olx_morton_coordinate(i), olx_morton_coordinate(i >> 1), &irradiance)) {
      if (last == NO_POINT || !much_alike(&roots->surface[k], &roots->surface[last], c->shade->share_distance)) {
        last_irradiance = olx_shade_irradiance(c->shade, roots, k, c->bounces - 1);
        last = k;
      }
      irradiance = last_irradiance;
    }
    roots->radiance[k] = olx_add(roots->radiance[k], olx_mul(roots->diffuse[k], irradiance));
  }
}

static void light_samples(const olx_capture *c, olx_shade_scratch *scratch, uint32_t tile, uint32_t count) {
  const uint32_t per_texel = c->samples * c->samples;
  uint32_t paths = 0;
  olx_shade_batch_begin(&scratch->roots, c->light_samples);
  scratch->roots.per_texel = per_texel;
  scratch->roots.averages_lobes = true;
  scratch->roots.shares_diffuse = c->shade->reflected_lights;
  for (uint32_t i = 0; i < count; i += per_texel) {
    const uint32_t seed = olx_hash3(c->probe, texel_index(c, tile, i / per_texel), SALT_TEXEL);
    const uint32_t first = scratch->roots.count;
    for (uint32_t k = i; k < i + per_texel; k++) {
      const olx_vec3 direction = scratch->rays[k].direction;
      if (scratch->hits[k].triangle == OLX_NO_HIT) {
        scratch->colors[k] = scratch->emission[k] = olx_environment_radiance(c->shade->scene, direction);
        scratch->emits[k] = true;
        continue;
      }
      scratch->slot[olx_shade_append(c->shade, &scratch->roots, &scratch->hits[k], direction, seed, k - i)] = k;
    }
    paths = choose_reflections(scratch, first, scratch->roots.count, paths);
    paths = choose_scattering(scratch, first, scratch->roots.count, paths);
  }
  olx_shade_direct(c->shade, scratch, &scratch->roots);
  if (c->bounces > 0) add_diffuse(c, scratch, per_texel);
  olx_shade_reflections(c->shade, scratch, paths, c->bounces, OLX_REFLECT_LIGHTS | OLX_REFLECT_BOUNCES);
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const olx_vec3 emission = scratch->roots.surface[k].emission;
    scratch->emission[scratch->slot[k]] = emission;
    scratch->emits[scratch->slot[k]] = olx_max3(emission) > 0.0f;
    scratch->colors[scratch->slot[k]] = olx_add(emission, scratch->roots.radiance[k]);
  }
}

static bool sees_emitter(uint16_t distance) { return (distance & 0x8000u) != 0 || distance == olx_half_pack(INFINITY); }

// The mean of the samples that are what the texel's middle is: emitter and sky, or surface. Readers leave out emission by the
// texel, so a surface beside a lamp must not hold a share of it.
static olx_vec3 filter_texel(const olx_shade_scratch *scratch, uint32_t first, uint32_t end, bool emits) {
  olx_vec3 like = {0}, all = {0};
  float like_weight = 0.0f, all_weight = 0.0f;
  for (uint32_t k = first; k < end; k++) {
    const float weight = scratch->weights[k];
    all = olx_madd(all, olx_sub(scratch->colors[k], emits ? olx_splat(0.0f) : scratch->emission[k]), weight);
    all_weight += weight;
    if (emits != scratch->emits[k]) continue;
    like = olx_madd(like, scratch->colors[k], weight);
    like_weight += weight;
  }
  return like_weight > 0.0f ? olx_scale(like, 1.0f / like_weight) : olx_scale(all, 1.0f / all_weight);
}

static void capture_radiance(const olx_capture *c, olx_shade_scratch *scratch, uint32_t tile) {
  const uint32_t per_texel = c->samples * c->samples, count = make_sample_rays(c, scratch, tile);
  cast(c, scratch, count);
  light_samples(c, scratch, tile, count);
  for (uint32_t i = 0; i < count; i += per_texel) {
    const uint32_t texel = texel_index(c, tile, i / per_texel);
    c->radiance[texel] = olx_r11g11b10f_pack(filter_texel(scratch, i, i + per_texel, sees_emitter(c->distance[texel])));
  }
}

static void capture_job(void *user, uint32_t tile) {
  const olx_capture *c = user;
  olx_shade_scratch *scratch = olx_shade_scratch_take(c->shade);
  if (!scratch) return;
  capture_geometry(c, scratch, tile);
  capture_radiance(c, scratch, tile);
  olx_shade_scratch_give(c->shade, scratch);
}

static uint32_t tile_count(const olx_capture *c) {
  const uint32_t tiles = c->size / c->tile_side;
  return tiles * tiles;
}

static olx_result run_tiles(olx_capture *c, olx_job job, olx_task *task, uint64_t units) {
  OLX_TRY(olx_parallel_for(tile_count(c), c->threads, job, c, task, units));
  if (!atomic_load(&c->shade->out_of_memory)) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the work of a thread");
}

olx_result olx_capture_probe(olx_capture *c, uint32_t probe, olx_vec3 position) {
  c->probe = probe;
  c->position = position;
  return run_tiles(c, capture_job, c->task, olx_capture_units(c) / tile_count(c));
}

static void measure_job(void *user, uint32_t tile) {
  const olx_capture *c = user;
  olx_shade_scratch *scratch = olx_shade_scratch_take(c->shade);
  if (!scratch) return;
  const uint32_t count = make_sample_rays(c, scratch, tile);
  const double start = olx_seconds();
  olx_bvh_intersect_many(c->shade->scene->bvh, scratch->rays, count, true, scratch->hits);
  c->tile_seconds[tile] = olx_seconds() - start;
  olx_shade_scratch_give(c->shade, scratch);
}

olx_result olx_capture_measure(olx_capture *c, double *embree_seconds) {
  OLX_TRY(run_tiles(c, measure_job, c->task, 0));
  const uint32_t tiles = tile_count(c), wanted = c->threads ? c->threads : olx_processor_count();
  double sum = 0.0;
  for (uint32_t i = 0; i < tiles; i++) sum += c->tile_seconds[i];
  *embree_seconds += sum / (wanted < tiles ? wanted : tiles);
  return OLX_OK;
}

olx_result olx_capture_create(olx_capture *c) {
  const size_t texels = (size_t)c->size * c->size;
  c->tile_side = 32;
  while (c->tile_side > c->size || c->tile_side * c->tile_side * c->samples * c->samples > OLX_BATCH_POINTS)
    c->tile_side /= 2;
  c->radiance = olx_allocate(texels, sizeof *c->radiance);
  c->normal = olx_allocate(texels, sizeof *c->normal);
  c->distance = olx_allocate(texels, sizeof *c->distance);
  c->tile_seconds = olx_allocate(tile_count(c), sizeof *c->tile_seconds);
  if (c->radiance && c->normal && c->distance && c->tile_seconds) return OLX_OK;
  olx_capture_free(c);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for maps of %u x %u texels", c->size, c->size);
}

void olx_capture_free(olx_capture *c) {
  olx_release(c->radiance);
  olx_release(c->normal);
  olx_release(c->distance);
  olx_release(c->tile_seconds);
  c->radiance = NULL;
  c->normal = c->distance = NULL;
  c->tile_seconds = NULL;
}

uint64_t olx_capture_units(const olx_capture *c) { return (uint64_t)c->size * c->size * c->samples * c->samples; }
