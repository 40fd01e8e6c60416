// Compares placed sets of a half, a third and a quarter as many probes with grids, by images and by mirror rays, to
// find how few probes match a grid.
#include "experiment_list.h"
#include "wang_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "set", BENCH_NAME, NULL, NULL},
    {"probes", "probes", BENCH_COUNT, NULL, NULL},
    {"texels", "texels", BENCH_COUNT, NULL, "along a map"},
    {"mb", "size", BENCH_COUNT, "MB", NULL},
    {"coverage", "covered", BENCH_QUALITY, "%", "by placed probes"},
    {"glossy_mse", "glossy MSE", BENCH_QUALITY, NULL, "against one bounce path traced, mean over the cameras"},
    {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},
    {"glossy_relative_mse", "relative MSE", BENCH_QUALITY, NULL, NULL},
    {"bias", "bias", BENCH_QUALITY, "%", "light too much or missing, over the reference's mean"},
    {"over_grid", "over the best grid", BENCH_QUALITY, NULL,
     "glossy MSE over that of the best grid, or of the first set"},
    {"worst", "worst camera", BENCH_QUALITY, NULL, "the same of the camera that shows the set worst"},
    {"final_mse", "final MSE", BENCH_QUALITY, NULL, "of all indirect light"},
    {"unseen", "unseen", BENCH_QUALITY, "%", "mirror rays whose end no probe sees"},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "mirror rays that no probe could answer"},
    {"wrong", "wrong", BENCH_QUALITY, "%", "mirror rays that end elsewhere than on the triangles"},
};
static const bench_plot plots[] = {{.caption = "Glossy error over that of the best grid", .y = "over_grid"}};

static const bench_column camera_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "set", BENCH_NAME, NULL, NULL},
    {"camera", "camera", BENCH_NAME, NULL, NULL},
    {"glossy_mse", "glossy MSE", BENCH_QUALITY, NULL, NULL},
    {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},
    {"glossy_relative_mse", "relative MSE", BENCH_QUALITY, NULL, NULL},
    {"bias", "bias", BENCH_QUALITY, "%", NULL},
};

// A scene, and the list of its sets.
typedef struct contest {
  wang_view view;
  bench_table *sets, *cameras;
} contest;

// The measurements of a set of probes: its image, and mirror rays of the cameras against the true triangles.
typedef struct finding {
  bench_probes probes;
  uint32_t count;
  wang_quality quality;
  olx_audit_rays mirror;
  double coverage, megabytes;
} finding;

static olx_result trace_mirrors(const wang_view *view, const olx_field *field, olx_audit_rays *mirror) {
  const bench_options *o = view->b->options;
  olx_audit_settings audit = olx_audit_settings_default();
  audit.rays = o->quick ? 2000 : 20000;
  audit.points = 0;
  audit.threads = o->threads;
  olx_audit judged;
  const olx_result result = olx_audit_field(view->scene, field, &audit, &view->b->progress, &judged);
  if (result == OLX_OK) *mirror = judged.mirror;
  return result;
}

