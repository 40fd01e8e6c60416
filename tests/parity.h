// Code that the parity tests share: every function of shaders/lib and its C twin run on the same random and edge
// inputs, on any Vulkan device (a CPU device will do). Tests include C files, so that their static functions can be
// called.
#ifndef OLX_TESTS_PARITY_H
#define OLX_TESTS_PARITY_H

#include "analytic_field.h"
#include "core/bsdf.h"
#include "gpu_pipeline.h"
#include "parity_rows.h"
#include "select/select.h"
#include "shade/irradiance.h"
#include "trace/probe_trace.h"
#include "vulkan/vulkan_field.h"

#include <octalux/sample.h>

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

typedef struct parity_item {
  float v[16];
  uint32_t u[4];
} parity_item;

// The values that parity.glsl derives from an item, by the same names.
typedef struct parity_state {
  const olx_field *field;
  const olx_field_constants *constants;
  const parity_item *item;
  uint32_t index;
  olx_vec3 point, direction, view;
  float random[4];
  uint32_t bits[4];
  uint32_t probe, irradiance_probe, x, y;
  olx_sample_settings settings;
  olx_irradiance_source source;
  olx_bsdf bsdf;
} parity_state;

// The results of C for an item. Words that are floats may differ a little.
typedef struct parity_result {
  uint32_t word[PARITY_RESULTS];
  bool is_float[PARITY_RESULTS];
  uint32_t count;
} parity_result;

static inline void put_u(parity_result *r, uint32_t x) { r->word[r->count++] = x; }
static inline void put_i(parity_result *r, int32_t x) { put_u(r, (uint32_t)x); }
static inline void put_f(parity_result *r, float x) {
  r->is_float[r->count] = true;
  put_u(r, olx_float_bits(x));
}
static inline void put_2(parity_result *r, olx_vec2 v) {
  put_f(r, v.x);
  put_f(r, v.y);
}
static inline void put_3(parity_result *r, olx_vec3 v) {
  put_f(r, v.x);
  put_f(r, v.y);
  put_f(r, v.z);
}

static inline void put_answer(parity_result *r, const olx_probe_answer *a) {
  put_u(r, a->status);
  put_u(r, (uint32_t)a->texel);
  put_u(r, a->steps);
  put_f(r, a->t);
  put_f(r, a->gap);
}

// Defines the C function that evaluates a row.
#define ROW(name, ...)                                                                                                 \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    (void)s;                                                                                                           \
    __VA_ARGS__                                                                                                        \
  }

// One function's bounds: how much its floats may differ, relative to their size and at least 1, and the share of items
// that may give anything else. Devices round divisions and roots differently, so results that depend on a comparison
// may differ in one item of a thousand; the edge of a lobe and a variance (a difference of squares) magnify rounding.
typedef struct parity_row {
  uint32_t number;
  const char *name;
  void (*evaluate)(parity_state *s, parity_result *r);
  float bound;
  double allowed;
} parity_row;

#define PARITY(name, bound, allowed)                                                                                   \
  { ROW_olx_##name, #name, row_##name, bound, allowed }

// A shader for the rows below `end` that no earlier shader computes.
typedef struct parity_code {
  uint32_t end;
  gpu_code code;
} parity_code;

enum { PARITY_MOST_CODES = 2 };

// Rooms and grids. The first two together contain every kind of texel, block and cage; the third has so many probes
// that maps share layers, the fourth has textures of blocks. The last two have classic maps, and only the rows that
// read these are compared there.
enum {
  PARITY_FURNISHED_ROOM,
  PARITY_OPEN_COURT,
  PARITY_MANY_PROBES,
  PARITY_ROOM_OF_BLOCKS,
  PARITY_CLASSIC_ROOM,
  PARITY_CLASSIC_WALL,
  PARITY_ROOMS
};

// A range of rows by their numbers; 0, 0 is empty.
typedef struct parity_range {
  uint32_t first, end;
} parity_range;

typedef struct parity_suite {
  const parity_row *rows;
  uint32_t row_count;
  const parity_code *codes;
  uint32_t code_count;       // number of codes, at most PARITY_MOST_CODES
  const parity_range *rooms; // PARITY_ROOMS ranges: the rows to compare in each room
} parity_suite;

#define PARITY_COUNT(array) (sizeof(array) / sizeof(array)[0])

// Compares all rows in one test for each room; returns the result for main.
int parity_run(const parity_suite *suite);

static inline olx_vec2 random_2(const parity_state *s) { return (olx_vec2){s->random[0], s->random[1]}; }
static inline size_t texel_of(const parity_state *s) {
  return olx_map_index(s->field->stride, (int32_t)s->x, (int32_t)s->y);
}
static inline bool has_voronoi(const parity_state *s) { return olx_select_available(s->field, OLX_SELECT_VORONOI); }

#endif
