// Saves what rays depend on, and finds rays of an earlier scene that still hold.
#include "light/links/kept_rays.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

enum { MOST_CAST = UINT16_MAX }; // rays counted for one ray

// What a unit's rays have in common. The slot OLX_INPUT_SURFELS of the inputs names the surfels.
typedef struct kept_header {
  olx_scene_inputs inputs;
  uint32_t count, rays, packets, guided; // surfels, 0 where nothing is kept; rays and packets of each; whether guided
  uint32_t kinds, lights, unused[2];     // number of kinds of rays; 0: fill the struct
} kept_header;

// What rays of one kind depend on.
typedef struct ray_kind {
  uint64_t needs;
  olx_brick_set crossed;
} ray_kind;

// Light that a ray brings without its link.
typedef struct kept_light {
  uint32_t ray, surfaces; // index in the unit, and index in olx_kept_ray.fixed
  olx_vec3 light;
} kept_light;

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

// The arrays that are saved beside the header.
typedef struct kept_arrays {
  uint32_t *surfels;
  uint32_t *kinds; // of each ray
  ray_kind *table; // of kinds
  uint16_t *cast;  // of each ray
  kept_light *lights;
} kept_arrays;

static void free_arrays(kept_arrays *arrays) {
  olx_release(arrays->surfels);
  olx_release(arrays->kinds);
  olx_release(arrays->table);
  olx_release(arrays->cast);
  olx_release(arrays->lights);
}

// Numbers the kinds of rays: `slots` is a hash table of their numbers plus one, whose size is a power of two.
static void number_kinds(const olx_kept_rays *kept, size_t rays, uint32_t *slots, size_t slot_count,
                         kept_header *header, kept_arrays *arrays) {
  for (size_t i = 0; i < rays; i++) {
    const ray_kind kind = {kept->rays[i].needs, kept->rays[i].crossed};
    size_t slot = olx_content_hash(&kind, sizeof kind) & (slot_count - 1);
    while (slots[slot] && memcmp(&arrays->table[slots[slot] - 1], &kind, sizeof kind) != 0) {
      slot = (slot + 1) & (slot_count - 1);
    }
    if (slots[slot] == 0) {
      arrays->table[header->kinds++] = kind;
      slots[slot] = header->kinds;
    }
    arrays->kinds[i] = slots[slot] - 1;
  }
}

static bool make_kinds(const olx_kept_rays *kept, size_t rays, kept_header *header, kept_arrays *arrays) {
  size_t slot_count = 64;
  while (slot_count < 2 * rays) slot_count *= 2;
  uint32_t *slots = olx_allocate_zero(slot_count, sizeof *slots);
  arrays->kinds = olx_allocate(rays, sizeof *arrays->kinds);
  arrays->table = olx_allocate(rays, sizeof *arrays->table);
  const bool allocated = slots && arrays->kinds && arrays->table;
  if (allocated) number_kinds(kept, rays, slots, slot_count, header, arrays);
  olx_release(slots);
  return allocated;
}

static bool fill_arrays(const olx_kept_rays *kept, const olx_link_batch *batch, kept_header *header,
                        kept_arrays *arrays) {
  const size_t rays = (size_t)batch->count * batch->rays;
  for (size_t i = 0; i < rays; i++) {
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) header->lights += has_light(kept->rays[i].fixed[k]);
  }
  arrays->surfels = olx_allocate(batch->count, sizeof *arrays->surfels);
  arrays->cast = olx_allocate(rays, sizeof *arrays->cast);
  arrays->lights = olx_allocate(header->lights, sizeof *arrays->lights);
  if (!arrays->surfels || !arrays->cast || !arrays->lights || !make_kinds(kept, rays, header, arrays)) return false;
  for (uint32_t n = 0; n < batch->count; n++) arrays->surfels[n] = olx_link_surfel(batch, n);
  uint32_t lights = 0;
  for (size_t i = 0; i < rays; i++) {
    const olx_kept_ray *ray = &kept->rays[i];
    arrays->cast[i] = (uint16_t)(ray->cast < MOST_CAST ? ray->cast : MOST_CAST);
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) {
      if (has_light(ray->fixed[k])) arrays->lights[lights++] = (kept_light){(uint32_t)i, k, ray->fixed[k]};
    }
  }
  return true;
}

void olx_kept_rays_save(const olx_kept_rays *kept, const olx_link_batch *batch, const olx_scene_inputs *inputs,
                        olx_byte_writer *to) {
  const size_t rays = (size_t)batch->count * batch->rays;
  kept_header header = {.inputs = *inputs};
  kept_arrays arrays = {0};
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
    olx_bytes_put(to, arrays.kinds, rays, sizeof *arrays.kinds);
    olx_bytes_put(to, arrays.table, header.kinds, sizeof *arrays.table);
    olx_bytes_put(to, arrays.cast, rays, sizeof *arrays.cast);
    olx_bytes_put(to, arrays.lights, header.lights, sizeof *arrays.lights);
  }
  free_arrays(&arrays);
}

// ---- Former rays

// A unit of rays that were cast for another scene, as pointers into its bytes.
typedef struct olx_former_unit {
  void *data;                        // owned
  const olx_former_surfels *earlier; // the surfels that its rays end at; NULL: those of this scene
  bool *holds;                       // of each kind: whether nothing has changed that its rays depend on; owned
  const kept_header *header;
  const uint32_t *surfels;
  const uint64_t *checks;
  const uint32_t *kinds;
  const ray_kind *table;
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
  unit->kinds = olx_bytes_get(from, rays, sizeof *unit->kinds);
  unit->table = olx_bytes_get(from, h->kinds, sizeof *unit->table);
  unit->cast = olx_bytes_get(from, rays, sizeof *unit->cast);
  unit->lights = olx_bytes_get(from, h->lights, sizeof *unit->lights);
}

