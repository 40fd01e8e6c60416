// Checks the chunk that holds bricks and points into it. Once it has passed, every index and every probe in it is in
// range.
#include "field/brick_data.h"

#include "core/result.h"
#include "field/coded_probes.h"

#include <math.h>

static olx_result check_header(const olx_bricks_header *h, const char *name) {
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (!isfinite(h->origin[axis])) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: origin is not finite", name);
    if (h->size[axis] < 1 || h->size[axis] > 1u << 16) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: %u bricks along %c are not in 1..65536", name, h->size[axis],
                      "xyz"[axis]);
    }
  }
  if (!(h->cell_metres > 0.0f && isfinite(h->cell_metres) && isfinite(1.0f / h->cell_metres))) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: cells of %g metres", name, (double)h->cell_metres);
  }
  if (h->lists < 1 || h->lists > OLX_BRICK_MOST_LISTS) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: %u lists are not in 1..%d", name, h->lists,
                    OLX_BRICK_MOST_LISTS);
  }
  for (uint32_t i = 0; i < sizeof h->zero / sizeof h->zero[0]; i++) {
    if (h->zero[i]) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: reserved bytes are not 0", name);
  }
  return OLX_OK;
}

static olx_result check_index(const olx_bricks *b, uint64_t count, const char *name) {
  for (uint64_t i = 0; i < count; i++) {
    const uint32_t entry = b->index[i], number = entry & ~OLX_BRICK_DIVIDED;
    if (number < (entry & OLX_BRICK_DIVIDED ? b->header->divided : b->header->lists)) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: brick %llu: %#x is out of range", name, (unsigned long long)i,
                    entry);
  }
  return OLX_OK;
}

static olx_result check_cells(const olx_bricks *b, const char *name) {
  const uint64_t words = (uint64_t)b->header->divided * OLX_BRICK_CELL_WORDS;
  for (uint64_t i = 0; i < words; i++) {
    const uint32_t word = b->cells[i];
    if ((word & 0xFFFFu) < b->header->lists && word >> 16 < b->header->lists) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: cells %llu of %u lists: %#x is out of range", name,
                    (unsigned long long)i, b->header->lists, word);
  }
  return OLX_OK;
}

static uint32_t probe_of(const olx_bricks *b, uint32_t list, uint32_t i) {
  return b->lists[list * OLX_BRICK_LIST_WORDS + i / 2] >> (i % 2 * 16) & 0xFFFFu;
}

static olx_result check_lists(const olx_bricks *b, uint32_t probe_count, const char *name) {
  for (uint32_t list = 0; list < b->header->lists; list++) {
    bool ended = false;
    for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) {
      const uint32_t probe = probe_of(b, list, i);
      const bool none = probe == OLX_BRICK_NO_PROBE;
      bool twice = false;
      for (uint32_t k = 0; k < i && !none; k++) twice |= probe_of(b, list, k) == probe;
      if (!none && (ended || twice || probe >= probe_count)) {
        return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: list %u names probe %u%s", name, list, probe,
                        ended   ? " after its end"
                        : twice ? " twice"
                                : "");
      }
      ended |= none;
    }
  }
  return OLX_OK;
}

olx_result olx_bricks_open(const void *data, size_t size_bytes, uint32_t probe_count, const char *name,
                           olx_bricks *bricks) {
  const olx_bricks_header *h = data;
  OLX_TRY(olx_coded_probes_check(probe_count, "BRIK", name));
  if (size_bytes < sizeof *h) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk BRIK: %zu bytes", name, size_bytes);
  OLX_TRY(check_header(h, name));
  const uint64_t count = (uint64_t)h->size[0] * h->size[1] * h->size[2]; // below 2^49
  const uint64_t words =
      count + (uint64_t)h->divided * OLX_BRICK_CELL_WORDS + (uint64_t)h->lists * OLX_BRICK_LIST_WORDS;
  if (size_bytes != sizeof *h + 4 * words) {
    return olx_fail(OLX_ERROR_FORMAT,
                    "%s: chunk BRIK: %zu bytes where %u x %u x %u bricks, %u divided, %u lists take %llu", name,
                    size_bytes, h->size[0], h->size[1], h->size[2], h->divided, h->lists,
                    (unsigned long long)(sizeof *h + 4 * words));
  }
  olx_bricks b = {.header = h, .index = (const uint32_t *)(h + 1)};
  b.cells = b.index + count;
  b.lists = b.cells + (size_t)h->divided * OLX_BRICK_CELL_WORDS;
  OLX_TRY(check_index(&b, count, name));
  OLX_TRY(check_cells(&b, name));
  OLX_TRY(check_lists(&b, probe_count, name));
  *bricks = b;
  return OLX_OK;
}
