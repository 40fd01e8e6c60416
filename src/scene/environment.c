// Evaluates the radiance of an environment, and samples directions in proportion to the luminance of its image.
#include "scene/environment.h"

#include "core/distribution.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

static olx_vec3 texel(const olx_environment *e, int32_t x, int32_t y) {
  const int32_t width = (int32_t)e->width, height = (int32_t)e->height;
  const int32_t column = x < 0 ? x + width : x >= width ? x - width : x;
  const int32_t row = y < 0 ? 0 : y >= height ? height - 1 : y;
  const float *rgb = e->texels + 3 * ((size_t)row * e->width + (size_t)column);
  return olx_v3(rgb[0], rgb[1], rgb[2]);
}

// Returns the image coordinates in [0, 1) of a direction.
static olx_vec2 image_uv(const olx_environment *e, olx_vec3 direction) {
  const float across = sqrtf(direction.x * direction.x + direction.z * direction.z);
  const float u = (atan2f(direction.z, direction.x) + e->rotation_radians) * (0.5f / OLX_PI) + 0.5f;
  const float v = atan2f(across, direction.y) * (1.0f / OLX_PI);
  return (olx_vec2){olx_min(u - floorf(u), 0x1.fffffep-1f), olx_min(v, 0x1.fffffep-1f)};
}

olx_vec3 olx_environment_lookup(const olx_environment *e, olx_vec3 direction) {
  if (!e->texels) return e->radiance;
  const olx_vec2 uv = image_uv(e, direction);
  const float px = uv.x * (float)e->width - 0.5f, py = uv.y * (float)e->height - 0.5f;
  const float fx = floorf(px), fy = floorf(py);
  const int32_t x = (int32_t)fx, y = (int32_t)fy;
  const olx_vec3 upper = olx_mix3(texel(e, x, y), texel(e, x + 1, y), px - fx);
  const olx_vec3 lower = olx_mix3(texel(e, x, y + 1), texel(e, x + 1, y + 1), px - fx);
  return olx_mul(e->radiance, olx_mix3(upper, lower, py - fy));
}

// Returns the solid angle of a texel of row y.
static float texel_solid_angle(const olx_environment *e, uint32_t y) {
  const float half_step = 0.5f * OLX_PI / (float)e->height;
  return 4.0f * OLX_PI / (float)e->width * sinf(half_step * (float)(2 * y + 1)) * sinf(half_step);
}

// Returns the mean luminance of bilinear samples over the texel.
static float texel_luminance(const olx_environment *e, int32_t x, int32_t y) {
  static const float tent[3] = {0.125f, 0.75f, 0.125f};
  float sum = 0.0f;
  for (int32_t j = 0; j < 3; j++) {
    for (int32_t i = 0; i < 3; i++) {
      sum += tent[i] * tent[j] * olx_luminance(olx_mul(e->radiance, texel(e, x + i - 1, y + j - 1)));
    }
  }
  return olx_max(sum, 0.0f);
}

// The mean square of luminance over directions is at most this multiple of its squared mean in an even environment.
static const double MOST_UNEVEN = 16.0;

static void measure(const olx_environment *e, olx_environment_sampler *sampler) {
  double weight = 0.0, light = 0.0, square = 0.0;
  for (uint32_t y = 0; y < e->height; y++) {
    const double angle = (double)texel_solid_angle(e, y);
    for (uint32_t x = 0; x < e->width; x++) {
      const double luminance = (double)texel_luminance(e, (int32_t)x, (int32_t)y);
      weight += angle;
      light += angle * luminance;
      square += angle * luminance * luminance;
    }
  }
  sampler->mean = (float)(light / weight);
  sampler->even = square * weight <= MOST_UNEVEN * light * light;
}

