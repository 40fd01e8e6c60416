// Saves and loads the whole state of a solution after a step, but for links and points, which are units of their own.
#include "light/solution/light_state.h"

#include "core/result.h"
#include "light/solution/light_steps.h"

void olx_cell_table_save(const olx_cell_table *t, olx_byte_writer *to) {
  const uint32_t counts[] = {t->capacity, t->count};
  olx_bytes_put(to, counts, 2, sizeof *counts);
  olx_bytes_put(to, t->keys, t->capacity, sizeof *t->keys);
  olx_bytes_put(to, t->values, t->capacity, sizeof *t->values);
}

void olx_cell_table_load(olx_cell_table *t, olx_byte_reader *from) {
  uint32_t counts[2] = {0};
  olx_cell_table_free(t);
  olx_bytes_copy(from, counts, 2, sizeof *counts);
  *t = (olx_cell_table){.capacity = counts[0], .count = counts[1]};
  t->keys = olx_bytes_take(from, t->capacity, sizeof *t->keys);
  t->values = olx_bytes_take(from, t->capacity, sizeof *t->values);
}

static void save_surfels(const olx_light_surfels *s, olx_byte_writer *to) {
  const uint32_t counts[] = {s->point_count, s->count};
  olx_bytes_put(to, counts, 2, sizeof *counts);
  olx_bytes_put(to, &s->rays, 1, sizeof s->rays);
  olx_bytes_put(to, s->surfels, s->count, sizeof *s->surfels);
  olx_cell_table_save(&s->table, to);
}

static void load_surfels(olx_light_surfels *s, olx_byte_reader *from) {
  uint32_t counts[2] = {0};
  olx_bytes_copy(from, counts, 2, sizeof *counts);
  olx_bytes_copy(from, &s->rays, 1, sizeof s->rays);
  s->point_count = counts[0];
  s->count = s->capacity = counts[1];
  s->surfels = olx_bytes_take(from, s->count, sizeof *s->surfels);
  olx_cell_table_load(&s->table, from);
}

// A stored batch, without its links, which are units.
typedef struct batch_record {
  uint32_t first_surfel, count, first_ray, rays, round;
  bool has_numbers, is_guided;
} batch_record;

static void save_batches(const olx_scene_light *l, olx_byte_writer *to) {
  olx_bytes_put(to, &l->links.batch_count, 1, sizeof l->links.batch_count);
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    const olx_link_batch *b = &l->batches[k];
    const batch_record record = {b->first_surfel, b->count,           b->first_ray,    b->rays,
                                 l->rounds_of[k], b->surfels != NULL, b->guide != NULL};
    olx_bytes_put(to, &record, 1, sizeof record);
    if (b->surfels) olx_bytes_put(to, b->surfels, b->count, sizeof *b->surfels);
  }
}

static void load_batches(olx_scene_light *l, olx_byte_reader *from) {
  uint32_t count = 0;
  olx_bytes_copy(from, &count, 1, sizeof count);
  for (uint32_t k = 0; k < count && k < OLX_LIGHT_MOST_BATCHES; k++) {
    batch_record r = {0};
    olx_bytes_copy(from, &r, 1, sizeof r);
    l->rounds_of[k] = r.round;
    l->batches[k] = (olx_link_batch){.first_surfel = r.first_surfel,
                                     .count = r.count,
                                     .first_ray = r.first_ray,
                                     .rays = r.rays,
                                     .guide = r.is_guided ? &l->guide : NULL,
                                     .folder = l->settings.link_folder};
    if (r.has_numbers) l->batches[k].surfels = olx_bytes_take(from, r.count, sizeof *l->batches[k].surfels);
    l->links.batch_count = k + 1;
  }
}

static void save_patches(const olx_scene_light *l, olx_byte_writer *to) {
  for (uint32_t round = 0; round < OLX_LIGHT_HIDDEN_ROUNDS; round++) {
    const olx_link_patch *patch = &l->patches[round];
    olx_bytes_put(to, &patch->count, 1, sizeof patch->count);
    olx_bytes_put(to, patch->links, patch->count, sizeof *patch->links);
    olx_bytes_put(to, patch->fixed, patch->count, sizeof *patch->fixed);
  }
}

static void load_patches(olx_scene_light *l, olx_byte_reader *from) {
  for (uint32_t round = 0; round < OLX_LIGHT_HIDDEN_ROUNDS; round++) {
    olx_link_patch *patch = &l->patches[round];
    olx_bytes_copy(from, &patch->count, 1, sizeof patch->count);
    if (patch->count == 0) continue;
    patch->links = olx_bytes_take(from, patch->count, sizeof *patch->links);
    patch->fixed = olx_bytes_take(from, patch->count, sizeof *patch->fixed);
  }
}

// Saves an array with one element per surfel, which may not exist yet.
static void save_array(const void *array, uint32_t count, size_t element_bytes, olx_byte_writer *to) {
  const uint32_t there = array ? count : 0;
  olx_bytes_put(to, &there, 1, sizeof there);
  olx_bytes_put(to, array, there, element_bytes);
}

static void *load_counted(olx_byte_reader *from, size_t element_bytes, uint32_t *count) {
  olx_bytes_copy(from, count, 1, sizeof *count);
  return *count ? olx_bytes_take(from, *count, element_bytes) : NULL;
}

