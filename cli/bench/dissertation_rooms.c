// Figures 5.1 to 5.5: two rooms with a wall between them that is whole, or open at one end.
#include "experiment_list.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { GATHERED = 16, WAYS = 3, PATH_TEXT = 4096 };

static const bench_column columns[] = {
    {"opening", "opening", BENCH_NAME, NULL, "in the wall, from floor to ceiling"},
    {"way", "way", BENCH_NAME, NULL, NULL},
    {"width", "opening", BENCH_COUNT, "m", NULL},
    {"lit", "lit room", BENCH_QUALITY, NULL, "mean indirect diffuse light in the picture of the room with the lamp"},
    {"dark", "far room", BENCH_QUALITY, NULL, "the same of the room without"},
    {"dark_over_lit", "far over lit", BENCH_QUALITY, "%", NULL},
    {"dark_over_path", "far over path", BENCH_QUALITY, "%", "the far room's mean over the path tracer's"},
    {"over_classic", "far over classic's", BENCH_QUALITY, "%", "behind a whole wall all of it is leaked"},
    {"dark_relative_mse", "far room: relative MSE", BENCH_QUALITY, NULL, NULL},
};

static const bench_plot plots[] = {
    {.caption = "Light in the far room as the opening grows", .x = "width", .y = "dark_over_lit", .series = "way"},
};

typedef struct rooms {
  bench *b;
  olx_scene *scene;
  olx_camera cameras[2]; // lit and dark
  bench_images *reference;
  bench_table *table;
  float width;
} rooms;

static bool put_file(const char *path, const char *text) { return olx_write_file(path, text, strlen(text)) == OLX_OK; }

// The rooms with an opening of 0.8 m, and a slab that leaves `width` of it.
static olx_result load_narrowed(const bench *b, float width, olx_scene **scene) {
  char object[PATH_TEXT], material[PATH_TEXT], description[PATH_TEXT], text[1024];
  snprintf(object, sizeof object, "%s/slab.obj", b->folder.path);
  snprintf(material, sizeof material, "%s/slab.mtl", b->folder.path);
  snprintf(description, sizeof description, "%s/narrowed.json", b->folder.path);
  const double z = 2.0 - (double)width;
  snprintf(text, sizeof text,
           "mtllib slab.mtl\nusemtl slab\n"
           "v -0.1 0 1.2\nv 0.1 0 1.2\nv 0.1 3 1.2\nv -0.1 3 1.2\nv -0.1 0 %g\nv 0.1 0 %g\nv 0.1 3 %g\nv -0.1 3 %g\n"
           "f 5 6 7 8\nf 1 5 8 4\nf 6 2 3 7\n",
           z, z, z, z);
  bool written = put_file(object, text) && put_file(material, "newmtl slab\nKd 0.75 0.75 0.75\nKs 0 0 0\n");
  snprintf(text, sizeof text,
           "{\"models\": [{\"path\": \"builtin:two-rooms-gap\"}, {\"path\": \"slab.obj\"}],"
           " \"probes\": {\"min\": [-3, 0.75, -1], \"max\": [3, 2.25, 1], \"grid\": [4, 2, 2]}}");
  written = written && put_file(description, text);
  const olx_result result = written ? olx_scene_load(description, scene) : OLX_ERROR_FILE;
  unlink(object);
  unlink(material);
  unlink(description);
  return result;
}

static olx_result load_rooms(rooms *r, float width) {
  r->width = width;
  const char *name = width > 0.0f ? "builtin:two-rooms-gap" : "builtin:two-rooms-sealed";
  olx_result result =
      width > 0.0f && width < 0.8f ? load_narrowed(r->b, width, &r->scene) : olx_scene_load(name, &r->scene);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, "lit", &r->cameras[0]);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, "dark", &r->cameras[1]);
  return result;
}

