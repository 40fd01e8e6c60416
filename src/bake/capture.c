#include "bake/capture.h"

#include "bake/morton.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"

enum { SALT_TEXEL = 0x54455845, SALT_CHOICE = 0x43484F49, SALT_SCATTER = 0x53434154 };

// Above the first reflectance towards the probe every sample of a texel casts a reflection. Below the second, four texels
// share one.
static const float strong_reflectance = 0.25f, weak_reflectance = 0.1f;

// Texels that share shadow rays, those that share a reflection, and those over which samples of lights are stratified: consecutive in Morton order.
enum { SHADOW_BLOCK = 2, REFLECTION_BLOCK = 4, LIGHT_BLOCK = 16 };
#define NO_POINT UINT32_MAX

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
    c->hits[texel] = *hit;
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

static float reflectance(const olx_shade_batch *batch, uint32_t k) {
  const olx_surface *s = &batch->surface[k];
  if (!batch->reflects[k]) return 0.0f;
  return olx_max3(olx_fresnel(&s->bsdf, olx_dot(s->shading_normal, batch->view[k])));
}

// Whether the surfaces differ in the colour of their diffuse lobe at most, and lie in one plane but for a little.
static bool same_surface(const olx_surface *a, const olx_surface *b, float distance) {
  if (a->material != b->material || olx_dot(a->shading_normal, b->shading_normal) < 0.99f) return false;
  const olx_vec3 step = olx_sub(a->position, b->position);
  return fabsf(olx_dot(step, a->geometric_normal)) < distance && fabsf(a->roughness - b->roughness) < 0.05f;
}

static bool can_be_shared(const olx_shade_batch *batch, uint32_t k) {
  return olx_max3(batch->surface[k].emission) <= 0.0f && reflectance(batch, k) <= strong_reflectance;
}

// Whether the hit lies on the surface of point `r` but for its colour. Edges within the plane's tolerance do not count: the
// point was drawn among the samples.
static bool on_surface_of(const olx_capture *c, const olx_shade_scratch *scratch, uint32_t r, uint32_t k) {
  const olx_surface *s = &scratch->roots.surface[r];
  const olx_ray_hit *hit = &scratch->hits[k];
  if (s->triangle == hit->triangle) return true;
  if (c->shade->scene->material_index[hit->triangle] != s->material) return false;
  const olx_vec3 position = olx_madd(c->position, scratch->rays[k].direction, hit->t);
  return fabsf(olx_dot(olx_sub(position, s->position), s->geometric_normal)) < c->shade->share_distance;
}

// The point among [first, count) that lights a texel's sample `k`, appended when none can.
static uint32_t point_of_sample(const olx_capture *c, olx_shade_scratch *scratch, uint32_t first, uint32_t k,
                                uint32_t seed, uint32_t place, float *members) {
  olx_shade_batch *roots = &scratch->roots;
  const olx_ray_hit *hit = &scratch->hits[k];
  for (uint32_t r = first; r < roots->count; r++) {
    olx_vec3 albedo;
    if (!on_surface_of(c, scratch, r, k) || !can_be_shared(roots, r)) continue;
    if (!olx_surface_albedo(c->shade->scene, hit, &roots->surface[r], &albedo)) continue;
    members[r - first] += 1.0f;
    roots->surface[r].bsdf.albedo = olx_mix3(roots->surface[r].bsdf.albedo, albedo, 1.0f / members[r - first]);
    return r;
  }
  const uint32_t sequence = place + LIGHT_BLOCK * (roots->count - first);
  const uint32_t made = olx_shade_append(c->shade, roots, hit, scratch->rays[k].direction, seed, sequence);
  members[made - first] = 1.0f;
  scratch->slot[made] = k;
  return made;
}

