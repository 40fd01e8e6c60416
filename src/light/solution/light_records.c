// Divides the cells of surfels where light varies between them, and lights a record in each part.
#include "light/solution/light_records.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/solution/light_lookup.h"

enum {
  RECORDS_PER_JOB = 16,
  RECORDS_A_UNIT = OLX_LIGHT_UNIT_RAYS / (4 * OLX_GATHER_RAYS) // a record casts one to eight batches
};

static olx_result grow(olx_light_records *r, uint32_t count) {
  if (count <= r->places.capacity) return OLX_OK;
  const uint32_t capacity = count > 2 * r->places.capacity ? count : 2 * r->places.capacity;
  olx_light_surfel *places = olx_allocate(capacity, sizeof *places);
  uint32_t *surfel_of = olx_allocate(capacity, sizeof *surfel_of);
  olx_vec3 *irradiance = olx_allocate_zero(capacity, sizeof *irradiance);
  const bool made = places && surfel_of && irradiance;
  for (uint32_t i = 0; made && i < r->places.count; i++) {
    places[i] = r->places.surfels[i];
    surfel_of[i] = r->surfel_of[i];
    irradiance[i] = r->irradiance[i];
  }
  olx_release(made ? r->places.surfels : places);
  olx_release(made ? r->surfel_of : surfel_of);
  olx_release(made ? r->irradiance : irradiance);
  if (!made) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u records", capacity);
  r->places.surfels = places;
  r->places.capacity = capacity;
  r->surfel_of = surfel_of;
  r->irradiance = irradiance;
  return OLX_OK;
}

static olx_result begin(olx_scene_light *l) {
  olx_light_records *r = &l->records;
  r->places = (olx_light_surfels){.scene = l->scene, .grid = l->surfels.grid};
  OLX_TRY(grow(r, l->visible));
  for (uint32_t i = 0; i < l->visible; i++) {
    r->places.surfels[i] = l->surfels.surfels[i];
    r->surfel_of[i] = i;
    r->irradiance[i] = l->irradiance[i];
  }
  r->places.count = r->lit = l->visible;
  return OLX_OK;
}

typedef struct varying_job {
  const olx_scene_light *light;
  uint8_t *varies; // one per record
} varying_job;

static void find_varying(void *user, uint32_t job) {
  const varying_job *v = user;
  const olx_light_surfels *places = &v->light->records.places;
  const uint32_t first = job * RECORDS_PER_JOB;
  const uint32_t end = first + RECORDS_PER_JOB < places->count ? first + RECORDS_PER_JOB : places->count;
  for (uint32_t i = first; i < end; i++) {
    const olx_surface surface = olx_surfel_point_surface(v->light->scene, &places->surfels[i].point);
    v->varies[i] = olx_light_varies(v->light, &surface);
  }
}

static bool are_too_many(const olx_scene_light *l) {
  return l->records.places.count > OLX_LIGHT_MOST_RECORDS * l->visible;
}

// Divides the cells of the records that vary, until there are too many, and counts the rays that the new records will
// cast.
static olx_result divide(olx_scene_light *l, const uint8_t *varies, uint64_t *rays) {
  olx_light_records *r = &l->records;
  for (uint32_t i = 0; i < r->lit && !are_too_many(l); i++) {
    olx_light_surfel parts[OLX_CELL_PARTS];
    if (!varies[i]) continue;
    const uint32_t count = olx_light_surfels_part(&l->surfels, r->surfel_of[i], &r->places.surfels[i], parts);
    if (count == 0) continue;
    OLX_TRY(grow(r, r->places.count + count - 1));
    r->places.surfels[i] = parts[0];
    for (uint32_t k = 1; k < count; k++) {
      r->surfel_of[r->places.count] = r->surfel_of[i];
      r->places.surfels[r->places.count++] = parts[k];
    }
    *rays += (uint64_t)(count - 1) * olx_light_record_batches(l, r->surfel_of[i]) * OLX_GATHER_RAYS;
  }
  return OLX_OK;
}

// Takes the planned division back.
static void undo(olx_light_records *r, const olx_light_surfel *former) {
  for (uint32_t i = 0; i < r->lit; i++) r->places.surfels[i] = former[i];
  r->places.count = r->lit;
}

