// Uses fields that may be hostile as a host would: opens, verifies, samples and relights them, by random choices that a
// seed decides. Fuzzers of fields share it.
#pragma once

#include "core/pack.h"
#include "core/sampling.h"

#include <octalux/base.h>

#include <math.h>

// The random choices of one round.
typedef struct dice {
  uint32_t seed, round, drawn;
} dice;

static inline uint32_t draw(dice *d) { return olx_hash3(d->drawn++, d->round, d->seed); }
static inline uint32_t draw_below(dice *d, uint32_t count) { return (uint32_t)((uint64_t)draw(d) * count >> 32); }
static inline size_t draw_offset(dice *d, size_t size_bytes) {
  return size_bytes ? draw_below(d, (uint32_t)size_bytes) : 0;
}
static inline float draw_unit(dice *d) { return olx_unit_float(draw(d)); }

static inline uint32_t extreme_u32(dice *d) {
  static const uint32_t values[] = {0,          1,          2,          3,          7,          8,          64,
                                    255,        256,        4096,       65535,      65536,      0x7FFFFFFF, 0x80000000,
                                    0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFC0, 0x55555556, 0x40000000, 0x00FFFFFF};
  const uint32_t i = draw_below(d, sizeof values / sizeof values[0] + 2);
  return i < sizeof values / sizeof values[0] ? values[i] : i & 1 ? draw(d) : draw_below(d, 300);
}

static inline float extreme_float(dice *d) {
  static const float values[] = {0.0f,   -0.0f,   1.0f,    -1.0f,    1e-45f, 1e-38f,   -1e-38f,  1e-18f,    1e18f,
                                 -1e18f, 1.1e18f, 3.4e38f, -3.4e38f, 1e-7f,  16777216, INFINITY, -INFINITY, NAN};
  const uint32_t i = draw_below(d, sizeof values / sizeof values[0] + 2);
  return i < sizeof values / sizeof values[0] ? values[i] : olx_bits_float(draw(d));
}

static inline uint64_t extreme_u64(dice *d) {
  switch (draw_below(d, 5)) {
  case 0: return extreme_u32(d);
  case 1: return (uint64_t)extreme_u32(d) << 32 | extreme_u32(d);
  case 2: return UINT64_MAX - extreme_u32(d);
  case 3: return (uint64_t)64 * draw_below(d, 2000);
  default: return UINT64_C(1) << draw_below(d, 64);
  }
}

typedef struct field_counts {
  uint64_t opened, verified, refused[16], calls;
} field_counts;

// Opens the bytes of a file (aligned to 64) and, when that succeeds, uses the field. A broken promise is reported and
// ends in abort().
void hostile_field_use(dice *d, const void *bytes, size_t size_bytes, field_counts *counts);