olx_result olx_environment_sampler_create(const olx_environment *e, olx_environment_sampler *sampler) {
  *sampler = (olx_environment_sampler){.lit = olx_max3(e->radiance) > 0.0f};
  sampler->even = sampler->lit;
  sampler->mean = olx_luminance(e->radiance);
  if (!e->texels || !sampler->lit) return OLX_OK;
  measure(e, sampler);
  const size_t stride = (size_t)e->width + 1;
  sampler->row_sums = olx_allocate((size_t)e->height + 1, sizeof(float));
  sampler->column_sums = olx_allocate(stride * e->height, sizeof(float));
  if (!sampler->row_sums || !sampler->column_sums) {
    olx_environment_sampler_free(sampler);
    return olx_fail(OLX_ERROR_MEMORY, "environment: no memory to sample an image of %u x %u texels", e->width,
                    e->height);
  }
  for (uint32_t y = 0; y < e->height; y++) {
    float *columns = sampler->column_sums + stride * y;
    double row_weight = 0.0;
    for (uint32_t x = 0; x < e->width; x++) {
      columns[x] = texel_luminance(e, (int32_t)x, (int32_t)y);
      row_weight += (double)columns[x];
    }
    sampler->row_sums[y] = (float)(row_weight * (double)texel_solid_angle(e, y));
    olx_distribution_build(columns, e->width, columns);
  }
  sampler->lit = olx_distribution_build(sampler->row_sums, e->height, sampler->row_sums);
  return OLX_OK;
}

void olx_environment_sampler_free(olx_environment_sampler *sampler) {
  olx_release(sampler->row_sums);
  olx_release(sampler->column_sums);
  *sampler = (olx_environment_sampler){0};
}

static float texel_density(const olx_environment *e, const olx_environment_sampler *sampler, uint32_t x, uint32_t y) {
  const float row = olx_distribution_probability(sampler->row_sums, y);
  if (row <= 0.0f) return 0.0f;
  const float *columns = sampler->column_sums + ((size_t)e->width + 1) * y;
  return row * olx_distribution_probability(columns, x) / texel_solid_angle(e, y);
}

olx_vec3 olx_environment_draw(const olx_environment *e, const olx_environment_sampler *sampler, olx_vec2 random,
                              float *pdf) {
  if (!e->texels) {
    *pdf = 0.25f / OLX_PI;
    return olx_sample_sphere(random);
  }
  float rest_x, rest_y;
  const uint32_t y = olx_distribution_draw(sampler->row_sums, e->height, random.y, &rest_y);
  const float *columns = sampler->column_sums + ((size_t)e->width + 1) * y;
  const uint32_t x = olx_distribution_draw(columns, e->width, random.x, &rest_x);
  *pdf = texel_density(e, sampler, x, y);
  // Uniform over the texel's solid angle: (1 - cos theta) / 2 = sin(theta / 2)^2 is uniform between its edges.
  const float step = 0.5f * OLX_PI / (float)e->height;
  const float upper = olx_square(sinf(step * (float)y)), lower = olx_square(sinf(step * (float)(y + 1)));
  const float s = olx_mix(upper, lower, rest_y), sine = 2.0f * sqrtf(olx_max(s * (1.0f - s), 0.0f));
  const float phi = (((float)x + rest_x) / (float)e->width - 0.5f) * 2.0f * OLX_PI - e->rotation_radians;
  return olx_v3(sine * cosf(phi), 1.0f - 2.0f * s, sine * sinf(phi));
}

olx_vec2 olx_environment_point(const olx_environment *e, const olx_environment_sampler *sampler, olx_vec3 direction) {
  if (!e->texels) {
    const float turns = atan2f(direction.y, direction.x) * (0.5f / OLX_PI);
    return (olx_vec2){0.5f - 0.5f * direction.z, turns < 0.0f ? turns + 1.0f : turns};
  }
  const olx_vec2 uv = image_uv(e, direction);
  const float px = uv.x * (float)e->width;
  const uint32_t x = (uint32_t)px, y = (uint32_t)(uv.y * (float)e->height);
  const float *columns = sampler->column_sums + ((size_t)e->width + 1) * y;
  const float step = 0.5f * OLX_PI / (float)e->height, s = 0.5f - 0.5f * direction.y;
  const float upper = olx_square(sinf(step * (float)y)), lower = olx_square(sinf(step * (float)(y + 1)));
  const float rest_y = olx_clamp((s - upper) / (lower - upper), 0.0f, 1.0f);
  return (olx_vec2){olx_mix(columns[x], columns[x + 1], px - (float)x),
                    olx_mix(sampler->row_sums[y], sampler->row_sums[y + 1], rest_y)};
}

float olx_environment_density(const olx_environment *e, const olx_environment_sampler *sampler, olx_vec3 direction) {
  if (!sampler->lit) return 0.0f;
  if (!e->texels) return 0.25f / OLX_PI;
  const olx_vec2 uv = image_uv(e, direction);
  return texel_density(e, sampler, (uint32_t)(uv.x * (float)e->width), (uint32_t)(uv.y * (float)e->height));
}
