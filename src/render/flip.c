// Computes LDR-FLIP (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, HPG 2020): differences of colour
// that the eye can resolve, in a space where distances match perception, amplified by those of edges and points.
#include "render/perceptual.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/vec.h"

#include <math.h>
#include <string.h>

// Radius in pixels of the largest kernel, 3 standard deviations of sqrt(0.04 / 2) / pi degrees.
#define MAX_RADIUS 136
#define PLANES 5 // planes per image: three of colour, one of edges, one of points

typedef struct kernel {
  int radius;
  float weights[2 * MAX_RADIUS + 1];
} kernel;

typedef struct picture {
  const uint8_t *rgb;
  float *color[3]; // YCxCz, then filtered, then Hunt-adjusted L*a*b*
  float *edges, *points;
} picture;

typedef struct flip {
  uint32_t width, height, threads;
  float pixels_per_degree;
  picture pictures[2];
  float *scratch[3];
  float srgb_to_linear[256];
  float *map;
} flip;

// Converts linear Rec.709 to CIE XYZ relative to the white point (D65: 0.3127, 0.3290), so that white is (1, 1, 1).
static olx_vec3 to_xyz(olx_vec3 c) {
  return olx_v3(0.433887346f * c.x + 0.376224009f * c.y + 0.189888645f * c.z,
                0.212639006f * c.x + 0.715168679f * c.y + 0.072192315f * c.z,
                0.017750040f * c.x + 0.109447621f * c.y + 0.872802339f * c.z);
}

static olx_vec3 from_xyz(olx_vec3 c) {
  return olx_v3(3.080399091f * c.x - 1.537383178f * c.y - 0.543015913f * c.z,
                -0.921223359f * c.x + 1.875967502f * c.y + 0.045255857f * c.z,
                0.052873939f * c.x - 0.203976959f * c.y + 1.151103020f * c.z);
}

static olx_vec3 xyz_to_ycxcz(olx_vec3 c) {
  return olx_v3(116.0f * c.y - 16.0f, 500.0f * (c.x - c.y), 200.0f * (c.y - c.z));
}

static olx_vec3 ycxcz_to_xyz(olx_vec3 c) {
  const float y = (c.x + 16.0f) / 116.0f;
  return olx_v3(c.y / 500.0f + y, y, y - c.z / 200.0f);
}

static float lab_curve(float t) {
  const float delta = 6.0f / 29.0f;
  return t > delta * delta * delta ? cbrtf(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

// Converts to CIE L*a*b* with a* and b* scaled by lightness: colour is less visible in the dark (the Hunt effect).
static olx_vec3 hunt_lab(olx_vec3 linear) {
  const olx_vec3 xyz = to_xyz(linear);
  const float x = lab_curve(xyz.x), y = lab_curve(xyz.y), z = lab_curve(xyz.z), lightness = 116.0f * y - 16.0f;
  return olx_v3(lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z));
}

static float hyab(olx_vec3 a, olx_vec3 b) {
  return fabsf(a.x - b.x) + sqrtf(olx_square(a.y - b.y) + olx_square(a.z - b.z));
}

// Returns a Gaussian, or its first or second derivative, normalized so that positive weights sum to 1 and negative ones
// to -1. The product with a Gaussian across keeps these sums in two dimensions.
static kernel gaussian(double sigma, int radius, int derivative) {
  kernel k = {.radius = radius};
  double values[2 * MAX_RADIUS + 1] = {0.0}, positive = 0.0, negative = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    const double bell = exp(-i * i / (2.0 * sigma * sigma));
    const double value = derivative == 0 ? bell : derivative == 1 ? -i * bell : (i * i / (sigma * sigma) - 1.0) * bell;
    if (value > 0.0) positive += value;
    else negative -= value;
    values[i + radius] = value;
  }
  for (int i = 0; i <= 2 * radius; ++i) {
    const double sum = values[i] > 0.0 ? positive : negative;
    k.weights[i] = sum > 0.0 ? (float)(values[i] / sum) : 0.0f;
  }
  return k;
}

typedef struct filter_job {
  const flip *f;
  const kernel *k;
  const float *in;
  float *out;
} filter_job;

