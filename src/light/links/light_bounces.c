// Propagates light over links, bounce after bounce, and measures the variance of each surfel over its rays.
#include "light/links/light_bounces.h"

#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "light/links/link_batch.h"
#include "light/links/links.h"

enum { SURFELS_PER_JOB = 256, KEPT = OLX_BOUNCES_KEPT };

// The light of one bounce, with the earlier bounces that chains of specular surfaces need.
typedef struct bounce {
  const olx_light_links *links;
  const olx_link_batch *batch;
  olx_vec3 *kept[KEPT]; // light after n surfaces, at index n mod KEPT
  const olx_surfel_direct *direct;
  uint32_t number, surfel_count;
  olx_vec3 *sum;
} bounce;

static void add_links(void *user, uint32_t job) {
  const bounce *b = user;
  const uint32_t first = job * SURFELS_PER_JOB;
  const uint32_t end = first + SURFELS_PER_JOB < b->batch->count ? first + SURFELS_PER_JOB : b->batch->count;
  uint32_t from = first;
  for (uint32_t n = first; n < end; n++) {
    const olx_link *links = b->batch->links + (size_t)n * b->batch->rays;
    olx_vec3 sum = {0};
    for (uint32_t i = 0; i < b->batch->rays; i++) {
      const uint32_t chain = olx_link_chain(&links[i]);
      if (!olx_link_brings_light(&links[i]) || chain >= b->number) continue;
      const olx_vec3 light = chain + 1 == b->number ? olx_direct_of_link(&links[i], b->direct)
                                                    : b->kept[(b->number - 1 - chain) % KEPT][olx_link_end(&links[i])];
      sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(links[i].weight), light));
    }
    olx_vec3 *const to = &b->sum[olx_link_surfel(b->batch, n)];
    *to = olx_add(*to, sum);
    olx_link_batch_passed(b->batch, n, &from);
  }
  olx_link_batch_rest(b->batch, from, end);
}

// Computes the light after exactly `number` surfaces, in place of the oldest bounce.
static olx_result add_bounce(bounce *b, uint32_t threads) {
  olx_vec3 *sum = b->sum;
  for (uint32_t i = 0; i < b->surfel_count; i++) {
    sum[i] = b->number <= OLX_CHAIN_MOST ? b->links->fixed[i].sum[b->number - 1] : olx_splat(0.0f);
  }
  for (uint32_t k = 0; k < b->links->batch_count; k++) {
    b->batch = &b->links->batches[k];
    const uint32_t jobs = (b->batch->count + SURFELS_PER_JOB - 1) / SURFELS_PER_JOB;
    OLX_TRY(olx_parallel_for(jobs, threads, add_links, b, NULL, 0));
  }
  for (uint32_t i = 0; i < b->surfel_count; i++) sum[i] = olx_scale(sum[i], 1.0f / b->links->worth[i]);
  return OLX_OK;
}

// Returns the share of its light that a surfel still lacks, as a mean over surfels: what further bounces bring if each
// brings as much less than the one before as the last two did. Bright places thus do not decide for dark ones.
static double lacking(const bounce *b, const olx_vec3 *irradiance) {
  const olx_vec3 *last = b->kept[b->number % KEPT], *former = b->kept[(b->number - 1) % KEPT];
  double now = 0.0, before = 0.0, count = 0.0;
  for (uint32_t i = 0; i < b->surfel_count; i++) {
    const double all = (double)olx_luminance(irradiance[i]);
    if (!(all > 0.0)) continue;
    now += (double)olx_luminance(last[i]) / all;
    before += (double)olx_luminance(former[i]) / all;
    count++;
  }
  if (!(now > 0.0)) return 0.0;
  return b->number > 1 && now < before ? now / count * now / (before - now) : 1.0; // light before bounce 1 is direct
}

static olx_result solve(bounce *b, uint32_t threads, uint32_t bounces, const olx_bounce_keeper *keeper,
                        olx_bounce_state *state) {
  while (state->done < bounces) {
    b->number = ++state->done;
    // No link reads the oldest light any more, because chains are shorter than the ring buffer.
    olx_vec3 *const oldest = b->sum = b->kept[b->number % KEPT];
    OLX_TRY(add_bounce(b, threads));
    const olx_vec3 *previous = b->kept[(b->number - 1) % KEPT];
    for (uint32_t i = 0; i < b->surfel_count; i++) {
      state->irradiance[i] = olx_add(state->irradiance[i], oldest[i]);
      state->passed_on[i] = olx_add(state->passed_on[i], previous[i]);
    }
    if (lacking(b, state->irradiance) < 0x1p-10) break;
    if (keeper && state->done < bounces) OLX_TRY(keeper->save(keeper->user, state));
  }
  return OLX_OK;
}

