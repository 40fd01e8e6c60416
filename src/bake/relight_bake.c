// Turns the solved light of a scene into what its light can be changed with: links of surfels and of volume probes are merged,
// and all becomes one structure.
#include "bake/relight_bake.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"

#include <string.h>

enum {
  MOST_LINKS = 128, // of a place
  PLACES_PER_JOB = 256,
  PLACES_AT_A_TIME = 64 * PLACES_PER_JOB,
  VOLUME_RAYS = 256, // of a volume probe
  PACKET = 64,
  SALT_VOLUME = 0x524C564F
};

// Merged links bring a surfel the light that it was baked with: their weights are scaled by this much at most, or the inverse.
static const float MOST_SCALE = 2.0f;

// The merged links of some places, PLACES_PER_JOB a job.
typedef struct merge_job {
  const olx_relight_bake *bake;
  const olx_vec3 *light;     // of surfels, direct and indirect
  const olx_vec3 *positions; // of volume probes; NULL for surfels
  uint32_t first, count;
  olx_merged_link *links; // MOST_LINKS a place
  uint32_t *counts;       // a place
  atomic_bool out_of_memory;
} merge_job;

// The links of a batch that start at a surfel; NULL when there are none.
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

static float scale_to(float wanted, float found) {
  return found > 0.0f ? olx_clamp(wanted / found, 1.0f / MOST_SCALE, MOST_SCALE) : 1.0f;
}

// What rays found by way of specular surfaces and at near ends has no links: the others, which bring `found`, are scaled to bring
// all that is wanted.
static void scale_links(olx_merged_link *links, uint32_t count, olx_vec3 found, olx_vec3 wanted) {
  const olx_vec3 scale = {scale_to(wanted.x, found.x), scale_to(wanted.y, found.y), scale_to(wanted.z, found.z)};
  for (uint32_t i = 0; i < count; i++) links[i].weight = olx_mul(links[i].weight, scale);
}

static uint32_t merge_surfel(const merge_job *j, olx_link_merger *merger, uint32_t surfel, olx_merged_link *links) {
  const olx_scene_light_parts parts = olx_scene_light_open(j->bake->light);
  const float share = 1.0f / parts.links->worth[surfel];
  olx_vec3 found = {0};
  for (uint32_t k = 0; k < parts.links->batch_count; k++) {
    const olx_link_batch *batch = &parts.links->batches[k];
    const olx_link *from = links_of(batch, surfel);
    for (uint32_t i = 0; from && i < batch->rays; i++) {
      if (!olx_link_brings_light(&from[i])) continue;
      const olx_vec3 weight = olx_scale(olx_rgb9e5_unpack(from[i].weight), share);
      found = olx_add(found, olx_mul(weight, j->light[olx_link_end(&from[i])]));
      olx_link_merger_add(merger, olx_link_end(&from[i]), weight, olx_splat(0.0f));
    }
  }
  const uint32_t count = olx_link_merger_take(merger, MOST_LINKS, links);
  scale_links(links, count, found, parts.irradiance[surfel]);
  return count;
}

// The links of a ray's end, which reflects as it does on average over views.
static void add_end(const olx_relight_bake *b, olx_link_merger *merger, const olx_ray *ray, const olx_ray_hit *hit) {
  if (hit->triangle == OLX_NO_HIT) return;
  const olx_light_surfels *surfels = olx_scene_light_open(b->light).surfels;
  const olx_surface surface = olx_surface_at(b->scene, hit, ray->direction);
  const uint64_t key = olx_cell_key(&surfels->grid, surface.position, surface.geometric_normal);
  const uint32_t end = olx_light_surfels_find(surfels, key, &surface, INFINITY).surfel;
  if (end == OLX_CELL_NONE) return;
  const olx_vec3 albedo = olx_min_each(olx_bsdf_matte(&surface.bsdf).albedo, olx_splat(1.0f));
  if (olx_max3(albedo) <= 0.0f) return; // nothing ever comes from there
  olx_link_merger_add(merger, end, olx_scale(albedo, 1.0f / (OLX_PI * VOLUME_RAYS)), ray->direction);
}

