// Saves what packets of rays depend on, and finds packets of an earlier scene that still hold.
#include "light/kept_rays.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"

enum { SURFEL_STRIDE = OLX_BYTES_ALIGNMENT / sizeof(uint32_t) }; // words from one surfel's number to the next

// What a unit's packets have in common.
typedef struct kept_header {
  uint64_t surfels_hash;
  olx_scene_inputs inputs;
  uint32_t count, rays, packets, guided; // surfels, rays of each, packets of each, whether a guide drew them
} kept_header;

// A surfel, without the padding of its struct.
typedef struct surfel_numbers {
  uint64_t cell;
  olx_vec3 position, normal;
  float side, nearest;
  uint32_t next, triangle, back_face;
  float u, v;
  uint32_t unused; // 0: fills the struct
} surfel_numbers;

_Static_assert(sizeof(surfel_numbers) == 64, "no padding that the hash would see");

uint64_t olx_surfels_hash(const olx_light_surfels *s) {
  uint64_t hash[3] = {s->count};
  for (uint32_t i = 0; i < s->count; i++) {
    const olx_light_surfel *f = &s->surfels[i];
    const surfel_numbers numbers = {.cell = f->cell,
                                    .position = f->position,
                                    .normal = f->normal,
                                    .side = f->side,
                                    .nearest = f->nearest,
                                    .next = f->next,
                                    .triangle = f->point.triangle,
                                    .back_face = f->point.back_face,
                                    .u = f->point.u,
                                    .v = f->point.v};
    hash[1] = olx_content_hash(&numbers, sizeof numbers);
    hash[0] = olx_content_hash(hash, sizeof hash);
  }
  for (uint32_t i = 0; i < s->table.capacity; i++) {
    if (s->table.keys[i] == 0) continue;
    hash[1] = s->table.keys[i];
    hash[2] = s->table.values[i];
    hash[0] = olx_content_hash(hash, sizeof hash);
  }
  return hash[0];
}

static uint32_t packets_of(uint32_t rays) { return (rays + OLX_LINK_PACKET - 1) / OLX_LINK_PACKET; }

void olx_kept_rays_save(const olx_link_batch *batch, const olx_kept_packet *kept, uint64_t surfels_hash,
                        const olx_scene_inputs *inputs, olx_byte_writer *to) {
  const kept_header header = {surfels_hash,        *inputs, batch->count, batch->rays, packets_of(batch->rays),
                              batch->guide != NULL};
  olx_bytes_put(to, &header, 1, sizeof header);
  for (uint32_t n = 0; n < batch->count; n++) {
    const uint32_t surfel[SURFEL_STRIDE] = {olx_link_surfel(batch, n)};
    olx_bytes_put(to, surfel, 1, sizeof surfel);
  }
  olx_bytes_put(to, kept, (size_t)batch->count * header.packets, sizeof *kept);
}

void olx_kept_rays_skip(olx_byte_reader *from) {
  kept_header header = {.count = 0};
  olx_bytes_copy(from, &header, 1, sizeof header);
  olx_bytes_get(from, header.count, SURFEL_STRIDE * sizeof(uint32_t));
  olx_bytes_get(from, (size_t)header.count * header.packets, sizeof(olx_kept_packet));
}

// ---- Former rays

static uint64_t changed_slots(const olx_scene_inputs *a, const olx_scene_inputs *b) {
  uint64_t changed = 0;
  for (uint32_t i = 0; i < OLX_INPUT_SLOTS; i++) changed |= (uint64_t)(a->slots[i] != b->slots[i]) << i;
  return changed;
}

static olx_result allocate_places(olx_former_rays *former, uint32_t surfel_count) {
  if (former->place) return OLX_OK;
  former->place = olx_allocate_zero(2 * (size_t)surfel_count, sizeof *former->place);
  former->surfel_count = surfel_count;
  return former->place ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", surfel_count);
}

// Makes room for one more unit.
static olx_result grow_units(olx_former_rays *former) {
  olx_former_unit *units = olx_allocate((size_t)former->unit_count + 1, sizeof *units);
  if (!units) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for units of another scene");
  for (uint32_t i = 0; i < former->unit_count; i++) units[i] = former->units[i];
  olx_release(former->units);
  former->units = units;
  return OLX_OK;
}

