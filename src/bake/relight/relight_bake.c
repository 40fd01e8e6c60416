// Packs the solved light of a scene for relighting: reduces the links of surfels and of volume probes to a few each,
// and writes them into one structure.
#include "bake/relight/relight_bake.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"
#include "light/links/link_batch.h"
#include "scene/bvh.h"

#include <string.h>

enum {
  PLACES_PER_JOB = 256,
  VOLUME_RAYS = 256, // per volume probe
  PACKET = 64,
  SALT_VOLUME = 0x524C564F,
  SALT_DRAW = 0x524C4452
};

// The links of PLACES_PER_JOB places, found by one job.
typedef struct link_job {
  const olx_relight_bake *bake;
  const olx_vec3 *positions; // positions of volume probes; NULL for surfels
  uint32_t first, count;
  olx_few_link *links; // OLX_RELIGHT_MOST_LINKS per place
  uint32_t *counts;    // one per place
  atomic_bool out_of_memory;
} link_job;

// Finds the links of a batch that start at a surfel; NULL when there are none.
static const olx_link *links_of(const olx_link_batch *batch, uint32_t surfel) {
  uint32_t low = 0, high = batch->count;
  if (!batch->surfels) {
    const bool inside = surfel >= batch->first_surfel && surfel - batch->first_surfel < batch->count;
    return inside ? batch->links + (size_t)(surfel - batch->first_surfel) * batch->rays : NULL;
  }
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (batch->surfels[middle] < surfel) low = middle + 1;
    else high = middle;
  }
  return low < batch->count && batch->surfels[low] == surfel ? batch->links + (size_t)low * batch->rays : NULL;
}

// Returns the random number that selects the links of a place, a function of the place alone.
static float draw_of(uint64_t place) {
  return olx_unit_float(olx_hash3((uint32_t)place, (uint32_t)(place >> 32), SALT_DRAW));
}

static void add_link(olx_link_list *list, const olx_link *link, float share) {
  const olx_vec3 weight = olx_scale(olx_rgb9e5_unpack(link->weight), share);
  if (olx_max3(weight) <= 0.0f) return; // a black surface
  olx_link_list_add(list, &(olx_few_link){.from = olx_link_end(link),
                                          .weight = weight,
                                          .straight = olx_link_chain(link) ? 0.0f : olx_luminance(weight)});
}

static uint32_t link_surfel(const link_job *j, olx_link_list *list, uint32_t surfel, olx_few_link *links) {
  const olx_scene_light_parts parts = olx_scene_light_open(j->bake->light);
  const float share = 1.0f / parts.links->worth[surfel];
  for (uint32_t k = 0; k < parts.links->batch_count; k++) {
    const olx_link_batch *batch = &parts.links->batches[k];
    const olx_link *from = links_of(batch, surfel);
    for (uint32_t i = 0; from && i < batch->rays; i++) {
      if (olx_link_brings_light(&from[i])) add_link(list, &from[i], share);
    }
    const uint32_t n = from ? (uint32_t)((size_t)(from - batch->links) / batch->rays) : 0;
    if (from) olx_link_batch_rest(batch, n, n + 1);
  }
  return olx_link_list_take(list, OLX_RELIGHT_MOST_LINKS, draw_of(parts.surfels->surfels[surfel].cell), links);
}

// Adds the links of a ray's end, with its albedo averaged over views.
static void add_end(const olx_relight_bake *b, olx_link_list *list, const olx_ray *ray, const olx_ray_hit *hit) {
  if (hit->triangle == OLX_NO_HIT) return;
  const olx_light_surfels *surfels = olx_scene_light_open(b->light).surfels;
  const olx_surface surface = olx_surface_at(b->context->scene, hit, ray->direction);
  const uint64_t key = olx_cell_key(&surfels->grid, surface.position, surface.geometric_normal);
  const uint32_t end = olx_light_surfels_find(surfels, key, &surface, INFINITY).surfel;
  if (end == OLX_CELL_NONE) return;
  const olx_vec3 albedo = olx_min_each(olx_bsdf_matte(&surface.bsdf).albedo, olx_splat(1.0f));
  if (olx_max3(albedo) <= 0.0f) return; // the surface reflects no light
  olx_link_list_add(list, &(olx_few_link){.from = end,
                                          .weight = olx_scale(albedo, 1.0f / (OLX_PI * VOLUME_RAYS)),
                                          .direction = ray->direction});
}

