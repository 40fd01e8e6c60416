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
  uint32_t count, rays;   // surfels, 0 where nothing is kept; rays of each
  uint32_t guided, kinds; // whether there is a guide; kinds of rays
  uint32_t lights;        // light that rays bring without their links
  uint32_t unused;        // 0: fills the struct
} kept_header;

// What rays of one kind depend on.
typedef struct ray_kind {
  uint64_t needs;
  olx_brick_set crossed;
} ray_kind;

// Light that a ray brings without its link.
typedef struct kept_light {
  uint32_t ray, surfaces; // index in the unit, and index in olx_kept_ray.fixed; OLX_CHAIN_MOST: olx_kept_ray.near
  olx_vec3 light;
} kept_light;

olx_result olx_kept_rays_create(olx_kept_rays *kept, const olx_link_batch *batch) {
  kept->checks = olx_allocate(batch->count, sizeof *kept->checks);
  kept->rays = olx_allocate((size_t)batch->count * batch->rays, sizeof *kept->rays);
  if (batch->guide) kept->bins = olx_allocate((size_t)batch->count * OLX_GUIDE_BINS, sizeof *kept->bins);
  if (kept->checks && kept->rays && (kept->bins || !batch->guide)) return OLX_OK;
  olx_kept_rays_free(kept);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for what rays depend on");
}

void olx_kept_rays_free(olx_kept_rays *kept) {
  olx_release(kept->checks);
  olx_release(kept->bins);
  olx_release(kept->rays);
  *kept = (olx_kept_rays){0};
}

// ---- Saving

static bool has_light(olx_vec3 light) { return light.x != 0.0f || light.y != 0.0f || light.z != 0.0f; }

// The arrays that are saved beside the header.
typedef struct kept_arrays {
  uint32_t *surfels;
  uint32_t *kinds;   // of each ray
  ray_kind *table;   // of kinds
  uint16_t *cast;    // of each ray
  uint32_t *weights; // of each ray's link, as in olx_kept_ray; NULL: those of links
  kept_light *lights;
} kept_arrays;

static void free_arrays(kept_arrays *arrays) {
  olx_release(arrays->surfels);
  olx_release(arrays->kinds);
  olx_release(arrays->table);
  olx_release(arrays->cast);
  olx_release(arrays->weights);
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
    header->lights += has_light(kept->rays[i].near);
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) header->lights += has_light(kept->rays[i].fixed[k]);
  }
  arrays->surfels = olx_allocate(batch->count, sizeof *arrays->surfels);
  arrays->cast = olx_allocate(rays, sizeof *arrays->cast);
  arrays->lights = olx_allocate(header->lights, sizeof *arrays->lights);
  if (header->guided) arrays->weights = olx_allocate(rays, sizeof *arrays->weights);
  if (!arrays->surfels || !arrays->cast || !arrays->lights || (header->guided && !arrays->weights)) return false;
  if (!make_kinds(kept, rays, header, arrays)) return false;
  for (uint32_t n = 0; n < batch->count; n++) arrays->surfels[n] = olx_link_surfel(batch, n);
  uint32_t lights = 0;
  for (size_t i = 0; i < rays; i++) {
    const olx_kept_ray *ray = &kept->rays[i];
    arrays->cast[i] = (uint16_t)(ray->cast < MOST_CAST ? ray->cast : MOST_CAST);
    if (arrays->weights) arrays->weights[i] = ray->weight;
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) {
      if (has_light(ray->fixed[k])) arrays->lights[lights++] = (kept_light){(uint32_t)i, k, ray->fixed[k]};
    }
    if (has_light(ray->near)) arrays->lights[lights++] = (kept_light){(uint32_t)i, OLX_CHAIN_MOST, ray->near};
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
    header.guided = batch->guide != NULL;
    to->failed |= !fill_arrays(kept, batch, &header, &arrays);
  }
  olx_bytes_put(to, &header, 1, sizeof header);
  if (kept->checks && !to->failed) {
    olx_bytes_put(to, arrays.surfels, batch->count, sizeof *arrays.surfels);
    olx_bytes_put(to, kept->checks, batch->count, sizeof *kept->checks);
    if (header.guided) olx_bytes_put(to, kept->bins, (size_t)batch->count * OLX_GUIDE_BINS, sizeof *kept->bins);
    olx_bytes_put(to, arrays.kinds, rays, sizeof *arrays.kinds);
    olx_bytes_put(to, arrays.table, header.kinds, sizeof *arrays.table);
    olx_bytes_put(to, arrays.cast, rays, sizeof *arrays.cast);
    if (header.guided) olx_bytes_put(to, arrays.weights, rays, sizeof *arrays.weights);
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
  const uint16_t *bins; // NULL: there is no guide
  const uint32_t *kinds;
  const ray_kind *table;
  const uint16_t *cast;
  const uint32_t *weights; // NULL: those of links
  const kept_light *lights;
  const olx_link *links;
  const olx_surfel_point *points;
  uint32_t *first_point, *first_light; // of each surfel; owned
} olx_former_unit;

