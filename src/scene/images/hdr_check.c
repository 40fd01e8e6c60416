// Checks the rows of a Radiance image by stb_image's rules before it decodes them: four bytes per texel, or runs of
// each of the four channels where a row begins with 2, 2 and its width.
#include "scene/images/hdr_check.h"

#include "core/result.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { LEAST_WIDTH_OF_RUNS = 8, LONGEST_RUN = 128 };

typedef struct hdr_reader {
  const uint8_t *at, *end;
} hdr_reader;

// Reads a line; false when it is empty, or begins with a zero byte.
static bool next_line(hdr_reader *r) {
  const uint8_t *line = r->at, *stop = memchr(line, '\n', (size_t)(r->end - line));
  r->at = stop ? stop + 1 : r->end;
  return stop && stop > line && *line != 0;
}

static bool has(const hdr_reader *r, uint64_t size_bytes) { return (uint64_t)(r->end - r->at) >= size_bytes; }

// Checks the runs that hold one of the four channels of a row.
static bool check_runs(hdr_reader *r, uint32_t width) {
  for (uint32_t left = width; left > 0;) {
    if (!has(r, 1)) return false;
    const uint32_t count = *r->at++;
    const uint32_t texels = count > LONGEST_RUN ? count - LONGEST_RUN : count, stored = count > LONGEST_RUN ? 1 : count;
    if (texels == 0 || texels > left || !has(r, stored)) return false;
    r->at += stored;
    left -= texels;
  }
  return true;
}

static bool check_rows(hdr_reader *r, uint32_t width, uint32_t height) {
  for (uint32_t y = 0; y < height; y++) {
    if (!has(r, 4)) return false;
    const uint8_t *row = r->at;
    // A row without runs restarts the image, without any.
    const bool runs = width >= LEAST_WIDTH_OF_RUNS && row[0] == 2 && row[1] == 2 && !(row[2] & 0x80);
    if (!runs) return has(r, (uint64_t)width * height * 4);
    if (((uint32_t)row[2] << 8 | row[3]) != width) return false;
    r->at += 4;
    for (uint32_t i = 0; i < 4; i++) {
      if (!check_runs(r, width)) return false;
    }
  }
  return true;
}

// Parses the line "-Y HEIGHT +X WIDTH", only in the usual form; false for any other line.
static bool read_size(hdr_reader *r, uint32_t *width, uint32_t *height) {
  char line[64] = {0};
  const hdr_reader begin = *r;
  (void)next_line(r);
  const size_t length = (size_t)(r->at - begin.at);
  memcpy(line, begin.at, length < sizeof line ? length : sizeof line - 1);
  return sscanf(line, "-Y %9" SCNu32 " +X %9" SCNu32, height, width) == 2;
}

static bool is_radiance(const uint8_t *data, size_t size_bytes) {
  static const char *const kinds[] = {"#?RADIANCE\n", "#?RGBE\n"};
  bool known = false;
  for (uint32_t i = 0; i < 2; i++) {
    const size_t length = strlen(kinds[i]);
    known |= size_bytes >= length && memcmp(data, kinds[i], length) == 0;
  }
  return known;
}

olx_result olx_hdr_check(const char *path, const uint8_t *data, size_t size_bytes) {
  if (!is_radiance(data, size_bytes)) return OLX_OK;
  hdr_reader r = {.at = data, .end = data + size_bytes};
  uint32_t width, height;
  while (next_line(&r)) {}
  if (read_size(&r, &width, &height) && check_rows(&r, width, height)) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: the texels of this Radiance image are damaged or end early", path);
}
