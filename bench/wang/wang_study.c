// Measures the sets of probes of Wang's thesis once per run, and provides rows and images to the experiments that need
// them.
#include "wang_study.h"

#include <stdio.h>
#include <stdlib.h>

enum { SHOWN_CAMERAS = 2 };

typedef struct wang_study {
  wang_measured *measured[WANG_SCENES];
} wang_study;

static void release_study(void *shared) {
  wang_study *study = shared;
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    for (uint32_t r = 0; study->measured[i] && r < study->measured[i]->row_count; ++r) {
      bench_images_free(&study->measured[i]->rows[r].pictures);
    }
    free(study->measured[i]);
  }
}

static olx_result measure_rows(const wang_view *view, uint32_t parts, bool series, wang_measured *t) {
  bench *b = view->b;
  t->references = view->references;
  olx_result result = wang_bake_sets(view, series, t);
  if (result == OLX_OK && parts & WANG_ERRORS) {
    result = wang_measure_errors(view, t, b->section || b->options->images);
  }
  if (result == OLX_OK && parts & WANG_TIMES) result = wang_time_rows(view, t);
  wang_close_sets(t);
  return result;
}

static olx_result measure_scene(bench *b, wang_study *study, uint32_t scene, uint32_t parts, bool series) {
  wang_view view;
  const olx_result result = wang_open(b, scene, &view);
  if (result != OLX_OK || !view.scene) return result;
  study->measured[scene] = calloc(1, sizeof *study->measured[scene]);
  return study->measured[scene] ? measure_rows(&view, parts, series, study->measured[scene]) : OLX_ERROR_MEMORY;
}

olx_result wang_study_scene(bench *b, uint32_t scene, uint32_t parts, bool series, wang_measured **measured) {
  wang_study *study = bench_shared(b, sizeof *study, release_study);
  *measured = NULL;
  if (!study) return OLX_ERROR_MEMORY;
  if (wang_leaves_out(b, scene)) return OLX_OK;
  if (!study->measured[scene]) {
    const uint32_t needed = b->options->several ? WANG_ERRORS | WANG_TIMES : parts;
    const olx_result result = measure_scene(b, study, scene, needed, series);
    if (result != OLX_OK) return result;
  }
  *measured = study->measured[scene];
  return OLX_OK;
}

const char *wang_tracer_name(olx_tracer tracer) {
  static const char *const names[] = {"texel", "two-level", "hiz"};
  return names[tracer];
}

olx_result wang_study_show(bench *b, uint32_t scene, const uint32_t *rows, uint32_t count, olx_layer layer) {
  const wang_study *study = bench_shared(b, sizeof *study, release_study);
  wang_measured *t = study->measured[scene];
  bench_shown shown[WANG_ROWS];
  char names[WANG_ROWS][128];
  if (!b->section && !b->options->images) return OLX_OK;
  for (uint32_t c = 0; c < t->references->cameras && c < SHOWN_CAMERAS; ++c) {
    for (uint32_t i = 0; i < count; ++i) {
      wang_measured_row *row = &t->rows[rows[i]];
      snprintf(names[i], sizeof names[i], "%s, %s", wang_row_name(row).text, olx_select_name(row->row->select));
      shown[i] = (bench_shown){.way = names[i], .images = &row->pictures, .camera = c};
    }
    char view[128];
    snprintf(view, sizeof view, "%s, %s", wang_scenes[scene].name, t->references->camera[c].name);
    const olx_result result = bench_show(b, view, layer, shown, count, t->references, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
