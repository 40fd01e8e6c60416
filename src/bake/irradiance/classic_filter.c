// Filters a cube map of radiance into classic maps: an octahedral map, its irradiance, and levels prefiltered for rough
// lobes. The table of reflectances is also integrated here.
#include "bake/irradiance/classic_filter.h"

#include "bake/irradiance/border.h"
#include "core/bsdf.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"
#include "shade/classic.h"

#include <string.h>

olx_cube_face olx_cube_face_of(uint32_t face) {
  static const olx_cube_face faces[OLX_CUBE_FACES] = {
      {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}};
  return faces[face];
}

uint32_t olx_classic_sharpness(uint32_t size, uint32_t cube_size) {
  const uint32_t octahedral = size * size / 2, cube = cube_size * cube_size;
  const uint32_t sharpness = octahedral < cube ? octahedral : cube;
  return sharpness < 65536 ? sharpness : 65536;
}

// Lobes are cut off where they fall below this share of their peak.
static const float lobe_floor = 0.0025f;

static float power(float base, uint32_t exponent) {
  float result = 1.0f;
  for (; exponent; exponent >>= 1, base *= base) {
    if (exponent & 1u) result *= base;
  }
  return result;
}

// Finds the range of texels along one axis of a face that a cone may reach. `along` and `across` are the coordinates of
// the cone's direction along the face's axis and along this one.
static bool reach(float along, float across, float angle, uint32_t size, uint32_t *first, uint32_t *end) {
  const float length = sqrtf(along * along + across * across), sine = sinf(angle);
  float low = -0.25f * OLX_PI, high = 0.25f * OLX_PI;
  if (sine < length) {
    const float middle = atan2f(across, along), half = asinf(sine / length);
    low = olx_max(low, middle - half);
    high = olx_min(high, middle + half);
  }
  if (low >= high) return false;
  const float scale = 0.5f * (float)size;
  *first = (uint32_t)olx_clamp((tanf(low) + 1.0f) * scale, 0.0f, (float)(size - 1));
  *end = (uint32_t)olx_clamp(ceilf((tanf(high) + 1.0f) * scale), 1.0f, (float)size);
  return true;
}

// Filters cube texels in a direction, weighted by a power of the cosine and by solid angle (equation 4.9 of the
// dissertation).
static olx_vec3 resample(const olx_classic_filter *f, olx_vec3 direction) {
  const uint32_t n = f->cube_size;
  const float angle = acosf(powf(lobe_floor, 1.0f / (float)f->sharpness));
  olx_vec3 sum = {0}, nearest = {0};
  float weights = 0.0f, closest = -1.0f;
  for (uint32_t face = 0; face < OLX_CUBE_FACES; face++) {
    const olx_cube_face basis = olx_cube_face_of(face);
    const olx_vec3 d =
        olx_v3(olx_dot(direction, basis.axis), olx_dot(direction, basis.right), olx_dot(direction, basis.up));
    uint32_t x0, x1, y0, y1;
    if (d.x <= 0.3f || !reach(d.x, d.y, angle, n, &x0, &x1) || !reach(d.x, d.z, angle, n, &y0, &y1)) continue;
    for (uint32_t y = y0; y < y1; y++) {
      for (uint32_t x = x0; x < x1; x++) {
        const uint32_t texel = y * n + x;
        const float cosine = olx_dot(d, f->face_direction[texel]);
        const olx_vec3 radiance = f->cube[(size_t)face * n * n + texel];
        if (cosine > closest) {
          closest = cosine;
          nearest = radiance;
        }
        const float lobe = power(olx_max(cosine, 0.0f), f->sharpness);
        if (lobe < lobe_floor) continue;
        sum = olx_madd(sum, radiance, lobe * f->face_solid_angle[texel]);
        weights += lobe * f->face_solid_angle[texel];
      }
    }
  }
  return weights > 0.0f ? olx_scale(sum, 1.0f / weights) : nearest;
}

