// Reversible filters that reorder the bytes of a block, or replace them by differences, so that they compress better.
#ifndef OLX_EXPORT_BLOCK_FILTER_H
#define OLX_EXPORT_BLOCK_FILTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Bits of a filter, applied in this order and inverted in the reverse order.
enum {
  OLX_FILTER_COLORS = 1, // of RGB9E5, in 4-byte elements: one byte for the high bits of each channel, one for the rest
  OLX_FILTER_DIFFERENCES = 2, // each byte minus the byte at the same position in the element before
  OLX_FILTER_PLANES = 4,      // the first bytes of all elements, then the second bytes, and so on
  OLX_FILTERS = 8
};

// Returns whether a filter exists for elements of that many bytes: 1, 2, 4 or 8.
bool olx_filter_exists(uint32_t filter, uint32_t element_bytes);

// Applies a filter. `room` is as large as the data. Bytes after the last whole element are unchanged. Returns `data` or
// `room`, whichever holds the result; the other one is overwritten.
uint8_t *olx_filter_apply(uint32_t filter, uint32_t element_bytes, uint8_t *data, uint8_t *room, size_t size_bytes);
uint8_t *olx_filter_undo(uint32_t filter, uint32_t element_bytes, uint8_t *data, uint8_t *room, size_t size_bytes);

#endif
