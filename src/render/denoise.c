// Denoises one ray per pixel (McGuire et al. 2017, section 5.1): blends it into the history of its surface, found by
// reprojection, and filters along rows and columns across pixels of that surface. Its twin is shaders/lib/denoise.glsl.
#include "render/denoise.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

#include <stdlib.h>
#include <string.h>

// The accumulated value at a surface point: the mean over `count` frames.
typedef struct known {
  olx_incident incident;
  float count;
} known;

static const known nothing_known = {.incident = {.inverse_distance = -1.0f}};

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
  for (size_t i = 0; i < pixels; i++) history->incident[i] = nothing_known.incident;
  memset(history->count, 0, pixels * sizeof *history->count);
}

// ---- Positions of pixels

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

// The surface that a pixel shows.
typedef struct shown {
  olx_vec3 position, normal;
  float depth, roughness;
  float pixel_angle; // width of a pixel at depth 1
} shown;

// Returns the width of a pixel at depth 1.
static float pixel_angle(const olx_guide *guide) { return 2.0f * olx_length(guide->camera.up) / (float)guide->height; }

static shown show(const olx_guide *guide, uint32_t x, uint32_t y) {
  const size_t pixel = x + (size_t)guide->width * y;
  return (shown){.position = olx_guide_position(guide, x, y),
                 .normal = guide->normal[pixel],
                 .depth = guide->depth[pixel],
                 .roughness = guide->roughness[pixel],
                 .pixel_angle = pixel_angle(guide)};
}

// Returns how well a point fits the plane through another: from 1 on the plane to 0 on another surface.
static float plane_fit(olx_vec3 offset, olx_vec3 normal, float pixel_metres) {
  const float tolerance = OLX_PLANE_PIXELS * pixel_metres + OLX_PLANE_SLOPE * olx_length(offset);
  return olx_max(0.0f, 1.0f - fabsf(olx_dot(offset, normal)) / tolerance);
}

static bool is_sample(olx_incident incident) {
  return incident.inverse_distance >= 0.0f && isfinite(incident.inverse_distance) && olx_finite(incident.light);
}

// ---- History

// Returns whether another pixel, of this frame or of the previous one, shows the surface that `now` shows.
static bool same_surface(const shown *now, const shown *before) {
  if (!(olx_dot(before->normal, now->normal) > OLX_SAME_NORMAL)) return false;
  return plane_fit(olx_sub(before->position, now->position), now->normal, now->depth * now->pixel_angle) > 0.0f;
}

// Rounds a position in the previous frame to a pixel's centre when it is very close.
static float settle(float at) {
  const float nearest = floorf(at + 0.5f);
  return fabsf(at - nearest) < OLX_STILL_PIXELS ? nearest : at;
}

static bool stands_still(olx_vec2 at, olx_vec2 pixel) {
  return fabsf(at.x - pixel.x) < OLX_STILL_PIXELS && fabsf(at.y - pixel.y) < OLX_STILL_PIXELS;
}

// Returns the bilinear weight of one of the four pixels around a position, `corner` 0 to 3 from the top left.
static float bilinear_weight(olx_vec2 at, uint32_t corner) {
  const float right = at.x - floorf(at.x), bottom = at.y - floorf(at.y);
  return (corner & 1 ? right : 1.0f - right) * (corner >> 1 ? bottom : 1.0f - bottom);
}

// Blends a frame's sample into the history, which it replaces where that is borrowed. History has the weight 1 - 1/n,
// and n stops growing where that reaches `largest`.
static known mix_sample(known past, olx_incident incident, float largest) {
  if (!is_sample(incident)) return past;
  if (past.count < OLX_OWN_COUNT) past = nothing_known;
  const float n = olx_min(past.count + 1.0f, 1.0f / (1.0f - largest)), share = 1.0f / n;
  known result = {.incident = incident, .count = n};
  if (share >= 1.0f) return result;
  result.incident.light = olx_mix3(past.incident.light, incident.light, share);
  result.incident.inverse_distance = olx_mix(past.incident.inverse_distance, incident.inverse_distance, share);
  return result;
}

