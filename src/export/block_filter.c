// Filters blocks of a chunk before they are packed, and inverts the filters. docs/format.md, "Packed fields", is the
// specification.
#include "export/block_filter.h"

#include <string.h>

bool olx_filter_exists(uint32_t filter, uint32_t element_bytes) {
  const bool size = element_bytes == 1 || element_bytes == 2 || element_bytes == 4 || element_bytes == 8;
  return size && filter < OLX_FILTERS && (!(filter & OLX_FILTER_COLORS) || element_bytes == 4);
}

// Bits 0 to 8 are red, 9 to 17 green, 18 to 26 blue, 27 to 31 the exponent. The lowest bit of each channel moves to the
// exponent's byte.
static uint32_t gather_color(uint32_t c) {
  return (c >> 1 & 0xFFu) | (c >> 10 & 0xFFu) << 8 | (c >> 19 & 0xFFu) << 16 | (c >> 27) << 24 | (c & 1u) << 31 |
         (c >> 9 & 1u) << 30 | (c >> 18 & 1u) << 29;
}

static uint32_t scatter_color(uint32_t g) {
  return (g & 0xFFu) << 1 | (g >> 8 & 0xFFu) << 10 | (g >> 16 & 0xFFu) << 19 | (g >> 24 & 0x1Fu) << 27 | g >> 31 |
         (g >> 30 & 1u) << 9 | (g >> 29 & 1u) << 18;
}

static void change_colors(uint8_t *data, size_t size_bytes, uint32_t (*change)(uint32_t)) {
  for (size_t i = 0; i + 4 <= size_bytes; i += 4) {
    uint32_t word;
    memcpy(&word, data + i, 4);
    word = change(word);
    memcpy(data + i, &word, 4);
  }
}

static void subtract(uint8_t *data, size_t element_bytes, size_t size_bytes) {
  for (size_t i = size_bytes; i-- > element_bytes;) data[i] = (uint8_t)(data[i] - data[i - element_bytes]);
}

static void add(uint8_t *data, size_t element_bytes, size_t size_bytes) {
  for (size_t i = element_bytes; i < size_bytes; i++) data[i] = (uint8_t)(data[i] + data[i - element_bytes]);
}

static void split(const uint8_t *data, uint8_t *planes, size_t element_bytes, size_t size_bytes) {
  const size_t count = size_bytes / element_bytes;
  for (size_t byte = 0; byte < element_bytes; byte++) {
    for (size_t i = 0; i < count; i++) planes[byte * count + i] = data[i * element_bytes + byte];
  }
  memcpy(planes + count * element_bytes, data + count * element_bytes, size_bytes - count * element_bytes);
}

static void join(const uint8_t *planes, uint8_t *data, size_t element_bytes, size_t size_bytes) {
  const size_t count = size_bytes / element_bytes;
  for (size_t byte = 0; byte < element_bytes; byte++) {
    for (size_t i = 0; i < count; i++) data[i * element_bytes + byte] = planes[byte * count + i];
  }
  memcpy(data + count * element_bytes, planes + count * element_bytes, size_bytes - count * element_bytes);
}

uint8_t *olx_filter_apply(uint32_t filter, uint32_t element_bytes, uint8_t *data, uint8_t *room, size_t size_bytes) {
  if (filter & OLX_FILTER_COLORS) change_colors(data, size_bytes, gather_color);
  if (filter & OLX_FILTER_DIFFERENCES) subtract(data, element_bytes, size_bytes);
  if (!(filter & OLX_FILTER_PLANES)) return data;
  split(data, room, element_bytes, size_bytes);
  return room;
}

uint8_t *olx_filter_undo(uint32_t filter, uint32_t element_bytes, uint8_t *data, uint8_t *room, size_t size_bytes) {
  if (filter & OLX_FILTER_PLANES) {
    join(data, room, element_bytes, size_bytes);
    data = room;
  }
  if (filter & OLX_FILTER_DIFFERENCES) add(data, element_bytes, size_bytes);
  if (filter & OLX_FILTER_COLORS) change_colors(data, size_bytes, scatter_color);
  return data;
}
