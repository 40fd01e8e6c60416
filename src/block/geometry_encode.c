// Finds the planes of geometry blocks: one for all texels where that fits, else several, those with most texels first.
// Inverse depths are affine over a block, so a plane is fitted by linear least squares.
#include "block/geometry_encode.h"

#include <stdlib.h>

enum { NUMBERS = 3, SKY = OLX_BLOCK_TEXELS };

// The weight of the slope of a texel's surface, relative to the position of its point, when a plane is fitted to
// several texels.
static const double SLOPE_WEIGHT = 0.05;
// The weight of an error of the plane's depth in the middle of the block, which texels beyond a fold may not determine.
static const double MIDDLE_WEIGHT = 1e-6;
// The share of the tolerance with which planes are searched; the rest is for rounding their codes.
static const float SEARCH_SHARE = 0.9f;
// Surfaces at a smaller cosine than this are tilted to it, because no plane may pass through the probe.
static const float LEAST_FACING = 1e-3f;
// A texel's decoded inverse depth lies between these multiples of its own: at grazing angles a plane may be near
// although its point is far away.
static const float LEAST_DEPTH_SHARE = 0.5f, MOST_DEPTH_SHARE = 2.0f;
// The range of inverse depths in which numbers are accurate.
static const float MOST_INVERSE = 0x1p56f, LEAST_INVERSE = 0x1p-56f;

// A plane in the form of a code, before rounding: its inverse depth in the middle of the block, and the increase in
// half a texel along the map's axes.
typedef struct fit {
  double a, b, c;
} fit;

// The place of a block: its middle relative to that of the map, in half texels.
typedef struct frame {
  olx_block_place place;
  double x, z, sign_x, sign_z;
  bool upper, folded;
} frame;

// What the texels see, an array for each number, so that a plane is tested against all of them at once.
typedef struct views {
  frame frame;
  uint32_t seen;                        // a bit for each texel that is not sky
  float inverse[OLX_BLOCK_TEXELS];      // 1 / |p|_1 of the point
  float row[NUMBERS][OLX_BLOCK_TEXELS]; // the inverse depth of a fit at the texel is its product with this
  float scale[OLX_BLOCK_TEXELS];        // footprints per unit of inverse depth and of a plane's distance
  float normal[NUMBERS][OLX_BLOCK_TEXELS];
  fit own[OLX_BLOCK_TEXELS]; // the plane of the texel alone
  float tolerance, least_cosine;
} views;

// The planes of a block, and the plane of each texel.
typedef struct solution {
  uint32_t count;
  olx_plane_code codes[OLX_BLOCK_TEXELS];
  olx_vec3 planes[OLX_BLOCK_TEXELS];
  uint8_t of[OLX_BLOCK_TEXELS]; // SKY: none
} solution;

olx_geometry_settings olx_geometry_settings_default(void) {
  return (olx_geometry_settings){.tolerance = 0.25f, .least_cosine = 0.8f};
}

static frame make_frame(olx_block_place place) {
  const int32_t n = (int32_t)place.n, x = 8 * (int32_t)place.x + 4 - n, z = 8 * (int32_t)place.y + 4 - n;
  const int32_t sum = abs(x) + abs(z);
  return (frame){.place = place,
                 .x = x,
                 .z = z,
                 .sign_x = x < 0 ? -1 : 1,
                 .sign_z = z < 0 ? -1 : 1,
                 .upper = sum <= n,
                 .folded = sum == n};
}

// Returns the plane m of a fit, as olx_plane_decode computes it.
static olx_vec3 plane_of_fit(const frame *f, fit k) {
  const double n = f->place.n, middle = k.a - k.b * f->x - k.c * f->z;
  const double along_x = f->sign_x * k.b * n, along_z = f->sign_z * k.c * n;
  return olx_v3((float)(f->sign_x * (middle + along_x)), (float)(f->upper ? middle : -(middle + along_x + along_z)),
                (float)(f->sign_z * (middle + along_z)));
}

// Returns the fit of a plane, the inverse of plane_of_fit.
static fit fit_of_plane(const frame *f, olx_vec3 plane) {
  const double x = f->sign_x * plane.x, y = plane.y, z = f->sign_z * plane.z;
  const double middle = f->upper ? y : x + y + z;
  const double b = f->sign_x * (x - middle) / f->place.n, c = f->sign_z * (z - middle) / f->place.n;
  return (fit){middle + b * f->x + c * f->z, b, c};
}