static void resample_job(void *user, uint32_t y) {
  const olx_classic_filter *f = user;
  for (uint32_t x = 0; x < f->size; x++) {
    const olx_vec3 radiance = resample(f, olx_texel_direction(x, y, f->size));
    f->chain[0][(size_t)(y + 1) * (f->size + 2) + x + 1] = radiance;
    f->levels[0][(size_t)y * f->size + x] = radiance;
  }
}

// Averages four texels, weighted by solid angle.
static void average(const olx_vec3 *finer, uint32_t finer_side, olx_vec3 *coarser) {
  const uint32_t side = finer_side / 2, stride = side + 2, finer_stride = finer_side + 2;
  for (uint32_t y = 0; y < side; y++) {
    for (uint32_t x = 0; x < side; x++) {
      olx_vec3 sum = {0};
      float weights = 0.0f;
      for (uint32_t i = 0; i < 4; i++) {
        const uint32_t fx = 2 * x + (i & 1u), fy = 2 * y + (i >> 1);
        const float weight = (float)olx_texel_solid_angle(fx, fy, finer_side);
        sum = olx_madd(sum, finer[(fy + 1) * finer_stride + fx + 1], weight);
        weights += weight;
      }
      coarser[(y + 1) * stride + x + 1] = olx_scale(sum, 1.0f / weights);
    }
  }
  olx_fill_border(coarser, side, sizeof *coarser);
}

static olx_vec3 chain_texel(const olx_classic_filter *f, uint32_t level, olx_vec2 uv) {
  const olx_bilinear b = olx_bilinear_at(uv, f->size >> level);
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < 4; i++) sum = olx_madd(sum, f->chain[level][b.index[i]], b.weight[i]);
  return sum;
}

static olx_vec3 chain_look_up(const olx_classic_filter *f, olx_vec3 direction, float level) {
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const uint32_t below = (uint32_t)level;
  const olx_vec3 fine = chain_texel(f, below, uv);
  if (below + 1 >= f->chain_levels || level <= (float)below) return fine;
  return olx_mix3(fine, chain_texel(f, below + 1, uv), level - (float)below);
}

// Draws samples of the lobe for a view direction along the normal.
static void draw_lobe(olx_classic_filter *f, uint32_t level) {
  const float roughness = olx_classic_level_roughness(level), alpha = roughness * roughness;
  const float texel = 4.0f * OLX_PI / ((float)f->size * (float)f->size);
  for (uint32_t i = 0; i < OLX_CLASSIC_SAMPLES; i++) {
    const olx_vec2 random = olx_hammersley(i, OLX_CLASSIC_SAMPLES);
    const float cosine2 = (1.0f - random.x) / (1.0f + (alpha * alpha - 1.0f) * random.x), cosine = sqrtf(cosine2);
    const float sine = sqrtf(olx_max(0.0f, 1.0f - cosine2)), phi = 2.0f * OLX_PI * random.y;
    const olx_vec3 half = olx_v3(sine * cosf(phi), sine * sinf(phi), cosine);
    const olx_vec3 light = olx_reflect(olx_v3(0.0f, 0.0f, -1.0f), half);
    if (light.z <= 0.0f) continue;
    const float pdf = 0.25f * olx_ggx_distribution(alpha, half);
    const float apart = 0.5f * log2f(1.0f / ((float)OLX_CLASSIC_SAMPLES * pdf * texel));
    f->lobe[level][f->lobe_count[level]++] =
        (olx_lobe_sample){.direction = light,
                          .weight = olx_classic_masking(alpha, light.z),
                          .level = olx_clamp(apart, 0.0f, (float)(f->chain_levels - 1))};
  }
}

typedef struct prefilter_work {
  const olx_classic_filter *filter;
  uint32_t level;
} prefilter_work;

