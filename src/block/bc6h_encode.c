// Encodes BC6H blocks: fits one or two lines between two colours by weighted least squares on the bits of half floats,
// which are nearly logarithms, and chooses the mode whose numbers hold them best.
#include "block/bc6h_encode.h"

#include "block/line_encode.h"

#include <stdlib.h>

enum {
  CHANNELS = 3,
  TEXELS = 16,
  GROUPS = OLX_LINE_ROWS,
  LANES = OLX_LINE_LANES,
  REFINEMENTS = 2,
  STARTS = 3,
  REGIONS = 2,
  SHAPES_TRIED = 3
};

// The range of interpolated numbers is 64/31 of that of the bits of a half float.
static const float BITS_SCALE = 64.0f / 31.0f;
// A channel darker than this share of its texel's reference light is raised to it where the channel is as bright
// elsewhere in the block, because zeros would take half of a line's range.
static const float LEAST_SHARE = 1.0f / 128.0f;
// The least reference light, as a share of the block's brightest light; a tenth of this where reference light is given.
static const float DARKNESS = 1.0f / 100.0f;
// A channel is weighted as if it were at least this share of its texel's reference light.
static const float LEAST_WEIGHT = 1.0f / 32.0f;
// Lines longer than this, 2.5 factors of 2, are also fitted from brighter starts.
static const float LONG_LINE = 2.5f * 1024.0f * 64.0f / 31.0f;
// The mean squared relative error of texels above which two lines are tried.
static const float ENOUGH = 2e-4f;
static const olx_line_steps SIXTEEN = {CHANNELS, 15.0f, 64.0f}, EIGHT = {CHANNELS, 7.0f, 64.0f};
// The largest half float.
static const float MOST_LIGHT = 65504.0f;

// Colours as interpolated numbers (places), and as values divided by the reference light of their texel; unit is 1 /
// that light.
typedef struct colours {
  olx_line_colours line;
  olx_row value[CHANNELS][GROUPS], unit[GROUPS];
} colours;

// A coded line, the index of each texel on it, and the sum of the squared relative errors of the texels that count.
typedef struct coded_line {
  uint32_t from[CHANNELS], to[CHANNELS];
  int32_t index[TEXELS];
  float error;
} coded_line;

typedef struct one_region {
  uint32_t code, precision, difference_bits;
  coded_line line;
} one_region;

typedef struct two_regions {
  const olx_bc6h_mode *mode;
  uint32_t shape;
  coded_line lines[REGIONS];
  float error;
} two_regions;

static inline olx_row square(olx_row a) { return a * a; }

// Converts light from 0 to MOST_LIGHT to the bits of half floats, with a fraction, in the range of interpolated
// numbers. Decoding drops fractions, so half a unit is added for rounding.
static inline olx_row places_of(olx_row light) {
  const olx_row normal = __builtin_convertvector((olx_row_words)light - 0x38000000, olx_row) * 0x1p-13f;
  return (olx_row_pick(light < 0x1p-14f, light * 0x1p24f, normal) + 0.5f) * BITS_SCALE;
}

// Converts places to light: the inverse of places_of on average, without rounding to a half float.
static inline olx_row light_at(olx_row place) {
  const olx_row bits = olx_row_most(place * (1.0f / BITS_SCALE) - 0.5f, olx_row_splat(0.0f));
  const olx_row normal = (olx_row)(__builtin_convertvector(bits * 0x1p13f, olx_row_words) + 0x38000000);
  return olx_row_pick(bits < 1024.0f, bits * 0x1p-24f, normal);
}