static void *load_array(olx_byte_reader *from, size_t element_bytes) {
  uint32_t there = 0;
  return load_counted(from, element_bytes, &there);
}

static void save_lit(const olx_scene_light *l, olx_byte_writer *to) {
  const uint32_t count = l->surfels.count;
  save_array(l->links.fixed, count, sizeof *l->links.fixed, to);
  save_array(l->links.worth, count, sizeof *l->links.worth, to);
  save_array(l->direct, count, sizeof *l->direct, to);
  save_array(l->sky, count, sizeof *l->sky, to);
  save_array(l->surfels.marks, count, sizeof *l->surfels.marks, to);
  save_array(l->irradiance, count, sizeof *l->irradiance, to);
  save_array(l->passed_on, count, sizeof *l->passed_on, to);
  save_array(l->noise, count, sizeof *l->noise, to);
  save_array(l->gathered, l->visible, sizeof *l->gathered, to);
  save_array(l->final_rays, l->visible, sizeof *l->final_rays, to);
  save_array(l->guide.pool_of, count, sizeof *l->guide.pool_of, to);
  olx_bytes_put(to, &l->guide.pool_count, 1, sizeof l->guide.pool_count);
  save_array(l->guide.pools, l->guide.pool_count, sizeof *l->guide.pools, to);
}

static void load_lit(olx_scene_light *l, olx_byte_reader *from) {
  l->links.fixed = load_array(from, sizeof *l->links.fixed);
  l->links.worth = load_array(from, sizeof *l->links.worth);
  l->direct = load_array(from, sizeof *l->direct);
  l->sky = load_array(from, sizeof *l->sky);
  l->surfels.marks = load_array(from, sizeof *l->surfels.marks);
  l->irradiance = load_array(from, sizeof *l->irradiance);
  l->passed_on = load_array(from, sizeof *l->passed_on);
  l->noise = load_array(from, sizeof *l->noise);
  l->gathered = load_array(from, sizeof *l->gathered);
  l->final_rays = load_array(from, sizeof *l->final_rays);
  l->guide.pool_of = load_array(from, sizeof *l->guide.pool_of);
  olx_bytes_copy(from, &l->guide.pool_count, 1, sizeof l->guide.pool_count);
  l->guide.pools = load_array(from, sizeof *l->guide.pools);
}

static void save_placed(const olx_light_records *r, olx_byte_writer *to) {
  const uint32_t numbers[] = {r->lit, r->round};
  olx_bytes_put(to, numbers, 2, sizeof *numbers);
  save_array(r->places.surfels, r->places.count, sizeof *r->places.surfels, to);
  save_array(r->surfel_of, r->places.count, sizeof *r->surfel_of, to);
  save_array(r->irradiance, r->places.count, sizeof *r->irradiance, to);
}

static void load_placed(olx_scene_light *l, olx_byte_reader *from) {
  olx_light_records *r = &l->records;
  uint32_t numbers[2] = {0}, count = 0;
  olx_bytes_copy(from, numbers, 2, sizeof *numbers);
  r->lit = numbers[0];
  r->round = numbers[1];
  r->places = (olx_light_surfels){.scene = l->scene, .grid = l->surfels.grid};
  r->places.surfels = load_counted(from, sizeof *r->places.surfels, &count);
  r->places.count = r->places.capacity = count;
  r->surfel_of = load_array(from, sizeof *r->surfel_of);
  r->irradiance = load_array(from, sizeof *r->irradiance);
}

void olx_light_state_save(const olx_scene_light *l, olx_byte_writer *to) {
  const uint32_t numbers[] = {l->phase, l->round, l->visible, l->served, l->first_rays, l->gathering};
  olx_bytes_put(to, numbers, 6, sizeof *numbers);
  olx_bytes_put(to, l->point_ends, OLX_LIGHT_HIDDEN_ROUNDS + 1, sizeof *l->point_ends);
  olx_bytes_put(to, &l->report, 1, sizeof l->report);
  save_surfels(&l->surfels, to);
  save_batches(l, to);
  save_patches(l, to);
  save_lit(l, to);
  save_placed(&l->records, to);
}

olx_result olx_light_state_load(olx_scene_light *l, olx_byte_reader *from) {
  uint32_t numbers[6] = {0};
  olx_scene_light_clear(l);
  OLX_TRY(olx_light_surfels_create(&l->surfels, l->scene, l->settings.spacing, l->settings.seed, l->settings.threads));
  l->surfels.task = l->settings.task;
  olx_bytes_copy(from, numbers, 6, sizeof *numbers);
  olx_bytes_copy(from, l->point_ends, OLX_LIGHT_HIDDEN_ROUNDS + 1, sizeof *l->point_ends);
  l->phase = (olx_scene_light_phase)numbers[0];
  l->round = numbers[1];
  l->visible = numbers[2];
  l->served = numbers[3];
  l->first_rays = numbers[4];
  l->gathering = numbers[5];
  olx_bytes_copy(from, &l->report, 1, sizeof l->report);
  load_surfels(&l->surfels, from);
  load_batches(l, from);
  load_patches(l, from);
  load_lit(l, from);
  load_placed(l, from);
  return OLX_OK;
}