// Filters a row; pixels beyond the border repeat the border.
static void filter_along_row(void *user, uint32_t y) {
  const filter_job *job = user;
  const int width = (int)job->f->width, radius = job->k->radius;
  const float *in = job->in + (size_t)y * job->f->width;
  float *out = job->out + (size_t)y * job->f->width;
  memset(out, 0, (size_t)width * sizeof *out);
  for (int i = -radius; i <= radius; ++i) {
    const float weight = job->k->weights[i + radius];
    const int first = i < 0 ? (-i < width ? -i : width) : 0, last = i > 0 ? (i < width ? width - i : 0) : width;
    for (int x = 0; x < first; ++x) out[x] += weight * in[0];
    for (int x = first; x < last; ++x) out[x] += weight * in[x + i];
    for (int x = last; x < width; ++x) out[x] += weight * in[width - 1];
  }
}

static void filter_across_rows(void *user, uint32_t y) {
  const filter_job *job = user;
  const int width = (int)job->f->width, height = (int)job->f->height, radius = job->k->radius;
  float *out = job->out + (size_t)y * job->f->width;
  memset(out, 0, (size_t)width * sizeof *out);
  for (int i = -radius; i <= radius; ++i) {
    const int row = (int)y + i < 0 ? 0 : (int)y + i >= height ? height - 1 : (int)y + i;
    const float weight = job->k->weights[i + radius], *in = job->in + (size_t)row * job->f->width;
    for (int x = 0; x < width; ++x) out[x] += weight * in[x];
  }
}

static olx_result filter(const flip *f, const kernel *across, const kernel *down, const float *in, float *out) {
  filter_job along = {f, across, in, f->scratch[0]}, columns = {f, down, f->scratch[0], out};
  OLX_TRY(olx_parallel_for(f->height, f->threads, filter_along_row, &along, NULL, 0));
  return olx_parallel_for(f->height, f->threads, filter_across_rows, &columns, NULL, 0);
}

static size_t pixel_count(const flip *f) { return (size_t)f->width * f->height; }

// Returns the radius of a kernel in pixels.
static int radius_of(double sigma_pixels) { return (int)ceil(3.0 * sigma_pixels); }

// Filters one channel by its contrast sensitivity function (section 4.1.1, table 1), a sum of at most two Gaussians a
// sqrt(pi / b) exp(-(pi x)^2 / b) of x in degrees.
static olx_result filter_contrast(const flip *f, float *channel, const double a[2], const double b[2]) {
  const double degree = (double)f->pixels_per_degree;
  const int radius = radius_of(sqrt(0.04 / 2.0) / (double)OLX_PI * degree); // the widest kernel's, for all channels
  double volumes[2] = {0.0, 0.0};
  for (int i = 0; i < 2; ++i) {
    if (a[i] == 0.0) continue;
    double sum = 0.0;
    const double sigma = sqrt(b[i] / 2.0) / (double)OLX_PI * degree;
    const kernel k = gaussian(sigma, radius, 0);
    for (int x = -radius; x <= radius; ++x) sum += exp(-x * x / (2.0 * sigma * sigma));
    volumes[i] = a[i] * sqrt((double)OLX_PI / b[i]) * sum * sum;
    OLX_TRY(filter(f, &k, &k, channel, f->scratch[1 + i]));
  }
  const float first = (float)(volumes[0] / (volumes[0] + volumes[1])), second = 1.0f - first;
  for (size_t i = 0; i < pixel_count(f); ++i) {
    channel[i] = volumes[1] > 0.0 ? first * f->scratch[1][i] + second * f->scratch[2][i] : f->scratch[1][i];
  }
  return OLX_OK;
}

static olx_vec3 color_at(const picture *p, size_t i) { return olx_v3(p->color[0][i], p->color[1][i], p->color[2][i]); }

static void set_color(const picture *p, size_t i, olx_vec3 color) {
  p->color[0][i] = color.x;
  p->color[1][i] = color.y;
  p->color[2][i] = color.z;
}

// Computes the strength of the features that a derivative of the Gaussian detects in lightness (section 4.2).
static olx_result find_features(const flip *f, const picture *p, int derivative, float *strength) {
  const double sigma = 0.5 * 0.082 * (double)f->pixels_per_degree;
  const kernel bell = gaussian(sigma, radius_of(sigma), 0), slope = gaussian(sigma, radius_of(sigma), derivative);
  OLX_TRY(filter(f, &slope, &bell, p->color[0], f->scratch[1]));
  OLX_TRY(filter(f, &bell, &slope, p->color[0], f->scratch[2]));
  for (size_t i = 0; i < pixel_count(f); ++i) {
    strength[i] = sqrtf(olx_square(f->scratch[1][i]) + olx_square(f->scratch[2][i])) / 116.0f;
  }
  return OLX_OK;
}