// Converts colours to rows of channels, black where a texel does not count.
static void load(const olx_vec3 *texels, const olx_row on[GROUPS], olx_row light[CHANNELS][GROUPS]) {
  for (uint32_t g = 0; g < GROUPS; g++) {
    const olx_vec3 *t = texels + LANES * g;
    const olx_row c[CHANNELS] = {
        {t[0].x, t[1].x, t[2].x, t[3].x}, {t[0].y, t[1].y, t[2].y, t[3].y}, {t[0].z, t[1].z, t[2].z, t[3].z}};
    for (uint32_t k = 0; k < CHANNELS; k++)
      light[k][g] = on[g] * olx_row_least(olx_row_most(c[k], olx_row_splat(0.0f)), olx_row_splat(MOST_LIGHT));
  }
}

static float brightest(const olx_row channel[GROUPS]) {
  olx_row highest = channel[0];
  for (uint32_t g = 1; g < GROUPS; g++) highest = olx_row_most(highest, channel[g]);
  return olx_row_highest(highest);
}

// Returns the reference light of a row of texels, relative to which errors are measured.
static olx_row unit_of(const olx_row own, const float *given, float least) {
  const olx_row wanted = given ? (olx_row){given[0], given[1], given[2], given[3]} : own;
  return olx_row_least(olx_row_most(wanted, olx_row_splat(least)), olx_row_splat(0x1p30f));
}

static void set_colours(colours *s, const olx_vec3 *texels, const float *relative_to, uint32_t counted) {
  olx_row light[CHANNELS][GROUPS];
  for (uint32_t i = 0; i < TEXELS; i++) s->line.on[i / LANES][i % LANES] = (float)(counted >> i & 1u);
  load(texels, s->line.on, light);
  const float most[CHANNELS] = {brightest(light[0]), brightest(light[1]), brightest(light[2])};
  const float least = DARKNESS * olx_max(most[0], olx_max(most[1], most[2])) * (relative_to ? 0.1f : 1.0f);
  for (uint32_t g = 0; g < GROUPS; g++) {
    const olx_row own = olx_row_most(light[0][g], olx_row_most(light[1][g], light[2][g]));
    const olx_row unit = unit_of(own, relative_to ? relative_to + LANES * g : NULL, olx_max(least, 0x1p-24f));
    s->unit[g] = 1.0f / unit;
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const olx_row floor = olx_row_least(unit * LEAST_SHARE, olx_row_splat(most[k]));
      s->value[k][g] = light[k][g] * s->unit[g];
      s->line.place[k][g] = places_of(olx_row_most(light[k][g], floor));
      s->line.weight[k][g] = s->line.on[g] * square(olx_row_most(s->value[k][g], olx_row_splat(LEAST_WEIGHT)));
    }
  }
}

// Returns the code of `bits` bits that unquantises nearest to a place.
static uint32_t quantize(float place, uint32_t bits) {
  const float clamped = olx_clamp(place, 0.0f, 65535.0f);
  const uint32_t code =
      bits >= 16 ? (uint32_t)(clamped + 0.5f) : (uint32_t)(clamped * olx_bits_float((111u + bits) << 23));
  const uint32_t most = bits >= 16 ? 0xFFFFu : (1u << bits) - 1;
  return code > most ? most : code;
}

static void quantize_line(const olx_line *l, uint32_t precision, coded_line *c) {
  for (uint32_t k = 0; k < CHANNELS; k++) {
    c->from[k] = quantize(l->from[k], precision);
    c->to[k] = quantize(l->to[k], precision);
  }
}

// Returns whether the mode's bits hold the difference of two codes in either direction.
static bool reaches(const uint32_t a[CHANNELS], const uint32_t b[CHANNELS], const uint8_t difference_bits[CHANNELS]) {
  for (uint32_t k = 0; k < CHANNELS; k++) {
    if (abs((int32_t)a[k] - (int32_t)b[k]) >= 1 << (difference_bits[k] - 1)) return false;
  }
  return true;
}

