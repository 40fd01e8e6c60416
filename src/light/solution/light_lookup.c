// Evaluates the irradiance of a surface from a solution: interpolated between records, or gathered by rays where
// interpolation is unreliable.
#include "light/solution/light_lookup.h"

#include "core/sampling.h"
#include "light/links/gathers.h"
#include "light/solution/light_noise.h"

enum {
  LEAST_NEIGHBOURS = 3, // with fewer records around it, a point casts rays of its own
  MOST_BATCHES = 4,
  MOST_RECORD_BATCHES = 8,
  SALT_GATHER = 0x47415448
};

// Light is not interpolated where the standard deviation over the neighbours is above this share of the mean.
static const float ROUGH_SPREAD = 0.3f;
// Cells are divided where the standard deviation of light over the records around one is above this share of its mean.
static const float DIVIDED_SPREAD = 0.25f;
// Where few records determine light, it is not interpolated above this share of its mean either, unless the rays that
// the point would cast itself are expected to be less certain: their standard error, times this factor, is a share that
// is allowed, too.
static const float FEW_SPREAD = 0.1f, FEW_NOISE = 1.5f;
// A point's own rays are as many as bring the standard error that is expected of them to this multiple of the bound on
// noise, but for at most MOST_BATCHES times OLX_GATHER_RAYS. Records, between which light is interpolated, cast more.
static const float GATHER_NOISE = 4.0f, RECORD_NOISE = 2.0f;
// Bound on the light of one gathered ray, as a share of the light around the point or of all other rays' light.
static const float MOST_OF_A_RAY = 0.25f;

olx_vec3 olx_light_gather(const olx_scene_light *l, const olx_surface *surface, uint32_t batches, olx_gather_row *row) {
  const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
  const uint32_t seed = olx_hash3(l->surfels.seed ^ (uint32_t)key, (uint32_t)(key >> 32), SALT_GATHER);
  const uint32_t near = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
  const olx_ray_pool *pool = near == OLX_CELL_NONE ? NULL : olx_light_pool(l, near);
  const float around = near == OLX_CELL_NONE ? INFINITY : olx_luminance(l->irradiance[near]);
  const float most = MOST_OF_A_RAY * (float)batches;
  const olx_passed_light light = {olx_light_direct(l), l->passed_on, l->settings.bounces};
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < batches; i++) {
    const uint32_t own = i ? olx_hash2(seed, i) : seed;
    sum = olx_add(sum, olx_gather_at(&l->surfels, surface, pool, own, &light, most, around, row));
  }
  return olx_scale(sum, 1.0f / (float)batches);
}

// Returns the standard error that is expected of OLX_GATHER_RAYS rays of a point's own, as a share of the light around
// it.
static float expected_error(const olx_scene_light *l, const olx_surfel_weights *weights) {
  float sum = 0.0f, deviation = 0.0f;
  for (uint32_t i = 0; i < weights->count; i++) {
    const float weight = fabsf(weights->weight[i]);
    sum += weight;
    deviation += weight * olx_scene_light_deviation(l, l->records.surfel_of[weights->surfel[i]]);
  }
  return deviation / (sum * sqrtf(OLX_GATHER_RAYS));
}

// Returns the number of batches, at most `most`, that bring an error of one batch to a bound.
static uint32_t batches_to(float bound, uint32_t most, float error) {
  uint32_t batches = 1;
  while (batches < most && error > bound * sqrtf((float)batches)) batches *= 2;
  return batches;
}

static uint32_t batches_wanted(const olx_scene_light *l, float error) {
  return batches_to(GATHER_NOISE * l->settings.noise, MOST_BATCHES, error);
}

uint32_t olx_light_record_batches(const olx_scene_light *l, uint32_t surfel) {
  const float error = olx_scene_light_deviation(l, surfel) / sqrtf(OLX_GATHER_RAYS);
  return batches_to(RECORD_NOISE * l->settings.noise, MOST_RECORD_BATCHES, error);
}

olx_gather_plan olx_light_plan_gather(const olx_scene_light *l, const olx_surface *surface) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->records.lookup, surface, false);
  if (weights.count == 0) return (olx_gather_plan){.batches = 1};
  const float error = expected_error(l, &weights);
  const uint32_t batches = batches_wanted(l, error);
  return (olx_gather_plan){batches, error / sqrtf((float)batches)};
}

// Returns the standard deviation up to which the light of few neighbours is interpolated, as a share of its mean.
static float spread_of_few(const olx_scene_light *l, const olx_surfel_weights *weights) {
  const float error = expected_error(l, weights), rays = (float)batches_wanted(l, error);
  return olx_clamp(FEW_NOISE * error / sqrtf(rays), FEW_SPREAD, ROUGH_SPREAD);
}

