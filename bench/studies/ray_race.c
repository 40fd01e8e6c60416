// Races rays through a field against ray casting: ray-race SCENE FIELD.olx [RAYS]. The rays leave surfaces that the
// field's probes see, cosine-distributed and in random order. Embree, whose row includes the surface at the hit but no
// light, olx_trace and olx_trace_rays, both without and with light, take turns on batches on one thread. Prints a
// Markdown table with the processor time of each.
#include "core/sampling.h"
#include "field/field_data.h"
#include "options.h"
#include "scene/bvh.h"
#include "scene/scene_data.h"
#include "scene/surface.h"
#include "studies.h"

#include <octalux/octalux.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const char NAME[] = BENCH_PROGRAM " ray-race";

enum { BATCH = 1000, RUNNERS = 5, SALT_PROBE = 1, SALT_VIEW, SALT_RAY };

// A batch of rays, and what the runners find on them.
typedef struct batch {
  const olx_scene *scene;
  const olx_field *field;
  olx_ray rays[BATCH];
  olx_vec3 origins[BATCH], directions[BATCH];
  olx_surface surfaces[BATCH];
  olx_trace_hit hits[BATCH];
} batch;

static void by_embree(batch *b) {
  for (uint32_t i = 0; i < BATCH; i++) {
    const olx_ray_hit hit = olx_bvh_intersect(b->scene->bvh, &b->rays[i]);
    if (hit.triangle != OLX_NO_HIT) b->surfaces[i] = olx_surface_at(b->scene, &hit, b->rays[i].direction);
  }
}

// Rays together are fast with bricks, which every baked field has.
static olx_sample_settings with_bricks(bool visibility_only) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.select = OLX_SELECT_BRICKS;
  settings.visibility_only = visibility_only;
  return settings;
}

static void one_by_one(batch *b, bool visibility_only) {
  const olx_sample_settings settings = with_bricks(visibility_only);
  for (uint32_t i = 0; i < BATCH; i++) {
    b->hits[i] = olx_trace(b->field, &settings, b->origins[i], b->directions[i], INFINITY);
  }
}

static void together(batch *b, bool visibility_only) {
  const olx_sample_settings settings = with_bricks(visibility_only);
  olx_trace_rays(b->field, &settings, BATCH, b->origins, b->directions, INFINITY, b->hits);
}

static void by_trace(batch *b) { one_by_one(b, false); }
static void by_trace_alone(batch *b) { one_by_one(b, true); }
static void by_trace_rays(batch *b) { together(b, false); }
static void by_trace_rays_alone(batch *b) { together(b, true); }

static const struct {
  const char *name;
  void (*run)(batch *);
} runners[RUNNERS] = {{"Embree, with the surface", by_embree},
                      {"olx_trace, visibility only", by_trace_alone},
                      {"olx_trace_rays, visibility only", by_trace_rays_alone},
                      {"olx_trace", by_trace},
                      {"olx_trace_rays", by_trace_rays}};

// Makes the ray numbered `index`; false when the drawn probe sees no surface in the drawn direction.
static bool make_ray(const batch *b, uint32_t index, olx_ray *ray) {
  const uint32_t probe = olx_hash2(index, SALT_PROBE) % b->field->info.probes.count;
  if (b->field->probe_flags[probe] & OLX_PROBE_BURIED) return false;
  const olx_ray view = {.origin = b->field->probe_positions[probe],
                        .direction = olx_sample_sphere(olx_stratified2(index, SALT_VIEW)),
                        .t_max = INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(b->scene->bvh, &view);
  if (hit.triangle == OLX_NO_HIT) return false;
  const olx_surface surface = olx_surface_at(b->scene, &hit, view.direction);
  const olx_vec3 cosine = olx_sample_cosine(olx_stratified2(index, SALT_RAY));
  *ray = olx_surface_ray(&surface, olx_from_basis(cosine, surface.geometric_normal), INFINITY);
  return true;
}

// Fills the batch with rays from number *next on; false when few probes see surfaces.
static bool fill(batch *b, uint32_t *next) {
  const uint32_t most = *next + 64 * BATCH;
  for (uint32_t i = 0; i < BATCH; i++) {
    while (!make_ray(b, (*next)++, &b->rays[i])) {
      if (*next > most) return false;
    }
    b->origins[i] = b->rays[i].origin;
    b->directions[i] = b->rays[i].direction;
  }
  return true;
}

static int race(batch *b, uint32_t batches) {
  clock_t spent[RUNNERS] = {0};
  uint32_t next = 0;
  for (uint32_t k = 0; k < batches; k++) {
    if (!fill(b, &next)) return failure(NAME, "the probes see too few surfaces");
    for (uint32_t turn = 0; turn < RUNNERS; turn++) {
      const uint32_t r = (turn + k) % RUNNERS;
      const clock_t start = clock();
      runners[r].run(b);
      spent[r] += clock() - start;
    }
  }
  printf("%u probes of %u^2, %u rays\n\n| rays | ns a ray | of Embree |\n|---|---|---|\n", b->field->info.probes.count,
         b->field->info.maps.size, batches * BATCH);
  for (uint32_t r = 0; r < RUNNERS; r++) {
    printf("| %s | %.0f | %.2f |\n", runners[r].name, 1e9 * (double)spent[r] / CLOCKS_PER_SEC / (batches * BATCH),
           (double)spent[r] / (double)spent[0]);
  }
  return 0;
}

int study_ray_race(int argc, char **argv) {
  const long count = argc > 3 ? strtol(argv[3], NULL, 10) : 100000;
  if (count < BATCH || count > 1 << 26) return usage_error(NAME, "'%s' is not a number of rays from 1000 on", argv[3]);
  olx_scene *scene;
  if (olx_scene_load(argv[1], &scene) != OLX_OK) return library_failure(NAME);
  olx_field *field;
  // Verification reads every page of the mapped file, so that no ray waits for one.
  if (olx_field_open(argv[2], &field) != OLX_OK || olx_field_verify(field) != OLX_OK) {
    olx_scene_free(scene);
    return library_failure(NAME);
  }
  batch *b = calloc(1, sizeof *b);
  if (b) *b = (batch){.scene = scene, .field = field};
  const int code = b ? race(b, (uint32_t)(count / BATCH)) : failure(NAME, "out of memory");
  free(b);
  olx_field_close(field);
  olx_scene_free(scene);
  return code;
}
