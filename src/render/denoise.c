#include "render/denoise.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

#include <string.h>

// Two pixels show one surface when the second lies off the first one's plane by at most so many pixels' width, or by this
// share of their distance (normal maps tilt planes), ...
static const float PLANE_PIXELS = 2.0f, PLANE_SLOPE = 0.1f;
// ... and, for history, when their normals agree to this cosine.
static const float SAME_NORMAL = 0.9f;
// A point seen this near to a pixel's centre, in pixels, has not moved.
static const float STILL_PIXELS = 1e-2f;
// Glossy light is not mixed between surfaces whose roughness differs by more.
static const float ROUGHNESS_RANGE = 0.1f;

// Below this sum of weights nothing is known of a pixel.
static const float LEAST_WEIGHT = 1e-6f;

static const olx_incident nothing = {.inverse_distance = -1.0f};

olx_denoise_settings olx_denoise_settings_published(void) {
  return (olx_denoise_settings){
      .diffuse = {.radius_pixels = 12, .stride_pixels = 2, .history = 0.98f, .still_history = 0.98f},
      .glossy = {.radius_pixels = 3, .stride_pixels = 1, .history = 0.75f, .still_history = 0.75f},
  };
}

olx_denoise_settings olx_denoise_settings_default(void) {
  olx_denoise_settings settings = olx_denoise_settings_published();
  settings.diffuse.reach = 2.5f;
  settings.glossy.reach = 0.6f;
  settings.glossy.still_history = 0.98f;
  return settings;
}

olx_denoise_settings olx_denoise_settings_none(void) {
  return (olx_denoise_settings){.diffuse = {.stride_pixels = 1}, .glossy = {.stride_pixels = 1}};
}

olx_result olx_history_create(uint32_t width, uint32_t height, olx_history *history) {
  const size_t pixels = (size_t)width * height;
  history->incident = olx_allocate(pixels, sizeof *history->incident);
  history->count = olx_allocate(pixels, sizeof *history->count);
  if (!history->incident || !history->count) {
    olx_history_free(history);
    return olx_fail(OLX_ERROR_MEMORY, "denoise: no memory for the history of %u x %u pixels", width, height);
  }
  olx_history_clear(width, height, history);
  return OLX_OK;
}

void olx_history_free(olx_history *history) {
  olx_release(history->incident);
  olx_release(history->count);
  *history = (olx_history){0};
}

void olx_history_clear(uint32_t width, uint32_t height, olx_history *history) {
  const size_t pixels = (size_t)width * height;
  for (size_t i = 0; i < pixels; i++) history->incident[i] = nothing;
  memset(history->count, 0, pixels * sizeof *history->count);
}

// ---- where pixels are

olx_vec3 olx_guide_position(const olx_guide *guide, uint32_t x, uint32_t y) {
  const float across = 2.0f * ((float)x + 0.5f) / (float)guide->width - 1.0f;
  const float up = 1.0f - 2.0f * ((float)y + 0.5f) / (float)guide->height;
  const olx_camera_frame *c = &guide->camera;
  const olx_vec3 direction = olx_madd(olx_madd(c->forward, c->right, across), c->up, up);
  return olx_madd(c->eye, direction, guide->depth[x + (size_t)guide->width * y]);
}

bool olx_guide_project(const olx_guide *guide, olx_vec3 position, olx_vec2 *pixel) {
  const olx_camera_frame *c = &guide->camera;
  const olx_vec3 offset = olx_sub(position, c->eye);
  const float depth = olx_dot(offset, c->forward);
  if (!(depth > 0.0f)) return false;
  const float across = olx_dot(offset, c->right) / (olx_dot(c->right, c->right) * depth);
  const float up = olx_dot(offset, c->up) / (olx_dot(c->up, c->up) * depth);
  pixel->x = 0.5f * (across + 1.0f) * (float)guide->width - 0.5f;
  pixel->y = 0.5f * (1.0f - up) * (float)guide->height - 0.5f;
  return true;
}

