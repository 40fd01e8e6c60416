// Measures the rows of Tables 5.1 and 5.2 of Wang's thesis, and the comparisons of its sections 5.1 and 5.2.
#include "wang.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *wang_tracer_name(olx_tracer tracer) {
  static const char *const names[] = {"texel", "two-level", "hiz"};
  return names[tracer];
}

static bool same_probes(const bench_probes *a, const bench_probes *b) {
  return memcmp(a->grid, b->grid, sizeof a->grid) == 0 && a->method == b->method && a->count == b->count &&
         a->optimize == b->optimize && a->texels == b->texels;
}

// Whether the thesis shows the row in its appendix alone: --short leaves these out.
static bool is_series(const wang_row *row) {
  return row->shown && (strncmp(row->shown, "Fig. A", 6) == 0 || strncmp(row->shown, "Figs. A", 7) == 0);
}

// Bakes a field for each different set of probes that the rows name.
olx_result wang_bake_sets(wang_run *run, wang_measured *t) {
  const wang_scene *experiment = run->experiment;
  for (uint32_t i = 0; i < experiment->row_count; ++i) {
    if (run->options->brief && is_series(&experiment->rows[i])) continue;
    wang_measured_row *row = &t->rows[t->row_count++];
    *row = (wang_measured_row){.row = &experiment->rows[i], .set = t->set_count};
    for (const wang_measured_row *before = t->rows; before < row; ++before) {
      if (same_probes(&row->row->probes, &before->row->probes)) row->set = before->set;
    }
    if (row->set < t->set_count) continue;
    const bench_probes probes = wang_probes(run, &row->row->probes);
    wang_tell(run, "baking", bench_probes_name(&probes).text);
    bench_field *made = &t->sets[t->set_count++];
    const olx_result result =
        bench_field_make(run->scene, &probes, &run->bake, &run->folder, row->set, &run->progress, made);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

// Measures errors. Those of a set are the same for every tracer, so each selector of a set is rendered once.
olx_result wang_measure_errors(wang_run *run, wang_measured *t, bool keep_pictures) {
  for (uint32_t i = 0; i < t->row_count; ++i) {
    wang_measured_row *row = &t->rows[i];
    uint32_t k = 0;
    while (k < i && (t->rows[k].set != row->set || t->rows[k].row->select != row->row->select)) ++k;
    row->quality = t->rows[k].quality;
    if (k < i) continue;
    const bench_probes probes = wang_probes(run, &row->row->probes);
    char name[128];
    snprintf(name, sizeof name, "%s %s", bench_probes_name(&probes).text, olx_select_name(row->row->select));
    wang_tell(run, "rendering", name);
    const olx_result result = wang_measure(run, t->sets[row->set].field, row->row->tracer, row->row->select, name,
                                           &row->quality, keep_pictures ? &row->pictures : NULL);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

// One round of one row: the glossy pass of every camera, on one processor, in milliseconds of its time.
static olx_result time_row(wang_run *run, const wang_measured *t, wang_measured_row *row, uint32_t round) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE; // as the papers have it
  settings.width = run->options->size[0];
  settings.height = run->options->size[1];
  settings.spp = settings.glossy_samples = settings.threads = 1;
  settings.sample.tracer = row->row->tracer;
  settings.sample.select = row->row->select;
  olx_render_stats sum = {0};
  for (uint32_t c = 0; c < run->references.cameras; ++c) {
    olx_image image;
    olx_render_stats stats;
    const olx_result result = olx_render(run->scene, t->sets[row->set].field, &run->references.camera[c], &settings,
                                         &run->progress, &image, &stats);
    if (result != OLX_OK) return result;
    olx_image_free(&image);
    sum.glossy_seconds += stats.glossy_seconds;
    sum.field_rays += stats.field_rays;
    sum.field_steps += stats.field_steps;
    sum.field_probes += stats.field_probes;
    sum.field_unresolved += stats.field_unresolved;
  }
  const double rays = sum.field_rays ? (double)sum.field_rays : 1.0;
  row->ms[round] = 1e3 * sum.glossy_seconds / run->references.cameras;
  row->steps = (double)sum.field_steps / rays;
  row->probes_tried = (double)sum.field_probes / rays;
  row->unresolved = (double)sum.field_unresolved / rays;
  return OLX_OK;
}

// Times the rows in turns, so that what else the machine does affects all of them alike.
olx_result wang_time_rows(wang_run *run, wang_measured *t) {
  wang_tell(run, "timing", "");
  const uint32_t rounds = run->options->rounds;
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t i = 0; i < t->row_count; ++i) {
      const olx_result result = time_row(run, t, &t->rows[i], round);
      if (result != OLX_OK) return result;
    }
  }
  for (uint32_t i = 0; i < t->row_count; ++i) t->rows[i].median_ms = bench_median(t->rows[i].ms, rounds);
  return OLX_OK;
}

void wang_close_sets(wang_measured *t) {
  for (uint32_t i = 0; i < t->set_count; ++i) bench_field_close(&t->sets[i]);
}

static void add_row(const wang_run *run, const wang_measured *t, const wang_measured_row *row, cJSON *list) {
  const bench_probes probes = wang_probes(run, &row->row->probes);
  cJSON *entry = cJSON_CreateObject();
  cJSON_AddItemToArray(list, entry);
  add_text(entry, "name", bench_probes_name(&probes).text);
  add_number(entry, "probes", t->sets[row->set].info.probe_count);
  add_text(entry, "tracer", wang_tracer_name(row->row->tracer));
  add_text(entry, "select", olx_select_name(row->row->select));
  add_number(entry, "ms", row->median_ms);
  add_number(entry, "speedup", t->rows[0].median_ms / row->median_ms);
  add_number(entry, "steps_mean", row->steps);
  add_number(entry, "probes_mean", row->probes_tried);
  add_number(entry, "unresolved", row->unresolved);
  wang_add_error(entry, "glossy", &row->quality.glossy);
  wang_add_error(entry, "final", &row->quality.beauty);
  if (row->row->shown) add_text(entry, "shown", row->row->shown);
  if (row->row->ms > 0.0) add_number(entry, "published_ms", row->row->ms);
  if (row->row->mse > 0.0) add_number(entry, "published_mse", row->row->mse);
}

static void print_row(const wang_run *run, const wang_measured *t, const wang_measured_row *row) {
  const bench_probes probes = wang_probes(run, &row->row->probes);
  const double *published = &row->row->ms;
  char theirs[32] = "";
  if (*published > 0.0 && t->rows[0].row->ms > 0.0) {
    snprintf(theirs, sizeof theirs, "%.2f", t->rows[0].row->ms / *published);
  }
  printf("| %s | %s | %s | %.1f | %.2f | %s | %.1f | %.2f | %.2f %% | %.3g | %.3g | %.3g | %s |\n",
         bench_probes_name(&probes).text, wang_tracer_name(row->row->tracer), olx_select_name(row->row->select),
         row->median_ms, t->rows[0].median_ms / row->median_ms, theirs, row->steps, row->probes_tried,
         100.0 * row->unresolved, row->quality.glossy.mse, row->quality.glossy.relative_mse, row->quality.beauty.mse,
         row->row->shown ? row->row->shown : "");
}

static const double MIB = 1048576.0;

static void add_memory(const wang_run *run, const wang_measured *t, cJSON *list) {
  uint32_t listed = 0;
  for (uint32_t i = 0; i < t->row_count; ++i) {
    const wang_measured_row *row = &t->rows[i];
    if (row->set < listed) continue;
    listed = row->set + 1;
    const olx_field_info *info = &t->sets[row->set].info;
    const bench_probes probes = wang_probes(run, &row->row->probes);
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(list, entry);
    add_text(entry, "name", bench_probes_name(&probes).text);
    add_number(entry, "probes", info->probe_count);
    add_number(entry, "distance", (double)info->distance_bytes);
    add_number(entry, "geometry", (double)info->geometry_bytes);
    add_number(entry, "pyramid", (double)info->pyramid_bytes);
    add_number(entry, "radiance", (double)info->radiance_bytes);
    add_number(entry, "normal", (double)info->normal_bytes);
    add_number(entry, "irradiance", (double)(info->irradiance_bytes + info->moments_bytes));
    for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_EXHAUSTIVE; ++select) {
      add_number(entry, olx_select_name(select), (double)info->select_bytes[select]);
    }
    add_number(entry, "maps", (double)(info->file_bytes - info->selector_bytes));
    add_number(entry, "place_seconds", t->sets[row->set].place_seconds);
    add_number(entry, "bake_seconds", t->sets[row->set].bake_seconds);
  }
}

