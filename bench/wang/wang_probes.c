// Compares placed sets of a half, a third and a quarter as many probes with grids, by pictures and by mirror rays, and
// so finds how few do as well as a grid.
#include "wang.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A set of probes with its measurements: its picture, and mirror rays of the cameras against the true triangles.
typedef struct finding {
  bench_probes probes;
  uint32_t count;
  wang_quality quality;
  olx_audit_rays mirror;
  double coverage, megabytes;
} finding;

static olx_result examine(wang_run *run, const bench_probes *wanted, finding *found) {
  found->probes = wang_probes(run, wanted);
  const bench_name name = bench_probes_name(&found->probes);
  wang_tell(run, "baking and rendering", name.text);
  bench_field made;
  olx_result result = bench_field_make(run->scene, &found->probes, &run->bake, &run->folder, 0, &run->progress, &made);
  if (result == OLX_OK) {
    found->count = made.info.probe_count;
    found->coverage = made.coverage;
    found->megabytes = (double)(made.info.radiance_bytes + made.info.normal_bytes + made.info.distance_bytes +
                                made.info.geometry_bytes) *
                       1e-6;
    result = wang_measure(run, made.field, OLX_TRACER_HIZ, OLX_SELECT_BEST, name.text, &found->quality, NULL);
  }
  if (result == OLX_OK) {
    olx_audit_settings audit = olx_audit_settings_default();
    audit.rays = run->options->quick ? 2000 : 20000;
    audit.points = 0;
    audit.threads = run->options->threads;
    olx_audit judged;
    result = olx_audit_field(run->scene, made.field, &audit, &run->progress, &judged);
    if (result == OLX_OK) found->mirror = judged.mirror;
  }
  bench_field_close(&made);
  return result;
}

// The error of a set over that of the best grid, of all cameras and of the camera that shows the set worst.
static double against(const finding *found, const finding *best) {
  return found->quality.glossy.mse / best->quality.glossy.mse;
}

static double worst_camera(const wang_run *run, const finding *found, const finding *best) {
  double worst = 0.0;
  for (uint32_t c = 0; c < run->references.cameras; ++c) {
    worst = fmax(worst, found->quality.glossy_camera[c].mse / best->quality.glossy_camera[c].mse);
  }
  return worst;
}

static void add_finding(const wang_run *run, cJSON *list, const finding *found, const finding *best) {
  cJSON *entry = cJSON_CreateObject();
  cJSON_AddItemToArray(list, entry);
  add_text(entry, "name", bench_probes_name(&found->probes).text);
  add_number(entry, "probes", found->count);
  add_number(entry, "texels", found->probes.texels);
  add_number(entry, "megabytes", found->megabytes);
  add_number(entry, "coverage", found->coverage);
  wang_add_error(entry, "glossy", &found->quality.glossy);
  wang_add_error(entry, "final", &found->quality.beauty);
  add_number(entry, "against_best_grid", against(found, best));
  add_number(entry, "against_best_grid_worst_camera", worst_camera(run, found, best));
  cJSON *cameras = cJSON_AddArrayToObject(entry, "cameras");
  for (uint32_t c = 0; c < run->references.cameras; ++c) {
    cJSON *camera = cJSON_CreateObject();
    cJSON_AddItemToArray(cameras, camera);
    wang_add_error(camera, run->references.camera[c].name, &found->quality.glossy_camera[c]);
  }
  add_number(entry, "unresolved", found->mirror.unresolved);
  add_number(entry, "wrong", found->mirror.wrong);
  add_number(entry, "unseen", found->mirror.unseen);
}

static void print_finding(const wang_run *run, const finding *found, const finding *best) {
  const bench_error *glossy = &found->quality.glossy;
  printf("| %s | %u | %.0f | %.3g ± %.1g | %.3g | %+.3f | %.2f | %.2f | %.3g | %.2f %% | %.2f %% | %.2f %% |\n",
         bench_probes_name(&found->probes).text, found->count, found->megabytes, glossy->mse, glossy->noise,
         glossy->relative_mse, glossy->bias, against(found, best), worst_camera(run, found, best),
         found->quality.beauty.mse, 100.0 * found->mirror.unseen, 100.0 * found->mirror.unresolved,
         100.0 * found->mirror.wrong);
}

enum { MOST_SHAPES = 8, CONTENDERS = 6 };