static void prefilter_job(void *user, uint32_t y) {
  const prefilter_work *work = user;
  const olx_classic_filter *f = work->filter;
  const uint32_t side = olx_classic_side(f->size, work->level), count = f->lobe_count[work->level];
  for (uint32_t x = 0; x < side; x++) {
    const olx_vec3 mirror = olx_texel_direction(x, y, side);
    olx_vec3 tangent, bitangent, sum = {0};
    float weights = 0.0f;
    olx_basis(mirror, &tangent, &bitangent);
    for (uint32_t i = 0; i < count; i++) {
      const olx_lobe_sample *s = &f->lobe[work->level][i];
      const olx_vec3 direction =
          olx_madd(olx_madd(olx_scale(tangent, s->direction.x), bitangent, s->direction.y), mirror, s->direction.z);
      sum = olx_madd(sum, chain_look_up(f, direction, s->level), s->weight);
      weights += s->weight;
    }
    f->levels[work->level][(size_t)y * side + x] = olx_scale(sum, 1.0f / weights);
  }
}

// Integrates irradiance over the hemisphere, weighted by the cosine, exactly over each cell of the octahedral map.
static void irradiance_job(void *user, uint32_t row) {
  const olx_classic_filter *f = user;
  olx_quadrature_irradiance(&f->quadrature, f->cells, f->size, row, f->irradiance, f->size);
}

static void fill_cells(olx_classic_filter *f) {
  const uint32_t side = f->quadrature.cells;
  uint32_t level = 0;
  while (f->size >> level > side) level++;
  for (uint32_t y = 0; y < side; y++) {
    memcpy(f->cells + (size_t)y * side, f->chain[level] + (size_t)(y + 1) * (side + 2) + 1, side * sizeof *f->cells);
  }
}

olx_result olx_classic_filter_run(olx_classic_filter *f, olx_task *task) {
  OLX_TRY(olx_parallel_for(f->size, f->threads, resample_job, f, task, 0));
  olx_fill_border(f->chain[0], f->size, sizeof *f->chain[0]);
  for (uint32_t k = 1; k < f->chain_levels; k++) average(f->chain[k - 1], f->size >> (k - 1), f->chain[k]);
  for (uint32_t level = 1; level < OLX_CLASSIC_LEVELS; level++) {
    prefilter_work work = {f, level};
    OLX_TRY(olx_parallel_for(olx_classic_side(f->size, level), f->threads, prefilter_job, &work, task, 0));
  }
  fill_cells(f);
  return olx_parallel_for(f->size / OLX_BLOCK_ROWS, f->threads, irradiance_job, f, task, 0);
}

static void fill_face(olx_classic_filter *f) {
  const uint32_t n = f->cube_size;
  for (uint32_t i = 0; i < n * n; i++) {
    const float u = (2.0f * (float)(i % n) + 1.0f) / (float)n - 1.0f,
                v = (2.0f * (float)(i / n) + 1.0f) / (float)n - 1.0f;
    const float length = sqrtf(1.0f + u * u + v * v);
    f->face_direction[i] = olx_scale(olx_v3(1.0f, u, v), 1.0f / length);
    f->face_solid_angle[i] = 4.0f / ((float)n * (float)n * length * length * length);
  }
}

olx_result olx_classic_filter_create(olx_classic_filter *f) {
  const size_t texels = (size_t)f->size * f->size, face = (size_t)f->cube_size * f->cube_size;
  OLX_TRY(olx_quadrature_create(f->size, &f->quadrature));
  f->cube = olx_allocate(OLX_CUBE_FACES * face, sizeof *f->cube);
  f->irradiance = olx_allocate(texels, sizeof *f->irradiance);
  f->cells = olx_allocate((size_t)f->quadrature.cells * f->quadrature.cells, sizeof *f->cells);
  f->face_direction = olx_allocate(face, sizeof *f->face_direction);
  f->face_solid_angle = olx_allocate(face, sizeof *f->face_solid_angle);
  bool complete = f->cube && f->irradiance && f->cells && f->face_direction && f->face_solid_angle;
  for (uint32_t side = f->size; side >= OLX_CLASSIC_LEAST_SIDE && complete; side /= 2) {
    f->chain[f->chain_levels] = olx_allocate((size_t)(side + 2) * (side + 2), sizeof(olx_vec3));
    complete = f->chain[f->chain_levels++] != NULL;
  }
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS && complete; level++) {
    const size_t side = olx_classic_side(f->size, level);
    f->levels[level] = olx_allocate(side * side, sizeof *f->levels[level]);
    f->lobe[level] = olx_allocate(OLX_CLASSIC_SAMPLES, sizeof *f->lobe[level]);
    complete = f->levels[level] && f->lobe[level];
  }
  if (!complete) {
    olx_classic_filter_free(f);
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for cube maps of %u texels", f->cube_size);
  }
  fill_face(f);
  for (uint32_t level = 1; level < OLX_CLASSIC_LEVELS; level++) draw_lobe(f, level);
  return OLX_OK;
}