void olx_kept_rays_skip(olx_byte_reader *from) {
  olx_former_unit unit;
  read_kept(from, &unit);
}

// Finds whose surfels a unit has; returns false where they are unknown.
static bool find_surfels(olx_former_unit *unit, const olx_former_rays *former) {
  const olx_surfels_name own = olx_surfels_name_of(&unit->header->inputs), now = olx_surfels_name_of(&former->inputs);
  if (olx_surfels_same_name(&own, &now)) return true;
  unit->earlier = former->surfels;
  return former->surfels && former->surfels->count > 0 && olx_surfels_same_name(&own, &former->surfels->name);
}

// Finds the parts of a unit's bytes, in the order in which they were saved; returns false where they are of no use.
static bool read_unit(olx_former_unit *unit, olx_byte_reader *from, const olx_former_rays *former) {
  read_kept(from, unit);
  const kept_header *h = unit->header;
  if (from->failed || h->count == 0 || !find_surfels(unit, former)) return false;
  const size_t links = (size_t)h->count * h->rays;
  uint32_t points = 0;
  olx_bytes_get(from, 1, sizeof(uint64_t));
  unit->links = olx_bytes_get(from, links, sizeof *unit->links);
  if (!h->guided) olx_bytes_get(from, links, sizeof(float));
  for (uint32_t n = 0; n < h->count; n++) olx_bytes_get(from, 1, sizeof(olx_fixed_light));
  olx_bytes_copy(from, &points, 1, sizeof points);
  unit->points = olx_bytes_get(from, points, sizeof *unit->points);
  return !from->failed;
}

static olx_result judge_kinds(olx_former_unit *unit, const olx_former_rays *former) {
  const uint64_t changed = olx_inputs_changed(&unit->header->inputs, &former->inputs);
  const uint32_t kinds = unit->header->kinds;
  unit->holds = olx_allocate(kinds, sizeof *unit->holds);
  if (!unit->holds) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u kinds of rays", kinds);
  for (uint32_t i = 0; i < kinds; i++) {
    const ray_kind *kind = &unit->table[i];
    unit->holds[i] =
        !(kind->needs & changed) && !(unit->earlier && olx_brick_sets_meet(&kind->crossed, &unit->earlier->changed));
  }
  return OLX_OK;
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

static olx_result allocate_places(olx_former_rays *former) {
  const uint32_t count = former->now->count;
  if (former->place) return OLX_OK;
  former->place = olx_allocate_zero(2 * (size_t)count, sizeof *former->place);
  return former->place ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", count);
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
  olx_release(unit->holds);
  olx_release(unit->first_point);
  olx_release(unit->first_light);
}

// Returns the surfel that casts the rays of a unit's surfel now; OLX_CELL_NONE when there is none.
static uint32_t caster_of(const olx_former_rays *former, const olx_former_unit *unit, uint32_t surfel) {
  if (unit->earlier) surfel = surfel < unit->earlier->count ? unit->earlier->now[surfel] : OLX_CELL_NONE;
  return surfel < former->now->count ? surfel : OLX_CELL_NONE;
}

static olx_result add_unit(olx_former_rays *former, olx_former_unit *unit) {
  OLX_TRY(allocate_places(former));
  OLX_TRY(judge_kinds(unit, former));
  OLX_TRY(number_packets(unit));
  OLX_TRY(grow_units(former));
  former->units[former->unit_count++] = *unit;
  for (uint32_t n = 0; n < unit->header->count; n++) {
    const uint32_t surfel = caster_of(former, unit, unit->surfels[n]);
    if (surfel == OLX_CELL_NONE) continue;
    former->place[2 * (size_t)surfel] = former->unit_count;
    former->place[2 * (size_t)surfel + 1] = n;
  }
  return OLX_OK;
}

olx_result olx_former_rays_add(olx_former_rays *former, void *data, size_t size_bytes) {
  olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
  olx_former_unit unit = {.data = data};
  const bool holds = read_unit(&unit, &reader, former);
  const olx_result result = holds ? add_unit(former, &unit) : OLX_OK;
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
  return (olx_former_packet){.rays = former,
                             .unit = unit,
                             .at = n * unit->header->rays + (size_t)packet * OLX_LINK_PACKET,
                             .point = unit->first_point[number],
                             .light = unit->first_light[number]};
}

olx_former_ray olx_former_packet_next(olx_former_packet *p) {
  const olx_former_unit *unit = p->unit;
  const size_t at = p->at++;
  const uint32_t kind = unit->kinds[at];
  olx_former_ray ray = {.link = unit->links[at], .point = &unit->points[p->point]};
  ray.kept.needs = unit->table[kind].needs;
  ray.kept.crossed = unit->table[kind].crossed;
  ray.kept.cast = unit->cast[at];
  p->point += olx_link_end(&ray.link) == OLX_LINK_UNSERVED;
  for (; p->light < unit->header->lights && unit->lights[p->light].ray == at; p->light++) {
    const kept_light *light = &unit->lights[p->light];
    ray.kept.fixed[light->surfaces] = light->light;
  }
  ray.holds = unit->holds[kind] && olx_link_still_ends(&ray.link, ray.point, unit->earlier, p->rays->now);
  return ray;
}