static void set_row(views *v, uint32_t texel, olx_vec3 point) {
  float row[NUMBERS] = {1.0f, (float)(2 * (int32_t)(texel % OLX_BLOCK_SIDE) - 3),
                        (float)(2 * (int32_t)(texel / OLX_BLOCK_SIDE) - 3)};
  if (v->frame.folded) { // beyond the fold, the map's coordinates mean something else
    const fit unit[NUMBERS] = {{.a = 1.0}, {.b = 1.0}, {.c = 1.0}};
    for (uint32_t k = 0; k < NUMBERS; k++) row[k] = olx_dot(plane_of_fit(&v->frame, unit[k]), point);
  }
  for (uint32_t k = 0; k < NUMBERS; k++) v->row[k][texel] = row[k];
}

// Returns the normal, turned to face the probe.
static olx_vec3 facing_normal(olx_vec3 normal, olx_vec3 direction) {
  const float length = olx_length(normal);
  if (!(length > 0.5f && length < 2.0f)) return olx_negate(direction); // not a unit vector
  const olx_vec3 unit = olx_scale(normal, 1.0f / length);
  const float facing = -olx_dot(unit, direction);
  return facing >= LEAST_FACING ? unit : olx_normalize(olx_madd(unit, direction, facing - LEAST_FACING));
}

static void set_texel(views *v, uint32_t i, olx_geometry_texel texel) {
  const olx_vec3 q = olx_block_texel_point(v->frame.place, i);
  const float length = olx_length(q);
  const olx_vec3 direction = olx_scale(q, 1.0f / length);
  set_row(v, i, q);
  v->scale[i] = 0.5f * (float)v->frame.place.n * sqrtf(length);
  if (!(texel.distance > 0.0f && texel.distance < INFINITY)) return;
  v->seen |= 1u << i;
  v->inverse[i] = olx_clamp(length / texel.distance, LEAST_INVERSE, MOST_INVERSE);
  const olx_vec3 normal = facing_normal(texel.normal, direction);
  v->own[i] = fit_of_plane(&v->frame, olx_scale(normal, v->inverse[i] / olx_dot(normal, q)));
  const float components[NUMBERS] = {normal.x, normal.y, normal.z};
  for (uint32_t k = 0; k < NUMBERS; k++) v->normal[k][i] = components[k];
}

// Returns the texels among `wanted` that lie on the plane m, with depths by the fit or, exactly as decoded, by m
// itself.
static uint32_t texels_on(const views *v, olx_vec3 plane, fit k, float tolerance, uint32_t wanted) {
  const float height = 1.0f / olx_length(plane), a = (float)k.a, b = (float)k.b, c = (float)k.c;
  const olx_vec3 normal = olx_scale(plane, -height);
  uint8_t on[OLX_BLOCK_TEXELS];
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const float inverse = v->row[0][i] * a + v->row[1][i] * b + v->row[2][i] * c;
    const float off = fabsf(inverse - v->inverse[i]) * height * v->scale[i];
    const float cosine = v->normal[0][i] * normal.x + v->normal[1][i] * normal.y + v->normal[2][i] * normal.z;
    const float share = inverse / v->inverse[i];
    on[i] =
        (off <= tolerance) & (cosine >= v->least_cosine) & (share >= LEAST_DEPTH_SHARE) & (share <= MOST_DEPTH_SHARE);
  }
  uint32_t mask = 0;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) mask |= (uint32_t)on[i] << i;
  return mask & wanted;
}

static uint32_t texels_on_fit(const views *v, fit k, uint32_t wanted) {
  return texels_on(v, plane_of_fit(&v->frame, k), k, SEARCH_SHARE * v->tolerance, wanted);
}

// Returns the distance of a texel's point from a decoded plane in footprints; infinite when the texel does not lie on
// it at all.
static float miss(const views *v, olx_vec3 plane, uint32_t i) {
  const float inverse = olx_dot(plane, olx_block_texel_point(v->frame.place, i)), height = 1.0f / olx_length(plane);
  const float cosine = -height * (v->normal[0][i] * plane.x + v->normal[1][i] * plane.y + v->normal[2][i] * plane.z);
  const float share = inverse / v->inverse[i];
  if (!(share >= LEAST_DEPTH_SHARE && share <= MOST_DEPTH_SHARE && cosine >= v->least_cosine)) return INFINITY;
  return fabsf(inverse - v->inverse[i]) * height * v->scale[i];
}