// Width of a pixel at depth 1.
static float pixel_width(const olx_guide *guide) { return 2.0f * olx_length(guide->camera.up) / (float)guide->height; }

// How well a point fits the plane through another: 1 on it, 0 where it belongs to another surface.
static float plane_fit(olx_vec3 offset, olx_vec3 normal, float pixel_metres) {
  const float tolerance = PLANE_PIXELS * pixel_metres + PLANE_SLOPE * olx_length(offset);
  return olx_max(0.0f, 1.0f - fabsf(olx_dot(offset, normal)) / tolerance);
}

static bool is_sample(const olx_incident *incident) {
  return incident->inverse_distance >= 0.0f && isfinite(incident->inverse_distance) && olx_finite(incident->light);
}

// ---- history

typedef struct accumulate_job {
  const olx_lobe_filter *filter;
  const olx_guide *now, *before;
  const olx_incident *sample;
  const olx_history *from, *to;
} accumulate_job;

// What is known of a surface point.
typedef struct known {
  olx_incident incident;
  float count;
  bool still;
} known;

// Whether pixel (x, y) of the frame before showed this surface and has a history.
static bool same_surface(const accumulate_job *job, int32_t x, int32_t y, olx_vec3 position, olx_vec3 normal,
                         float pixel_metres) {
  const olx_guide *before = job->before;
  if (x < 0 || y < 0 || x >= (int32_t)before->width || y >= (int32_t)before->height) return false;
  const size_t pixel = (size_t)x + (size_t)before->width * (size_t)y;
  if (!isfinite(before->depth[pixel]) || !(job->from->count[pixel] > 0.0f)) return false;
  if (!is_sample(&job->from->incident[pixel]) || !(olx_dot(before->normal[pixel], normal) > SAME_NORMAL)) return false;
  const olx_vec3 there = olx_guide_position(before, (uint32_t)x, (uint32_t)y);
  return plane_fit(olx_sub(there, position), normal, pixel_metres) > 0.0f;
}

static known look_back(const accumulate_job *job, size_t pixel, uint32_t x, uint32_t y) {
  known result = {.incident = nothing};
  olx_vec2 at;
  const olx_vec3 position = olx_guide_position(job->now, x, y), normal = job->now->normal[pixel];
  if (!olx_guide_project(job->before, position, &at)) return result;
  const float columns = (float)job->before->width, rows = (float)job->before->height;
  if (!(at.x > -1.0f && at.y > -1.0f && at.x < columns && at.y < rows)) return result;
  const olx_vec2 nearest = {roundf(at.x), roundf(at.y)};
  result.still = fabsf(at.x - (float)x) < STILL_PIXELS && fabsf(at.y - (float)y) < STILL_PIXELS;
  if (fabsf(at.x - nearest.x) < STILL_PIXELS) at.x = nearest.x;
  if (fabsf(at.y - nearest.y) < STILL_PIXELS) at.y = nearest.y;
  const int32_t left = (int32_t)floorf(at.x), top = (int32_t)floorf(at.y);
  const float right_share = at.x - floorf(at.x), bottom_share = at.y - floorf(at.y);
  const float pixel_metres = job->now->depth[pixel] * pixel_width(job->now);
  olx_incident sum = {0};
  float weight_sum = 0.0f, count_sum = 0.0f;
  for (int32_t i = 0; i < 4; i++) {
    const int32_t tap_x = left + (i & 1), tap_y = top + (i >> 1);
    const float weight = (i & 1 ? right_share : 1.0f - right_share) * (i >> 1 ? bottom_share : 1.0f - bottom_share);
    if (weight <= 0.0f || !same_surface(job, tap_x, tap_y, position, normal, pixel_metres)) continue;
    const size_t tap = (size_t)tap_x + (size_t)job->before->width * (size_t)tap_y;
    sum.light = olx_madd(sum.light, job->from->incident[tap].light, weight);
    sum.inverse_distance += weight * job->from->incident[tap].inverse_distance;
    count_sum += weight * job->from->count[tap];
    weight_sum += weight;
  }
  if (weight_sum < 0.01f) return result;
  result.incident.light = olx_scale(sum.light, 1.0f / weight_sum);
  result.incident.inverse_distance = sum.inverse_distance / weight_sum;
  result.count = count_sum / weight_sum;
  return result;
}

