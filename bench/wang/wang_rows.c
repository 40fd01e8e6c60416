// Measures the rows of Wang's tables: bakes a field for each of their sets of probes, and measures errors and times.
#include "wang_rows.h"

#include <string.h>

static bool same_probes(const bench_probes *a, const bench_probes *b) {
  return memcmp(a->grid, b->grid, sizeof a->grid) == 0 && a->method == b->method && a->count == b->count &&
         a->optimize == b->optimize && a->texels == b->texels;
}

// Returns whether the thesis shows the row only in its appendix.
static bool is_series(const wang_row *row) {
  return row->shown && (strncmp(row->shown, "Fig. A", 6) == 0 || strncmp(row->shown, "Figs. A", 7) == 0);
}

olx_result wang_bake_sets(const wang_view *view, bool series, wang_measured *t) {
  for (uint32_t i = 0; i < view->plan->row_count; ++i) {
    if (!series && is_series(&view->plan->rows[i])) continue;
    wang_measured_row *row = &t->rows[t->row_count++];
    *row = (wang_measured_row){.row = &view->plan->rows[i], .set = t->set_count};
    for (const wang_measured_row *before = t->rows; before < row; ++before) {
      if (same_probes(&row->row->probes, &before->row->probes)) row->set = before->set;
    }
    if (row->set < t->set_count) continue;
    const bench_probes probes = wang_probes(view->b, &row->row->probes);
    const olx_result result = bench_bake_field(view->b, view->scene, &probes, &view->bake, &t->sets[t->set_count++]);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

// Measures errors. The errors of a set do not depend on the tracer, so that each selector of a set is rendered once.
olx_result wang_measure_errors(const wang_view *view, wang_measured *t, bool keep_pictures) {
  for (uint32_t i = 0; i < t->row_count; ++i) {
    wang_measured_row *row = &t->rows[i];
    uint32_t k = 0;
    while (k < i && (t->rows[k].set != row->set || t->rows[k].row->select != row->row->select)) ++k;
    row->quality = t->rows[k].quality;
    if (k < i) continue;
    const olx_result result = wang_compare(view, t->sets[row->set].field, row->row->tracer, row->row->select,
                                           wang_row_name(row).text, &row->quality, &row->pictures);
    if (!keep_pictures) bench_images_free(&row->pictures);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

// Times one round of one row: the glossy pass of every camera, in milliseconds of processor time.
static olx_result time_row(const wang_view *view, const wang_measured *t, wang_measured_row *row, uint32_t round) {
  olx_render_settings settings = wang_picture(view->b, OLX_METHOD_FIELD);
  settings.spp = settings.glossy_samples = settings.threads = 1;
  settings.sample.tracer = row->row->tracer;
  settings.sample.select = row->row->select;
  olx_render_stats sum = {0};
  for (uint32_t c = 0; c < view->references->cameras; ++c) {
    olx_image image;
    olx_render_stats stats;
    const olx_result result = olx_render(view->scene, t->sets[row->set].field, &view->references->camera[c], &settings,
                                         &view->b->progress, &image, &stats);
    if (result != OLX_OK) return result;
    olx_image_free(&image);
    sum.glossy_seconds += stats.glossy_seconds;
    sum.field_rays += stats.field_rays;
    sum.field_steps += stats.field_steps;
    sum.field_probes += stats.field_probes;
    sum.field_unresolved += stats.field_unresolved;
  }
  const double rays = sum.field_rays ? (double)sum.field_rays : 1.0;
  row->ms[round] = 1e3 * sum.glossy_seconds / view->references->cameras;
  row->steps = (double)sum.field_steps / rays;
  row->probes_tried = (double)sum.field_probes / rays;
  row->unresolved = (double)sum.field_unresolved / rays;
  return OLX_OK;
}

// Rows take turns, so that other work on the machine affects all alike.
olx_result wang_time_rows(const wang_view *view, wang_measured *t) {
  bench_progress(view->b, "timing");
  const uint32_t rounds = wang_rounds(view->b);
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t i = 0; i < t->row_count; ++i) {
      const olx_result result = time_row(view, t, &t->rows[i], round);
      if (result != OLX_OK) return result;
    }
  }
  for (uint32_t i = 0; i < t->row_count; ++i) t->rows[i].median_ms = bench_median(t->rows[i].ms, rounds);
  return OLX_OK;
}

bench_name wang_row_name(const wang_measured_row *row) { return bench_probes_name(&row->row->probes); }

void wang_close_sets(wang_measured *t) {
  for (uint32_t i = 0; i < t->set_count; ++i) bench_field_close(&t->sets[i]);
}