static fit solve(const double m[6], const double r[NUMBERS]) {
  const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5], c02 = m[1] * m[4] - m[2] * m[3];
  const double c11 = m[0] * m[5] - m[2] * m[2], c12 = m[1] * m[2] - m[0] * m[4], c22 = m[0] * m[3] - m[1] * m[1];
  const double inverse = 1.0 / (m[0] * c00 + m[1] * c01 + m[2] * c02);
  return (fit){(c00 * r[0] + c01 * r[1] + c02 * r[2]) * inverse, (c01 * r[0] + c11 * r[1] + c12 * r[2]) * inverse,
               (c02 * r[0] + c12 * r[1] + c22 * r[2]) * inverse};
}

// Returns the plane that fits texels best: their points and, with a small weight, the slopes of their surfaces.
static fit fit_texels(const views *v, uint32_t mask) {
  double m[6] = {0}, r[NUMBERS] = {0};
  for (uint32_t left = mask; left; left &= left - 1) {
    const uint32_t i = (uint32_t)__builtin_ctz(left);
    const double p = v->row[0][i], q = v->row[1][i], s = v->row[2][i], inverse = v->inverse[i];
    m[0] += p * p + MIDDLE_WEIGHT;
    m[1] += p * q;
    m[2] += p * s;
    m[3] += q * q + SLOPE_WEIGHT;
    m[4] += q * s;
    m[5] += s * s + SLOPE_WEIGHT;
    r[0] += p * inverse + MIDDLE_WEIGHT * v->own[i].a;
    r[1] += q * inverse + SLOPE_WEIGHT * v->own[i].b;
    r[2] += s * inverse + SLOPE_WEIGHT * v->own[i].c;
  }
  return solve(m, r);
}

static int32_t round_within(double value, int32_t least, int32_t most) {
  if (!(value > least)) return least; // also for NaN
  return value >= most ? most : (int32_t)floor(value + 0.5);
}

// Codes a plane. The shift that rounding its slopes causes at its texels is subtracted from `a`.
static olx_plane_code code_fit(const views *v, fit k, uint32_t mask) {
  const double most = fmax(fabs(k.a) / (4.0 * 65535.0), fmax(fabs(k.b), fabs(k.c)) / 16383.0);
  int exponent;
  frexp(most, &exponent);
  const int32_t e = exponent < -82 ? 0 : exponent > 45 ? 127 : exponent + 82;
  const double unit = ldexp(1.0, e - 82);
  const int32_t b = round_within(k.b / unit, -16384, 16383), c = round_within(k.c / unit, -16384, 16383);
  double shift = 0.0, share = 0.0;
  for (uint32_t left = mask; left; left &= left - 1) {
    const uint32_t i = (uint32_t)__builtin_ctz(left);
    shift += v->row[1][i] * (k.b - b * unit) + v->row[2][i] * (k.c - c * unit);
    share += v->row[0][i];
  }
  const double middle = k.a + (share >= 0.5 ? shift / share : 0.0); // beyond a fold, shares may cancel
  const int32_t a = round_within(middle / (4.0 * unit), -65536, 65535);
  return (olx_plane_code){{((uint32_t)a & 0x1FFFFu) | (uint32_t)b << 17, ((uint32_t)c & 0x7FFFu) | (uint32_t)e << 15}};
}

static void add_plane(solution *s, const views *v, fit k, uint32_t mask) {
  s->codes[s->count] = code_fit(v, k, mask);
  s->planes[s->count] = olx_plane_decode(s->codes[s->count], v->frame.place);
  for (uint32_t left = mask; left; left &= left - 1) s->of[__builtin_ctz(left)] = (uint8_t)s->count;
  s->count++;
}

// Returns the largest group of texels on the plane of one of them; the search ends at a group of half of `left`.
static uint32_t largest_group(const views *v, uint32_t left) {
  uint32_t best = 0;
  int most = 0;
  const int enough = (__builtin_popcount(left) + 1) / 2;
  for (uint32_t seeds = left; seeds && most < enough; seeds &= seeds - 1) {
    const uint32_t seed = (uint32_t)__builtin_ctz(seeds);
    const uint32_t group = texels_on_fit(v, v->own[seed], left) | 1u << seed;
    const int size = __builtin_popcount(group);
    if (size > most) {
      most = size;
      best = group;
    }
  }
  return best;
}

