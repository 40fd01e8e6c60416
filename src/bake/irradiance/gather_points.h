// Directions in which irradiance probes cast rays: samples of the sphere, and gather points, each of which represents a
// quarter of a cell.
#ifndef OLX_BAKE_GATHER_POINTS_H
#define OLX_BAKE_GATHER_POINTS_H

#include "bake/irradiance/quadrature.h"
#include "core/morton.h"
#include "core/sampling.h"

enum {
  OLX_GATHER_TILE = 32, // samples along the side of a tile, which is one batch
  OLX_SALT_PICK = 0x47415448,
  OLX_SALT_CELL = 0x43454C4C,
  OLX_SALT_JITTER = 0x4A495454
};

static inline uint32_t olx_gather_tiles(const olx_quadrature *q) {
  const uint32_t side = q->sample_size / OLX_GATHER_TILE;
  return side * side;
}

static inline uint32_t olx_samples_per_cell(const olx_quadrature *q) {
  const uint32_t side = q->sample_size / q->cells;
  return side * side;
}

static inline uint32_t olx_gather_points(const olx_quadrature *q) { return 4 * q->cells * q->cells; }

// Position of sample `i` of a tile, in Morton order, in the map of samples.
typedef struct olx_sample_place {
  uint32_t x, y, cell;
} olx_sample_place;

static inline olx_sample_place olx_place_of(const olx_quadrature *q, uint32_t tile, uint32_t i) {
  const uint32_t side = q->sample_size / OLX_GATHER_TILE, per_cell = q->sample_size / q->cells;
  const uint32_t x = tile % side * OLX_GATHER_TILE + olx_morton_coordinate(i);
  const uint32_t y = tile / side * OLX_GATHER_TILE + olx_morton_coordinate(i >> 1);
  return (olx_sample_place){x, y, y / per_cell * q->cells + x / per_cell};
}

// Returns a direction within the sample's texel, jittered by a probe's key. From a probe placed symmetrically in a
// room, as probes of grids often are, regular directions would hit edges of walls exactly, where it is undetermined
// which wall they hit.
static inline olx_vec3 olx_sample_direction(const olx_quadrature *q, uint32_t key, olx_sample_place p) {
  const uint32_t hash = olx_hash3(key, p.y * q->sample_size + p.x, OLX_SALT_JITTER);
  const float scale = 1.0f / (float)q->sample_size, u = ((float)(hash & 0xFFFFu) + 0.5f) * 0x1p-16f;
  const float v = ((float)(hash >> 16) + 0.5f) * 0x1p-16f;
  return olx_octahedral_decode((olx_vec2){((float)p.x + u) * scale, ((float)p.y + v) * scale});
}

// Returns the index of the sample that represents a gather point: one of the consecutive samples in its quarter of a
// cell, drawn by hash.
static inline uint32_t olx_picked_sample(uint32_t key, uint32_t point, uint32_t per_quarter) {
  return olx_hash3(key, point, OLX_SALT_PICK) & (per_quarter - 1);
}

static inline float olx_quarter_solid_angle(const olx_quadrature *q, uint32_t tile, uint32_t quarter,
                                            uint32_t per_quarter) {
  float sum = 0.0f;
  for (uint32_t i = 0; i < per_quarter; i++) {
    const olx_sample_place p = olx_place_of(q, tile, quarter * per_quarter + i);
    sum += q->sample_solid_angle[p.y * q->sample_size + p.x];
  }
  return sum;
}

static inline uint32_t olx_cell_seed(uint32_t probe, uint32_t cell) { return olx_hash3(probe, cell, OLX_SALT_CELL); }

#endif