static void print_memory(const cJSON *list) {
  static const char *const keys[] = {"distance", "pyramid", "radiance", "normal", "irradiance",
                                     "maps",     "voronoi", "octree",   "bricks"};
  printf("\n| MiB | distance | pyramid | radiance | normal | irradiance | all maps | voronoi | octree | bricks |\n");
  printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  const cJSON *entry;
  cJSON_ArrayForEach(entry, list) {
    printf("| %s |", cJSON_GetObjectItem(entry, "name")->valuestring);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; ++k) {
      printf(" %.2f |", cJSON_GetObjectItem(entry, keys[k])->valuedouble / MIB);
    }
    putchar('\n');
  }
}

static void report_tables(const wang_run *run, const wang_measured *t, cJSON *object) {
  cJSON *rows = cJSON_AddArrayToObject(object, "rows"), *memory = cJSON_AddArrayToObject(object, "memory");
  for (uint32_t i = 0; i < t->row_count; ++i) add_row(run, t, &t->rows[i], rows);
  add_memory(run, t, memory);
  if (run->options->json) return;
  printf("\n%s\n\n", run->experiment->name);
  printf("| probes | tracer | selector | ms | times as fast | published | steps a ray | probes a ray | unresolved | "
         "glossy MSE | relative | final MSE | shown in |\n");
  printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (uint32_t i = 0; i < t->row_count; ++i) print_row(run, t, &t->rows[i]);
  print_memory(memory);
  fflush(stdout);
}

olx_result wang_run_tables(wang_run *run, cJSON *object) {
  wang_measured *t = calloc(1, sizeof *t);
  if (!t) return OLX_ERROR_MEMORY;
  olx_result result = wang_bake_sets(run, t);
  if (result == OLX_OK) result = wang_measure_errors(run, t, false);
  if (result == OLX_OK) result = wang_time_rows(run, t);
  if (result == OLX_OK) report_tables(run, t, object);
  wang_close_sets(t);
  free(t);
  return result;
}
