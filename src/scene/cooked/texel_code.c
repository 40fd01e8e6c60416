// Codes 8-bit texels losslessly: predicts each from its neighbours, and stores the differences in Rice codes with an
// adaptive parameter.
#include "scene/cooked/texel_code.h"

#include "core/hooks.h"

#include <string.h>

// A unary part of this many ones is followed by the plain difference in 8 bits.
enum { ESCAPE = 15, HALVE_AT = 64, START_SUM = 8, START_COUNT = 2 };

// The size of recent differences of a channel.
typedef struct rice_state {
  uint32_t sum, count;
} rice_state;

static uint32_t rice_parameter(const rice_state *state) {
  uint32_t k = 0;
  while (k < 7 && state->count << k < state->sum) k++;
  return k;
}

static void rice_update(rice_state *state, uint32_t value) {
  state->sum += value;
  if (++state->count < HALVE_AT) return;
  state->sum /= 2;
  state->count /= 2;
}

// ---- Prediction

// Returns the value of a channel relative to green, so that grey texels cost little.
static inline uint8_t plane_value(const uint8_t *texel, uint32_t channel) {
  return channel == 0 || channel == 2 ? (uint8_t)(texel[channel] - texel[1]) : texel[channel];
}

static inline uint8_t median_prediction(int left, int above, int corner) {
  const int low = left < above ? left : above, high = left < above ? above : left;
  return (uint8_t)(corner >= high ? low : corner <= low ? high : left + above - corner);
}

static inline uint8_t predict(const uint8_t *rgba, uint32_t width, uint32_t x, uint32_t y, uint32_t channel) {
  const size_t row = (size_t)4 * width;
  if (y == 0) return x == 0 ? 0 : plane_value(rgba - 4, channel);
  const uint8_t above = plane_value(rgba - row, channel);
  if (x == 0) return above;
  return median_prediction(plane_value(rgba - 4, channel), above, plane_value(rgba - row - 4, channel));
}

// The order of channels: green first, because red and blue are predicted from it.
static const uint32_t channel_order[4] = {1, 0, 2, 3};

// Maps 0, -1, 1, -2, 2 ... to 0, 1, 2, 3, 4 ...
static uint32_t fold_difference(uint8_t difference) {
  return difference < 128 ? 2u * difference : 2u * (255u - difference) + 1u;
}

static uint8_t unfold_difference(uint32_t value) { return (uint8_t)(value & 1 ? 255u - value / 2 : value / 2); }

// ---- Bits, most significant first

typedef struct bit_writer {
  olx_byte_buffer *buffer;
  uint64_t bits;
  uint32_t count;
} bit_writer;

static bool reserve(olx_byte_buffer *buffer, size_t added) {
  if (buffer->size_bytes + added <= buffer->capacity_bytes) return true;
  const size_t capacity_bytes = 2 * buffer->capacity_bytes + added + 65536;
  uint8_t *grown = olx_allocate(capacity_bytes, 1);
  if (!grown) return false;
  if (buffer->size_bytes) memcpy(grown, buffer->data, buffer->size_bytes);
  olx_release(buffer->data);
  buffer->data = grown;
  buffer->capacity_bytes = capacity_bytes;
  return true;
}

static void put_bits(bit_writer *w, uint32_t bits, uint32_t count) {
  w->bits = w->bits << count | bits;
  w->count += count;
  while (w->count >= 8) {
    w->count -= 8;
    w->buffer->data[w->buffer->size_bytes++] = (uint8_t)(w->bits >> w->count);
  }
}

static void put_value(bit_writer *w, rice_state *state, uint32_t value) {
  const uint32_t k = rice_parameter(state), ones = value >> k;
  if (ones < ESCAPE) {
    put_bits(w, (1u << (ones + 1)) - 2, ones + 1);
    put_bits(w, value & ((1u << k) - 1), k);
  } else {
    put_bits(w, (1u << ESCAPE) - 1, ESCAPE);
    put_bits(w, value, 8);
  }
  rice_update(state, value);
}

