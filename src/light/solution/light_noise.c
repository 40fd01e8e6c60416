// Measures how far the light of surfels may be off, from the spread of what their rays bring.
#include "light/solution/light_noise.h"

#include "core/hooks.h"
#include "core/result.h"

// Interpolation averages the noise of several surfels: the variance of the result is about this share of one surfel's.
static const float INTERPOLATED_VARIANCE = 0.2f;
// Noise is measured relative to the light of a place, or to this share of the mean light where the place is darker.
static const float DARK_SHARE = 0.002f;
// Surfels learn from those of the cell this many levels above their own how uneven light may be.
enum { WIDE_LEVELS = OLX_POOL_LEVELS + 3 };
// The rays of a pool are taken to know their variance when they should have met a bright place of their surroundings
// this often.
static const double ENOUGH_HITS = 8.0;
// Further rays are cast only where they are at least this share of the first rays.
static const float ENOUGH_RAYS = 0.25f;

static float mean_luminance(const olx_vec3 *light, uint32_t count) {
  double sum = 0.0;
  for (uint32_t i = 0; i < count; i++) sum += (double)olx_luminance(light[i]);
  return count ? (float)(sum / count) : 0.0f;
}

// Returns the number of rays of even density to which a surfel's rays amount.
static float worth_of(const olx_scene_light *l, uint32_t surfel) {
  return l->gathered ? l->gathered[surfel].worth : l->links.worth[surfel];
}

// Sums over the visible surfels of a pool.
typedef struct noise_sum {
  double light, variance;           // variance: of a surfel's mean
  double squares, deviations, rays; // of light, and of rays from it; rays of even density
  uint32_t count;
} noise_sum;

static void add_up(const olx_scene_light *l, const float *variance, const uint32_t *pool_of, noise_sum *sums) {
  for (uint32_t i = 0; i < l->visible; i++) {
    noise_sum *sum = &sums[pool_of[i]];
    const double light = (double)olx_luminance(l->irradiance[i]), rays = (double)worth_of(l, i);
    sum->light += light;
    sum->variance += (double)variance[i];
    sum->squares += light * light;
    sum->deviations += (double)variance[i] * rays;
    sum->rays += rays;
    sum->count++;
  }
}

// Returns the variance of a ray, over the squared light, that the rays of a pool may have missed: those of a wider pool
// have met brighter places. The fewer rays a pool has for this variance, the more it may be. Without it, surfels that
// missed a small bright place would seem certain and get no further rays, and light would be too dark.
static double missed(const noise_sum *pool, const noise_sum *wide) {
  const double spread = wide->squares > 0.0 ? wide->deviations / wide->squares : 0.0;
  return spread * fmin(1.0, ENOUGH_HITS * spread / pool->rays);
}

// Averages the variance with surfels of the same size nearby, which see about the same: the few first rays of a surfel
// may all miss a small bright source and then seem to agree, and adds what all rays there may have missed. (Hidden
// surfels never get more than their first rays.)
static void smooth(const olx_scene_light *l, const noise_sum *sums, const noise_sum *wide, const uint32_t *wide_of,
                   float *variance, float *light) {
  for (uint32_t i = 0; i < l->visible; i++) {
    const noise_sum *sum = &sums[l->guide.pool_of[i]];
    const double mean = sum->light / sum->count;
    light[i] = (float)mean;
    variance[i] =
        (float)(sum->variance / sum->count + missed(sum, &wide[wide_of[i]]) * mean * mean / (double)worth_of(l, i));
  }
}

static olx_result smooth_noise(const olx_scene_light *l, float *variance, float *light) {
  uint32_t *wide_of = olx_allocate(l->surfels.count, sizeof *wide_of), wide_count = 0;
  if (!wide_of) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", l->surfels.count);
  olx_result result = olx_pool_surfels(&l->surfels, WIDE_LEVELS, wide_of, &wide_count);
  noise_sum *sums = olx_allocate_zero(l->guide.pool_count, sizeof *sums),
            *wide = olx_allocate_zero(wide_count, sizeof *wide);
  if (result == OLX_OK && (!sums || !wide))
    result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", l->surfels.count);
  if (result == OLX_OK) {
    add_up(l, variance, l->guide.pool_of, sums);
    add_up(l, variance, wide_of, wide);
    smooth(l, sums, wide, wide_of, variance, light);
  }
  olx_release(sums);
  olx_release(wide);
  olx_release(wide_of);
  return result;
}

// Finds the variance of each surfel's irradiance, in luminance squared.
static olx_result find_variance(const olx_scene_light *l, float *variance) {
  if (!l->gathered) {
    const olx_surfel_direct direct = olx_light_direct(l);
    return olx_bounces_variance(&l->links, l->surfels.count, l->settings.threads, &direct, l->irradiance, variance);
  }
  for (uint32_t i = 0; i < l->visible; i++) variance[i] = l->gathered[i].squares / olx_square(l->gathered[i].worth);
  return OLX_OK;
}

// Turns the variances of visible surfels into noise, and returns its mean square.
static double relate(const olx_scene_light *l, const float *light, float *noise) {
  const float dark = DARK_SHARE * mean_luminance(l->irradiance, l->surfels.count);
  double squares = 0.0;
  for (uint32_t i = 0; i < l->visible; i++) {
    const float level = olx_max(light[i], dark);
    noise[i] = level > 0.0f ? sqrtf(INTERPOLATED_VARIANCE * noise[i]) / level : 0.0f;
    squares += (double)noise[i] * (double)noise[i];
  }
  return squares / fmax(1.0, l->visible);
}

olx_result olx_light_noise_measure(olx_scene_light *l) {
  float *light = olx_allocate(l->surfels.count, sizeof *light);
  if (!light) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", l->surfels.count);
  olx_result result = find_variance(l, l->noise);
  if (result == OLX_OK) result = smooth_noise(l, l->noise, light);
  if (result == OLX_OK) l->report.noise = sqrt(relate(l, light, l->noise));
  olx_release(light);
  return result;
}

float olx_scene_light_deviation(const olx_scene_light *l, uint32_t surfel) {
  return l->noise[surfel] * sqrtf(worth_of(l, surfel) / INTERPOLATED_VARIANCE);
}

uint32_t olx_light_rays_wanted(const olx_scene_light *l, uint32_t surfel, uint32_t most) {
  const float ratio = l->noise[surfel] / l->settings.noise;
  const float wanted = olx_light_pool(l, surfel)->spread * worth_of(l, surfel) * (ratio * ratio - 1.0f);
  if (wanted < ENOUGH_RAYS * (float)l->first_rays) return 0;
  uint32_t rays = l->first_rays;
  while (rays < most && (float)rays < wanted) rays *= 2;
  return rays;
}