static void read_kept(olx_byte_reader *from, olx_former_unit *unit) {
  unit->header = olx_bytes_get(from, 1, sizeof *unit->header);
  if (!unit->header || unit->header->count == 0) return;
  const kept_header *h = unit->header;
  const size_t rays = (size_t)h->count * h->rays;
  unit->surfels = olx_bytes_get(from, h->count, sizeof *unit->surfels);
  unit->checks = olx_bytes_get(from, h->count, sizeof *unit->checks);
  if (h->guided) unit->bins = olx_bytes_get(from, (size_t)h->count * OLX_GUIDE_BINS, sizeof *unit->bins);
  unit->kinds = olx_bytes_get(from, rays, sizeof *unit->kinds);
  unit->table = olx_bytes_get(from, h->kinds, sizeof *unit->table);
  unit->cast = olx_bytes_get(from, rays, sizeof *unit->cast);
  if (h->guided) unit->weights = olx_bytes_get(from, rays, sizeof *unit->weights);
  unit->lights = olx_bytes_get(from, h->lights, sizeof *unit->lights);
}

void olx_kept_rays_skip(olx_byte_reader *from) {
  olx_former_unit unit;
  read_kept(from, &unit);
}

// Returns whether the bins of each surfel have as many rays as it has.
static bool are_all(const olx_former_unit *unit) {
  for (size_t n = 0; unit->bins && n < unit->header->count; n++) {
    uint32_t rays = 0;
    for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) rays += unit->bins[n * OLX_GUIDE_BINS + i];
    if (rays != unit->header->rays) return false;
  }
  return true;
}

// Finds whose surfels a unit has; returns false where they are unknown.
static bool find_surfels(olx_former_unit *unit, const olx_former_rays *former) {
  const olx_surfels_name own = olx_surfels_name_of(&unit->header->inputs), now = olx_surfels_name_of(&former->inputs);
  if (olx_surfels_same_name(&own, &now)) return true;
  unit->earlier = former->surfels;
  return former->surfels && former->surfels->count > 0 && olx_surfels_same_name(&own, &former->surfels->name);
}

// Returns whether every ray is of a kind in the table, and there is a point for each that met no surfel.
static bool are_described(const olx_former_unit *unit, uint32_t points) {
  const kept_header *h = unit->header;
  uint32_t unserved = 0;
  for (size_t i = 0; i < (size_t)h->count * h->rays; i++) {
    if (unit->kinds[i] >= h->kinds) return false;
    unserved += olx_link_end(&unit->links[i]) == OLX_LINK_UNSERVED;
  }
  return unserved == points;
}