typedef struct accumulate_job {
  const olx_lobe_filter *filter;
  const olx_ray_turn *turn;
  const olx_guide *now, *before;
  const olx_incident *sample;
  const olx_history *from, *to;
} accumulate_job;

// Reads the history of the surface that `s` shows, from the four pixels around its position in the previous frame.
static known look_back(const accumulate_job *job, const shown *s, olx_vec2 at) {
  const olx_guide *before = job->before;
  known sum = {.count = 0.0f};
  float weight_sum = 0.0f;
  for (uint32_t corner = 0; corner < 4; corner++) {
    const float weight = bilinear_weight(at, corner);
    const int32_t x = (int32_t)floorf(at.x) + (int32_t)(corner & 1), y = (int32_t)floorf(at.y) + (int32_t)(corner >> 1);
    if (weight <= 0.0f || x < 0 || y < 0 || x >= (int32_t)before->width || y >= (int32_t)before->height) continue;
    const size_t tap = (size_t)x + (size_t)before->width * (size_t)y;
    const olx_incident incident = job->from->incident[tap];
    if (!isfinite(before->depth[tap]) || !(job->from->count[tap] > 0.0f) || !is_sample(incident)) continue;
    const shown there = show(before, (uint32_t)x, (uint32_t)y);
    if (!same_surface(s, &there)) continue;
    sum.incident.light = olx_madd(sum.incident.light, incident.light, weight);
    sum.incident.inverse_distance += weight * incident.inverse_distance;
    sum.count += weight * job->from->count[tap];
    weight_sum += weight;
  }
  if (weight_sum < OLX_LEAST_SHARE) return nothing_known;
  sum.incident.light = olx_scale(sum.incident.light, 1.0f / weight_sum);
  sum.incident.inverse_distance /= weight_sum;
  sum.count /= weight_sum;
  return sum;
}

// Returns the sample of the pixel that traced for the square around (x, y). If that pixel shows another surface than
// `s`, the sample counts as nothing: the pixel shows it where it finds no light of its own surface.
static known borrow(const accumulate_job *job, const shown *s, uint32_t x, uint32_t y) {
  const olx_ray_turn *turn = job->turn;
  const uint32_t lender_x = x - x % turn->spacing + turn->x, lender_y = y - y % turn->spacing + turn->y;
  if (lender_x >= job->now->width || lender_y >= job->now->height) return nothing_known;
  const size_t lender = lender_x + (size_t)job->now->width * lender_y;
  if (!isfinite(job->now->depth[lender]) || !is_sample(job->sample[lender])) return nothing_known;
  const shown there = show(job->now, lender_x, lender_y);
  const bool same = same_surface(s, &there) && fabsf(there.roughness - s->roughness) < OLX_ROUGHNESS_RANGE;
  return (known){.incident = job->sample[lender], .count = same ? OLX_BORROWED_COUNT : 0.0f};
}

static known accumulate_pixel(const accumulate_job *job, uint32_t x, uint32_t y) {
  const size_t pixel = x + (size_t)job->now->width * y;
  known past = nothing_known;
  if (!isfinite(job->now->depth[pixel])) return past;
  const shown s = show(job->now, x, y);
  const float columns = (float)job->before->width, rows = (float)job->before->height;
  bool still = false;
  olx_vec2 at;
  if (olx_guide_project(job->before, s.position, &at) && at.x > -1.0f && at.y > -1.0f && at.x < columns &&
      at.y < rows) {
    still = stands_still(at, (olx_vec2){(float)x, (float)y});
    past = look_back(job, &s, (olx_vec2){settle(at.x), settle(at.y)});
  }
  if (!olx_ray_turn_is(job->turn, x, y)) return past.count > 0.0f ? past : borrow(job, &s, x, y);
  return mix_sample(past, job->sample[pixel], still ? job->filter->still_history : job->filter->history);
}

