// Integrates over the sphere around a probe without random numbers: irradiance from cells of radiance, and filtered
// moments from cells of distance, eight texels of the result at a time.
#include "bake/irradiance/quadrature.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/widest.h"

#include <stdint.h>
#include <string.h>

// Eight texels of the output at a time. Every texel sums its cells in the same order, independent of the machine's
// vector width.
typedef float lanes __attribute__((vector_size(32)));
typedef int32_t mask __attribute__((vector_size(32)));

enum {
  LANES = OLX_BLOCK_COLUMNS,
  TILE = 8 // distance cells along the side of a tile
};

// Lobes are cut off where they fall to this share of their peak.
static const float lobe_floor = 1e-4f;

// Replaces negative values by 0. The argument is passed by address, because the calling convention of vectors that are
// passed by value differs between machines.
static inline void keep_positive(lanes *x) { *x = (lanes)((mask)*x & (*x > 0.0f)); }

static inline void raise_to(lanes *x, uint32_t exponent) {
  lanes power = *x, result = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
  for (; exponent; exponent >>= 1) {
    if (exponent & 1u) result *= power;
    power *= power;
  }
  *x = result;
}

typedef struct lane_directions {
  lanes x, y, z;
} lane_directions;

static void block_row_directions(uint32_t x, uint32_t y, uint32_t size, lane_directions *d) {
  for (uint32_t i = 0; i < LANES; i++) {
    const olx_vec3 v = olx_texel_direction(x + i, y, size);
    d->x[i] = v.x;
    d->y[i] = v.y;
    d->z[i] = v.z;
  }
}

OLX_WIDEST void olx_quadrature_irradiance(const olx_quadrature *quadrature, const olx_vec3 *radiance, uint32_t size,
                                          uint32_t row, olx_vec3 *map, uint32_t stride) {
  const uint32_t count = quadrature->cells * quadrature->cells;
  const float *mx = quadrature->moment_x, *my = quadrature->moment_y, *mz = quadrature->moment_z;
  for (uint32_t x = 0; x < size; x += OLX_BLOCK_COLUMNS) {
    lane_directions a, b;
    block_row_directions(x, row * OLX_BLOCK_ROWS, size, &a);
    block_row_directions(x, row * OLX_BLOCK_ROWS + 1, size, &b);
    lanes ar = {0}, ag = {0}, ab = {0}, br = {0}, bg = {0}, bb = {0};
    lanes weight_a = {0}, weight_b = {0};
    for (uint32_t c = 0; c < count; c++) {
      const float r = radiance[c].x, g = radiance[c].y, l = radiance[c].z;
      lanes wa = a.x * mx[c] + a.y * my[c] + a.z * mz[c];
      lanes wb = b.x * mx[c] + b.y * my[c] + b.z * mz[c];
      keep_positive(&wa);
      keep_positive(&wb);
      weight_a += wa;
      weight_b += wb;
      ar += wa * r;
      ag += wa * g;
      ab += wa * l;
      br += wb * r;
      bg += wb * g;
      bb += wb * l;
    }
    olx_vec3 *first = map + (size_t)row * OLX_BLOCK_ROWS * stride + x, *second = first + stride;
    // Cells that the horizon cuts have a slightly low weight; the weights must sum to pi.
    for (uint32_t i = 0; i < LANES; i++) {
      first[i] = olx_scale(olx_v3(ar[i], ag[i], ab[i]), OLX_PI / weight_a[i]);
      second[i] = olx_scale(olx_v3(br[i], bg[i], bb[i]), OLX_PI / weight_b[i]);
    }
  }
}

typedef struct lobe_sums {
  lanes weight, mean, square;
} lobe_sums;

static inline void lobe_add(lobe_sums *sums, const lane_directions *d, uint32_t exponent, olx_vec3 direction,
                            float weight, olx_vec2 distance) {
  lanes w = d->x * direction.x + d->y * direction.y + d->z * direction.z;
  keep_positive(&w);
  raise_to(&w, exponent);
  w *= weight;
  sums->weight += w;
  sums->mean += w * distance.x;
  sums->square += w * distance.y;
}

static void lobe_store(const lobe_sums *sums, olx_vec2 *texels) {
  for (uint32_t i = 0; i < LANES; i++) {
    const float inverse = 1.0f / sums->weight[i];
    texels[i] = (olx_vec2){sums->mean[i] * inverse, sums->square[i] * inverse};
  }
}