static uint32_t link_volume_probe(const link_job *j, olx_link_list *list, uint32_t probe, olx_few_link *links) {
  const olx_relight_bake *b = j->bake;
  olx_ray rays[PACKET];
  olx_ray_hit hits[PACKET];
  for (uint32_t first = 0; first < VOLUME_RAYS; first += PACKET) {
    for (uint32_t i = 0; i < PACKET; i++) {
      const olx_vec3 direction = olx_sample_sphere(olx_stratified2(first + i, olx_hash3(b->seed, probe, SALT_VOLUME)));
      rays[i] = (olx_ray){j->positions[probe], olx_normalize(direction), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(b->context->scene->light_bvh, rays, PACKET, false, hits);
    for (uint32_t i = 0; i < PACKET; i++) add_end(b, list, &rays[i], &hits[i]);
  }
  return olx_link_list_take(list, OLX_RELIGHT_MOST_LINKS, draw_of(probe), links);
}

static void link_some(void *user, uint32_t job) {
  link_job *j = user;
  olx_link_list list;
  if (olx_link_list_create(&list, j->bake->surfel_count) != OLX_OK) {
    atomic_store(&j->out_of_memory, true);
    return;
  }
  const uint32_t first = job * PLACES_PER_JOB,
                 end = first + PLACES_PER_JOB < j->count ? first + PLACES_PER_JOB : j->count;
  for (uint32_t i = first; i < end; i++) {
    olx_few_link *links = j->links + (size_t)i * OLX_RELIGHT_MOST_LINKS;
    const uint32_t place = j->first + i;
    j->counts[i] = j->positions ? link_volume_probe(j, &list, place, links) : link_surfel(j, &list, place, links);
  }
  olx_link_list_free(&list);
}

// Quantizes a share from 0 to 1 to a byte.
static uint8_t byte_of(float share) { return (uint8_t)(olx_clamp(share, 0.0f, 1.0f) * 255.0f + 0.5f); }

// Packs a link of either kind: links of surfels have no direction, and links of volume probes have a straight share of
// 0.
static olx_relight_volume_link packed(const olx_few_link *link) {
  const float weight = olx_luminance(link->weight), length = olx_length(link->direction);
  const uint32_t straight = weight > 0.0f ? byte_of(link->straight / weight) : 0;
  const olx_vec2 at = length > 0.0f ? olx_octahedral_encode(olx_scale(link->direction, 1.0f / length)) : (olx_vec2){0};
  return (olx_relight_volume_link){link->from | straight << 24,
                                   olx_rgb9e5_pack(link->weight),
                                   {(uint16_t)(at.x * 65535.0f + 0.5f), (uint16_t)(at.y * 65535.0f + 0.5f)}};
}

// Reserves room for `more` links beyond `count`.
static olx_result grow(olx_relight_rows *rows, uint64_t count, uint64_t more) {
  if (count + more <= rows->most) return OLX_OK;
  if (count + more > OLX_RELIGHT_MOST)
    return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: more links than a field can hold");
  const uint64_t most = count + more > 2 * rows->most ? count + more : 2 * rows->most;
  olx_relight_volume_link *larger = olx_allocate(most, sizeof *larger);
  if (!larger) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for links");
  if (count > 0) memcpy(larger, rows->links, count * sizeof *larger);
  olx_release(rows->links);
  rows->links = larger;
  rows->most = most;
  return OLX_OK;
}

// Appends the links of a job to those of the jobs before.
static olx_result append(const link_job *j, olx_relight_rows *rows) {
  uint64_t more = 0;
  for (uint32_t i = 0; i < j->count; i++) more += j->counts[i];
  uint32_t end = rows->starts[j->first];
  OLX_TRY(grow(rows, end, more));
  for (uint32_t i = 0; i < j->count; i++) {
    for (uint32_t k = 0; k < j->counts[i]; k++)
      rows->links[end++] = packed(&j->links[(size_t)i * OLX_RELIGHT_MOST_LINKS + k]);
    rows->starts[j->first + i + 1] = end;
  }
  return OLX_OK;
}

static olx_result link_parts(link_job *j, uint32_t count, olx_relight_rows *rows) {
  rows->starts[0] = 0;
  for (j->first = 0; j->first < count; j->first += OLX_RELIGHT_PLACES) {
    j->count = count - j->first < OLX_RELIGHT_PLACES ? count - j->first : OLX_RELIGHT_PLACES;
    const uint32_t jobs = (j->count + PLACES_PER_JOB - 1) / PLACES_PER_JOB;
    OLX_TRY(olx_bake_for(j->bake->context, jobs, link_some, j, 0));
    if (atomic_load(&j->out_of_memory)) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for lists of links");
    OLX_TRY(append(j, rows));
  }
  return OLX_OK;
}

static olx_result link_places(link_job *j, uint32_t count, olx_relight_rows *rows) {
  const size_t most = count < OLX_RELIGHT_PLACES ? count : OLX_RELIGHT_PLACES;
  rows->starts = olx_allocate((size_t)count + 1, sizeof *rows->starts);
  j->links = olx_allocate(most * OLX_RELIGHT_MOST_LINKS, sizeof *j->links);
  j->counts = olx_allocate(most, sizeof *j->counts);
  const olx_result result = rows->starts && j->links && j->counts
                                ? link_parts(j, count, rows)
                                : olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for links of %u places", count);
  olx_release(j->links);
  olx_release(j->counts);
  return result;
}

olx_result olx_relight_bake_volume(olx_relight_bake *b, const olx_vec3 *positions, uint32_t count) {
  link_job j = {.bake = b, .positions = positions};
  b->volume_count = count;
  b->rays += (uint64_t)count * VOLUME_RAYS;
  return count > 0 ? link_places(&j, count, &b->volume) : OLX_OK;
}

olx_result olx_relight_bake_probe(olx_relight_bake *b, const olx_relight_sites *probe) {
  return olx_relight_sites_append(&b->sites, probe);
}

olx_result olx_relight_bake_look_up(olx_relight_bake *b) {
  const olx_scene_light_parts parts = olx_scene_light_open(b->light);
  return olx_surfel_lookup_create(&b->lookup, parts.surfels, parts.visible);
}

void olx_relight_bake_free(olx_relight_bake *b) {
  olx_surfel_lookup_free(&b->lookup);
  olx_release(b->stored);
  olx_release(b->surfels.starts);
  olx_release(b->surfels.links);
  olx_release(b->volume.starts);
  olx_release(b->volume.links);
  olx_relight_sites_free(&b->sites);
}

// ---- The structure

// A buffer of bytes that is written front to back.
typedef struct output {
  char *next;
} output;

static void put(output *o, const void *data, size_t size_bytes) {
  if (size_bytes > 0) memcpy(o->next, data, size_bytes);
  o->next += size_bytes;
}

static void store_reflectance(olx_relight_surfel *stored, const olx_bsdf *bsdf) {
  const olx_bsdf specular = {.f0 = bsdf->f0, .f90 = bsdf->f90, .alpha = bsdf->alpha};
  const float all = olx_luminance(olx_bsdf_matte(bsdf).albedo), part = olx_luminance(olx_bsdf_matte(&specular).albedo);
  stored->diffuse = byte_of(all - part);
  stored->specular = byte_of(part);
  stored->f0 = byte_of(olx_luminance(bsdf->f0));
  stored->alpha = byte_of(bsdf->alpha);
}

// Packs a surfel, with sample points spread over the area that it represents, slightly off the surface.
static olx_relight_surfel stored_surfel(const olx_relight_bake *b, uint32_t index) {
  const olx_scene_light_parts parts = olx_scene_light_open(b->light);
  const olx_light_surfel *s = &parts.surfels->surfels[index];
  olx_relight_surfel stored = {.irradiance = olx_rgb9e5_pack(parts.irradiance[index])};
  const olx_surfel_point *points = parts.surfels->points + s->first_point;
  float area = 0.0f, passed = 0.0f;
  for (uint32_t k = 0; k < s->point_count; k++) area += olx_surfel_point_area(&points[k]);
  for (uint32_t i = 0, k = 0; i < OLX_RELIGHT_POINTS; i++) {
    const float wanted = area * ((float)i + 0.5f) / OLX_RELIGHT_POINTS;
    while (k + 1 < s->point_count && passed + olx_surfel_point_area(&points[k]) < wanted)
      passed += olx_surfel_point_area(&points[k++]);
    const olx_surface surface = olx_surfel_point_surface(b->context->scene, &points[k]);
    olx_store3(stored.points[i], olx_surface_ray(&surface, surface.geometric_normal, INFINITY).origin);
  }
  const olx_surface middle = olx_surfel_point_surface(b->context->scene, &s->point);
  stored.normal = olx_normal_pack(middle.shading_normal);
  store_reflectance(&stored, &middle.bsdf);
  return stored;
}

olx_result olx_relight_bake_create(olx_relight_bake *b) {
  b->surfel_count = olx_scene_light_open(b->light).surfels->count;
  if (b->surfel_count > OLX_RELIGHT_MOST_SURFELS) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: %u surfels are more than a field can hold", b->surfel_count);
  }
  b->stored = olx_allocate(b->surfel_count, sizeof *b->stored);
  if (!b->stored) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u surfels", b->surfel_count);
  for (uint32_t i = 0; i < b->surfel_count; i++) b->stored[i] = stored_surfel(b, i);
  link_job j = {.bake = b};
  return link_places(&j, b->surfel_count, &b->surfels);
}

static uint32_t row_links(const olx_relight_rows *rows, uint32_t count) { return count ? rows->starts[count] : 0; }

static void save_rows(const olx_relight_rows *rows, uint32_t count, olx_byte_writer *to) {
  const uint32_t links = row_links(rows, count);
  olx_bytes_put(to, &links, 1, sizeof links);
  olx_bytes_put(to, rows->starts, count ? count + (size_t)1 : 0, sizeof *rows->starts);
  olx_bytes_put(to, rows->links, links, sizeof *rows->links);
}

static void load_rows(olx_relight_rows *rows, uint32_t count, olx_byte_reader *from) {
  uint32_t links = 0;
  olx_bytes_copy(from, &links, 1, sizeof links);
  rows->starts = olx_bytes_take(from, count ? count + (size_t)1 : 0, sizeof *rows->starts);
  rows->links = olx_bytes_take(from, links, sizeof *rows->links);
  rows->most = links;
}

void olx_relight_bake_save(const olx_relight_bake *b, olx_byte_writer *to) {
  const uint32_t counts[] = {b->surfel_count, b->volume_count};
  olx_bytes_put(to, counts, 2, sizeof *counts);
  olx_bytes_put(to, b->stored, b->surfel_count, sizeof *b->stored);
  save_rows(&b->surfels, b->surfel_count, to);
  save_rows(&b->volume, b->volume_count, to);
}

olx_result olx_relight_bake_load(olx_relight_bake *b, olx_byte_reader *from) {
  uint32_t counts[2] = {0};
  olx_bytes_copy(from, counts, 2, sizeof *counts);
  b->surfel_count = counts[0];
  b->volume_count = counts[1];
  b->stored = olx_bytes_take(from, b->surfel_count, sizeof *b->stored);
  load_rows(&b->surfels, b->surfel_count, from);
  load_rows(&b->volume, b->volume_count, from);
  return from->failed ? olx_fail(OLX_ERROR_FORMAT, "relight: a result does not hold what it should") : OLX_OK;
}

// Returns where the links of each place begin, and where the last place's end.
static const uint32_t *starts_of(const olx_relight_rows *rows, uint32_t count) {
  static const uint32_t zero;
  return count ? rows->starts : &zero;
}

static void put_links(const olx_relight_rows *rows, uint32_t count, output *o) {
  for (uint32_t i = 0; i < count; i++) {
    const olx_relight_link link = {rows->links[i].from, rows->links[i].weight};
    put(o, &link, sizeof link);
  }
}

static olx_relight_header header_of(const olx_relight_bake *b) {
  return (olx_relight_header){.surfels = b->surfel_count,
                              .links = row_links(&b->surfels, b->surfel_count),
                              .sites = b->sites.site_count,
                              .entries = b->sites.entry_count,
                              .volume_links = row_links(&b->volume, b->volume_count),
                              .blocks = b->sites.block_count,
                              .volume_probes = b->volume_count};
}

static void put_all(const olx_relight_bake *b, const olx_relight_header *h, output *o) {
  put(o, h, sizeof *h);
  put(o, b->stored, h->surfels * sizeof *b->stored);
  put(o, starts_of(&b->surfels, h->surfels), (h->surfels + (size_t)1) * sizeof(uint32_t));
  put_links(&b->surfels, h->links, o);
  put(o, b->sites.blocks, h->blocks * sizeof *b->sites.blocks);
  put(o, b->sites.starts, (h->sites + (size_t)1) * sizeof(uint32_t));
  put(o, b->sites.entries, h->entries * sizeof *b->sites.entries);
  put(o, starts_of(&b->volume, h->volume_probes), (h->volume_probes + (size_t)1) * sizeof(uint32_t));
  put(o, b->volume.links, h->volume_links * sizeof *b->volume.links);
}

olx_result olx_relight_bake_write(olx_relight_bake *b, olx_field_writer *writer) {
  const olx_relight_header header = header_of(b);
  const uint64_t size_bytes = olx_relight_structure_bytes(&header);
  char *data = olx_allocate(size_bytes, 1);
  if (!data) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %llu bytes", (unsigned long long)size_bytes);
  output o = {data};
  put_all(b, &header, &o);
  const olx_result result = olx_field_writer_relight(writer, data, size_bytes);
  olx_release(data);
  return result;
}
