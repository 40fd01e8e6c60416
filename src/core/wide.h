// Vectors of eight floats or integers, for code that computes eight results at once. Functions that use them are
// compiled for AVX2 even if all else is not, and must be called only where olx_wide_available returns true.
#ifndef OLX_CORE_WIDE_H
#define OLX_CORE_WIDE_H

#include "core/vec.h"

#if defined(__x86_64__)
#define OLX_WIDE 1

enum { OLX_WIDE_LANES = 8 };

typedef float reals __attribute__((vector_size(32)));
typedef int32_t words __attribute__((vector_size(32))); // also masks: -1 where true
typedef int64_t addresses __attribute__((vector_size(32)));
typedef int32_t four_words __attribute__((vector_size(16)));

#define WIDE_CODE __attribute__((target("avx2")))
#define WIDE WIDE_CODE __attribute__((always_inline)) static inline

static inline bool olx_wide_available(void) { return __builtin_cpu_supports("avx2"); }

WIDE reals splat(float f) { return (reals){f, f, f, f, f, f, f, f}; }
WIDE words splat_word(int32_t i) { return (words){i, i, i, i, i, i, i, i}; }
WIDE reals pick(words mask, reals a, reals b) { return __builtin_ia32_blendvps256(b, a, (reals)mask); }
WIDE words pick_word(words mask, words a, words b) { return (words)pick(mask, (reals)a, (reals)b); }
WIDE reals least(reals a, reals b) { return pick(a < b, a, b); }
WIDE reals most(reals a, reals b) { return pick(a > b, a, b); }
WIDE reals magnitude(reals a) { return (reals)((words)a & 0x7FFFFFFF); }
WIDE reals clamped(reals a, reals low, reals high) { return least(most(a, low), high); }
WIDE words truncated(reals a) { return __builtin_convertvector(a, words); }
WIDE reals real(words a) { return __builtin_convertvector(a, reals); }
WIDE words mask_of(uint32_t lanes_on) { return ((int32_t)lanes_on & (words){1, 2, 4, 8, 16, 32, 64, 128}) != 0; }
WIDE uint32_t bits(words mask) { return (uint32_t)__builtin_ia32_movmskps256((reals)mask); }
WIDE reals sign_not_zero(reals a) { return pick(a >= 0.0f, splat(1.0f), splat(-1.0f)); }

#else
#define OLX_WIDE 0
static inline bool olx_wide_available(void) { return false; }
#endif

#endif
