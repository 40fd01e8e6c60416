// Decodes all fourteen modes of BC6H. Modes with one region store their numbers in regular places and are read
// directly; modes with two regions scatter theirs, and are read by a table of runs of bits.
#include "block/bc6h.h"

const uint16_t olx_bc6h_shapes[OLX_BC6H_SHAPES] = {0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
                                                   0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000,
                                                   0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE,
                                                   0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C};
const uint8_t olx_bc6h_anchors[OLX_BC6H_SHAPES] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                                   15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};

enum { CHANNELS = OLX_BC6H_CHANNELS, ENDS = OLX_BC6H_ENDS, TWO_REGION_INDICES = 82, SHAPE_AT = 77, SHAPE_BITS = 5 };

// Inlines a function into each mode's case, where the numbers of bits are constants.
#define INLINE __attribute__((always_inline)) static inline

// The three channels of a colour, in four lanes.
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_words __attribute__((vector_size(16)));

// A block as two words, the first bit lowest.
typedef struct bits {
  uint64_t low, high;
} bits;

static bits bits_of(const olx_bc6h_block *block) {
  const uint32_t *w = block->words;
  return (bits){w[0] | (uint64_t)w[1] << 32, w[2] | (uint64_t)w[3] << 32};
}

INLINE uint32_t read(bits b, uint32_t at, uint32_t count) {
  const uint64_t from = at >= 64 ? b.high >> (at - 64) : at == 0 ? b.low : b.low >> at | b.high << (64 - at);
  return (uint32_t)from & ((1u << count) - 1);
}

INLINE uint32_t reversed(uint32_t value, uint32_t count) {
  uint32_t result = 0;
  for (uint32_t i = 0; i < count; i++) result |= (value >> i & 1u) << (count - 1 - i);
  return result;
}

// Returns the share of a line's second end in 64ths, for an index from 0 to 15.
INLINE uint32_t share_of_16(uint32_t index) { return (64 * index + 7) / 15; }
INLINE uint32_t share_of_8(uint32_t index) { return (64 * index + 3) / 7; }

// Adds a signed difference of `difference_bits` bits.
INLINE uint32_t add_signed(uint32_t base, uint32_t difference, uint32_t difference_bits, uint32_t precision) {
  const uint32_t sign = 1u << (difference_bits - 1);
  return (base + (difference ^ sign) - sign) & ((1u << precision) - 1);
}

// Returns the first end of a mode with one region. Each channel has ten bits of its first end, and ten more that hold a
// difference and the remaining bits of the first end, the highest bit first.
INLINE int32_t first_end(bits b, uint32_t c, uint32_t precision, uint32_t difference_bits) {
  const uint32_t more = reversed(read(b, 35 + 10 * c, 10) >> difference_bits, precision - 10);
  return (int32_t)(read(b, 5 + 10 * c, 10) | more << 10);
}

INLINE int32_t second_end(bits b, uint32_t c, uint32_t precision, uint32_t difference_bits, int32_t first) {
  const uint32_t difference = read(b, 35 + 10 * c, difference_bits);
  return (int32_t)(precision > 10 ? add_signed((uint32_t)first, difference, difference_bits, precision) : difference);
}

// Ends 0 to 3 are w, x, y and z.
enum { RW, GW, BW, RX, GX, BX, RY, GY, BY, RZ, GZ, BZ };