// Points that stand for the samples of a texel: one for all that lie on one surface, at a sample drawn at random.
static void append_texel(const olx_capture *c, olx_shade_scratch *scratch, uint32_t tile, uint32_t texel) {
  const uint32_t per_texel = c->samples * c->samples, place = texel % LIGHT_BLOCK;
  const uint32_t seed = olx_hash3(c->probe, texel_index(c, tile, texel - place), SALT_TEXEL);
  const uint32_t first = scratch->roots.count,
                 start = olx_hash2(olx_shade_key(c->shade, seed) + place, SALT_CHOICE) % per_texel;
  float members[64];
  for (uint32_t i = 0; i < per_texel; i++) {
    const uint32_t k = texel * per_texel + (start + i < per_texel ? start + i : start + i - per_texel);
    if (scratch->hits[k].triangle == OLX_NO_HIT) {
      scratch->owner[k] = NO_POINT;
      scratch->colors[k] = scratch->emission[k] = olx_environment_radiance(c->shade->scene, scratch->rays[k].direction);
      scratch->emits[k] = true;
      continue;
    }
    scratch->owner[k] = point_of_sample(c, scratch, first, k, seed, place, members);
  }
  for (uint32_t r = first; r < scratch->roots.count; r++) {
    if (members[r - first] > 1.0f) olx_shade_refresh(&scratch->roots, r);
  }
}

// A point of the same `block` texels that leads already and on whose surface point `k` lies, or `k`.
static uint32_t find_leader(const olx_capture *c, const olx_shade_scratch *scratch, const uint32_t *leaders, uint32_t k,
                            uint32_t block) {
  const olx_shade_batch *roots = &scratch->roots;
  const uint32_t points = c->samples * c->samples * block;
  const uint32_t least = scratch->slot[k] / points * points;
  // The nearest two points tell: a longer search costs more than it finds.
  for (uint32_t i = k, tried = 0; i-- > 0 && tried < 2 && scratch->slot[i] >= least; tried++) {
    const uint32_t leader = leaders[i];
    if (leader == NO_POINT || scratch->slot[leader] < least) continue;
    if (same_surface(&roots->surface[leader], &roots->surface[k], c->shade->share_distance)) return leader;
  }
  return k;
}

// Chooses which points send shadow rays to lights with an area. Lobes too narrow to count as matte do so for themselves.
static void choose_lit(const olx_capture *c, olx_shade_scratch *scratch) {
  olx_shade_batch *roots = &scratch->roots;
  for (uint32_t k = 0; k < roots->count; k++) {
    roots->lit_like[k] = roots->reflects[k] ? k : find_leader(c, scratch, roots->lit_like, k, SHADOW_BLOCK);
    if (roots->reflects[roots->lit_like[k]]) roots->lit_like[k] = k;
  }
}

// Chooses which points cast reflections; returns the count of paths.
static uint32_t choose_reflections(const olx_capture *c, olx_shade_scratch *scratch) {
  uint32_t paths = 0;
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const float share = reflectance(&scratch->roots, k);
    scratch->leader[k] = share > 0.0f ? k : NO_POINT;
    if (share <= 0.0f) continue;
    if (share < weak_reflectance) {
      const uint32_t leader = find_leader(c, scratch, scratch->leader, k, REFLECTION_BLOCK);
      if (reflectance(&scratch->roots, leader) < weak_reflectance) scratch->leader[k] = leader;
    }
    if (scratch->leader[k] != k) continue;
    scratch->paths[0][paths++] = (olx_shade_path){.root = k, .from = k, .throughput = olx_splat(1.0f)};
  }
  return paths;
}

// Rays through the diffuse lobe, where they can find a light.
static uint32_t choose_scattering(const olx_capture *c, olx_shade_scratch *scratch) {
  olx_shade_batch *roots = &scratch->roots;
  uint32_t paths = 0;
  for (uint32_t k = 0; k < roots->count; k++) {
    if (olx_max3(roots->diffuse[k]) <= 0.0f) continue;
    const float share = roots->scattered[k] = olx_shade_scattering(c->shade, &roots->surface[k]);
    if (share <= 0.0f) continue;
    if (share < 1.0f && olx_unit_float(olx_hash3(roots->seed[k], roots->sequence[k], SALT_SCATTER)) >= share) continue;
    scratch->paths[0][paths++] =
        (olx_shade_path){.root = k, .from = k, .diffuse = true, .throughput = olx_splat(1.0f / share)};
  }
  return paths;
}