static void accumulate_row(void *user, uint32_t y) {
  const accumulate_job *job = user;
  for (uint32_t x = 0; x < job->now->width; x++) {
    const size_t pixel = x + (size_t)job->now->width * y;
    const known now = accumulate_pixel(job, x, y);
    job->to->incident[pixel] = now.incident;
    job->to->count[pixel] = now.count;
  }
}

olx_result olx_denoise_accumulate(const olx_lobe_filter *filter, const olx_ray_turn *turn, const olx_guide *now,
                                  const olx_incident *sample, const olx_guide *before, const olx_history *from,
                                  const olx_history *to, uint32_t threads) {
  accumulate_job job = {
      .filter = filter, .turn = turn, .now = now, .before = before, .sample = sample, .from = from, .to = to};
  return olx_parallel_for(now->height, threads, accumulate_row, &job, NULL, 0);
}

// ---- Spatial filter

// The properties of a pixel that determine the weights of its neighbours.
typedef struct scales {
  float inverse_distance; // 0 when the pixel has no history
  float narrowing;        // kernels shrink with the noise, which falls with the square root of the number of frames
  bool known;             // whether the pixel has history
} scales;

static scales scales_of(olx_incident incident, float count) {
  if (!is_sample(incident) || !(count > 0.0f)) return (scales){.narrowing = 1.0f};
  return (scales){.inverse_distance = incident.inverse_distance, .narrowing = 1.0f / sqrtf(count), .known = true};
}

static float gaussian(float squared_over_variance) { return expf(-0.5f * squared_over_variance); }

// Returns the weight by distance. Diffuse light varies with the distance to its sources, glossy light with the lobe's
// width where its rays end. `nearness` is the mean inverse distance of the two pixels, which are this many metres and
// pixels apart.
static float reach_weight(olx_lobe lobe, float reach, const shown *middle, float nearness, float metres, float pixels) {
  if (lobe == OLX_LOBE_DIFFUSE) return gaussian(olx_square(metres * nearness / reach));
  const float alpha = olx_square(middle->roughness);
  const float sigma_pixels = reach * alpha / (middle->pixel_angle * (1.0f + middle->depth * nearness));
  return pixels > 0.0f ? gaussian(olx_square(pixels / olx_max(sigma_pixels, 1e-3f))) : 1.0f;
}

// Returns the weight of the pixel `tap`, at this many pixels from the centre pixel.
static float tap_weight(const olx_lobe_filter *filter, olx_lobe lobe, const shown *middle, scales here,
                        const shown *tap, float tap_inverse_distance, float pixels) {
  const float cosine = olx_max(0.0f, olx_dot(tap->normal, middle->normal));
  const olx_vec3 offset = olx_sub(tap->position, middle->position);
  const float sigma = 0.5f * olx_max((float)filter->radius_pixels, 1.0f);
  float weight = gaussian(olx_square(pixels / sigma)) *
                 plane_fit(offset, middle->normal, middle->depth * middle->pixel_angle) *
                 olx_square(olx_square(olx_square(cosine)));
  if (weight <= 0.0f) return 0.0f;
  if (lobe == OLX_LOBE_GLOSSY) {
    weight *= olx_max(0.0f, 1.0f - fabsf(tap->roughness - middle->roughness) / OLX_ROUGHNESS_RANGE);
  }
  if (filter->reach > 0.0f) {
    const float nearness = 0.5f * (here.inverse_distance + olx_max(tap_inverse_distance, 0.0f));
    const float reached =
        reach_weight(lobe, filter->reach * here.narrowing, middle, nearness, olx_length(offset), pixels);
    // However sharp its light is, a pixel without history takes that of the next pixels of its surface, not none.
    weight *= here.known ? reached : olx_max(reached, gaussian(olx_square(pixels)));
  }
  return weight;
}

// Returns the distance in pixels to the tap numbered i of -steps to steps. With a reach taps lie closer to each other
// near the middle, where kernels that narrow weigh most. So pixels also share rows and columns with the next ones,
// without which their noise shows as a pattern of 2 x 2 pixels.
static int32_t tap_distance(const olx_lobe_filter *filter, int32_t i, int32_t steps) {
  const int32_t stride = (int32_t)filter->stride_pixels;
  if (i == 0 || !(filter->reach > 0.0f)) return i * stride;
  return i + (stride - 1) * i * abs(i) / steps;
}