// clang-format off
const olx_bc6h_mode olx_bc6h_two_region_modes[OLX_BC6H_TWO_REGION_MODES] = {
    {2, 0, 10, {5, 5, 5},
     {{GY, 4, 1}, {BY, 4, 1}, {BZ, 4, 1}, {RW, 0, 10}, {GW, 0, 10}, {BW, 0, 10}, {RX, 0, 5}, {GZ, 4, 1}, {GY, 0, 4},
      {GX, 0, 5}, {BZ, 0, 1}, {GZ, 0, 4}, {BX, 0, 5}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 5}, {BZ, 2, 1}, {RZ, 0, 5},
      {BZ, 3, 1}}},
    {2, 1, 7, {6, 6, 6},
     {{GY, 5, 1}, {GZ, 4, 2}, {RW, 0, 7}, {BZ, 0, 2}, {BY, 4, 1}, {GW, 0, 7}, {BY, 5, 1}, {BZ, 2, 1}, {GY, 4, 1},
      {BW, 0, 7}, {BZ, 3, 1}, {BZ, 5, 1}, {BZ, 4, 1}, {RX, 0, 6}, {GY, 0, 4}, {GX, 0, 6}, {GZ, 0, 4}, {BX, 0, 6},
      {BY, 0, 4}, {RY, 0, 6}, {RZ, 0, 6}}},
    {5, 2, 11, {5, 4, 4},
     {{RW, 0, 10}, {GW, 0, 10}, {BW, 0, 10}, {RX, 0, 5}, {RW, 10, 1}, {GY, 0, 4}, {GX, 0, 4}, {GW, 10, 1}, {BZ, 0, 1},
      {GZ, 0, 4}, {BX, 0, 4}, {BW, 10, 1}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 5}, {BZ, 2, 1}, {RZ, 0, 5}, {BZ, 3, 1}}},
    {5, 6, 11, {4, 5, 4},
     {{RW, 0, 10}, {GW, 0, 10}, {BW, 0, 10}, {RX, 0, 4}, {RW, 10, 1}, {GZ, 4, 1}, {GY, 0, 4}, {GX, 0, 5}, {GW, 10, 1},
      {GZ, 0, 4}, {BX, 0, 4}, {BW, 10, 1}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 4}, {BZ, 0, 1}, {BZ, 2, 1}, {RZ, 0, 4},
      {GY, 4, 1}, {BZ, 3, 1}}},
    {5, 10, 11, {4, 4, 5},
     {{RW, 0, 10}, {GW, 0, 10}, {BW, 0, 10}, {RX, 0, 4}, {RW, 10, 1}, {BY, 4, 1}, {GY, 0, 4}, {GX, 0, 4}, {GW, 10, 1},
      {BZ, 0, 1}, {GZ, 0, 4}, {BX, 0, 5}, {BW, 10, 1}, {BY, 0, 4}, {RY, 0, 4}, {BZ, 1, 2}, {RZ, 0, 4}, {BZ, 4, 1},
      {BZ, 3, 1}}},
    {5, 14, 9, {5, 5, 5},
     {{RW, 0, 9}, {BY, 4, 1}, {GW, 0, 9}, {GY, 4, 1}, {BW, 0, 9}, {BZ, 4, 1}, {RX, 0, 5}, {GZ, 4, 1}, {GY, 0, 4},
      {GX, 0, 5}, {BZ, 0, 1}, {GZ, 0, 4}, {BX, 0, 5}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 5}, {BZ, 2, 1}, {RZ, 0, 5},
      {BZ, 3, 1}}},
    {5, 18, 8, {6, 5, 5},
     {{RW, 0, 8}, {GZ, 4, 1}, {BY, 4, 1}, {GW, 0, 8}, {BZ, 2, 1}, {GY, 4, 1}, {BW, 0, 8}, {BZ, 3, 2}, {RX, 0, 6},
      {GY, 0, 4}, {GX, 0, 5}, {BZ, 0, 1}, {GZ, 0, 4}, {BX, 0, 5}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 6}, {RZ, 0, 6}}},
    {5, 22, 8, {5, 6, 5},
     {{RW, 0, 8}, {BZ, 0, 1}, {BY, 4, 1}, {GW, 0, 8}, {GY, 5, 1}, {GY, 4, 1}, {BW, 0, 8}, {GZ, 5, 1}, {BZ, 4, 1},
      {RX, 0, 5}, {GZ, 4, 1}, {GY, 0, 4}, {GX, 0, 6}, {GZ, 0, 4}, {BX, 0, 5}, {BZ, 1, 1}, {BY, 0, 4}, {RY, 0, 5},
      {BZ, 2, 1}, {RZ, 0, 5}, {BZ, 3, 1}}},
    {5, 26, 8, {5, 5, 6},
     {{RW, 0, 8}, {BZ, 1, 1}, {BY, 4, 1}, {GW, 0, 8}, {BY, 5, 1}, {GY, 4, 1}, {BW, 0, 8}, {BZ, 5, 1}, {BZ, 4, 1},
      {RX, 0, 5}, {GZ, 4, 1}, {GY, 0, 4}, {GX, 0, 5}, {BZ, 0, 1}, {GZ, 0, 4}, {BX, 0, 6}, {BY, 0, 4}, {RY, 0, 5},
      {BZ, 2, 1}, {RZ, 0, 5}, {BZ, 3, 1}}},
    {5, 30, 6, {0, 0, 0},
     {{RW, 0, 6}, {GZ, 4, 1}, {BZ, 0, 2}, {BY, 4, 1}, {GW, 0, 6}, {GY, 5, 1}, {BY, 5, 1}, {BZ, 2, 1}, {GY, 4, 1},
      {BW, 0, 6}, {GZ, 5, 1}, {BZ, 3, 1}, {BZ, 5, 1}, {BZ, 4, 1}, {RX, 0, 6}, {GY, 0, 4}, {GX, 0, 6}, {GZ, 0, 4},
      {BX, 0, 6}, {BY, 0, 4}, {RY, 0, 6}, {RZ, 0, 6}}},
};
// clang-format on

