// Keeps the gathers of a row of texels, and finds those of an earlier scene again.
#include "light/kept_gathers.h"

enum { MOST_PASSED = 256 }; // gathers that are looked through for one

typedef struct gather_header {
  uint64_t check;
  uint32_t kind_count, light_count;
} gather_header;

static bool read_gather(olx_byte_reader *from, uint64_t *check, olx_kept_gather *gather) {
  const gather_header *header = from->next < from->size_bytes ? olx_bytes_get(from, 1, sizeof *header) : NULL;
  if (!header) return false;
  *check = header->check;
  gather->kind_count = header->kind_count;
  gather->light_count = header->light_count;
  gather->links = olx_bytes_get(from, OLX_GATHER_RAYS, sizeof *gather->links);
  gather->kinds = olx_bytes_get(from, OLX_GATHER_RAYS, sizeof *gather->kinds);
  gather->table = olx_bytes_get(from, header->kind_count, sizeof *gather->table);
  gather->lights = olx_bytes_get(from, header->light_count, sizeof *gather->lights);
  return !from->failed;
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
  const gather_header header = {check, gather->kind_count, gather->light_count};
  olx_bytes_put(&row->kept, &header, 1, sizeof header);
  olx_bytes_put(&row->kept, gather->links, OLX_GATHER_RAYS, sizeof *gather->links);
  olx_bytes_put(&row->kept, gather->kinds, OLX_GATHER_RAYS, sizeof *gather->kinds);
  olx_bytes_put(&row->kept, gather->table, gather->kind_count, sizeof *gather->table);
  olx_bytes_put(&row->kept, gather->lights, gather->light_count, sizeof *gather->lights);
}