typedef struct filter_job {
  const olx_lobe_filter *filter;
  olx_lobe lobe;
  const olx_guide *guide;
  const olx_history *history;
  const olx_history *rows; // results of the row pass: the light, and the sum of the weights
  olx_vec3 *light;
} filter_job;

// Returns the weighted mean over pixels along a line, of the history or of the row pass. The kernel is separated: the
// column pass weighs each pixel by the sum of weights of its row. Where there is no light, it is what the pixel's
// square has lent, with the weight 0.
static known sum_along(const filter_job *job, uint32_t x, uint32_t y, bool columns) {
  const olx_guide *guide = job->guide;
  const olx_history *from = columns ? job->rows : job->history;
  const size_t pixel = x + (size_t)guide->width * y;
  const shown middle = show(guide, x, y);
  const olx_incident own = job->history->incident[pixel];
  const scales here = scales_of(own, job->history->count[pixel]);
  const int32_t steps = (int32_t)(job->filter->radius_pixels / job->filter->stride_pixels);
  known sum = {.count = 0.0f};
  for (int32_t i = -steps; i <= steps; i++) {
    const int32_t away = tap_distance(job->filter, i, steps);
    const int32_t tap_x = (int32_t)x + (columns ? 0 : away), tap_y = (int32_t)y + (columns ? away : 0);
    if (tap_x < 0 || tap_y < 0 || tap_x >= (int32_t)guide->width || tap_y >= (int32_t)guide->height) continue;
    const size_t tap = (size_t)tap_x + (size_t)guide->width * (size_t)tap_y;
    const float count = from->count[tap];
    if (!isfinite(guide->depth[tap]) || !(count > 0.0f)) continue;
    if (!columns && !is_sample(from->incident[tap])) continue;
    const shown there = show(guide, (uint32_t)tap_x, (uint32_t)tap_y);
    float weight = tap_weight(job->filter, job->lobe, &middle, here, &there,
                              job->history->incident[tap].inverse_distance, fabsf((float)away));
    if (columns || job->filter->reach > 0.0f) weight *= count;
    sum.incident.light = olx_madd(sum.incident.light, from->incident[tap].light, weight);
    sum.count += weight;
  }
  if (sum.count > OLX_LEAST_WEIGHT) sum.incident.light = olx_scale(sum.incident.light, 1.0f / sum.count);
  else sum = (known){.incident.light = is_sample(own) ? own.light : olx_splat(0.0f)};
  return sum;
}

static void filter_along_row(void *user, uint32_t y) {
  const filter_job *job = user;
  for (uint32_t x = 0; x < job->guide->width; x++) {
    const size_t pixel = x + (size_t)job->guide->width * y;
    const known sum = isfinite(job->guide->depth[pixel]) ? sum_along(job, x, y, false) : nothing_known;
    job->rows->incident[pixel] = sum.incident;
    job->rows->count[pixel] = sum.count;
  }
}

static void filter_along_columns(void *user, uint32_t y) {
  const filter_job *job = user;
  for (uint32_t x = 0; x < job->guide->width; x++) {
    const size_t pixel = x + (size_t)job->guide->width * y;
    const bool seen = isfinite(job->guide->depth[pixel]);
    job->light[pixel] = seen ? sum_along(job, x, y, true).incident.light : olx_splat(0.0f);
  }
}

olx_result olx_denoise_filter(const olx_lobe_filter *filter, olx_lobe lobe, const olx_guide *guide,
                              const olx_history *history, const olx_history *rows, olx_vec3 *light, uint32_t threads) {
  filter_job job = {.filter = filter, .lobe = lobe, .guide = guide, .history = history, .rows = rows, .light = light};
  OLX_TRY(olx_parallel_for(guide->height, threads, filter_along_row, &job, NULL, 0));
  return olx_parallel_for(guide->height, threads, filter_along_columns, &job, NULL, 0);
}