// Chooses indices from what the codes decode to, and sums the errors.
static void choose_indices(const colours *s, olx_line_steps steps, uint32_t precision, coded_line *c) {
  olx_line l;
  olx_row share[GROUPS], error[GROUPS];
  olx_row_words index[GROUPS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    l.from[k] = (float)olx_bc6h_unquantize(c->from[k], precision);
    l.to[k] = (float)olx_bc6h_unquantize(c->to[k], precision);
  }
  olx_line_choose(&s->line, &l, steps, index, share);
  for (uint32_t g = 0; g < GROUPS; g++) {
    error[g] = olx_row_splat(0.0f);
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const olx_row light = light_at(share[g] * (l.to[k] - l.from[k]) + l.from[k]) * s->unit[g];
      error[g] += s->line.on[g] * square(light - s->value[k][g]);
    }
  }
  c->error = olx_line_sum(error);
  memcpy(c->index, index, sizeof index);
}

// Codes a line in the modes with one region, the finest first. The last mode stores no differences.
static one_region code_line(const colours *s, const olx_line *l) {
  static const struct {
    uint8_t code, precision, difference_bits;
  } MODES[4] = {{15, 16, 4}, {11, 12, 8}, {7, 11, 9}, {3, 10, 10}};
  one_region r;
  for (uint32_t i = 0; i < 4; i++) {
    const uint8_t bits = MODES[i].difference_bits, difference_bits[CHANNELS] = {bits, bits, bits};
    r = (one_region){.code = MODES[i].code, .precision = MODES[i].precision, .difference_bits = bits};
    quantize_line(l, r.precision, &r.line);
    if (reaches(r.line.from, r.line.to, difference_bits)) break;
  }
  choose_indices(s, SIXTEEN, r.precision, &r.line);
  return r;
}

// Returns the line without its darker part, which is `share` of its length.
static olx_line brighter_part(const olx_line *l, float share) {
  const bool rising = l->to[0] + l->to[1] + l->to[2] > l->from[0] + l->from[1] + l->from[2];
  olx_line part = *l;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const float step = share * (l->to[k] - l->from[k]);
    if (rising) part.from[k] += step;
    else part.to[k] -= step;
  }
  return part;
}

static one_region refined_line(const colours *s, olx_line l) {
  for (uint32_t round = 0; round < REFINEMENTS; round++) olx_line_refine(&s->line, SIXTEEN, &l);
  return code_line(s, &l);
}

static one_region best_line(const colours *s) {
  const olx_line whole = olx_line_through(&s->line, CHANNELS);
  float length = 0.0f;
  for (uint32_t k = 0; k < CHANNELS; k++) length = olx_max(length, fabsf(whole.to[k] - whole.from[k]));
  one_region best = refined_line(s, whole);
  for (uint32_t start = 1; start < STARTS && length > LONG_LINE; start++) {
    const one_region r = refined_line(s, brighter_part(&whole, 0.25f * (float)start));
    if (r.line.error < best.line.error) best = r;
  }
  return best;
}

// Returns the texels on the side of the second end, divided where the line's texels separate most clearly.
static uint32_t second_side(const coded_line *line, uint32_t counted) {
  int32_t count[17] = {0}, sum[17] = {0}; // of the texels with lower indices
  for (uint32_t i = 0; i < TEXELS; i++) {
    count[line->index[i] + 1] += (int32_t)(counted >> i & 1u);
    sum[line->index[i] + 1] += line->index[i] * (int32_t)(counted >> i & 1u);
  }
  for (uint32_t k = 1; k <= 16; k++) count[k] += count[k - 1], sum[k] += sum[k - 1];
  int32_t split = 8;
  float most = 0.0f;
  for (int32_t k = 1; k < 16; k++) {
    const float below = (float)count[k], above = (float)(count[16] - count[k]);
    if (below == 0.0f || above == 0.0f) continue;
    const float apart = (float)(sum[16] - sum[k]) / above - (float)sum[k] / below;
    if (below * above * apart * apart <= most) continue;
    most = below * above * apart * apart;
    split = k;
  }
  uint32_t side = 0;
  for (uint32_t i = 0; i < TEXELS; i++) side |= (uint32_t)(line->index[i] >= split) << i;
  return side & counted;
}

