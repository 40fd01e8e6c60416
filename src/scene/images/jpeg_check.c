// Checks the segments of a JPEG by stb_image's rules before it decodes them: bytes between two segments are skipped up
// to the next byte FF. So is coded data after a scan's segment, where FF 00 encodes FF and FF D0 to FF D7 restart.
#include "scene/images/jpeg_check.h"

#include "core/result.h"

enum {
  TABLES = 0xC4,
  RESTART_FIRST = 0xD0,
  RESTART_LAST = 0xD7,
  START = 0xD8,
  END = 0xD9,
  TEMPORARY = 0x01,
  MOST_CODES = 256
};

typedef struct jpeg_reader {
  const uint8_t *data;
  size_t size_bytes, at;
} jpeg_reader;

// Returns the next marker, after any bytes FF; END where there is none.
static uint32_t next_marker(jpeg_reader *r) {
  while (r->at < r->size_bytes && r->data[r->at] != 0xFF) r->at++;
  while (r->at < r->size_bytes && r->data[r->at] == 0xFF) r->at++;
  return r->at < r->size_bytes ? r->data[r->at++] : END;
}

static bool stands_alone(uint32_t marker) {
  return marker == 0 || marker == TEMPORARY || marker == START || (marker >= RESTART_FIRST && marker <= RESTART_LAST);
}

// Checks a segment's tables: a byte of kind, sixteen counts of codes by length, and the codes. stb_image itself rejects
// truncated tables.
static bool check_tables(const uint8_t *tables, size_t size_bytes) {
  while (size_bytes >= 17) {
    size_t codes = 0;
    for (uint32_t i = 1; i <= 16; i++) codes += tables[i];
    if (codes > MOST_CODES) return false;
    const size_t table_bytes = 17 + codes < size_bytes ? 17 + codes : size_bytes;
    tables += table_bytes;
    size_bytes -= table_bytes;
  }
  return size_bytes == 0;
}

olx_result olx_jpeg_check(const char *path, const uint8_t *data, size_t size_bytes) {
  jpeg_reader r = {.data = data, .size_bytes = size_bytes};
  if (size_bytes < 2 || data[0] != 0xFF || next_marker(&r) != START) return OLX_OK;
  for (uint32_t marker; (marker = next_marker(&r)) != END;) {
    if (stands_alone(marker)) continue;
    if (size_bytes - r.at < 2) return OLX_OK;
    const size_t segment_bytes = (size_t)data[r.at] << 8 | data[r.at + 1], left = size_bytes - r.at;
    if (segment_bytes < 2) continue;
    const size_t held = segment_bytes < left ? segment_bytes : left;
    if (marker == TABLES && !check_tables(data + r.at + 2, held - 2)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: a Huffman table of this JPEG is damaged", path);
    }
    r.at += held;
  }
  return OLX_OK;
}
