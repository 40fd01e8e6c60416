// Evaluates random points of free space for six normals each, by the volume, by irradiance probes and by paths. Paths
// form two independent halves, so that their noise cancels out of the errors.
#include "render/audit_space.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "light/path.h"
#include "place/space/space_find.h"
#include "shade/volume_irradiance.h"

enum { NORMALS = 6, VOXELS = 160, ATTEMPTS = 64, PATHS_SHARE = 16, SALT_PLACE = 0x53504143 };

static const olx_vec3 normals[NORMALS] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

typedef struct place_verdict {
  bool valid, served; // served: whether the volume has a cell there
  olx_vec3 volume[NORMALS], probes[NORMALS], truth[2][NORMALS];
} place_verdict;

typedef struct space_audit {
  const olx_scene *scene;
  const olx_field *field;
  const olx_audit_settings *settings;
  const olx_space *space;
  place_verdict *places;
} space_audit;

// Draws points uniformly from free voxels and from the free parts of the voxels beside them.
static bool draw_place(const space_audit *a, uint32_t index, olx_vec3 *place) {
  for (uint32_t attempt = 0; attempt < ATTEMPTS; attempt++) {
    const uint32_t seed = olx_hash3(a->settings->seed ^ SALT_PLACE, index, attempt);
    const size_t nth = (size_t)((double)olx_unit_float(seed) * (double)a->space->start_count);
    if (olx_space_draw(a->space, nth, olx_hash(seed), place)) return true;
  }
  return false;
}

static void judge_place(void *user, uint32_t index) {
  const space_audit *a = user;
  place_verdict *v = &a->places[index];
  olx_vec3 place;
  if (!draw_place(a, index, &place)) return;
  v->valid = true;
  const uint32_t paths = a->settings->spp / PATHS_SHARE + 1, bounces = a->field->info.bounces.count + 1;
  for (uint32_t i = 0; i < NORMALS; i++) {
    olx_volume_light_at light;
    v->served = olx_volume_gather(a->field, place, normals[i], &light);
    v->volume[i] = olx_volume_irradiance(a->field, place, normals[i]);
    v->probes[i] = olx_irradiance(a->field, &a->settings->sample, place, normals[i], normals[i]);
    for (uint32_t half = 0; half < 2; half++) {
      const uint32_t seed = olx_hash3(a->settings->seed, index * NORMALS + i, half + 1);
      v->truth[half][i] = olx_path_irradiance(a->scene, place, normals[i], 0.0f, bounces, paths, seed);
    }
  }
}

typedef struct space_sums {
  double squared, reference_squared, difference, reference, dark_estimate;
  uint64_t count, dark;
} space_sums;

static void add_estimate(space_sums *s, olx_vec3 estimate, olx_vec3 first, olx_vec3 second) {
  const olx_vec3 truth = olx_scale(olx_add(first, second), 0.5f), d = olx_sub(estimate, truth);
  s->count++;
  s->squared += (double)olx_dot(olx_sub(estimate, first), olx_sub(estimate, second));
  s->reference_squared += (double)olx_dot(first, second);
  s->difference += (double)(d.x + d.y + d.z);
  s->reference += (double)(truth.x + truth.y + truth.z);
  if (olx_max3(truth) > 0.0f) return;
  s->dark++;
  s->dark_estimate += (double)(estimate.x + estimate.y + estimate.z);
}

static olx_audit_points errors_of(const space_sums *s) {
  return (olx_audit_points){
      .count = s->count,
      .relative_mse = s->reference_squared > 0.0 ? s->squared / s->reference_squared : 0.0,
      .bias = s->reference > 0.0 ? s->difference / s->reference : 0.0,
      .leak =
          s->dark && s->reference > 0.0 ? s->dark_estimate / (double)s->dark / (s->reference / (double)s->count) : 0.0,
  };
}

static void sum_places(const space_audit *a, olx_audit *out) {
  space_sums volume = {0}, probes = {0};
  uint64_t places = 0, served = 0;
  for (uint32_t i = 0; i < a->settings->space_points; i++) {
    const place_verdict *v = &a->places[i];
    if (!v->valid) continue;
    places++;
    served += v->served;
    for (uint32_t k = 0; k < NORMALS; k++) {
      add_estimate(&volume, v->volume[k], v->truth[0][k], v->truth[1][k]);
      add_estimate(&probes, v->probes[k], v->truth[0][k], v->truth[1][k]);
    }
  }
  out->space_volume = errors_of(&volume);
  if (a->field->info.irradiance.probe_count) out->space_probes = errors_of(&probes);
  out->space_served = places ? (double)served / (double)places : 0.0;
}

olx_result olx_audit_space(const olx_scene *scene, const olx_field *field, const olx_audit_settings *settings,
                           olx_task *task, olx_audit *out) {
  if (settings->space_points == 0) return OLX_OK;
  olx_space space;
  OLX_TRY(olx_space_create(scene, VOXELS, settings->threads, &space));
  space_audit a = {.scene = scene,
                   .field = field,
                   .settings = settings,
                   .space = &space,
                   .places = olx_allocate_zero(settings->space_points, sizeof *a.places)};
  olx_result result = a.places ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "audit: out of memory");
  if (result == OLX_OK) result = olx_parallel_for(settings->space_points, settings->threads, judge_place, &a, task, 1);
  if (result == OLX_OK) sum_places(&a, out);
  olx_release(a.places);
  olx_space_free(&space);
  return result;
}