// Returns whether the standard deviation of the neighbours' light, from their mean or from their fit, is above a share
// of the mean.
static bool varies(const olx_scene_light *l, const olx_surfel_weights *weights, bool from_fit, float share) {
  float sum = 0.0f, mean = 0.0f, square = 0.0f, light[OLX_NEIGHBOURS_MOST];
  for (uint32_t i = 0; i < weights->count; i++) {
    const float weight = fabsf(weights->weight[i]);
    light[i] = olx_luminance(l->records.irradiance[weights->surfel[i]]);
    sum += weight;
    mean += weight * light[i];
    square += weight * light[i] * light[i];
  }
  mean /= sum;
  const float variance = from_fit ? olx_square(olx_surfel_misfit(weights, light)) : square / sum - mean * mean;
  return variance > olx_square(share * mean);
}

// Returns whether the neighbours near a point determine its light.
static bool determines(const olx_scene_light *l, const olx_surfel_weights *weights) {
  if (weights->count < LEAST_NEIGHBOURS) return false;
  const bool few = weights->count < OLX_NEIGHBOURS_FEW;
  return !varies(l, weights, false, few ? spread_of_few(l, weights) : ROUGH_SPREAD);
}

// Returns whether neighbours that lie farther away determine the light of a point between them. They may lie on a slope
// of light, which their fit follows unless it is steep.
static bool determines_between(const olx_scene_light *l, const olx_surfel_weights *weights) {
  if (weights->count < OLX_NEIGHBOURS_FEW || varies(l, weights, false, ROUGH_SPREAD)) return false;
  return !varies(l, weights, true, spread_of_few(l, weights));
}

bool olx_light_varies(const olx_scene_light *l, const olx_surface *surface) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->records.lookup, surface, false);
  float mean = 0.0f, square = 0.0f;
  for (uint32_t i = 0; i < weights.count; i++) {
    const float light = olx_luminance(l->records.irradiance[weights.surfel[i]]);
    mean += light / (float)weights.count;
    square += light * light / (float)weights.count;
  }
  return square - mean * mean > olx_square(DIVIDED_SPREAD * mean);
}

// Interpolates `light`, one value per neighbour in their order.
static olx_vec3 interpolate(const olx_surfel_weights *weights, const olx_vec3 light[OLX_NEIGHBOURS_MOST]) {
  olx_vec3 sum = {0}, least = olx_splat(INFINITY), most = olx_splat(0.0f);
  for (uint32_t i = 0; i < weights->count; i++) {
    sum = olx_madd(sum, light[i], weights->weight[i]);
    least = olx_min_each(least, light[i]);
    most = olx_max_each(most, light[i]);
  }
  // Slopes extrapolate slightly beyond the values that they were fitted to, and no farther.
  const olx_vec3 margin = olx_scale(olx_sub(most, least), 0.25f);
  return olx_max_each(olx_min_each(sum, olx_add(most, margin)), olx_max_each(olx_sub(least, margin), olx_splat(0.0f)));
}

bool olx_light_interpolate(const olx_scene_light *l, const olx_surface *surface, olx_vec3 *irradiance) {
  olx_surfel_weights weights = olx_surfel_weigh(&l->records.lookup, surface, false);
  if (!determines(l, &weights)) {
    weights = olx_surfel_weigh(&l->records.lookup, surface, true);
    if (!determines_between(l, &weights)) return false;
  }
  olx_vec3 light[OLX_NEIGHBOURS_MOST];
  for (uint32_t i = 0; i < weights.count; i++) light[i] = l->records.irradiance[weights.surfel[i]];
  *irradiance = interpolate(&weights, light);
  return true;
}

// Returns the irradiance of a surfel with one bounce less.
static olx_vec3 before(const olx_scene_light *l, uint32_t surfel) {
  return olx_max_each(olx_sub(l->passed_on[surfel], l->direct[surfel]), olx_splat(0.0f));
}

static float share_of(float part, float whole) { return whole > 0.0f ? olx_min(part / whole, 1.0f) : 0.0f; }

// Returns the irradiance of a record with one bounce less: the same share of all as that of its surfel.
static olx_vec3 record_before(const olx_scene_light *l, uint32_t record) {
  const uint32_t surfel = l->records.surfel_of[record];
  if (record < l->visible) return before(l, surfel);
  const olx_vec3 part = before(l, surfel), whole = l->irradiance[surfel];
  return olx_mul(l->records.irradiance[record],
                 olx_v3(share_of(part.x, whole.x), share_of(part.y, whole.y), share_of(part.z, whole.z)));
}

olx_vec3 olx_light_interpolate_before(const olx_scene_light *l, const olx_surface *surface) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->records.lookup, surface, false);
  olx_vec3 light[OLX_NEIGHBOURS_MOST];
  for (uint32_t i = 0; i < weights.count; i++) light[i] = record_before(l, weights.surfel[i]);
  if (weights.count > 0) return interpolate(&weights, light);
  const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
  const uint32_t found = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
  return found == OLX_CELL_NONE ? olx_splat(0.0f) : before(l, found);
}