// Reflections, and their share in points that do not cast their own.
static void add_reflections(const olx_capture *c, olx_shade_scratch *scratch) {
  olx_shade_batch *roots = &scratch->roots;
  const uint32_t paths = choose_reflections(c, scratch);
  if (paths == 0) return;
  for (uint32_t k = 0; k < roots->count; k++) {
    scratch->unreflected[k] = roots->radiance[k];
    roots->radiance[k] = olx_splat(0.0f);
  }
  olx_shade_reflections(c->shade, scratch, paths, c->bounces, OLX_REFLECT_LIGHTS | OLX_REFLECT_BOUNCES);
  // Leaders come before those they lead: backwards, none is changed before it is read.
  for (uint32_t k = roots->count; k-- > 0;) {
    const uint32_t leader = scratch->leader[k];
    const olx_vec3 reflected = leader == NO_POINT ? olx_splat(0.0f) : roots->radiance[leader];
    roots->radiance[k] = olx_add(scratch->unreflected[k], reflected);
  }
}

// Irradiance looked up at every fourth texel of a tile, between which the others interpolate.
enum { LATTICE_STEP = 4, LATTICE_MOST = 32 / LATTICE_STEP + 1 };

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
  olx_shade_batch *roots = &scratch->roots;
  olx_shade_batch_begin(roots, c->light_samples);
  roots->sparing = true;
  roots->averages_lobes = true;
  for (uint32_t texel = 0; texel < count / per_texel; texel++) append_texel(c, scratch, tile, texel);
  if (c->shade->reflected_lights) choose_lit(c, scratch);
  const uint32_t scattered = choose_scattering(c, scratch);
  olx_shade_direct(c->shade, scratch, roots);
  if (c->bounces > 0) add_diffuse(c, scratch, per_texel);
  if (scattered > 0) olx_shade_reflections(c->shade, scratch, scattered, 0, OLX_REFLECT_LIGHTS);
  add_reflections(c, scratch);
  for (uint32_t k = 0; k < count; k++) {
    const uint32_t point = scratch->owner[k];
    if (point == NO_POINT) continue;
    const olx_vec3 emission = roots->surface[point].emission;
    scratch->emission[k] = emission;
    scratch->emits[k] = olx_max3(emission) > 0.0f;
    scratch->colors[k] = olx_add(emission, roots->radiance[point]);
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

uint64_t olx_capture_bytes(uint32_t size) {
  const olx_capture *c = NULL;
  return (uint64_t)size * size * (sizeof *c->radiance + sizeof *c->normal + sizeof *c->distance + sizeof *c->hits);
}

olx_result olx_capture_create(olx_capture *c) {
  const size_t texels = (size_t)c->size * c->size;
  c->tile_side = 32;
  while (c->tile_side > c->size || c->tile_side * c->tile_side * c->samples * c->samples > OLX_BATCH_POINTS)
    c->tile_side /= 2;
  c->radiance = olx_allocate(texels, sizeof *c->radiance);
  c->normal = olx_allocate(texels, sizeof *c->normal);
  c->distance = olx_allocate(texels, sizeof *c->distance);
  c->hits = olx_allocate(texels, sizeof *c->hits);
  c->tile_seconds = olx_allocate(tile_count(c), sizeof *c->tile_seconds);
  if (c->radiance && c->normal && c->distance && c->hits && c->tile_seconds) return OLX_OK;
  olx_capture_free(c);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for maps of %u x %u texels", c->size, c->size);
}

void olx_capture_free(olx_capture *c) {
  olx_release(c->radiance);
  olx_release(c->normal);
  olx_release(c->distance);
  olx_release(c->hits);
  olx_release(c->tile_seconds);
  c->radiance = NULL;
  c->normal = c->distance = NULL;
  c->hits = NULL;
  c->tile_seconds = NULL;
}

uint64_t olx_capture_units(const olx_capture *c) { return (uint64_t)c->size * c->size * c->samples * c->samples; }