static void to_hunt_lab(void *user, uint32_t y) {
  const flip *f = user;
  for (size_t i = (size_t)y * f->width; i < (size_t)(y + 1) * f->width; ++i) {
    for (int k = 0; k < 2; ++k) {
      const olx_vec3 linear = from_xyz(ycxcz_to_xyz(color_at(&f->pictures[k], i)));
      set_color(&f->pictures[k], i, hunt_lab(olx_min_each(olx_max_each(linear, olx_splat(0.0f)), olx_splat(1.0f))));
    }
  }
}

static olx_result prepare(const flip *f, const picture *p) {
  static const double a[3][2] = {{1.0, 0.0}, {1.0, 0.0}, {34.1, 13.5}};
  static const double b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
  for (size_t i = 0; i < pixel_count(f); ++i) {
    const uint8_t *rgb = p->rgb + 3 * i;
    const olx_vec3 linear = olx_v3(f->srgb_to_linear[rgb[0]], f->srgb_to_linear[rgb[1]], f->srgb_to_linear[rgb[2]]);
    set_color(p, i, xyz_to_ycxcz(to_xyz(linear)));
  }
  OLX_TRY(find_features(f, p, 1, p->edges));
  OLX_TRY(find_features(f, p, 2, p->points));
  for (int channel = 0; channel < 3; ++channel) OLX_TRY(filter_contrast(f, p->color[channel], a[channel], b[channel]));
  return OLX_OK;
}

// Redistributes differences of colour: those up to 0.4 of the largest one use 0.95 of the range (section 4.1.3).
static float redistribute(float difference, float largest) {
  const float knee = 0.4f * largest, knee_value = 0.95f;
  if (difference < knee) return difference * knee_value / knee;
  return knee_value + (difference - knee) / (largest - knee) * (1.0f - knee_value);
}

static void combine(void *user, uint32_t y) {
  const flip *f = user;
  const picture *a = &f->pictures[0], *b = &f->pictures[1];
  const float largest = powf(hyab(hunt_lab(olx_v3(0.0f, 1.0f, 0.0f)), hunt_lab(olx_v3(0.0f, 0.0f, 1.0f))), 0.7f);
  for (size_t i = (size_t)y * f->width; i < (size_t)(y + 1) * f->width; ++i) {
    const float color = redistribute(powf(hyab(color_at(a, i), color_at(b, i)), 0.7f), largest);
    const float feature = olx_max(fabsf(a->edges[i] - b->edges[i]), fabsf(a->points[i] - b->points[i]));
    f->map[i] = powf(color, 1.0f - sqrtf(feature / sqrtf(2.0f)));
  }
}

static olx_result evaluate(flip *f) {
  for (int i = 0; i < 256; ++i) {
    const double encoded = i / 255.0;
    f->srgb_to_linear[i] = (float)(encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4));
  }
  for (int k = 0; k < 2; ++k) OLX_TRY(prepare(f, &f->pictures[k]));
  OLX_TRY(olx_parallel_for(f->height, f->threads, to_hunt_lab, f, NULL, 0));
  return olx_parallel_for(f->height, f->threads, combine, f, NULL, 0);
}

olx_result olx_flip(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height, float pixels_per_degree,
                    uint32_t threads, float *map) {
  flip f = {.width = width, .height = height, .threads = threads, .pixels_per_degree = pixels_per_degree, .map = map};
  const size_t pixels = pixel_count(&f);
  float *memory = olx_allocate(pixels, (2 * PLANES + 3) * sizeof *memory), *next = memory;
  if (!memory) return olx_fail(OLX_ERROR_MEMORY, "no memory to compare %ux%u pixels", width, height);
  for (int i = 0; i < 3; ++i, next += pixels) f.scratch[i] = next;
  for (int k = 0; k < 2; ++k) {
    picture *p = &f.pictures[k];
    p->rgb = k == 0 ? a : b;
    for (int i = 0; i < 3; ++i, next += pixels) p->color[i] = next;
    p->edges = next;
    p->points = next + pixels;
    next += 2 * pixels;
  }
  const olx_result result = evaluate(&f);
  olx_release(memory);
  return result;
}
