// Fills the probes of the irradiance volume: rays all around each are shaded from the solved light and projected onto
// spherical harmonics, whose bands the cosine then weighs.
#include "bake/volume/volume_light.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/result.h"
#include "scene/bvh.h"

enum { PACKET = 64, PROBES_PER_JOB = 4, SALT_DIRECTION = 0x564F4C44, SALT_LIGHT = 0x564F4C4C, VIEW_SIDE = 64 };

typedef struct light_job {
  const olx_volume_light *volume;
  const olx_vec3 *positions;
  uint32_t count;
  uint16_t *irradiance;
  uint64_t *rays; // a job
} light_job;

// Returns the bits of a number except its exponent, so that random numbers do not depend on the unit of length.
static uint32_t mantissa_bits(float value) {
  union {
    float value;
    uint32_t bits;
  } both = {.value = value};
  return both.bits & 0x807FFFFFu;
}

// Seeds random numbers by a probe's place.
static uint32_t seed_at(olx_vec3 p, uint32_t seed) {
  return olx_hash2(olx_hash3(mantissa_bits(p.x), mantissa_bits(p.y), mantissa_bits(p.z)), seed);
}

static void add_light(olx_vec3 *sums, olx_vec3 direction, olx_vec3 radiance) {
  float values[OLX_HARMONICS_MOST];
  olx_harmonics_at(direction, values);
  for (uint32_t i = 0; i < OLX_HARMONICS_MOST; i++) sums[i] = olx_madd(sums[i], radiance, values[i]);
}

// Adds the light of surfaces near lamps that one sample finds, as the radiance which has its mean over all directions.
static void add_beam(const olx_volume_light *v, olx_vec3 *sums, olx_vec3 position, olx_sampler *sampler,
                     uint64_t *cast) {
  olx_lamp_beam beam;
  if (olx_scene_light_bounces(v->light) == 0) return;
  if (!olx_scene_light_beam(v->scene, v->light, position, sampler, &beam, cast)) return;
  add_light(sums, beam.direction, olx_scale(beam.irradiance, 0.25f / OLX_PI));
}

static void light_probe(const light_job *j, uint32_t probe, uint64_t *cast) {
  const olx_volume_light *v = j->volume;
  const olx_vec3 position = j->positions[probe];
  const uint32_t seed = seed_at(position, v->seed), direction_seed = olx_hash2(seed, SALT_DIRECTION),
                 light_seed = olx_hash2(seed, SALT_LIGHT);
  const uint32_t bounces = olx_scene_light_bounces(v->light);
  olx_vec3 sums[OLX_HARMONICS_MOST] = {{0}};
  olx_ray rays[PACKET];
  olx_ray_hit hits[PACKET];
  for (uint32_t first = 0; first < v->rays; first += PACKET) {
    const uint32_t count = v->rays - first < PACKET ? v->rays - first : PACKET;
    for (uint32_t i = 0; i < count; i++) {
      const olx_vec3 direction = olx_sample_sphere(olx_stratified2(first + i, direction_seed));
      rays[i] = (olx_ray){position, olx_normalize(direction), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(v->scene->light_bvh, rays, count, false, hits);
    *cast += count;
    for (uint32_t i = 0; i < count; i++) {
      olx_sampler sampler = {.seed = light_seed, .index = first + i};
      const olx_vec3 radiance =
          olx_ray_light_but_near_lamps(v->scene, v->light, bounces, &rays[i], &hits[i], &sampler, cast);
      add_light(sums, rays[i].direction, radiance);
      add_beam(v, sums, position, &sampler, cast);
    }
  }
  for (uint32_t i = 0; i < OLX_HARMONICS_MOST; i++) {
    const uint32_t band = i == 0 ? 0 : i < 4 ? 1 : 2;
    sums[i] = olx_scale(sums[i], olx_harmonics_cosine(band) / (olx_harmonics_mean_square(i) * (float)v->rays));
  }
  olx_harmonics_pack(sums, OLX_VOLUME_BANDS, j->irradiance + (size_t)OLX_VOLUME_HALVES * probe);
}

static void light_some(void *user, uint32_t job) {
  const light_job *j = user;
  const uint32_t first = job * PROBES_PER_JOB,
                 end = first + PROBES_PER_JOB < j->count ? first + PROBES_PER_JOB : j->count;
  for (uint32_t i = first; i < end; i++) light_probe(j, i, &j->rays[job]);
}

olx_result olx_volume_light_make(olx_volume_light *volume, const olx_vec3 *positions, uint32_t count,
                                 uint16_t *irradiance) {
  const uint32_t jobs = (count + PROBES_PER_JOB - 1) / PROBES_PER_JOB;
  light_job j = {.volume = volume,
                 .positions = positions,
                 .count = count,
                 .irradiance = irradiance,
                 .rays = olx_allocate_zero(jobs, sizeof *j.rays)};
  if (!j.rays) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u volume probes", count);
  const olx_result result = olx_parallel_for(jobs, volume->threads, light_some, &j, volume->task, 0);
  for (uint32_t i = 0; i < jobs; i++) volume->rays_cast += j.rays[i];
  olx_release(j.rays);
  return result;
}

typedef struct view_job {
  const olx_scene *scene;
  const olx_volume *volume;
  const olx_vec3 *positions;
  const uint8_t *flags;
  double *seen, *unserved; // a probe
} view_job;

static void look_around(void *user, uint32_t probe) {
  const view_job *j = user;
  if (j->flags[probe]) return;
  for (uint32_t y = 0; y < VIEW_SIDE; y++) {
    olx_ray rays[VIEW_SIDE];
    olx_ray_hit hits[VIEW_SIDE];
    for (uint32_t x = 0; x < VIEW_SIDE; x++) {
      rays[x] = (olx_ray){j->positions[probe], olx_texel_direction(x, y, VIEW_SIDE), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(j->scene->bvh, rays, VIEW_SIDE, true, hits);
    for (uint32_t x = 0; x < VIEW_SIDE; x++) {
      if (hits[x].triangle == OLX_NO_HIT) continue;
      const olx_surface surface = olx_surface_at(j->scene, &hits[x], rays[x].direction);
      const double angle = olx_texel_solid_angle(x, y, VIEW_SIDE);
      olx_volume_place place;
      j->seen[probe] += angle;
      if (!olx_volume_find_at(j->volume, surface.position, surface.geometric_normal, &place))
        j->unserved[probe] += angle;
    }
  }
}

olx_result olx_volume_unserved(const olx_scene *scene, const olx_volume *volume, const olx_vec3 *positions,
                               const uint8_t *flags, uint32_t count, uint32_t threads, double *share) {
  view_job j = {.scene = scene,
                .volume = volume,
                .positions = positions,
                .flags = flags,
                .seen = olx_allocate_zero(count, sizeof *j.seen),
                .unserved = olx_allocate_zero(count, sizeof *j.unserved)};
  olx_result result =
      j.seen && j.unserved ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u probes", count);
  if (result == OLX_OK) result = olx_parallel_for(count, threads, look_around, &j, NULL, 0);
  double seen = 0.0, unserved = 0.0;
  for (uint32_t i = 0; result == OLX_OK && i < count; i++) {
    seen += j.seen[i];
    unserved += j.unserved[i];
  }
  *share = seen > 0.0 ? unserved / seen : 0.0;
  olx_release(j.seen);
  olx_release(j.unserved);
  return result;
}
