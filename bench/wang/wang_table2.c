// Repeats Table 5.2 of Wang's thesis: the memory that sets of probes of the same quality take.
#include "experiment_list.h"
#include "wang_study.h"

#include <math.h>
#include <string.h>

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "probes", BENCH_NAME, NULL, NULL},
    {"geometry", "geometry", BENCH_COUNT, "MiB", "planes, or distances and normals, with the pyramid"},
    {"published_distance", "published", BENCH_PUBLISHED, "MB", "distances"},
    {"other", "other textures", BENCH_COUNT, "MiB", "light and material of light field probes, irradiance and moments"},
    {"published_other", "published", BENCH_PUBLISHED, "MB", "with normals"},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes",
     "of both, in the maps that were baked, but for irradiance and moments"},
    {"octree", "octree", BENCH_QUALITY, "MiB", "Wang's selector as we store it, for the maps that were baked"},
    {"published_octree", "published", BENCH_PUBLISHED, "MB", NULL},
    {"bricks", "bricks", BENCH_QUALITY, "MiB", "our selector in its place, for the same"},
    {"total", "total with octree", BENCH_QUALITY, "MiB", NULL},
    {"published_total", "published", BENCH_PUBLISHED, "MB", NULL},
    {"place_s", "placing", BENCH_TIME, "s", NULL},
    {"bake_s", "bake", BENCH_TIME, "s", "with all selectors"},
};

// The published values. The thesis's rows of grids contradict each other (docs/experiments.md).
static const struct published {
  uint32_t scene;
  const char *set;
  double distance, other, octree, total;
} published[] = {
    {0, "7 sdf + gibbs", 9.33, 12.25, 15.41, 36.99},      {0, "2x2x2 grid", 4.57, 14.88, NAN, 19.45},
    {1, "16 sdf + gibbs", 21.33, 28.0, 61.21, 110.54},    {1, "4x2x4 grid", 13.71, 59.52, NAN, 73.23},
    {2, "54 medial + gibbs", 72.0, 94.0, 243.23, 409.23}, {2, "8x4x4 grid", 146.29, 238.08, NAN, 384.37},
};

static const double MIB = 1048576.0;

// Returns the size of maps scaled by texels to 512 along a side.
static double at_512(uint64_t bytes, uint32_t texels) {
  const double scale = 512.0 / texels;
  return (double)bytes / MIB * scale * scale;
}

static void add_set(bench *b, bench_table *table, const struct published *p, const bench_field *set) {
  const olx_field_info *info = &set->info;
  const double geometry = at_512(bench_geometry_bytes(info), info->maps.size);
  const double other =
      at_512(bench_light_bytes(info), info->maps.size) + (double)(info->bytes.irradiance + info->bytes.moments) / MIB;
  const bool placed = !info->probes.has_grid;
  const double octree = placed ? (double)info->bytes.select[OLX_SELECT_OCTREE] / MIB : NAN;
  FINDINGS_ROW(&b->found, table, TEXT_CELL(wang_scenes[p->scene].name), TEXT_CELL(p->set), NUMBER_CELL(geometry),
               NUMBER_CELL(p->distance), NUMBER_CELL(other), NUMBER_CELL(p->other),
               NUMBER_CELL(bench_texel_bytes(info)), NUMBER_CELL(octree), NUMBER_CELL(p->octree),
               NUMBER_CELL(placed ? (double)info->bytes.select[OLX_SELECT_BRICKS] / MIB : NAN),
               NUMBER_CELL(geometry + other + (placed ? octree : 0.0)), NUMBER_CELL(p->total),
               NUMBER_CELL(placed ? set->place_seconds : NAN), NUMBER_CELL(set->bake_seconds));
}

olx_result run_wang_table2(bench *b) {
  bench_table *table = findings_table(&b->found, "memory", "Memory with maps of 512\u00b2 texels", columns,
                                      sizeof columns / sizeof *columns, NULL, 0);
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    wang_measured *t;
    const olx_result result = wang_study_scene(b, i, 0, false, &t);
    if (result != OLX_OK) return result;
    for (size_t k = 0; t && k < sizeof published / sizeof *published; ++k) {
      uint32_t r = 0;
      while (r < t->row_count && strcmp(wang_row_name(&t->rows[r]).text, published[k].set) != 0) ++r;
      if (published[k].scene == i && r < t->row_count) add_set(b, table, &published[k], &t->sets[t->rows[r].set]);
    }
  }
  return OLX_OK;
}
