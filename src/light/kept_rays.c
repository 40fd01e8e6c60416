// Saves what rays depend on, and finds rays of an earlier scene that still hold.
#include "light/kept_rays.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"

enum {
  NEEDS_KINDS = 256, // different sets of slots in a unit; rays with further ones need everything
  NEEDS_ALL = NEEDS_KINDS - 1,
  MOST_CAST = UINT16_MAX // rays counted for one ray
};

// What a unit's rays have in common.
typedef struct kept_header {
  uint64_t surfels_hash;
  olx_scene_inputs inputs;
  uint64_t needs[NEEDS_KINDS];
  uint32_t count, rays, packets, guided; // surfels, 0 where nothing is kept; rays and packets of each; whether guided
  uint32_t lights, unused[3];            // 0: fill the struct
} kept_header;

// Light that a ray brings without its link.
typedef struct kept_light {
  uint32_t ray, surfaces; // index in the unit, and index in olx_kept_ray.fixed
  olx_vec3 light;
} kept_light;

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

olx_result olx_kept_rays_create(olx_kept_rays *kept, const olx_link_batch *batch) {
  kept->checks = olx_allocate((size_t)batch->count * packets_of(batch->rays), sizeof *kept->checks);
  kept->rays = olx_allocate((size_t)batch->count * batch->rays, sizeof *kept->rays);
  if (kept->checks && kept->rays) return OLX_OK;
  olx_kept_rays_free(kept);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for what rays depend on");
}

void olx_kept_rays_free(olx_kept_rays *kept) {
  olx_release(kept->checks);
  olx_release(kept->rays);
  *kept = (olx_kept_rays){0};
}

// ---- Saving

static bool has_light(olx_vec3 light) { return light.x != 0.0f || light.y != 0.0f || light.z != 0.0f; }

// Returns the number of a set of slots, which is added to the header's unless it is known.
static uint8_t kind_of(kept_header *header, uint32_t *kinds, uint64_t needs) {
  for (uint32_t i = *kinds; i-- > 0;) {
    if (header->needs[i] == needs) return (uint8_t)i;
  }
  if (*kinds == NEEDS_ALL) return NEEDS_ALL;
  header->needs[*kinds] = needs;
  return (uint8_t)(*kinds)++;
}

// The arrays that are saved beside the header.
typedef struct kept_arrays {
  uint32_t *surfels;
  uint8_t *kinds; // of each ray
  uint16_t *cast; // of each ray
  kept_light *lights;
} kept_arrays;

static bool fill_arrays(const olx_kept_rays *kept, const olx_link_batch *batch, kept_header *header,
                        kept_arrays *arrays) {
  const size_t rays = (size_t)batch->count * batch->rays;
  uint32_t kinds = 0;
  for (size_t i = 0; i < rays; i++) {
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) header->lights += has_light(kept->rays[i].fixed[k]);
  }
  arrays->surfels = olx_allocate(batch->count, sizeof *arrays->surfels);
  arrays->kinds = olx_allocate(rays, 1);
  arrays->cast = olx_allocate(rays, sizeof *arrays->cast);
  arrays->lights = olx_allocate(header->lights, sizeof *arrays->lights);
  if (!arrays->surfels || !arrays->kinds || !arrays->cast || !arrays->lights) return false;
  for (uint32_t n = 0; n < batch->count; n++) arrays->surfels[n] = olx_link_surfel(batch, n);
  uint32_t lights = 0;
  for (size_t i = 0; i < rays; i++) {
    const olx_kept_ray *ray = &kept->rays[i];
    arrays->kinds[i] = kind_of(header, &kinds, ray->needs);
    arrays->cast[i] = (uint16_t)(ray->cast < MOST_CAST ? ray->cast : MOST_CAST);
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) {
      if (has_light(ray->fixed[k])) arrays->lights[lights++] = (kept_light){(uint32_t)i, k, ray->fixed[k]};
    }
  }
  return true;
}