// Numbers the points of all packets.
static olx_result count_points(olx_former_unit *unit) {
  const size_t packets = (size_t)unit->count * unit->packets;
  uint32_t next = 0;
  unit->first_point = olx_allocate(packets, sizeof *unit->first_point);
  if (!unit->first_point) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %zu packets", packets);
  for (size_t i = 0; i < packets; i++) {
    unit->first_point[i] = next;
    next += unit->kept[i].unserved;
  }
  return OLX_OK;
}

// Finds the parts of a unit's bytes, in the order in which they were saved; returns false where they are not for these
// surfels and surfaces.
static bool read_unit(olx_former_unit *unit, olx_byte_reader *from, uint64_t surfels_hash,
                      const olx_scene_inputs *inputs, const uint32_t **surfels) {
  const kept_header *header = olx_bytes_get(from, 1, sizeof *header);
  if (!header || header->surfels_hash != surfels_hash || header->inputs.surfaces != inputs->surfaces) return false;
  const size_t links = (size_t)header->count * header->rays;
  unit->changed = changed_slots(&header->inputs, inputs);
  unit->count = header->count;
  unit->rays = header->rays;
  unit->packets = header->packets;
  *surfels = olx_bytes_get(from, header->count, SURFEL_STRIDE * sizeof **surfels);
  unit->kept = olx_bytes_get(from, (size_t)header->count * header->packets, sizeof *unit->kept);
  olx_bytes_get(from, 1, sizeof(uint64_t));
  unit->links = olx_bytes_get(from, links, sizeof *unit->links);
  if (!header->guided) unit->fixed = olx_bytes_get(from, links, sizeof *unit->fixed);
  for (uint32_t n = 0; n < header->count; n++) olx_bytes_get(from, 1, sizeof(olx_fixed_light));
  uint32_t points = 0;
  olx_bytes_copy(from, &points, 1, sizeof points);
  unit->points = olx_bytes_get(from, points, sizeof *unit->points);
  return !from->failed;
}

static olx_result add_unit(olx_former_rays *former, olx_former_unit *unit, uint32_t surfel_count,
                           const uint32_t *surfels) {
  OLX_TRY(allocate_places(former, surfel_count));
  OLX_TRY(grow_units(former));
  OLX_TRY(count_points(unit));
  former->units[former->unit_count++] = *unit;
  for (uint32_t n = 0; n < unit->count; n++) {
    const uint32_t surfel = surfels[(size_t)SURFEL_STRIDE * n];
    if (surfel >= surfel_count) continue;
    former->place[2 * (size_t)surfel] = former->unit_count;
    former->place[2 * (size_t)surfel + 1] = n;
  }
  return OLX_OK;
}

olx_result olx_former_rays_add(olx_former_rays *former, void *data, size_t size_bytes, uint32_t surfel_count,
                               uint64_t surfels_hash, const olx_scene_inputs *inputs) {
  olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
  olx_former_unit unit = {.data = data};
  const uint32_t *surfels;
  olx_result result = OLX_OK;
  if (read_unit(&unit, &reader, surfels_hash, inputs, &surfels)) {
    result = add_unit(former, &unit, surfel_count, surfels);
    if (result == OLX_OK) return OLX_OK;
  }
  olx_release(data);
  return result;
}

void olx_former_rays_free(olx_former_rays *former) {
  for (uint32_t i = 0; i < former->unit_count; i++) {
    olx_release(former->units[i].data);
    olx_release(former->units[i].first_point);
  }
  olx_release(former->units);
  olx_release(former->place);
  *former = (olx_former_rays){0};
}

olx_former_packet olx_former_rays_find(const olx_former_rays *former, uint32_t surfel, uint32_t packet,
                                       uint64_t check) {
  if (!former || !former->place || former->place[2 * (size_t)surfel] == 0) return (olx_former_packet){0};
  const olx_former_unit *unit = &former->units[former->place[2 * (size_t)surfel] - 1];
  const size_t n = former->place[2 * (size_t)surfel + 1];
  if (packet >= unit->packets) return (olx_former_packet){0};
  const olx_kept_packet *kept = &unit->kept[n * unit->packets + packet];
  if (kept->check != check || kept->needs & unit->changed) return (olx_former_packet){0};
  const size_t at = n * unit->rays + (size_t)packet * OLX_LINK_PACKET;
  return (olx_former_packet){.kept = kept,
                             .links = unit->links + at,
                             .fixed = unit->fixed ? unit->fixed + at : NULL,
                             .points = unit->points + unit->first_point[n * unit->packets + packet]};
}