// Shows a set's image in the report and writes it for --images.
static olx_result show(const wang_view *view, const char *name, bench_images *pictures) {
  for (uint32_t c = 0; c < pictures->cameras; ++c) {
    const bench_shown shown = {.way = name, .images = pictures, .camera = c};
    char title[192];
    snprintf(title, sizeof title, "%s, %s, %s", view->plan->name, pictures->camera[c].name, name);
    const olx_result result = bench_show(view->b, title, OLX_LAYER_INDIRECT_GLOSSY, &shown, 1, view->references, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

static olx_result judge(const wang_view *view, const bench_field *made, finding *found) {
  const olx_field_info *info = &made->info;
  const bench_name name = bench_probes_name(&found->probes);
  bench_images pictures;
  found->count = info->probes.count;
  found->coverage = made->coverage;
  found->megabytes = (double)(bench_geometry_bytes(info) + bench_light_bytes(info)) * 1e-6;
  olx_result result =
      wang_compare(view, made->field, OLX_TRACER_HIZ, OLX_SELECT_BEST, name.text, &found->quality, &pictures);
  if (result == OLX_OK) result = show(view, name.text, &pictures);
  bench_images_free(&pictures);
  return result == OLX_OK ? trace_mirrors(view, made->field, &found->mirror) : result;
}

static olx_result examine(const wang_view *view, const bench_probes *wanted, finding *found) {
  bench_field made;
  found->probes = wang_probes(view->b, wanted);
  olx_result result = bench_bake_field(view->b, view->scene, &found->probes, &view->bake, &made);
  if (result == OLX_OK) result = judge(view, &made, found);
  bench_field_close(&made);
  return result;
}

// Returns the ratio of a set's error to that of the best grid, for the camera with the greatest ratio.
static double worst_camera(const wang_view *view, const finding *found, const finding *best) {
  double worst = 0.0;
  for (uint32_t c = 0; c < view->references->cameras; ++c) {
    worst = fmax(worst, found->quality.glossy_camera[c].mse / best->quality.glossy_camera[c].mse);
  }
  return worst;
}

static void add_cameras(const contest *c, const finding *found) {
  const wang_view *view = &c->view;
  for (uint32_t i = 0; i < view->references->cameras; ++i) {
    const bench_error *e = &found->quality.glossy_camera[i];
    FINDINGS_ROW(&view->b->found, c->cameras, TEXT_CELL(view->plan->name),
                 TEXT_CELL(bench_probes_name(&found->probes).text), TEXT_CELL(view->references->camera[i].name),
                 NUMBER_CELL(e->mse), NUMBER_CELL(e->noise), NUMBER_CELL(e->relative_mse), NUMBER_CELL(e->bias));
  }
}

static void add_finding(const contest *c, const finding *found, const finding *best) {
  const wang_view *view = &c->view;
  const bench_error *glossy = &found->quality.glossy;
  FINDINGS_ROW(&view->b->found, c->sets, TEXT_CELL(view->plan->name), TEXT_CELL(bench_probes_name(&found->probes).text),
               NUMBER_CELL(found->count), NUMBER_CELL(found->probes.texels), NUMBER_CELL(found->megabytes),
               NUMBER_CELL(found->coverage > 0.0 ? found->coverage : NAN), NUMBER_CELL(glossy->mse),
               NUMBER_CELL(glossy->noise), NUMBER_CELL(glossy->relative_mse), NUMBER_CELL(glossy->bias),
               NUMBER_CELL(glossy->mse / best->quality.glossy.mse), NUMBER_CELL(worst_camera(view, found, best)),
               NUMBER_CELL(found->quality.beauty.mse), NUMBER_CELL(found->mirror.unseen),
               NUMBER_CELL(found->mirror.unresolved), NUMBER_CELL(found->mirror.wrong));
  add_cameras(c, found);
}

enum { MOST_SHAPES = 8, CONTENDERS = 6 };

// Lists the sets that are compared with grids of n probes: Wang's pipeline with half as many; cover with as many as
// that pipeline, with a third of n, and with a quarter of n whose maps are twice as wide, so that they have as many
// texels.
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

static olx_result run_contenders(const contest *c, uint32_t n, const finding *best) {
  bench_probes contenders[CONTENDERS];
  list_contenders(n, contenders);
  for (uint32_t i = 0; i < CONTENDERS; ++i) {
    finding found;
    const olx_result result = examine(&c->view, &contenders[i], &found);
    if (result != OLX_OK) return result;
    add_finding(c, &found, best);
  }
  return OLX_OK;
}

static olx_result run_size(const contest *c, const wang_size *size) {
  finding grids[MOST_SHAPES];
  const uint32_t shapes = c->view.b->options->quick ? 2 : size->shape_count;
  uint32_t best = 0;
  for (uint32_t i = 0; i < shapes; ++i) {
    bench_probes grid = {.texels = 512};
    for (int k = 0; k < 3; ++k) grid.grid[k] = size->shapes[i][k];
    const olx_result result = examine(&c->view, &grid, &grids[i]);
    if (result != OLX_OK) return result;
    if (grids[i].quality.glossy.mse < grids[best].quality.glossy.mse) best = i;
  }
  for (uint32_t i = 0; i < shapes; ++i) add_finding(c, &grids[i], &grids[best]);
  return run_contenders(c, size->probes, &grids[best]);
}

// Parses the next of several names separated by commas: a file of probes or a grid such as 4x2x4, each followed by
// @TEXELS or with maps of 512. `path` receives the file's name.
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

static olx_result run_given(const contest *c) {
  finding first, found;
  bool any = false;
  for (const char *name = c->view.b->options->sets; *name;) {
    char path[4096];
    bench_probes probes;
    name = next_set(name, path, &probes);
    const olx_result result = examine(&c->view, &probes, any ? &found : &first);
    if (result != OLX_OK) return result;
    add_finding(c, any ? &found : &first, &first);
    any = true;
  }
  return OLX_OK;
}

static olx_result run_scene(contest *c, uint32_t scene) {
  bench *b = c->view.b;
  olx_result result = wang_open(b, scene, &c->view);
  if (result != OLX_OK || !c->view.scene) return result;
  if (b->options->sets) return run_given(c);
  for (uint32_t i = 0; i < c->view.plan->size_count && result == OLX_OK; ++i) {
    result = run_size(c, &c->view.plan->sizes[i]);
  }
  return result;
}

olx_result run_wang_probes(bench *b) {
  contest c = {.view = {.b = b}};
  c.sets = FINDINGS_TABLE(&b->found, "sets", "Sets of probes against the best of several grids", columns, plots);
  c.cameras = findings_table(&b->found, "cameras", "The same, camera by camera", camera_columns,
                             sizeof camera_columns / sizeof *camera_columns, NULL, 0);
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < WANG_SCENES && result == OLX_OK; ++i) {
    if (!wang_leaves_out(b, i)) result = run_scene(&c, i);
  }
  return result;
}