static olx_result divide_varying(olx_scene_light *l, uint8_t *varies, olx_light_surfel *former) {
  olx_light_records *r = &l->records;
  varying_job v = {l, varies};
  uint64_t rays = 0;
  const uint32_t jobs = (r->lit + RECORDS_PER_JOB - 1) / RECORDS_PER_JOB;
  OLX_TRY(olx_parallel_for(jobs, l->settings.threads, find_varying, &v, l->settings.task, 0));
  for (uint32_t i = 0; i < r->lit; i++) former[i] = r->places.surfels[i];
  OLX_TRY(divide(l, varies, &rays));
  if (are_too_many(l) || rays > l->settings.most_final_rays) undo(r, former);
  return OLX_OK;
}

olx_result olx_light_records_plan(olx_scene_light *l, uint32_t round, bool *any) {
  olx_light_records *r = &l->records;
  r->round = round;
  if (!r->places.surfels) OLX_TRY(begin(l));
  OLX_TRY(olx_light_records_look_up(l));
  uint8_t *varies = olx_allocate(r->lit, sizeof *varies);
  olx_light_surfel *former = olx_allocate(r->lit, sizeof *former);
  const olx_result result = varies && former
                                ? divide_varying(l, varies, former)
                                : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u records", r->lit);
  olx_release(varies);
  olx_release(former);
  *any = r->places.count > r->lit;
  return result;
}

static uint32_t units_of(const olx_scene_light *l) {
  return (l->records.places.count - l->records.lit + RECORDS_A_UNIT - 1) / RECORDS_A_UNIT;
}

static uint32_t first_of(const olx_scene_light *l, uint32_t unit) {
  const uint32_t first = l->records.lit + unit * RECORDS_A_UNIT;
  return first < l->records.places.count ? first : l->records.places.count;
}

typedef struct record_job {
  olx_scene_light *light;
  uint32_t first, end;
  uint64_t *rays; // one per job
} record_job;

static void light_some(void *user, uint32_t job) {
  const record_job *j = user;
  olx_light_records *r = &j->light->records;
  const uint32_t first = j->first + job * RECORDS_PER_JOB;
  const uint32_t end = first + RECORDS_PER_JOB < j->end ? first + RECORDS_PER_JOB : j->end;
  for (uint32_t i = first; i < end; i++) {
    const olx_surface surface = olx_surfel_point_surface(j->light->scene, &r->places.surfels[i].point);
    const uint32_t batches = olx_light_record_batches(j->light, r->surfel_of[i]);
    r->irradiance[i] = olx_light_gather(j->light, &surface, batches, NULL);
    j->rays[job] += (uint64_t)batches * OLX_GATHER_RAYS;
  }
}

static olx_result cast(olx_scene_light *l, uint32_t first, uint32_t end, uint64_t *rays) {
  const uint32_t jobs = (end - first + RECORDS_PER_JOB - 1) / RECORDS_PER_JOB;
  record_job j = {.light = l, .first = first, .end = end, .rays = olx_allocate_zero(jobs, sizeof *j.rays)};
  if (!j.rays) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u records", end - first);
  const olx_result result = olx_parallel_for(jobs, l->settings.threads, light_some, &j, l->settings.task, 0);
  for (uint32_t i = 0; i < jobs; i++) *rays += j.rays[i];
  olx_release(j.rays);
  return result;
}

static uint32_t round_of(const olx_scene_light *l) { return l->records.round; }

static void *array_of(olx_scene_light *l) { return l->records.irradiance; }

const olx_light_ranges olx_record_ranges = {"record", sizeof(olx_vec3), round_of, units_of, first_of, array_of, cast};

void olx_light_records_settle(olx_scene_light *l) { l->records.lit = l->records.places.count; }

olx_result olx_light_records_look_up(olx_scene_light *l) {
  olx_light_records *r = &l->records;
  olx_surfel_lookup_free(&r->lookup);
  return olx_surfel_lookup_create(&r->lookup, &r->places, r->lit);
}

void olx_light_records_free(olx_light_records *r) {
  olx_surfel_lookup_free(&r->lookup);
  olx_release(r->places.surfels);
  olx_release(r->surfel_of);
  olx_release(r->irradiance);
  *r = (olx_light_records){0};
}