static uint32_t merge_volume_probe(const merge_job *j, olx_link_merger *merger, uint32_t probe, olx_merged_link *links) {
  const olx_relight_bake *b = j->bake;
  olx_ray rays[PACKET];
  olx_ray_hit hits[PACKET];
  for (uint32_t first = 0; first < VOLUME_RAYS; first += PACKET) {
    for (uint32_t i = 0; i < PACKET; i++) {
      const olx_vec3 direction = olx_sample_sphere(olx_stratified2(first + i, olx_hash3(b->seed, probe, SALT_VOLUME)));
      rays[i] = (olx_ray){j->positions[probe], olx_normalize(direction), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(b->scene->bvh, rays, PACKET, false, hits);
    for (uint32_t i = 0; i < PACKET; i++) add_end(b, merger, &rays[i], &hits[i]);
  }
  return olx_link_merger_take(merger, MOST_LINKS, links);
}

static void merge_some(void *user, uint32_t job) {
  merge_job *j = user;
  olx_link_merger merger;
  if (olx_link_merger_create(&merger, &j->bake->tree) != OLX_OK) {
    atomic_store(&j->out_of_memory, true);
    return;
  }
  const uint32_t first = job * PLACES_PER_JOB,
                 end = first + PLACES_PER_JOB < j->count ? first + PLACES_PER_JOB : j->count;
  for (uint32_t i = first; i < end; i++) {
    olx_merged_link *links = j->links + (size_t)i * MOST_LINKS;
    const uint32_t place = j->first + i;
    j->counts[i] = j->positions ? merge_volume_probe(j, &merger, place, links) : merge_surfel(j, &merger, place, links);
  }
  olx_link_merger_free(&merger);
}

static olx_relight_volume_link packed(const olx_merged_link *link) {
  const olx_vec2 at =
      olx_max3(olx_mul(link->direction, link->direction)) > 0.0f ? olx_octahedral_encode(link->direction) : (olx_vec2){0};
  return (olx_relight_volume_link){link->from, olx_rgb9e5_pack(link->weight),
                                   {(uint16_t)(at.x * 65535.0f + 0.5f), (uint16_t)(at.y * 65535.0f + 0.5f)}};
}

// Room for `more` links beyond `count`.
static olx_result grow(olx_relight_rows *rows, uint64_t count, uint64_t more) {
  if (count + more <= rows->most) return OLX_OK;
  if (count + more > OLX_RELIGHT_MOST) return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: more links than a field can hold");
  const uint64_t most = count + more > 2 * rows->most ? count + more : 2 * rows->most;
  olx_relight_volume_link *larger = olx_allocate(most, sizeof *larger);
  if (!larger) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for links");
  if (count > 0) memcpy(larger, rows->links, count * sizeof *larger);
  olx_release(rows->links);
  rows->links = larger;
  rows->most = most;
  return OLX_OK;
}

// What a job has merged, behind what there is.
static olx_result append(const merge_job *j, olx_relight_rows *rows) {
  uint64_t more = 0;
  for (uint32_t i = 0; i < j->count; i++) more += j->counts[i];
  uint32_t end = rows->starts[j->first];
  OLX_TRY(grow(rows, end, more));
  for (uint32_t i = 0; i < j->count; i++) {
    for (uint32_t k = 0; k < j->counts[i]; k++) rows->links[end++] = packed(&j->links[(size_t)i * MOST_LINKS + k]);
    rows->starts[j->first + i + 1] = end;
  }
  return OLX_OK;
}

static olx_result merge_parts(merge_job *j, uint32_t count, olx_relight_rows *rows) {
  rows->starts[0] = 0;
  for (j->first = 0; j->first < count; j->first += PLACES_AT_A_TIME) {
    j->count = count - j->first < PLACES_AT_A_TIME ? count - j->first : PLACES_AT_A_TIME;
    const uint32_t jobs = (j->count + PLACES_PER_JOB - 1) / PLACES_PER_JOB;
    OLX_TRY(olx_parallel_for(jobs, j->bake->threads, merge_some, j, j->bake->task, 0));
    if (atomic_load(&j->out_of_memory)) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for merging links");
    OLX_TRY(append(j, rows));
  }
  return OLX_OK;
}

static olx_result merge(merge_job *j, uint32_t count, olx_relight_rows *rows) {
  const size_t most = count < PLACES_AT_A_TIME ? count : PLACES_AT_A_TIME;
  rows->starts = olx_allocate((size_t)count + 1, sizeof *rows->starts);
  j->links = olx_allocate(most * MOST_LINKS, sizeof *j->links);
  j->counts = olx_allocate(most, sizeof *j->counts);
  const olx_result result = rows->starts && j->links && j->counts
                                ? merge_parts(j, count, rows)
                                : olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for links of %u places", count);
  olx_release(j->links);
  olx_release(j->counts);
  return result;
}

olx_result olx_relight_bake_create(olx_relight_bake *b) {
  const olx_scene_light_parts parts = olx_scene_light_open(b->light);
  OLX_TRY(olx_link_tree_create(&b->tree, parts.surfels, parts.links));
  olx_vec3 *light = olx_allocate(b->tree.leaves, sizeof *light);
  if (!light) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for light of %u surfels", b->tree.leaves);
  for (uint32_t i = 0; i < b->tree.leaves; i++) light[i] = olx_add(parts.direct[i], parts.irradiance[i]);
  merge_job j = {.bake = b, .light = light};
  const olx_result result = merge(&j, b->tree.leaves, &b->surfels);
  olx_release(light);
  return result;
}

olx_result olx_relight_bake_volume(olx_relight_bake *b, const olx_vec3 *positions, uint32_t count) {
  merge_job j = {.bake = b, .positions = positions};
  b->volume_count = count;
  b->rays += (uint64_t)count * VOLUME_RAYS;
  return count > 0 ? merge(&j, count, &b->volume) : OLX_OK;
}

olx_result olx_relight_bake_probe(olx_relight_bake *b, const olx_capture *capture) {
  return olx_relight_sites_add(&b->sites, capture, b->light);
}

void olx_relight_bake_free(olx_relight_bake *b) {
  olx_link_tree_free(&b->tree);
  olx_release(b->surfels.starts);
  olx_release(b->surfels.links);
  olx_release(b->volume.starts);
  olx_release(b->volume.links);
  olx_relight_sites_free(&b->sites);
}

// ---- The structure

// Bytes that are written one after the other.
typedef struct output {
  char *next;
} output;

static void put(output *o, const void *data, size_t size_bytes) {
  if (size_bytes > 0) memcpy(o->next, data, size_bytes);
  o->next += size_bytes;
}

// Area that a point of a cell stands for, but for a factor: points were found by rays that spread out.
static float area_of(const olx_surface_point *point) { return point->footprint * point->footprint; }

// Points spread over the area that the surfel stands for, a little off the surface.
static olx_relight_surfel stored_surfel(const olx_relight_bake *b, uint32_t index) {
  const olx_scene_light_parts parts = olx_scene_light_open(b->light);
  const olx_light_surfel *s = &parts.surfels->surfels[index];
  olx_relight_surfel stored = {.irradiance = olx_rgb9e5_pack(parts.irradiance[index])};
  const olx_surface_point *points = parts.surfels->points + s->first_point;
  float area = 0.0f, passed = 0.0f;
  for (uint32_t k = 0; k < s->point_count; k++) area += area_of(&points[k]);
  for (uint32_t i = 0, k = 0; i < OLX_RELIGHT_POINTS; i++) {
    const float wanted = area * ((float)i + 0.5f) / OLX_RELIGHT_POINTS;
    while (k + 1 < s->point_count && passed + area_of(&points[k]) < wanted) passed += area_of(&points[k++]);
    const olx_surface surface = olx_surface_point_surface(b->scene, &points[k]);
    olx_store3(stored.points[i], olx_surface_ray(&surface, surface.geometric_normal, INFINITY).origin);
  }
  const olx_surface middle = olx_surface_point_surface(b->scene, &s->point);
  stored.normal = olx_normal_pack(middle.shading_normal);
  return stored;
}

static void put_links(const olx_relight_rows *rows, uint32_t count, output *o) {
  for (uint32_t i = 0; i < count; i++) {
    const olx_relight_link link = {rows->links[i].from, rows->links[i].weight};
    put(o, &link, sizeof link);
  }
}

static olx_relight_header header_of(const olx_relight_bake *b) {
  const olx_link_tree *t = &b->tree;
  return (olx_relight_header){.surfels = t->leaves,
                              .nodes = t->count - t->leaves,
                              .members = t->starts[t->count - t->leaves],
                              .links = b->surfels.starts[t->leaves],
                              .sites = b->sites.site_count,
                              .entries = b->sites.entry_count,
                              .volume_links = b->volume_count ? b->volume.starts[b->volume_count] : 0,
                              .blocks = b->sites.block_count,
                              .volume_probes = b->volume_count};
}

static void put_all(const olx_relight_bake *b, const olx_relight_header *h, output *o) {
  static const uint32_t zero;
  put(o, h, sizeof *h);
  for (uint32_t i = 0; i < h->surfels; i++) {
    const olx_relight_surfel surfel = stored_surfel(b, i);
    put(o, &surfel, sizeof surfel);
  }
  put(o, b->surfels.starts, (h->surfels + (size_t)1) * sizeof zero);
  put_links(&b->surfels, h->links, o);
  put(o, b->tree.starts, (h->nodes + (size_t)1) * sizeof zero);
  for (uint32_t i = 0; i < h->members; i++) {
    const olx_relight_member member = {b->tree.members[i], olx_min(b->tree.shares[i], 1.0f)};
    put(o, &member, sizeof member);
  }
  put(o, b->sites.blocks, h->blocks * sizeof *b->sites.blocks);
  put(o, b->sites.starts, (h->sites + (size_t)1) * sizeof zero);
  put(o, b->sites.entries, h->entries * sizeof *b->sites.entries);
  put(o, b->volume_count ? b->volume.starts : &zero, (h->volume_probes + (size_t)1) * sizeof zero);
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