void olx_kept_rays_save(const olx_kept_rays *kept, const olx_link_batch *batch, uint64_t surfels_hash,
                        const olx_scene_inputs *inputs, olx_byte_writer *to) {
  const size_t rays = (size_t)batch->count * batch->rays;
  kept_header header = {.surfels_hash = surfels_hash, .inputs = *inputs};
  kept_arrays arrays = {0};
  header.needs[NEEDS_ALL] = UINT64_MAX;
  if (kept->checks) {
    header.count = batch->count;
    header.rays = batch->rays;
    header.packets = packets_of(batch->rays);
    header.guided = batch->guide != NULL;
    to->failed |= !fill_arrays(kept, batch, &header, &arrays);
  }
  olx_bytes_put(to, &header, 1, sizeof header);
  if (kept->checks && !to->failed) {
    olx_bytes_put(to, arrays.surfels, batch->count, sizeof *arrays.surfels);
    olx_bytes_put(to, kept->checks, (size_t)batch->count * header.packets, sizeof *kept->checks);
    olx_bytes_put(to, arrays.kinds, rays, 1);
    olx_bytes_put(to, arrays.cast, rays, sizeof *arrays.cast);
    olx_bytes_put(to, arrays.lights, header.lights, sizeof *arrays.lights);
  }
  olx_release(arrays.surfels);
  olx_release(arrays.kinds);
  olx_release(arrays.cast);
  olx_release(arrays.lights);
}

// ---- Former rays

// A unit of rays that were cast for another scene, as pointers into its bytes.
typedef struct olx_former_unit {
  void *data;       // owned
  uint64_t changed; // slots of the scene's inputs that differ
  const kept_header *header;
  const uint32_t *surfels;
  const uint64_t *checks;
  const uint8_t *kinds;
  const uint16_t *cast;
  const kept_light *lights;
  const olx_link *links;
  const olx_surface_point *points;
  uint32_t *first_point, *first_light; // of each packet; owned
} olx_former_unit;

static void read_kept(olx_byte_reader *from, olx_former_unit *unit) {
  unit->header = olx_bytes_get(from, 1, sizeof *unit->header);
  if (!unit->header || unit->header->count == 0) return;
  const kept_header *h = unit->header;
  const size_t rays = (size_t)h->count * h->rays;
  unit->surfels = olx_bytes_get(from, h->count, sizeof *unit->surfels);
  unit->checks = olx_bytes_get(from, (size_t)h->count * h->packets, sizeof *unit->checks);
  unit->kinds = olx_bytes_get(from, rays, 1);
  unit->cast = olx_bytes_get(from, rays, sizeof *unit->cast);
  unit->lights = olx_bytes_get(from, h->lights, sizeof *unit->lights);
}

void olx_kept_rays_skip(olx_byte_reader *from) {
  olx_former_unit unit;
  read_kept(from, &unit);
}

static uint64_t changed_slots(const olx_scene_inputs *a, const olx_scene_inputs *b) {
  uint64_t changed = 0;
  for (uint32_t i = 0; i < OLX_INPUT_SLOTS; i++) changed |= (uint64_t)(a->slots[i] != b->slots[i]) << i;
  return changed;
}

// Finds the parts of a unit's bytes, in the order in which they were saved; returns false where they are not for these
// surfels and surfaces.
static bool read_unit(olx_former_unit *unit, olx_byte_reader *from, uint64_t surfels_hash,
                      const olx_scene_inputs *inputs) {
  read_kept(from, unit);
  const kept_header *h = unit->header;
  if (from->failed || h->count == 0 || h->surfels_hash != surfels_hash || h->inputs.surfaces != inputs->surfaces) {
    return false;
  }
  const size_t links = (size_t)h->count * h->rays;
  uint32_t points = 0;
  unit->changed = changed_slots(&h->inputs, inputs);
  olx_bytes_get(from, 1, sizeof(uint64_t));
  unit->links = olx_bytes_get(from, links, sizeof *unit->links);
  if (!h->guided) olx_bytes_get(from, links, sizeof(float));
  for (uint32_t n = 0; n < h->count; n++) olx_bytes_get(from, 1, sizeof(olx_fixed_light));
  olx_bytes_copy(from, &points, 1, sizeof points);
  unit->points = olx_bytes_get(from, points, sizeof *unit->points);
  return !from->failed;
}

