// Measures the sets of probes of Wang's thesis once in a run, and hands scenes, rows and pictures to the experiments
// that draw on them.
#include "wang_study.h"

#include "studies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_ROWS = 8, SHOWN_CAMERAS = 2 };

struct wang_study {
  wang_options options;
  wang_measured *measured[WANG_SCENES];
  bench_images references[WANG_SCENES];
  char absent[WANG_SCENES][320]; // why it is left out
};

// Small maps, because there are some fifty sets of up to 128 probes; octalux-bench wang has the thesis's.
static void set_sizes(wang_options *o) {
  if (!o->size[0]) memcpy(o->size, (uint32_t[]){96, 54}, sizeof o->size);
  if (!o->spp) o->spp = 32;
  o->field_spp = 2;
  o->texels = 128;
  o->rounds = 3;
}

static wang_study *open_study(bench *b) {
  if (b->wang) return b->wang;
  wang_study *study = calloc(1, sizeof *study);
  if (!study) return NULL;
  const bench_options *o = b->options;
  study->options = (wang_options){.scene = WANG_SCENES,
                                  .folder = o->folder,
                                  .spp = o->spp,
                                  .threads = o->threads,
                                  .quick = o->quick,
                                  .brief = true};
  memcpy(study->options.size, o->size, sizeof o->size);
  if (!o->quick) set_sizes(&study->options);
  wang_resolve(&study->options);
  return b->wang = study;
}

static olx_result measure(bench *b, wang_run *run, uint32_t parts, wang_measured *t) {
  olx_result result = wang_bake_sets(run, t);
  if (result == OLX_OK && parts & WANG_ERRORS) {
    result = wang_measure_errors(run, t, b->section || b->options->images);
  }
  if (result == OLX_OK && parts & WANG_TIMES) result = wang_time_rows(run, t);
  wang_close_sets(t);
  return result;
}

static olx_result run_scene(bench *b, wang_study *study, uint32_t scene, uint32_t parts) {
  wang_run run = {.options = &study->options,
                  .experiment = &wang_scenes[scene],
                  .folder = b->folder,
                  .progress = b->progress,
                  .told = b->told};
  olx_result result = wang_load_scene(&run);
  if (result == OLX_ERROR_FILE) {
    snprintf(study->absent[scene], sizeof study->absent[scene], "%s", olx_last_error());
    return OLX_OK;
  }
  if (result != OLX_OK) return result;
  study->measured[scene] = calloc(1, sizeof *study->measured[scene]);
  result = study->measured[scene] ? wang_prepare(&run) : OLX_ERROR_MEMORY;
  study->references[scene] = run.references;
  if (result == OLX_OK) result = measure(b, &run, parts, study->measured[scene]);
  olx_scene_free(run.scene);
  return result;
}

olx_result wang_study_scene(bench *b, uint32_t scene, uint32_t parts, const wang_measured **measured) {
  wang_study *study = open_study(b);
  *measured = NULL;
  if (!study) return OLX_ERROR_MEMORY;
  const char *name = wang_scenes[scene].name;
  if (b->options->quick && scene > 0) {
    findings_skip(&b->found, name, "--quick keeps to the Cornell box");
    return OLX_OK;
  }
  if (!study->measured[scene] && !study->absent[scene][0]) {
    const olx_result result = run_scene(b, study, scene, b->options->all ? WANG_ERRORS | WANG_TIMES : parts);
    if (result != OLX_OK) return result;
  }
  if (study->absent[scene][0]) {
    findings_skip(&b->found, name, study->absent[scene]);
    fprintf(stderr, BENCH_PROGRAM ": %s: %s is left out: %s\n", b->experiment->name, name, study->absent[scene]);
  }
  *measured = study->measured[scene];
  return OLX_OK;
}

bench_name wang_study_name(const bench *b, const wang_measured_row *row) {
  const wang_run run = {.options = &b->wang->options};
  const bench_probes probes = wang_probes(&run, &row->row->probes);
  bench_name name = bench_probes_name(&probes);
  char *texels = strstr(name.text, ", "); // the same for all
  if (texels) *texels = 0;
  return name;
}

olx_result wang_study_show(bench *b, uint32_t scene, const uint32_t *rows, uint32_t count) {
  wang_measured *t = b->wang->measured[scene];
  bench_images *references = &b->wang->references[scene];
  bench_shown shown[SHOWN_ROWS];
  char names[SHOWN_ROWS][128];
  if (!b->section && !b->options->images) return OLX_OK;
  for (uint32_t c = 0; c < references->cameras && c < SHOWN_CAMERAS; ++c) {
    for (uint32_t i = 0; i < count; ++i) {
      wang_measured_row *row = &t->rows[rows[i]];
      snprintf(names[i], sizeof names[i], "%s, %s", wang_study_name(b, row).text, olx_select_name(row->row->select));
      shown[i] = (bench_shown){.way = names[i], .images = &row->pictures, .camera = c};
    }
    char view[128];
    snprintf(view, sizeof view, "%s, %s", wang_scenes[scene].name, references->camera[c].name);
    const olx_result result = bench_show(b, view, OLX_LAYER_INDIRECT_GLOSSY, shown, count, references, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

void wang_study_free(wang_study *study) {
  if (!study) return;
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    for (uint32_t r = 0; study->measured[i] && r < study->measured[i]->row_count; ++r) {
      bench_images_free(&study->measured[i]->rows[r].pictures);
    }
    bench_images_free(&study->references[i]);
    free(study->measured[i]);
  }
  free(study);
}