OLX_WIDEST void olx_quadrature_moments(const olx_quadrature *q, const olx_vec2 *distances, uint32_t row, olx_vec2 *map,
                                       uint32_t stride) {
  const uint32_t size = q->irradiance_size, blocks = size / OLX_BLOCK_COLUMNS, tiles = q->distance_cells / TILE;
  for (uint32_t block = 0; block < blocks; block++) {
    const uint32_t x = block * OLX_BLOCK_COLUMNS;
    lane_directions a, b;
    block_row_directions(x, row * OLX_BLOCK_ROWS, size, &a);
    block_row_directions(x, row * OLX_BLOCK_ROWS + 1, size, &b);
    lobe_sums sa = {0}, sb = {0};
    const uint32_t index = row * blocks + block;
    for (uint32_t t = q->tile_starts[index]; t < q->tile_starts[index + 1]; t++) {
      const uint32_t tile_x = q->tiles[t] % tiles * TILE, tile_y = q->tiles[t] / tiles * TILE;
      for (uint32_t i = 0; i < TILE * TILE; i++) {
        const uint32_t c = (tile_y + i / TILE) * q->distance_cells + tile_x + i % TILE;
        const olx_vec3 direction = olx_v3(q->distance_x[c], q->distance_y[c], q->distance_z[c]);
        lobe_add(&sa, &a, q->lobe_exponent, direction, q->distance_weight[c], distances[c]);
        lobe_add(&sb, &b, q->lobe_exponent, direction, q->distance_weight[c], distances[c]);
      }
    }
    olx_vec2 *first = map + (size_t)row * OLX_BLOCK_ROWS * stride + x;
    lobe_store(&sa, first);
    lobe_store(&sb, first + stride);
  }
}

static void fill_cells(olx_quadrature *q) {
  const uint32_t n = q->sample_size, half = n / 2, per_cell = n / q->cells, per_distance = n / q->distance_cells;
  // The map is symmetric in its four quadrants.
  for (uint32_t y = 0; y < half; y++) {
    for (uint32_t x = 0; x < half; x++) {
      const float angle = (float)olx_texel_solid_angle(x, y, n);
      q->sample_solid_angle[y * n + x] = q->sample_solid_angle[y * n + n - 1 - x] = angle;
      q->sample_solid_angle[(n - 1 - y) * n + x] = q->sample_solid_angle[(n - 1 - y) * n + n - 1 - x] = angle;
    }
  }
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      const float angle = q->sample_solid_angle[y * n + x];
      const olx_vec3 d = olx_scale(olx_texel_direction(x, y, n), angle);
      const uint32_t c = y / per_cell * q->cells + x / per_cell;
      q->cell_solid_angle[c] += angle;
      q->moment_x[c] += d.x;
      q->moment_y[c] += d.y;
      q->moment_z[c] += d.z;
      const uint32_t e = y / per_distance * q->distance_cells + x / per_distance;
      q->distance_weight[e] += angle;
      q->distance_x[e] += d.x;
      q->distance_y[e] += d.y;
      q->distance_z[e] += d.z;
    }
  }
  for (uint32_t e = 0; e < q->distance_cells * q->distance_cells; e++) {
    const olx_vec3 d = olx_normalize(olx_v3(q->distance_x[e], q->distance_y[e], q->distance_z[e]));
    q->distance_x[e] = d.x;
    q->distance_y[e] = d.y;
    q->distance_z[e] = d.z;
  }
}

// A cone that encloses all directions between the corners of a rectangle of the map.
typedef struct cone {
  olx_vec3 axis;
  float angle;
} cone;

static cone cone_of(uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t size) {
  const float scale = 1.0f / (float)size;
  const olx_vec2 middle = {((float)x + 0.5f * (float)width) * scale, ((float)y + 0.5f * (float)height) * scale};
  cone c = {olx_octahedral_decode(middle), 0.0f};
  for (uint32_t i = 0; i < 9; i++) {
    const olx_vec2 uv = {((float)x + 0.5f * (float)(width * (i % 3))) * scale,
                         ((float)y + 0.5f * (float)(height * (i / 3))) * scale};
    const float cosine = olx_dot(c.axis, olx_octahedral_decode(uv));
    c.angle = olx_max(c.angle, acosf(olx_clamp(cosine, -1.0f, 1.0f)));
  }
  return c;
}