typedef struct bit_reader {
  const uint8_t *next, *end;
  uint64_t bits; // the next bits, left-aligned; zeros after the end
  uint32_t count;
  bool overrun;
} bit_reader;

static void refill(bit_reader *r) {
  while (r->count <= 56 && r->next < r->end) {
    r->bits |= (uint64_t)*r->next++ << (56 - r->count);
    r->count += 8;
  }
}

static uint32_t get_bits(bit_reader *r, uint32_t count) {
  if (count == 0) return 0;
  if (count > r->count) {
    r->overrun = true;
    return 0;
  }
  const uint32_t bits = (uint32_t)(r->bits >> (64 - count));
  r->bits <<= count;
  r->count -= count;
  return bits;
}

static uint32_t get_value(bit_reader *r, rice_state *state) {
  refill(r); // at most 23 bits are needed
  const uint32_t k = rice_parameter(state);
  const uint64_t zeros = ~r->bits;
  const uint32_t ones = zeros ? (uint32_t)__builtin_clzll(zeros) : 64;
  uint32_t value;
  if (ones < ESCAPE) {
    get_bits(r, ones + 1);
    value = ones << k | get_bits(r, k);
  } else {
    get_bits(r, ESCAPE);
    value = get_bits(r, 8);
  }
  rice_update(state, value);
  return value;
}

// ---- Textures

uint32_t olx_texel_channels(const olx_texture *texture) {
  const size_t count = (size_t)texture->width * texture->height;
  bool opaque = true, grey = true;
  for (size_t i = 0; i < count && opaque; i++) {
    const uint8_t *texel = texture->texels + 4 * i;
    opaque = texel[3] == 255;
    grey = grey && texel[0] == texel[1] && texel[0] == texel[2];
  }
  return !opaque ? 4 : grey ? 1 : 3;
}

static void start(rice_state states[4]) {
  for (uint32_t i = 0; i < 4; i++) states[i] = (rice_state){.sum = START_SUM, .count = START_COUNT};
}

bool olx_texel_encode(const olx_texture *texture, uint32_t channels, olx_byte_buffer *buffer) {
  bit_writer writer = {.buffer = buffer};
  rice_state states[4];
  start(states);
  for (uint32_t y = 0; y < texture->height; y++) {
    if (!reserve(buffer, (size_t)3 * channels * texture->width + 8)) return false;
    const uint8_t *rgba = texture->texels + (size_t)4 * texture->width * y;
    for (uint32_t x = 0; x < texture->width; x++, rgba += 4) {
      for (uint32_t i = 0; i < channels; i++) {
        const uint32_t channel = channel_order[i];
        const uint8_t expected = predict(rgba, texture->width, x, y, channel);
        put_value(&writer, &states[i], fold_difference((uint8_t)(plane_value(rgba, channel) - expected)));
      }
    }
  }
  if (writer.count > 0) put_bits(&writer, 0, 8 - writer.count);
  return true;
}

static void store_channel(uint8_t *rgba, uint32_t channel, uint8_t value) {
  rgba[channel] = channel == 0 || channel == 2 ? (uint8_t)(value + rgba[1]) : value;
}

bool olx_texel_decode(const uint8_t *bytes, size_t size_bytes, uint32_t channels, olx_texture *texture) {
  bit_reader reader = {.next = bytes, .end = bytes + size_bytes};
  rice_state states[4];
  start(states);
  uint8_t *rgba = texture->texels;
  for (uint32_t y = 0; y < texture->height && !reader.overrun; y++) {
    for (uint32_t x = 0; x < texture->width; x++, rgba += 4) {
      for (uint32_t i = 0; i < channels; i++) {
        const uint32_t channel = channel_order[i];
        const uint8_t expected = predict(rgba, texture->width, x, y, channel);
        store_channel(rgba, channel, (uint8_t)(expected + unfold_difference(get_value(&reader, &states[i]))));
      }
      if (channels == 1) rgba[0] = rgba[2] = rgba[1];
      if (channels < 4) rgba[3] = 255;
    }
  }
  return !reader.overrun && reader.next == reader.end && reader.count < 8 && reader.bits == 0;
}