// Fits a plane to a group and adds the texels that lie on the plane, as long as the group grows.
static fit grow(const views *v, uint32_t *group, uint32_t left) {
  fit k = fit_texels(v, *group);
  uint32_t on = texels_on_fit(v, k, left);
  for (uint32_t round = 0; round < 4 && __builtin_popcount(on) > __builtin_popcount(*group); round++) {
    *group = on;
    k = fit_texels(v, on);
    on = texels_on_fit(v, k, left);
  }
  if (on & (on - 1)) *group = on;
  return k;
}

// Gives texels that lie off their coded plane planes of their own, and removes planes without texels.
static void settle(solution *s, const views *v) {
  solution settled = {.count = 0};
  uint8_t number[OLX_BLOCK_TEXELS];
  memset(number, SKY, sizeof number);
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    settled.of[i] = SKY;
    if (!(v->seen >> i & 1u)) continue;
    const uint32_t old = s->of[i];
    if (miss(v, s->planes[old], i) > v->tolerance) {
      add_plane(&settled, v, v->own[i], 1u << i);
      continue;
    }
    if (number[old] == SKY) {
      number[old] = (uint8_t)settled.count;
      settled.codes[settled.count] = s->codes[old];
      settled.planes[settled.count++] = s->planes[old];
    }
    settled.of[i] = number[old];
  }
  *s = settled;
}

static void find_planes(solution *s, const views *v) {
  s->count = 0;
  for (uint32_t left = v->seen; left;) {
    uint32_t group = largest_group(v, left);
    const fit k = grow(v, &group, left);
    add_plane(s, v, k, group);
    left &= ~group;
  }
  settle(s, v);
}

static bool all_on(const views *v, olx_vec3 plane) {
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    if (!(miss(v, plane, i) <= v->tolerance)) return false;
  }
  return true;
}

// Returns the bits of a float with subnormal numbers, which devices may flush to 0, replaced by 0.
static uint32_t plain_bits(float f) { return fabsf(f) < 0x1p-126f ? 0 : olx_float_bits(f); }

static olx_geometry_block one_plane(olx_vec3 plane) {
  return (olx_geometry_block){{plain_bits(plane.x), plain_bits(plane.y), plain_bits(plane.z), 0}};
}

// Writes a block of two planes; the sky is a plane of zeros.
static olx_geometry_block two_planes(const solution *s) {
  const olx_plane_code first = s->codes[0], second = s->count > 1 ? s->codes[1] : (olx_plane_code){{0, 0}};
  uint32_t mask = 0;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) mask |= (uint32_t)(s->of[i] != 0) << i;
  return (olx_geometry_block){{first.words[0], second.words[0], first.words[1] | (mask & 0xFFu) << 22,
                               second.words[1] | mask >> 8 << 22 | OLX_GEOMETRY_TWO << 30}};
}

static void pool_planes(const solution *s, bool sky, olx_block_place place, olx_geometry_code *code) {
  memcpy(code->planes, s->codes, s->count * sizeof *s->codes);
  code->pooled = s->count + sky;
  if (sky) code->planes[s->count] = (olx_plane_code){{0, 0}};
  code->block.words[3] = OLX_GEOMETRY_POOL << 30;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const uint32_t number = s->of[i] == SKY ? s->count : s->of[i];
    code->block.words[1 + i / 8] |= number << 4 * (i % 8);
  }
  const olx_plane_pool pool = {code->planes, code->pooled};
  code->block.words[3] |= olx_geometry_nearest_code(&code->block, &pool, place);
}

olx_geometry_code olx_geometry_encode(const olx_geometry_texel texels[OLX_BLOCK_TEXELS], olx_block_place place,
                                      const olx_geometry_settings *settings) {
  olx_geometry_code code = {.pooled = 0};
  views v = {.frame = make_frame(place), .tolerance = settings->tolerance, .least_cosine = settings->least_cosine};
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) set_texel(&v, i, texels[i]);
  if (!v.seen) return code;
  const bool sky = v.seen != 0xFFFFu;
  const fit whole = fit_texels(&v, v.seen);
  const olx_vec3 plane = plane_of_fit(&v.frame, whole);
  if (!sky && texels_on_fit(&v, whole, 0xFFFFu) == 0xFFFFu && all_on(&v, plane)) {
    code.block = one_plane(plane);
    return code;
  }
  solution s;
  find_planes(&s, &v);
  if (s.count == 1 && !sky) code.block = one_plane(s.planes[0]);
  else if (s.count + sky <= 2) code.block = two_planes(&s);
  else pool_planes(&s, sky, place, &code);
  return code;
}