static void add_row(rooms *r, const char *opening, const char *way, bench_images *images, double classic_dark) {
  const bench_error lit = bench_error_of(images, r->reference, BENCH_DIFFUSE, 0);
  const bench_error dark = bench_error_of(images, r->reference, BENCH_DIFFUSE, 1);
  const bool black = !(dark.reference_mean > 0.0), truth = images == r->reference;
  FINDINGS_ROW(&r->b->found, r->table, TEXT_CELL(opening), TEXT_CELL(way), NUMBER_CELL((double)r->width),
               NUMBER_CELL(lit.mean), NUMBER_CELL(dark.mean), NUMBER_CELL(dark.mean / lit.mean),
               NUMBER_CELL(black || truth ? NAN : dark.mean / dark.reference_mean),
               NUMBER_CELL(truth ? NAN : dark.mean / classic_dark),
               NUMBER_CELL(black || truth ? NAN : dark.relative_mse));
}

static olx_result measure(rooms *r, const olx_field *field, const char *opening) {
  bench_images images[WAYS] = {0};
  bench_shown shown[WAYS];
  bench_way ways[WAYS] = {{.name = "field"}, {.name = "field, gathered"}, {.name = "classic"}};
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < WAYS && result == OLX_OK; ++i) {
    ways[i].field = field;
    ways[i].settings = bench_field_settings(r->b);
    ways[i].settings.diffuse_samples = GATHERED;
    if (i == 1) ways[i].settings.diffuse = OLX_DIFFUSE_TRACED;
    if (i == 2) ways[i].settings.method = OLX_METHOD_CLASSIC;
    shown[i] = (bench_shown){.way = ways[i].name, .images = &images[i], .camera = 1};
    result = bench_pictures(r->b, r->scene, r->cameras, 2, &ways[i], &images[i]);
  }
  if (result == OLX_OK) {
    const double classic_dark = bench_error_of(&images[2], r->reference, BENCH_DIFFUSE, 1).mean;
    for (uint32_t i = 0; i < WAYS; ++i) add_row(r, opening, ways[i].name, &images[i], classic_dark);
    add_row(r, opening, "path traced", r->reference, classic_dark);
  }
  char view[64];
  snprintf(view, sizeof view, "far room, %s", opening);
  if (result == OLX_OK) result = bench_show(r->b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, WAYS, r->reference, 1);
  for (uint32_t i = 0; i < WAYS; ++i) bench_images_free(&images[i]);
  return result;
}

static olx_result run_rooms(rooms *r) {
  const olx_render_settings settings = bench_path_settings(r->b);
  const bench_probes probes = {.grid = {4, 2, 2}, .texels = 128};
  bench_bake bake = bench_bake_settings(r->b, true);
  bake.bounces = 2 * bench_bounces(r->b); // light that reaches the far room has been reflected often
  char opening[32];
  if (r->width > 0.0f) snprintf(opening, sizeof opening, "%.1f m", (double)r->width);
  else snprintf(opening, sizeof opening, "none");
  olx_result result = olx_scene_probe_grid(r->scene, probes.grid, &bake.irradiance_grid);
  if (result == OLX_OK) {
    result = bench_reference(r->b, r->scene, r->cameras, 2, &settings, bake.bounces + 1, &r->reference);
  }
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(r->b, r->scene, &probes, &bake, &made);
  if (result == OLX_OK) result = measure(r, made.field, opening);
  bench_field_close(&made);
  return result;
}

olx_result run_dissertation_rooms(bench *b) {
  static const float widths[] = {0.0f, 0.2f, 0.4f, 0.8f};
  bench_table *table = FINDINGS_TABLE(&b->found, "rooms", "Indirect diffuse light in both rooms", columns, plots);
  for (uint32_t i = 0; i < sizeof widths / sizeof *widths; ++i) {
    if (b->options->quick && i == 1) continue;
    rooms r = {.b = b, .table = table};
    olx_result result = load_rooms(&r, widths[i]);
    if (result == OLX_OK) result = run_rooms(&r);
    olx_scene_free(r.scene);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