// Finds the shapes that divide the counted texels most as `side` does, the best first.
static void nearest_shapes(uint32_t side, uint32_t counted, uint32_t nearest[SHAPES_TRIED]) {
  int distances[SHAPES_TRIED];
  for (uint32_t k = 0; k < SHAPES_TRIED; k++) distances[k] = TEXELS + 1;
  const int all = __builtin_popcount(counted);
  for (uint32_t shape = 0; shape < OLX_BC6H_SHAPES; shape++) {
    const int off = __builtin_popcount((side ^ olx_bc6h_shapes[shape]) & counted),
              distance = off < all - off ? off : all - off;
    uint32_t place = SHAPES_TRIED;
    while (place > 0 && distance < distances[place - 1]) place--;
    for (uint32_t k = SHAPES_TRIED - 1; k > place && k < SHAPES_TRIED; k--) {
      distances[k] = distances[k - 1];
      nearest[k] = nearest[k - 1];
    }
    if (place == SHAPES_TRIED) continue;
    distances[place] = distance;
    nearest[place] = shape;
  }
}

static void keep_texels(colours *s, uint32_t texels) {
  for (uint32_t g = 0; g < GROUPS; g++) {
    const uint32_t bits = texels >> LANES * g;
    const olx_row on = {(float)(bits & 1u), (float)(bits >> 1 & 1u), (float)(bits >> 2 & 1u), (float)(bits >> 3 & 1u)};
    s->line.on[g] = on;
    for (uint32_t k = 0; k < CHANNELS; k++) s->line.weight[k][g] *= on;
  }
}

// Returns whether the mode holds the differences of all ends from either end of the first line, because the indices
// decide which of these comes first.
static bool mode_reaches(const olx_bc6h_mode *m, const coded_line lines[REGIONS]) {
  if (!m->difference_bits[0]) return true;
  const coded_line *first = &lines[0], *second = &lines[1];
  const uint8_t *bits = m->difference_bits;
  return reaches(first->from, first->to, bits) && reaches(first->from, second->from, bits) &&
         reaches(first->from, second->to, bits) && reaches(first->to, second->from, bits) &&
         reaches(first->to, second->to, bits);
}

// Codes two lines in the modes with two regions, the finest first.
static void code_lines(const colours parts[REGIONS], const olx_line lines[REGIONS], two_regions *r) {
  static const uint8_t FINEST_FIRST[OLX_BC6H_TWO_REGION_MODES] = {2, 3, 4, 0, 5, 6, 7, 8, 1, 9};
  for (uint32_t i = 0; i < OLX_BC6H_TWO_REGION_MODES; i++) {
    r->mode = &olx_bc6h_two_region_modes[FINEST_FIRST[i]];
    for (uint32_t k = 0; k < REGIONS; k++) quantize_line(&lines[k], r->mode->precision, &r->lines[k]);
    if (mode_reaches(r->mode, r->lines)) break;
  }
  for (uint32_t k = 0; k < REGIONS; k++) choose_indices(&parts[k], EIGHT, r->mode->precision, &r->lines[k]);
  r->error = r->lines[0].error + r->lines[1].error;
}

static two_regions best_lines(const colours *s, const coded_line *one, uint32_t counted) {
  uint32_t shapes[SHAPES_TRIED] = {0};
  two_regions best = {.error = INFINITY};
  nearest_shapes(second_side(one, counted), counted, shapes);
  for (uint32_t i = 0; i < SHAPES_TRIED; i++) {
    const uint32_t second = olx_bc6h_shapes[shapes[i]] & counted;
    if (second == 0 || second == counted) continue;
    colours parts[REGIONS] = {*s, *s};
    olx_line lines[REGIONS];
    keep_texels(&parts[0], counted & ~second);
    keep_texels(&parts[1], second);
    for (uint32_t k = 0; k < REGIONS; k++) {
      lines[k] = olx_line_through(&parts[k].line, CHANNELS);
      olx_line_refine(&parts[k].line, EIGHT, &lines[k]);
    }
    two_regions r = {.shape = shapes[i]};
    code_lines(parts, lines, &r);
    if (r.error < best.error) best = r;
  }
  return best;
}

