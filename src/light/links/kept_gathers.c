// Keeps the gathers of a row of texels, and finds those of an earlier scene again.
#include "light/links/kept_gathers.h"

enum { MOST_PASSED = 256 }; // gathers that are looked through for one

typedef struct gather_header {
  uint64_t check;
  uint32_t kind_count, light_count, brick_count, unused; // 0: fills the struct
} gather_header;

static bool are_all(const uint16_t bins[OLX_GUIDE_BINS]) {
  uint32_t rays = 0;
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) rays += bins[i];
  return rays == OLX_GATHER_RAYS;
}

static bool read_gather(olx_byte_reader *from, uint64_t *check, olx_kept_gather *gather) {
  const gather_header *header = from->next < from->size_bytes ? olx_bytes_get(from, 1, sizeof *header) : NULL;
  if (!header) return false;
  *check = header->check;
  gather->kind_count = header->kind_count;
  gather->light_count = header->light_count;
  gather->brick_count = header->brick_count;
  gather->bins = olx_bytes_get(from, OLX_GUIDE_BINS, sizeof *gather->bins);
  gather->links = olx_bytes_get(from, OLX_GATHER_RAYS, sizeof *gather->links);
  gather->kinds = olx_bytes_get(from, OLX_GATHER_RAYS, sizeof *gather->kinds);
  gather->needs = olx_bytes_get(from, header->kind_count, sizeof *gather->needs);
  gather->bricks = olx_bytes_get(from, header->brick_count, 1);
  gather->lights = olx_bytes_get(from, header->light_count, sizeof *gather->lights);
  return !from->failed && are_all(gather->bins);
}

bool olx_gather_row_find(olx_gather_row *row, uint64_t check, olx_kept_gather *gather) {
  olx_byte_reader ahead = row->former;
  uint64_t found;
  for (uint32_t i = 0; i < MOST_PASSED && read_gather(&ahead, &found, gather); i++) {
    if (found != check) continue;
    row->former = ahead;
    return true;
  }
  return false;
}

void olx_gather_row_keep(olx_gather_row *row, uint64_t check, const olx_kept_gather *gather) {
  const gather_header header = {check, gather->kind_count, gather->light_count, gather->brick_count, 0};
  olx_bytes_put(&row->kept, &header, 1, sizeof header);
  olx_bytes_put(&row->kept, gather->bins, OLX_GUIDE_BINS, sizeof *gather->bins);
  olx_bytes_put(&row->kept, gather->links, OLX_GATHER_RAYS, sizeof *gather->links);
  olx_bytes_put(&row->kept, gather->kinds, OLX_GATHER_RAYS, sizeof *gather->kinds);
  olx_bytes_put(&row->kept, gather->needs, gather->kind_count, sizeof *gather->needs);
  olx_bytes_put(&row->kept, gather->bricks, gather->brick_count, 1);
  olx_bytes_put(&row->kept, gather->lights, gather->light_count, sizeof *gather->lights);
}

_Static_assert(OLX_SPACE_BRICKS == UINT8_MAX + 1, "a brick's number takes a byte");

uint32_t olx_gather_write_bricks(const olx_brick_set *set, uint8_t bytes[OLX_KIND_BYTES], uint64_t *needs) {
  uint32_t count = 0;
  for (uint32_t word = 0; word < OLX_BRICK_WORDS; word++) {
    for (uint64_t left = set->words[word]; left != 0; left &= left - 1) {
      if (++count < OLX_KIND_BYTES) bytes[count] = (uint8_t)(64 * word + (uint32_t)__builtin_ctzll(left));
    }
  }
  if (count >= OLX_KIND_BYTES) {
    *needs = UINT64_MAX;
    count = 0;
  }
  bytes[0] = (uint8_t)count;
  return 1 + count;
}

bool olx_gather_read_kinds(const olx_kept_gather *gather, olx_gather_kind *kinds) {
  uint32_t at = 0;
  if (gather->kind_count > UINT8_MAX + 1) return false;
  for (uint32_t i = 0; i < gather->kind_count; i++) {
    kinds[i] = (olx_gather_kind){.needs = gather->needs[i]};
    if (at >= gather->brick_count || gather->bricks[at] >= gather->brick_count - at) return false;
    for (uint32_t left = gather->bricks[at++]; left > 0; left--, at++) {
      kinds[i].crossed.words[gather->bricks[at] / 64] |= UINT64_C(1) << gather->bricks[at] % 64;
    }
  }
  return true;
}