olx_result olx_bounces_solve(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                             const olx_surfel_direct *direct, uint32_t bounces, const olx_bounce_keeper *keeper,
                             olx_vec3 *irradiance, olx_vec3 *passed_on, uint32_t *done) {
  olx_vec3 *memory = olx_allocate_zero((size_t)KEPT * surfel_count, sizeof *memory);
  if (!memory) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for bounces of %u surfels", surfel_count);
  olx_bounce_state state = {0, surfel_count, memory, irradiance, passed_on};
  bounce b = {.links = links, .direct = direct, .surfel_count = surfel_count};
  for (uint32_t i = 0; i < KEPT; i++) b.kept[i] = memory + (size_t)i * surfel_count;
  for (uint32_t i = 0; i < surfel_count; i++) {
    b.kept[0][i] = direct->all[i];
    irradiance[i] = passed_on[i] = olx_splat(0.0f);
  }
  if (keeper) keeper->load(keeper->user, &state);
  const olx_result result = solve(&b, threads, bounces, keeper, &state);
  *done = state.done;
  olx_release(memory);
  return result;
}

typedef struct spread {
  const olx_light_links *links;
  const olx_link_batch *batch;
  const olx_surfel_direct *direct;
  const olx_vec3 *irradiance;
  double *squares; // for each surfel, the sum of its luminances' squared deviations from the mean of their batch
  double *worths;  // and the sum over its rays of their squared worth
} spread;

static void add_spread(void *user, uint32_t job) {
  const spread *s = user;
  const uint32_t first = job * SURFELS_PER_JOB;
  const uint32_t end = first + SURFELS_PER_JOB < s->batch->count ? first + SURFELS_PER_JOB : s->batch->count;
  uint32_t from = first;
  for (uint32_t n = first; n < end; n++) {
    const olx_link *links = s->batch->links + (size_t)n * s->batch->rays;
    double sum = 0.0, square = 0.0;
    for (uint32_t i = 0; i < s->batch->rays; i++) {
      const double value = (double)olx_luminance(olx_link_light(&links[i], s->direct, s->irradiance));
      sum += value;
      square += value * value;
    }
    const uint32_t surfel = olx_link_surfel(s->batch, n);
    const double worth = (double)olx_link_worth(s->batch, surfel);
    s->squares[surfel] += square - sum * sum / s->batch->rays;
    s->worths[surfel] += worth * worth * s->batch->rays;
    olx_link_batch_passed(s->batch, n, &from);
  }
  olx_link_batch_rest(s->batch, from, end);
}

// Batches differ in the worth of their rays, so that each batch has its own mean. Of light without links only the sum
// over all batches is known, so there a batch has its rays' share of that.
static float variance_of_mean(const spread *s, uint32_t i) {
  const olx_light_links *links = s->links;
  const double n = (double)links->worth[i];
  double fixed = 0.0;
  for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) fixed += (double)olx_luminance(links->fixed[i].sum[k]);
  const double mean = fixed / n, without_links = (double)links->fixed[i].square - mean * mean * s->worths[i];
  return (float)(fmax(0.0, s->squares[i] + without_links) / (n * n));
}

olx_result olx_bounces_variance(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                                const olx_surfel_direct *direct, const olx_vec3 *irradiance, float *variance) {
  spread s = {.links = links,
              .direct = direct,
              .irradiance = irradiance,
              .squares = olx_allocate_zero(surfel_count, sizeof *s.squares),
              .worths = olx_allocate_zero(surfel_count, sizeof *s.worths)};
  olx_result result = s.squares && s.worths ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for variances");
  for (uint32_t k = 0; result == OLX_OK && k < links->batch_count; k++) {
    s.batch = &links->batches[k];
    const uint32_t jobs = (s.batch->count + SURFELS_PER_JOB - 1) / SURFELS_PER_JOB;
    result = olx_parallel_for(jobs, threads, add_spread, &s, NULL, 0);
  }
  for (uint32_t i = 0; result == OLX_OK && i < surfel_count; i++) variance[i] = variance_of_mean(&s, i);
  olx_release(s.squares);
  olx_release(s.worths);
  return result;
}
