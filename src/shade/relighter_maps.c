#include "core/hooks.h"
#include "core/result.h"
#include "shade/relighter.h"

typedef float lanes __attribute__((vector_size(16)));
typedef int32_t lane_masks __attribute__((vector_size(16)));
enum { LANES = 4, MOST_CELLS = OLX_RELIT_CELLS_MOST * OLX_RELIT_CELLS_MOST };

// A probe's maps are packed again when they have changed by more than this since.
static const float PACK_CHANGE = 1e-3f;

olx_result olx_relit_make_quadrature(olx_relight *r) {
  const uint32_t n = r->source->relight.size, cells = r->cells, per_cell = n / cells;
  r->surface_share = olx_allocate(r->surfaces, sizeof(float));
  for (uint32_t k = 0; k < 3; k++) r->moment[k] = olx_allocate_zero(cells * cells, sizeof(float));
  float *sum = olx_allocate_zero(cells * cells, sizeof *sum);
  if (!r->surface_share || !r->moment[0] || !r->moment[1] || !r->moment[2] || !sum) {
    olx_release(sum);
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  }
  for (uint32_t i = 0; i < r->surfaces; i++) {
    const uint32_t x = i % n, y = i / n, cell = y / per_cell * cells + x / per_cell;
    const float angle = (float)olx_texel_solid_angle(x, y, n);
    const olx_vec3 moment = olx_scale(olx_texel_direction(x, y, n), angle);
    r->surface_share[i] = angle;
    sum[cell] += angle;
    r->moment[0][cell] += moment.x;
    r->moment[1][cell] += moment.y;
    r->moment[2][cell] += moment.z;
  }
  for (uint32_t i = 0; i < r->surfaces; i++) r->surface_share[i] /= sum[i / n / per_cell * cells + i % n / per_cell];
  olx_release(sum);
  return OLX_OK;
}

static void sum_cells(const olx_relight *r, uint32_t probe, float cell[3][MOST_CELLS]) {
  const uint32_t n = r->source->relight.size, per_cell = n / r->cells;
  const olx_vec3 *radiance = r->radiance + r->surfaces * probe;
  for (uint32_t k = 0; k < 3; k++) {
    for (uint32_t c = 0; c < r->cells * r->cells; c++) cell[k][c] = 0.0f;
  }
  for (uint32_t i = 0; i < r->surfaces; i++) {
    const uint32_t c = i / n / per_cell * r->cells + i % n / per_cell;
    cell[0][c] += radiance[i].x * r->surface_share[i];
    cell[1][c] += radiance[i].y * r->surface_share[i];
    cell[2][c] += radiance[i].z * r->surface_share[i];
  }
}

// Irradiance for four texels of a row: the sum over cells of radiance times cosine, weights brought to pi.
static void gather_texels(const olx_relight *r, float cell[3][MOST_CELLS], uint32_t x, uint32_t y,
                          olx_vec3 out[LANES]) {
  lanes dx, dy, dz, weight = {0}, red = {0}, green = {0}, blue = {0};
  for (uint32_t i = 0; i < LANES; i++) {
    const olx_vec3 d = olx_texel_direction(x + i, y, r->map_size);
    dx[i] = d.x;
    dy[i] = d.y;
    dz[i] = d.z;
  }
  const float *mx = r->moment[0], *my = r->moment[1], *mz = r->moment[2];
  const lanes zero = {0};
  for (uint32_t c = 0; c < r->cells * r->cells; c++) {
    lanes w = dx * mx[c] + dy * my[c] + dz * mz[c];
    w = (lanes)((lane_masks)w & (w > zero));
    weight += w;
    red += w * cell[0][c];
    green += w * cell[1][c];
    blue += w * cell[2][c];
  }
  for (uint32_t i = 0; i < LANES; i++) out[i] = olx_scale(olx_v3(red[i], green[i], blue[i]), OLX_PI / weight[i]);
}

void olx_relit_gather(olx_relight *r, uint32_t probe, float history) {
  float cell[3][MOST_CELLS];
  sum_cells(r, probe, cell);
  const uint32_t n = r->map_size;
  olx_vec3 *map = r->exact + (size_t)n * n * probe;
  for (uint32_t i = 0; i < n * n; i += LANES) {
    olx_vec3 fresh[LANES];
    gather_texels(r, cell, i % n, i / n, fresh);
    for (uint32_t k = 0; k < LANES; k++) map[i + k] = olx_mix3(fresh[k], map[i + k], history);
  }
}

static olx_vec2 texel_centre(uint32_t x, uint32_t y, uint32_t n) {
  return (olx_vec2){((float)x + 0.5f) / (float)n, ((float)y + 0.5f) / (float)n};
}