// Lists the sets that are compared with grids of n probes: Wang's pipeline with half as many, cover with as many as
// that, with a third, and with a quarter whose maps are twice as wide, which are as many texels.
static void list_contenders(uint32_t n, bench_probes list[CONTENDERS]) {
  const bench_probes all[CONTENDERS] = {
      {.method = OLX_PLACE_SDF, .count = n / 2, .optimize = OLX_OPTIMIZE_GIBBS, .texels = 512},
      {.method = OLX_PLACE_MEDIAL, .count = n / 2, .optimize = OLX_OPTIMIZE_GIBBS, .texels = 512},
      {.method = OLX_PLACE_COVER, .count = n / 2, .texels = 512},
      {.method = OLX_PLACE_COVER, .count = n / 3, .texels = 512},
      {.method = OLX_PLACE_COVER, .count = n / 4, .texels = 512},
      {.method = OLX_PLACE_COVER, .count = n / 4, .texels = 1024},
  };
  for (uint32_t i = 0; i < CONTENDERS; ++i) list[i] = all[i];
}

static void report(const wang_run *run, const finding *found, const finding *best, cJSON *list) {
  add_finding(run, list, found, best);
  if (!run->options->json) print_finding(run, found, best);
  fflush(stdout);
}

static olx_result run_size(wang_run *run, const wang_size *size, cJSON *list) {
  finding grids[MOST_SHAPES], contender;
  const uint32_t shapes = run->options->quick ? 2 : size->shape_count;
  uint32_t best = 0;
  for (uint32_t i = 0; i < shapes; ++i) {
    bench_probes grid = {.texels = 512};
    for (int k = 0; k < 3; ++k) grid.grid[k] = size->shapes[i][k];
    const olx_result result = examine(run, &grid, &grids[i]);
    if (result != OLX_OK) return result;
    if (grids[i].quality.glossy.mse < grids[best].quality.glossy.mse) best = i;
  }
  for (uint32_t i = 0; i < shapes; ++i) report(run, &grids[i], &grids[best], list);
  bench_probes contenders[CONTENDERS];
  list_contenders(size->probes, contenders);
  for (uint32_t i = 0; i < CONTENDERS; ++i) {
    const olx_result result = examine(run, &contenders[i], &contender);
    if (result != OLX_OK) return result;
    report(run, &contender, &grids[best], list);
  }
  return OLX_OK;
}

// The next of names with commas between: a file of probes or a grid such as 4x2x4, each with @TEXELS behind it or with maps
// of 512. `path` keeps the file's name.
static const char *next_set(const char *name, char path[4096], bench_probes *probes) {
  const size_t length = strcspn(name, ",");
  snprintf(path, 4096, "%.*s", (int)length, name);
  *probes = (bench_probes){.texels = 512, .file = path};
  char *texels = strchr(path, '@');
  if (texels) {
    probes->texels = (uint32_t)strtoul(texels + 1, NULL, 10);
    *texels = 0;
  }
  uint32_t *grid = probes->grid;
  int end = 0;
  if (sscanf(path, "%4ux%4ux%4u%n", &grid[0], &grid[1], &grid[2], &end) == 3 && !path[end]) probes->file = NULL;
  else grid[0] = 0;
  return name + length + (name[length] == ',');
}

static olx_result run_given(wang_run *run, cJSON *list) {
  finding first, found;
  bool any = false;
  for (const char *name = run->options->sets; *name;) {
    char path[4096];
    bench_probes probes;
    name = next_set(name, path, &probes);
    const olx_result result = examine(run, &probes, any ? &found : &first);
    if (result != OLX_OK) return result;
    report(run, any ? &found : &first, &first, list);
    any = true;
  }
  return OLX_OK;
}

olx_result wang_run_counts(wang_run *run, cJSON *object) {
  cJSON *list = cJSON_AddArrayToObject(object, "sets");
  if (!run->options->json) {
    printf("\n%s\n\n", run->experiment->name);
    printf("| set | probes | MB | glossy MSE | relative | bias | over best grid | worst camera | final MSE | unseen | "
           "unresolved | wrong |\n");
    printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  }
  if (run->options->sets) return run_given(run, list);
  for (uint32_t i = 0; i < run->experiment->size_count; ++i) {
    const olx_result result = run_size(run, &run->experiment->sizes[i], list);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
