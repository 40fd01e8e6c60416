// The irradiance volume: probes at the corners of cells of free space. It lights moving objects, and surfaces whose
// light is not stored. The structure lies in the file as it is read (docs/format.md, "Irradiance volume"). src/bake
// builds it, and src/shade looks it up.
#ifndef OLX_FIELD_VOLUME_DATA_H
#define OLX_FIELD_VOLUME_DATA_H

#include "core/vec.h"
#include "field/harmonic_data.h"

#include <octalux/field.h>

enum {
  OLX_VOLUME_LEVELS = 4, // how often a cube may be halved
  OLX_VOLUME_CORNERS = 8,
  OLX_VOLUME_BANDS = 3,      // of spherical harmonics
  OLX_VOLUME_MOST_SPLITS = 6 // the most in succession
};

typedef struct olx_volume_header {
  float origin[3];
  float cube_metres; // side of the largest cells: a power of two
  uint32_t size[3];  // cubes along each axis
  uint32_t blocks, splits, cells, probes;
  uint32_t zero[5];
} olx_volume_header;

_Static_assert(sizeof(olx_volume_header) == OLX_VOLUME_HEADER_WORDS * sizeof(uint32_t), "docs/format.md");

// A plane that divides a cell where a surface passes through it: either side has probes of its own.
typedef struct olx_volume_split {
  float normal[3], offset; // in front: dot(normal, position) > offset, metres
  uint32_t behind, front;  // entries
  uint32_t zero[2];
} olx_volume_split;

_Static_assert(sizeof(olx_volume_split) == OLX_VOLUME_SPLIT_WORDS * sizeof(uint32_t), "docs/format.md");

// The probes at a cell's corners: bit 0 of a corner is x, bit 1 is y, bit 2 is z.
typedef struct olx_volume_cell {
  uint32_t probes[OLX_VOLUME_CORNERS];
} olx_volume_cell;

_Static_assert(sizeof(olx_volume_cell) == OLX_VOLUME_CELL_WORDS * sizeof(uint32_t), "docs/format.md");

// Pointers into the structure; every number is in range once olx_volume_open has passed.
typedef struct olx_volume {
  const olx_volume_header *header; // NULL: the field has none
  const uint32_t *index;           // an entry for each cube, x fastest, then y, then z
  const uint32_t *blocks;          // OLX_VOLUME_BLOCK_ENTRIES each
  const olx_volume_split *splits;
  const olx_volume_cell *cells;
  const olx_vec3 *positions;  // of the probes, metres
  const uint16_t *irradiance; // OLX_VOLUME_HALVES a probe, as olx_harmonics_pack stores them
} olx_volume;

// Checks all of a structure and points into it; the caller sets positions and irradiance. `name` begins the message.
olx_result olx_volume_open(const void *data, size_t size_bytes, const char *name, olx_volume *volume);

// Returns how many smallest cells a bake makes along the longest side of space: at most `most`, and fewer beside small
// maps of light field probes, which get a coarse volume.
static inline uint32_t olx_volume_cells_along(uint32_t map_size, uint32_t most) {
  enum { TEXELS_A_CELL = 16 }; // of a map's side
  const uint32_t fitting = map_size > TEXELS_A_CELL ? map_size / TEXELS_A_CELL : 1;
  return most < fitting ? most : fitting;
}

// Returns the side of the smallest cells, a power of two of metres, for a space `longest` metres long.
static inline float olx_volume_least_metres(float longest, uint32_t along) {
  return exp2f(ceilf(log2f(longest / (float)along)));
}

// The cell around a place, and the weight of each of its corners there.
typedef struct olx_volume_place {
  const uint32_t *probes;
  float weights[OLX_VOLUME_CORNERS]; // they sum to 1
} olx_volume_place;

static inline uint32_t olx_volume_part(float coordinate, float parts) { return (uint32_t)(coordinate * parts); }

// Finds the cell around a place; false where the volume has none.
static inline bool olx_volume_find(const olx_volume *v, olx_vec3 position, olx_volume_place *place) {
  const olx_volume_header *h = v->header;
  const float scale = 1.0f / h->cube_metres;
  const float x = (position.x - h->origin[0]) * scale, y = (position.y - h->origin[1]) * scale,
              z = (position.z - h->origin[2]) * scale;
  // This is written so that NaN is outside.
  if (!(x >= 0.0f && x < (float)h->size[0] && y >= 0.0f && y < (float)h->size[1] && z >= 0.0f &&
        z < (float)h->size[2])) {
    return false;
  }
  uint32_t entry = v->index[(uint32_t)x + h->size[0] * ((uint32_t)y + (size_t)h->size[1] * (uint32_t)z)];
  for (float parts = 4.0f; parts <= 16.0f && (entry & OLX_VOLUME_KIND) == OLX_VOLUME_BLOCK; parts *= 4.0f) {
    const uint32_t part = (olx_volume_part(x, parts) & 3u) | (olx_volume_part(y, parts) & 3u) << 2 |
                          (olx_volume_part(z, parts) & 3u) << 4;
    entry = v->blocks[(size_t)(entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_BLOCK_ENTRIES + part];
  }
  while ((entry & OLX_VOLUME_KIND) == OLX_VOLUME_SPLIT) {
    const olx_volume_split *split = &v->splits[entry & OLX_VOLUME_NUMBER];
    entry = olx_dot(olx_load3(split->normal), position) > split->offset ? split->front : split->behind;
  }
  if ((entry & OLX_VOLUME_KIND) != OLX_VOLUME_CELL) return false;
  const float cells = (float)(1u << (entry >> OLX_VOLUME_LEVEL_SHIFT & 7u));
  const float fx = x * cells - floorf(x * cells), fy = y * cells - floorf(y * cells),
              fz = z * cells - floorf(z * cells);
  place->probes = v->cells[entry & OLX_VOLUME_NUMBER].probes;
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    place->weights[i] = (i & 1 ? fx : 1.0f - fx) * (i & 2 ? fy : 1.0f - fy) * (i & 4 ? fz : 1.0f - fz);
  }
  return true;
}

// Finds the cell of a place on a surface or an object with that unit normal; false when there is none. The place is
// looked up slightly in front of the surface, because a thin sheet may divide the cell exactly there.
static inline bool olx_volume_find_at(const olx_volume *v, olx_vec3 position, olx_vec3 normal,
                                      olx_volume_place *place) {
  return olx_volume_find(v, olx_madd(position, normal, v->header->cube_metres * OLX_VOLUME_LIFT), place);
}

#endif