static void accumulate_row(void *user, uint32_t y) {
  const accumulate_job *job = user;
  for (uint32_t x = 0; x < job->now->width; x++) {
    const size_t pixel = x + (size_t)job->now->width * y;
    olx_incident *incident = &job->to->incident[pixel];
    float *count = &job->to->count[pixel];
    *incident = nothing;
    *count = 0.0f;
    if (!isfinite(job->now->depth[pixel])) continue;
    const known past = look_back(job, pixel, x, y);
    const olx_incident *sample = &job->sample[pixel];
    if (!is_sample(sample)) {
      *incident = past.incident;
      *count = past.count;
      continue;
    }
    // History weighs 1 - 1/n, and n stops growing where that reaches the largest weight.
    const float largest = past.still ? job->filter->still_history : job->filter->history;
    const float n = olx_min(past.count + 1.0f, 1.0f / (1.0f - largest)), share = 1.0f / n;
    *count = n;
    *incident = *sample;
    if (share >= 1.0f) continue;
    incident->light = olx_mix3(past.incident.light, sample->light, share);
    incident->inverse_distance = olx_mix(past.incident.inverse_distance, sample->inverse_distance, share);
  }
}

olx_result olx_denoise_accumulate(const olx_lobe_filter *filter, const olx_guide *now, const olx_incident *sample,
                                  const olx_guide *before, const olx_history *from, const olx_history *to,
                                  uint32_t threads) {
  accumulate_job job = {.filter = filter, .now = now, .before = before, .sample = sample, .from = from, .to = to};
  return olx_parallel_for(now->height, threads, accumulate_row, &job, NULL, 0);
}

// ---- space

typedef struct filter_job {
  const olx_lobe_filter *filter;
  olx_lobe lobe;
  const olx_guide *guide;
  const olx_history *history;
  olx_vec3 *light;
} filter_job;

// The pixel in the middle, and what the weights of its neighbours follow from.
typedef struct middle {
  uint32_t x, y;
  size_t pixel;
  olx_vec3 position, normal;
  float pixel_metres;
  float inverse_distance; // 0 when nothing is known
  float narrowing;        // kernels shrink with the noise, which falls with the root of the number of frames
} middle;

static middle find_middle(const filter_job *job, uint32_t x, uint32_t y) {
  const size_t pixel = x + (size_t)job->guide->width * y;
  middle m = {.x = x, .y = y, .pixel = pixel, .normal = job->guide->normal[pixel], .narrowing = 1.0f};
  m.position = olx_guide_position(job->guide, x, y);
  m.pixel_metres = job->guide->depth[pixel] * pixel_width(job->guide);
  if (is_sample(&job->history->incident[pixel]) && job->history->count[pixel] > 0.0f) {
    m.inverse_distance = job->history->incident[pixel].inverse_distance;
    m.narrowing = 1.0f / sqrtf(job->history->count[pixel]);
  }
  return m;
}

static float gaussian(float squared_over_variance) { return expf(-0.5f * squared_over_variance); }

// Diffuse light changes over the distance to what it comes from, glossy light over the width of the lobe where it ends.
static float reach_weight(const filter_job *job, const middle *m, size_t tap, float metres, float pixels) {
  const float reach = job->filter->reach * m->narrowing;
  const float nearness = 0.5f * (m->inverse_distance + job->history->incident[tap].inverse_distance);
  if (job->lobe == OLX_LOBE_DIFFUSE) return gaussian(olx_square(metres * nearness / reach));
  const float alpha = olx_square(job->guide->roughness[m->pixel]), depth = job->guide->depth[m->pixel];
  const float sigma_pixels = reach * alpha / (pixel_width(job->guide) * (1.0f + depth * nearness));
  return pixels > 0.0f ? gaussian(olx_square(pixels / olx_max(sigma_pixels, 1e-3f))) : 1.0f;
}