static void fill_map_border(olx_vec3 *map, uint32_t n) {
  const int32_t side = (int32_t)n;
  for (int32_t i = -1; i <= side; i++) {
    const int32_t edge[4][2] = {{i, -1}, {i, side}, {-1, i}, {side, i}};
    for (uint32_t e = 0; e < 4; e++) {
      int32_t x, y;
      olx_border_source(edge[e][0], edge[e][1], side, &x, &y);
      map[olx_map_index(n + 2, edge[e][0], edge[e][1])] = map[olx_map_index(n + 2, x, y)];
    }
  }
}

void olx_relit_fill_border(uint32_t *map, uint32_t n) {
  const int32_t side = (int32_t)n;
  for (int32_t i = -1; i <= side; i++) {
    const int32_t edge[4][2] = {{i, -1}, {i, side}, {-1, i}, {side, i}};
    for (uint32_t e = 0; e < 4; e++) {
      int32_t x, y;
      olx_border_source(edge[e][0], edge[e][1], side, &x, &y);
      map[olx_map_index(n + 2, edge[e][0], edge[e][1])] = map[olx_map_index(n + 2, x, y)];
    }
  }
}

// The field's maps may have more texels than ours.
static void pack_map(olx_relight *r, uint32_t probe) {
  const uint32_t n = r->field.irradiance_n;
  const olx_vec3 *map = r->maps + r->map_texels * probe;
  uint32_t *packed = r->packed_irradiance + r->field.irradiance_texels * probe;
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      const olx_bilinear b = olx_bilinear_at(texel_centre(x, y, n), r->map_size);
      olx_vec3 sum = {0};
      for (uint32_t k = 0; k < 4; k++) sum = olx_madd(sum, map[b.index[k]], b.weight[k]);
      packed[olx_map_index(n + 2, (int32_t)x, (int32_t)y)] = olx_r11g11b10f_pack(sum);
    }
  }
  olx_relit_fill_border(packed, n);
  r->unpacked[probe] = 0.0f;
  r->map_frames[probe] = r->frame;
}

bool olx_relit_pack_due(const olx_relight *r, uint32_t probe, float sum) {
  return r->unpacked[probe] > PACK_CHANGE * sum;
}

void olx_relit_finish_map(olx_relight *r, uint32_t probe) {
  const uint32_t n = r->map_size;
  const olx_vec3 *exact = r->exact + (size_t)n * n * probe;
  olx_vec3 *map = r->maps + r->map_texels * probe;
  float changed = 0.0f, sum = 0.0f;
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      olx_vec3 light = exact[y * n + x];
      if (r->fit.count) light = olx_add(light, olx_relit_correction(&r->fit, probe, texel_centre(x, y, n)));
      light = olx_max_each(light, olx_splat(0.0f));
      olx_vec3 *texel = &map[olx_map_index(n + 2, (int32_t)x, (int32_t)y)];
      changed += fabsf(olx_luminance(olx_sub(light, *texel)));
      sum += olx_luminance(light);
      *texel = light;
    }
  }
  r->changed[probe] = changed;
  r->mean[probe] = sum / (float)(n * n);
  if (changed == 0.0f) return;
  fill_map_border(map, n);
  r->unpacked[probe] += changed;
  if (r->in_frame[probe] || olx_relit_pack_due(r, probe, sum)) pack_map(r, probe);
}

void olx_relit_read_map(olx_relight *r, uint32_t probe) {
  const olx_field *f = r->source;
  const uint32_t n = r->map_size, ratio = f->irradiance_n / n;
  const uint32_t *packed = f->irradiance + f->irradiance_texels * probe;
  olx_vec3 *map = r->maps + r->map_texels * probe;
  float sum = 0.0f;
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      olx_vec3 mean = {0};
      for (uint32_t k = 0; k < ratio * ratio; k++) {
        const int32_t sx = (int32_t)(x * ratio + k % ratio), sy = (int32_t)(y * ratio + k / ratio);
        mean = olx_add(mean, olx_r11g11b10f_unpack(packed[olx_map_index(f->irradiance_stride, sx, sy)]));
      }
      mean = olx_scale(mean, 1.0f / (float)(ratio * ratio));
      map[olx_map_index(n + 2, (int32_t)x, (int32_t)y)] = mean;
      r->exact[(size_t)n * n * probe + y * n + x] = mean;
      sum += olx_luminance(mean);
    }
  }
  fill_map_border(map, n);
  r->mean[probe] = sum / (float)(n * n);
}