// Finds the parts of a unit's bytes, in the order in which they were saved; returns false where they are of no use.
static bool read_unit(olx_former_unit *unit, olx_byte_reader *from, const olx_former_rays *former) {
  read_kept(from, unit);
  const kept_header *h = unit->header;
  if (from->failed || h->count == 0 || !are_all(unit) || !find_surfels(unit, former)) return false;
  const size_t links = (size_t)h->count * h->rays;
  uint32_t points = 0;
  olx_bytes_get(from, 1, sizeof(uint64_t));
  unit->links = olx_bytes_get(from, links, sizeof *unit->links);
  if (!h->guided) olx_bytes_get(from, links, sizeof(float));
  for (uint32_t n = 0; n < h->count; n++) olx_bytes_get(from, 1, sizeof(olx_fixed_light));
  olx_bytes_copy(from, &points, 1, sizeof points);
  unit->points = olx_bytes_get(from, points, sizeof *unit->points);
  return !from->failed && are_described(unit, points);
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

// Finds the first point and the first light of each surfel.
static olx_result number_surfels(olx_former_unit *unit) {
  const kept_header *h = unit->header;
  uint32_t point = 0, light = 0;
  unit->first_point = olx_allocate(h->count, sizeof *unit->first_point);
  unit->first_light = olx_allocate(h->count, sizeof *unit->first_light);
  if (!unit->first_point || !unit->first_light) {
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", h->count);
  }
  for (size_t i = 0; i < (size_t)h->count * h->rays; i++) {
    if (i % h->rays == 0) {
      unit->first_point[i / h->rays] = point;
      unit->first_light[i / h->rays] = light;
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
  OLX_TRY(number_surfels(unit));
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

olx_former_surfel olx_former_rays_find(const olx_former_rays *former, uint32_t surfel, uint64_t check) {
  if (!former || !former->place || former->place[2 * (size_t)surfel] == 0) return (olx_former_surfel){0};
  const olx_former_unit *unit = &former->units[former->place[2 * (size_t)surfel] - 1];
  const size_t n = former->place[2 * (size_t)surfel + 1], first = n * unit->header->rays;
  if (unit->checks[n] != check) return (olx_former_surfel){0};
  return (olx_former_surfel){.rays = former,
                             .unit = unit,
                             .bins = unit->bins ? unit->bins + n * OLX_GUIDE_BINS : NULL,
                             .first = first,
                             .at = first,
                             .point = unit->first_point[n],
                             .light = unit->first_light[n]};
}

static uint32_t rays_in_bin(const olx_former_surfel *f) {
  if (f->bins) return f->bins[f->bin];
  return f->bin == 0 ? f->unit->header->rays : 0;
}

static void pass_ray(olx_former_surfel *f) {
  f->point += olx_link_end(&f->unit->links[f->at]) == OLX_LINK_UNSERVED;
  while (f->light < f->unit->header->lights && f->unit->lights[f->light].ray == f->at) f->light++;
  f->at++;
}

static void add_lights(const olx_former_surfel *f, olx_kept_ray *kept) {
  const olx_former_unit *unit = f->unit;
  for (uint32_t i = f->light; i < unit->header->lights && unit->lights[i].ray == f->at; i++) {
    const kept_light *light = &unit->lights[i];
    *(light->surfaces < OLX_CHAIN_MOST ? &kept->fixed[light->surfaces] : &kept->near) = light->light;
  }
}

olx_former_ray olx_former_ray_at(olx_former_surfel *f, olx_ray_place place) {
  const olx_former_unit *unit = f->unit;
  for (; f->bin < place.bin; f->bin++) f->first += rays_in_bin(f);
  if (place.number >= rays_in_bin(f)) return (olx_former_ray){0};
  while (f->at < f->first + place.number) pass_ray(f);
  const uint32_t kind = unit->kinds[f->at];
  olx_former_ray ray = {.link = unit->links[f->at], .point = &unit->points[f->point]};
  if (unit->weights) ray.link.weight = unit->weights[f->at];
  ray.kept.needs = unit->table[kind].needs;
  ray.kept.crossed = unit->table[kind].crossed;
  ray.kept.cast = unit->cast[f->at];
  add_lights(f, &ray.kept);
  ray.holds = unit->holds[kind] && olx_link_still_ends(&ray.link, ray.point, unit->earlier, f->rays->now);
  return ray;
}