static uint32_t reversed(uint32_t value, uint32_t count) {
  uint32_t result = 0;
  for (uint32_t i = 0; i < count; i++) result |= (value >> i & 1u) << (count - 1 - i);
  return result;
}

// Swaps the ends where the index of the line's first texel has its highest bit set, because that index is stored with
// one bit less.
static void turn(coded_line *c, uint32_t first_texel, int32_t last_index) {
  if (2 * c->index[first_texel] < last_index) return;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const uint32_t from = c->from[k];
    c->from[k] = c->to[k];
    c->to[k] = from;
  }
  for (uint32_t i = 0; i < TEXELS; i++) c->index[i] = last_index - c->index[i];
}

static olx_bc6h_block stored(const olx_block_writer *w) {
  olx_bc6h_block block;
  olx_block_store(w, block.words);
  return block;
}

static olx_bc6h_block write_one(one_region *r) {
  coded_line *c = &r->line;
  const uint32_t more = r->precision > 10 ? r->precision - 10 : 0;
  turn(c, 0, 15);
  olx_block_writer w = {0, 0, 0};
  olx_block_put(&w, r->code, 5);
  for (uint32_t k = 0; k < CHANNELS; k++) olx_block_put(&w, c->from[k] & 1023u, 10);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const uint32_t difference = r->precision == 10 ? c->to[k] : c->to[k] - c->from[k];
    olx_block_put(&w, difference & ((1u << r->difference_bits) - 1), r->difference_bits);
    olx_block_put(&w, reversed(c->from[k] >> 10, more), more);
  }
  for (uint32_t i = 0; i < TEXELS; i++) olx_block_put(&w, (uint32_t)c->index[i], i == 0 ? 3 : 4);
  return stored(&w);
}

static olx_bc6h_block write_two(two_regions *r) {
  const uint32_t anchor = olx_bc6h_anchors[r->shape], shape = olx_bc6h_shapes[r->shape];
  turn(&r->lines[0], 0, 7);
  turn(&r->lines[1], anchor, 7);
  const uint32_t *ends[OLX_BC6H_ENDS] = {r->lines[0].from, r->lines[0].to, r->lines[1].from, r->lines[1].to};
  olx_block_writer w = {0, 0, 0};
  olx_block_put(&w, r->mode->code, r->mode->code_bits);
  for (const olx_bc6h_run *run = r->mode->runs; run->count; run++) {
    const uint32_t end = run->of / CHANNELS, channel = run->of % CHANNELS;
    const bool differs = end > 0 && r->mode->difference_bits[channel];
    const uint32_t number = ends[end][channel] - (differs ? ends[0][channel] : 0);
    olx_block_put(&w, number >> run->first & ((1u << run->count) - 1), run->count);
  }
  olx_block_put(&w, r->shape, 5);
  for (uint32_t i = 0; i < TEXELS; i++) {
    olx_block_put(&w, (uint32_t)r->lines[shape >> i & 1u].index[i], i == 0 || i == anchor ? 2 : 3);
  }
  return stored(&w);
}

olx_bc6h_block olx_bc6h_encode(const olx_vec3 texels[16], const float relative_to[16], uint32_t counted) {
  counted &= 0xFFFFu;
  if (!counted) return (olx_bc6h_block){{OLX_BC6H_BLACK}}; // a mode with one region, because those decode fastest
  colours s;
  set_colours(&s, texels, relative_to, counted);
  one_region one = best_line(&s);
  if (one.line.error > ENOUGH * (float)(CHANNELS * __builtin_popcount(counted))) {
    two_regions two = best_lines(&s, &one.line, counted);
    if (two.error < one.line.error) return write_two(&two);
  }
  return write_one(&one);
}