// Reads the ends of one of the two regions of a block.
static void read_region(bits b, const olx_bc6h_mode *m, uint32_t region, four_words *from, four_words *to) {
  uint32_t ends[CHANNELS * ENDS] = {0}, at = m->code_bits;
  for (const olx_bc6h_run *r = m->runs; r->count; r++) {
    ends[r->of] |= read(b, at, r->count) << r->first;
    at += r->count;
  }
  for (uint32_t c = 0; c < CHANNELS; c++) {
    for (uint32_t e = 1; e < ENDS && m->difference_bits[c]; e++) {
      ends[CHANNELS * e + c] = add_signed(ends[c], ends[CHANNELS * e + c], m->difference_bits[c], m->precision);
    }
    (*from)[c] = (int32_t)ends[2 * CHANNELS * region + c];
    (*to)[c] = (int32_t)ends[2 * CHANNELS * region + CHANNELS + c];
  }
}

// Interpolates between two ends. Whole numbers up to 2^22 are exact in floats, whose vectors multiply fast on any
// machine.
INLINE olx_vec3 mix_line(four_words from, four_words to, uint32_t share) {
  const float part = (float)share;
  const four mixed =
      __builtin_convertvector(from, four) * (64.0f - part) + __builtin_convertvector(to, four) * part + 32.0f;
  const four_words whole = __builtin_convertvector(mixed, four_words) >> 6, half = ((whole << 5) - whole) >> 6;
  const four light = (four)(half << 13) * 0x1p112f;
  return olx_v3(light[0], light[1], light[2]);
}

// Applies olx_bc6h_unquantize to each channel.
INLINE four_words unquantize(four_words code, uint32_t precision) {
  if (precision >= 15) return code;
  const int32_t half = 0x8000 >> precision, most = (1 << precision) - 1;
  return (code << (16 - precision)) + half - ((code == 0) & half) + ((code == most) & (half - 1));
}

INLINE olx_vec3 one_region_texel(bits b, uint32_t texel, uint32_t precision, uint32_t difference_bits) {
  const int32_t r = first_end(b, 0, precision, difference_bits), g = first_end(b, 1, precision, difference_bits),
                l = first_end(b, 2, precision, difference_bits);
  const four_words from = {r, g, l, 0}, to = {second_end(b, 0, precision, difference_bits, r),
                                              second_end(b, 1, precision, difference_bits, g),
                                              second_end(b, 2, precision, difference_bits, l), 0};
  const uint32_t index = texel == 0 ? (uint32_t)b.high >> 1 & 7u : (uint32_t)(b.high >> 4 * texel) & 15u;
  return mix_line(unquantize(from, precision), unquantize(to, precision), share_of_16(index));
}

// Decodes a texel of a mode with two regions. It is not inlined, because it needs more registers than the modes with
// one region.
__attribute__((noinline)) static olx_vec3 two_region_texel(bits b, uint32_t texel, const olx_bc6h_mode *m) {
  const uint32_t shape = read(b, SHAPE_AT, SHAPE_BITS), anchor = olx_bc6h_anchors[shape];
  const uint32_t at = TWO_REGION_INDICES + 3 * texel - (texel > 0) - (texel > anchor);
  const uint32_t index = read(b, at, texel == 0 || texel == anchor ? 2 : 3);
  four_words from = {0}, to = {0};
  read_region(b, m, olx_bc6h_shapes[shape] >> texel & 1u, &from, &to);
  return mix_line(unquantize(from, m->precision), unquantize(to, m->precision), share_of_8(index));
}

olx_vec3 olx_bc6h_texel(const olx_bc6h_block *block, uint32_t texel) {
  const bits b = bits_of(block);
  const uint32_t code = (uint32_t)b.low & 31u;
  switch (code) {
  case 3: return one_region_texel(b, texel, 10, 10);
  case 7: return one_region_texel(b, texel, 11, 9);
  case 11: return one_region_texel(b, texel, 12, 8);
  case 15: return one_region_texel(b, texel, 16, 4);
  case 19:
  case 23:
  case 27:
  case 31: return olx_splat(0.0f);
  default: return two_region_texel(b, texel, &olx_bc6h_two_region_modes[(code & 3u) < 2 ? code & 3u : 2 + code / 4]);
  }
}
