// A bake that runs, from its settings to its file, and its stages as units (work/unit_store.h).
//
// Each stage makes its results, or takes them from the store, and hands them to the writer of the file. Parts have no
// writer, joining has nothing but the store.
#ifndef OLX_BAKE_BAKE_RUN_H
#define OLX_BAKE_BAKE_RUN_H

#include "bake/bake_context.h"
#include "bake/capture.h"
#include "bake/classic_bake.h"
#include "bake/gather.h"
#include "bake/relight_bake.h"
#include "bake/selectors.h"
#include "bake/surface_capture.h"
#include "bake/volume_bake.h"
#include "work/unit_store.h"

// What joining knows of the scene and the settings: it has neither, but what the plan says of them.
typedef struct olx_joined_bake {
  olx_scene scene; // bounds, origin, hash and the number of lights alone
  olx_bake_settings settings;
} olx_joined_bake;

// One bake, from its settings to its file.
typedef struct olx_bake_run {
  olx_bake_context context;
  uint32_t bounces; // that light between irradiance probes made
  olx_shade_context shade;
  olx_gather gather;
  olx_capture capture;
  olx_scene_light *light; // NULL where indirect light is the plain reference
  olx_surface_capture surfaces;
  olx_field_light *lights;
  olx_volume_bake volume;
  olx_classic_bake classic;
  uint32_t *classic_table; // NULL without classic maps
  olx_relight_bake relight;
  olx_selector_blobs selectors;
  olx_field_writer *writer; // NULL where no file is written
  olx_unit_store *store;    // NULL: every unit is made, none is kept
  olx_joined_bake *joined;  // the scene and the settings are in it; NULL unless units are joined
  bool incomplete;          // units of other parts are missing
  olx_bake_stats stats;
  double measure_seconds; // spent on timing Embree, in all
} olx_bake_run;

// What the file says of the whole before the first probe: which probes are buried, how probes are found, the cells of
// the volume, the scene's lights. `make` makes them.
olx_result olx_bake_plan(olx_bake_run *run, olx_result (*make)(olx_bake_run *run));
// Whether everything that the file is made of is stored.
bool olx_bake_is_stored(const olx_bake_run *run);
// What the file says of the solved light.
olx_result olx_bake_facts(olx_bake_run *run);
// Irradiance probes; `make` gathers their light.
olx_result olx_bake_irradiance(olx_bake_run *run, olx_result (*make)(olx_bake_run *run));
olx_result olx_bake_classic(olx_bake_run *run);
// What relighting needs of surfels and the volume.
olx_result olx_bake_relight(olx_bake_run *run);
// Light field probes, and what relighting needs of them.
olx_result olx_bake_probes(olx_bake_run *run);

// Everything that is released when a bake ends, with its file or without; `result` or what committing the file said
// comes back.
olx_result olx_bake_finish(olx_bake_run *run, olx_result result, double start);
// What the field will be: for the file, and to know its size before anything is made.
olx_field_header olx_bake_header(const olx_bake_run *run);
// Units of progress, in rays; the quadrature of the gather must be known.
uint64_t olx_bake_units(const olx_bake_run *run);
olx_result olx_bake_create_file(olx_bake_run *run, const char *path);
void olx_bake_describe(olx_bake_run *run);

#endif