// Finds which tiles of distance cells the lobes of each block reach; returns their number, and stores them when `tiles`
// is not NULL.
static uint32_t reach_tiles(const olx_quadrature *q, uint32_t *starts, uint16_t *tiles, const cone *cones) {
  const uint32_t side = q->distance_cells / TILE, blocks = q->irradiance_size / OLX_BLOCK_COLUMNS;
  const uint32_t rows = q->irradiance_size / OLX_BLOCK_ROWS;
  const float reach = acosf(powf(lobe_floor, 1.0f / (float)q->lobe_exponent));
  uint32_t count = 0;
  for (uint32_t block = 0; block < rows * blocks; block++) {
    if (starts) starts[block] = count;
    const cone lobe = cone_of(block % blocks * OLX_BLOCK_COLUMNS, block / blocks * OLX_BLOCK_ROWS, OLX_BLOCK_COLUMNS,
                              OLX_BLOCK_ROWS, q->irradiance_size);
    for (uint32_t t = 0; t < side * side; t++) {
      const float angle = reach + lobe.angle + cones[t].angle;
      if (angle < OLX_PI && olx_dot(lobe.axis, cones[t].axis) < cosf(angle)) continue;
      if (tiles) tiles[count] = (uint16_t)t;
      count++;
    }
  }
  if (starts) starts[rows * blocks] = count;
  return count;
}

static olx_result make_tiles(olx_quadrature *q) {
  const uint32_t side = q->distance_cells / TILE;
  const uint32_t blocks = q->irradiance_size / OLX_BLOCK_COLUMNS * (q->irradiance_size / OLX_BLOCK_ROWS);
  cone *cones = olx_allocate(side * side, sizeof *cones);
  q->tile_starts = olx_allocate(blocks + 1, sizeof *q->tile_starts);
  olx_result result = OLX_ERROR_MEMORY;
  if (cones && q->tile_starts) {
    for (uint32_t t = 0; t < side * side; t++) {
      cones[t] = cone_of(t % side * TILE, t / side * TILE, TILE, TILE, q->distance_cells);
    }
    q->tiles = olx_allocate(reach_tiles(q, q->tile_starts, NULL, cones), sizeof *q->tiles);
    if (q->tiles) {
      reach_tiles(q, NULL, q->tiles, cones);
      result = OLX_OK;
    }
  }
  olx_release(cones);
  return result;
}

olx_quadrature olx_quadrature_shape(uint32_t irradiance_size) {
  const uint32_t cells = irradiance_size >= 64 ? 64 : 32;
  return (olx_quadrature){.irradiance_size = irradiance_size,
                          .cells = cells,
                          .distance_cells = OLX_MOMENTS_CELLS,
                          .sample_size = 4 * cells > 2 * irradiance_size ? 4 * cells : 2 * irradiance_size};
}

olx_result olx_quadrature_create(uint32_t irradiance_size, olx_quadrature *q) {
  *q = olx_quadrature_shape(irradiance_size);
  const float ratio = olx_min((float)irradiance_size / OLX_MOMENTS_FULL_SIZE, 1.0f);
  const float exponent = OLX_MOMENTS_EXPONENT * ratio * ratio;
  q->lobe_exponent = (uint32_t)(olx_max(exponent, OLX_MOMENTS_EXPONENT_LEAST) + 0.5f);
  const size_t samples = (size_t)q->sample_size * q->sample_size, cells = (size_t)q->cells * q->cells;
  const size_t distances = (size_t)q->distance_cells * q->distance_cells;
  float **tables[] = {&q->cell_solid_angle, &q->moment_x,   &q->moment_y,   &q->moment_z,
                      &q->distance_x,       &q->distance_y, &q->distance_z, &q->distance_weight};
  q->sample_solid_angle = olx_allocate(samples, sizeof(float));
  bool complete = q->sample_solid_angle != NULL;
  for (uint32_t i = 0; i < sizeof tables / sizeof *tables; i++) {
    *tables[i] = olx_allocate_zero(i < 4 ? cells : distances, sizeof(float));
    complete = complete && *tables[i];
  }
  if (complete) {
    fill_cells(q);
    complete = make_tiles(q) == OLX_OK;
  }
  if (complete) return OLX_OK;
  olx_quadrature_free(q);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the tables of %u-texel irradiance maps", irradiance_size);
}

void olx_quadrature_free(olx_quadrature *q) {
  void *tables[] = {q->sample_solid_angle, q->cell_solid_angle, q->moment_x,   q->moment_y,
                    q->moment_z,           q->distance_x,       q->distance_y, q->distance_z,
                    q->distance_weight,    q->tile_starts,      q->tiles};
  for (uint32_t i = 0; i < sizeof tables / sizeof *tables; i++) olx_release(tables[i]);
  *q = (olx_quadrature){0};
}