static float tap_weight(const filter_job *job, const middle *m, int32_t x, int32_t y) {
  const olx_guide *guide = job->guide;
  const size_t tap = (size_t)x + (size_t)guide->width * (size_t)y;
  const float count = job->history->count[tap];
  if (!isfinite(guide->depth[tap]) || !(count > 0.0f) || !is_sample(&job->history->incident[tap])) return 0.0f;
  const float cosine = olx_max(0.0f, olx_dot(guide->normal[tap], m->normal));
  const olx_vec3 offset = olx_sub(olx_guide_position(guide, (uint32_t)x, (uint32_t)y), m->position);
  const float dx = (float)x - (float)m->x, dy = (float)y - (float)m->y, pixels_squared = dx * dx + dy * dy;
  const float sigma = 0.5f * olx_max((float)job->filter->radius_pixels, 1.0f);
  float weight = gaussian(pixels_squared / (sigma * sigma)) * plane_fit(offset, m->normal, m->pixel_metres) *
                 olx_square(olx_square(olx_square(cosine)));
  if (weight <= 0.0f) return 0.0f;
  if (job->lobe == OLX_LOBE_GLOSSY) {
    const float difference = fabsf(guide->roughness[tap] - guide->roughness[m->pixel]);
    weight *= olx_max(0.0f, 1.0f - difference / ROUGHNESS_RANGE);
  }
  if (job->filter->reach > 0.0f) {
    weight *= count * reach_weight(job, m, tap, olx_length(offset), sqrtf(pixels_squared));
  }
  return weight;
}

static olx_vec3 filter_pixel(const filter_job *job, uint32_t x, uint32_t y) {
  const middle m = find_middle(job, x, y);
  const int32_t stride = (int32_t)job->filter->stride_pixels;
  const int32_t steps = (int32_t)job->filter->radius_pixels / stride;
  olx_vec3 sum = {0};
  float weight_sum = 0.0f;
  for (int32_t j = -steps; j <= steps; j++) {
    for (int32_t i = -steps; i <= steps; i++) {
      const int32_t tap_x = (int32_t)x + i * stride, tap_y = (int32_t)y + j * stride;
      if (tap_x < 0 || tap_y < 0 || tap_x >= (int32_t)job->guide->width || tap_y >= (int32_t)job->guide->height)
        continue;
      const float weight = tap_weight(job, &m, tap_x, tap_y);
      if (weight <= 0.0f) continue;
      const size_t tap = (size_t)tap_x + (size_t)job->guide->width * (size_t)tap_y;
      sum = olx_madd(sum, job->history->incident[tap].light, weight);
      weight_sum += weight;
    }
  }
  return weight_sum > LEAST_WEIGHT ? olx_scale(sum, 1.0f / weight_sum) : olx_splat(0.0f);
}

static void filter_row(void *user, uint32_t y) {
  const filter_job *job = user;
  for (uint32_t x = 0; x < job->guide->width; x++) {
    const size_t pixel = x + (size_t)job->guide->width * y;
    job->light[pixel] = isfinite(job->guide->depth[pixel]) ? filter_pixel(job, x, y) : olx_splat(0.0f);
  }
}

olx_result olx_denoise_filter(const olx_lobe_filter *filter, olx_lobe lobe, const olx_guide *guide,
                              const olx_history *history, olx_vec3 *light, uint32_t threads) {
  filter_job job = {.filter = filter, .lobe = lobe, .guide = guide, .history = history, .light = light};
  return olx_parallel_for(guide->height, threads, filter_row, &job, NULL, 0);
}