void olx_classic_filter_free(olx_classic_filter *f) {
  olx_quadrature_free(&f->quadrature);
  olx_release(f->cube);
  olx_release(f->irradiance);
  olx_release(f->cells);
  olx_release(f->face_direction);
  olx_release(f->face_solid_angle);
  for (uint32_t k = 0; k < OLX_CLASSIC_CHAIN; k++) olx_release(f->chain[k]);
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    olx_release(f->levels[level]);
    olx_release(f->lobe[level]);
  }
  *f = (olx_classic_filter){0};
}

// Half vectors are the distribution's at the midpoints of ROWS x COLUMNS strata; by symmetry, those on one side of the
// view plane suffice. Rows are denser towards the horizon, where few half vectors are drawn and each has a large
// weight.
enum { ROWS = 64, COLUMNS = 16 };
static const float least_cosine = 1e-4f, least_roughness = 1e-2f; // smaller values are clamped to these

olx_vec2 olx_classic_integrate(float cosine, float roughness) {
  cosine = olx_max(cosine, least_cosine);
  roughness = olx_max(roughness, least_roughness);
  const float alpha = roughness * roughness, k = 0.5f * alpha;
  const olx_vec3 view = olx_v3(sqrtf(olx_max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
  double scale = 0.0, bias = 0.0;
  for (uint32_t row = 0; row < ROWS; row++) {
    const float rest = 1.0f - ((float)row + 0.5f) / ROWS, u = 1.0f - rest * rest * rest, crowding = 3.0f * rest * rest;
    const float nh2 = (1.0f - u) / (1.0f + (alpha * alpha - 1.0f) * u), nh = sqrtf(nh2);
    const float sine = sqrtf(olx_max(0.0f, 1.0f - nh2));
    for (uint32_t column = 0; column < COLUMNS; column++) {
      const float phi = OLX_PI * ((float)column + 0.5f) / COLUMNS;
      const float vh = sine * cosf(phi) * view.x + nh * view.z, light = 2.0f * vh * nh - view.z;
      if (light <= 0.0f || vh <= 0.0f) continue;
      // The BRDF times the cosine over the density of the light's direction, without Fresnel: G vh / (nh nv).
      const float weight = crowding * olx_classic_masking(alpha, light) * vh / (nh * (cosine * (1.0f - k) + k));
      const float fresnel = olx_pow5(olx_clamp(1.0f - vh, 0.0f, 1.0f));
      scale += (double)(weight * (1.0f - fresnel));
      bias += (double)(weight * fresnel);
    }
  }
  return (olx_vec2){(float)(scale / (ROWS * COLUMNS)), (float)(bias / (ROWS * COLUMNS))};
}

static void table_job(void *user, uint32_t row) {
  uint32_t *table = user;
  const float last = (float)(OLX_CLASSIC_TABLE_SIDE - 1);
  for (uint32_t x = 0; x < OLX_CLASSIC_TABLE_SIDE; x++) {
    const olx_vec2 value = olx_classic_integrate(olx_square((float)x / last), (float)row / last);
    table[row * OLX_CLASSIC_TABLE_SIDE + x] = olx_half_pack(value.x) | (uint32_t)olx_half_pack(value.y) << 16;
  }
}

olx_result olx_classic_table_make(uint32_t *table, uint32_t threads) {
  return olx_parallel_for(OLX_CLASSIC_TABLE_SIDE, threads, table_job, table, NULL, 0);
}