// Finds the first point and the first light of each packet.
static olx_result number_packets(olx_former_unit *unit) {
  const kept_header *h = unit->header;
  const size_t packets = (size_t)h->count * h->packets;
  uint32_t point = 0, light = 0;
  unit->first_point = olx_allocate(packets, sizeof *unit->first_point);
  unit->first_light = olx_allocate(packets, sizeof *unit->first_light);
  if (!unit->first_point || !unit->first_light) {
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %zu packets", packets);
  }
  for (size_t i = 0; i < (size_t)h->count * h->rays; i++) {
    const size_t packet = i / h->rays * h->packets + i % h->rays / OLX_LINK_PACKET;
    if (i % h->rays % OLX_LINK_PACKET == 0) {
      unit->first_point[packet] = point;
      unit->first_light[packet] = light;
    }
    while (light < h->lights && unit->lights[light].ray == i) light++;
    point += olx_link_end(&unit->links[i]) == OLX_LINK_UNSERVED;
  }
  return OLX_OK;
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

static void free_unit(olx_former_unit *unit) {
  olx_release(unit->data);
  olx_release(unit->first_point);
  olx_release(unit->first_light);
}

static olx_result add_unit(olx_former_rays *former, olx_former_unit *unit, uint32_t surfel_count) {
  OLX_TRY(allocate_places(former, surfel_count));
  OLX_TRY(number_packets(unit));
  OLX_TRY(grow_units(former));
  former->units[former->unit_count++] = *unit;
  for (uint32_t n = 0; n < unit->header->count; n++) {
    const size_t surfel = unit->surfels[n];
    if (surfel >= surfel_count) continue;
    former->place[2 * surfel] = former->unit_count;
    former->place[2 * surfel + 1] = n;
  }
  return OLX_OK;
}

olx_result olx_former_rays_add(olx_former_rays *former, void *data, size_t size_bytes, uint32_t surfel_count,
                               uint64_t surfels_hash, const olx_scene_inputs *inputs) {
  olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
  olx_former_unit unit = {.data = data};
  const bool holds = read_unit(&unit, &reader, surfels_hash, inputs);
  const olx_result result = holds ? add_unit(former, &unit, surfel_count) : OLX_OK;
  if (!holds || result != OLX_OK) free_unit(&unit);
  return result;
}

void olx_former_rays_free(olx_former_rays *former) {
  for (uint32_t i = 0; i < former->unit_count; i++) free_unit(&former->units[i]);
  olx_release(former->units);
  olx_release(former->place);
  *former = (olx_former_rays){0};
}

olx_former_packet olx_former_rays_find(const olx_former_rays *former, uint32_t surfel, uint32_t packet,
                                       uint64_t check) {
  if (!former || !former->place || former->place[2 * (size_t)surfel] == 0) return (olx_former_packet){0};
  const olx_former_unit *unit = &former->units[former->place[2 * (size_t)surfel] - 1];
  const size_t n = former->place[2 * (size_t)surfel + 1];
  if (packet >= unit->header->packets) return (olx_former_packet){0};
  const size_t number = n * unit->header->packets + packet;
  if (unit->checks[number] != check) return (olx_former_packet){0};
  return (olx_former_packet){.unit = unit,
                             .at = n * unit->header->rays + (size_t)packet * OLX_LINK_PACKET,
                             .point = unit->first_point[number],
                             .light = unit->first_light[number]};
}

olx_former_ray olx_former_packet_next(olx_former_packet *p) {
  const olx_former_unit *unit = p->unit;
  const size_t at = p->at++;
  olx_former_ray ray = {.link = unit->links[at], .point = &unit->points[p->point]};
  ray.kept.needs = unit->header->needs[unit->kinds[at]];
  ray.kept.cast = unit->cast[at];
  ray.holds = !(ray.kept.needs & unit->changed);
  p->point += olx_link_end(&ray.link) == OLX_LINK_UNSERVED;
  for (; p->light < unit->header->lights && unit->lights[p->light].ray == at; p->light++) {
    const kept_light *light = &unit->lights[p->light];
    ray.kept.fixed[light->surfaces] = light->light;
  }
  return ray;
}
