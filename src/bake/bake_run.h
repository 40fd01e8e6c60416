// A running bake, from its settings to its file, with its stages split into units (work/unit_store.h).
//
// Each stage computes its results or loads them from the store, and hands them to the writer of the file. A partial
// bake has no writer; joining has only the store.
#ifndef OLX_BAKE_BAKE_RUN_H
#define OLX_BAKE_BAKE_RUN_H

#include "bake/bake_context.h"
#include "bake/capture/capture.h"
#include "bake/capture/surface_capture.h"
#include "bake/irradiance/classic_bake.h"
#include "bake/irradiance/gather.h"
#include "bake/relight/relight_bake.h"
#include "bake/selectors/selectors.h"
#include "bake/volume/volume_bake.h"
#include "work/unit_store.h"

// The scene and the settings as far as joining knows them: both are read from the stored plan.
typedef struct olx_joined_bake {
  olx_scene scene; // only bounds, origin, hash and the number of lights are set
  olx_bake_settings settings;
} olx_joined_bake;

// One bake, from its settings to its file.
typedef struct olx_bake_run {
  olx_bake_context context;
  uint32_t bounces; // bounces between irradiance probes that added light
  olx_shade_context shade;
  olx_gather gather;
  olx_capture capture;
  const char *link_folder; // where links between surfels are kept in files; NULL: in memory
  olx_scene_light *light;  // NULL where indirect light is path traced for reference
  olx_surface_capture surfaces;
  olx_field_light *lights;
  olx_volume_bake volume;
  olx_classic_bake classic;
  uint32_t *classic_table; // NULL without classic maps
  olx_relight_bake relight;
  olx_selector_blobs selectors;
  olx_field_writer *writer; // NULL where no file is written
  olx_unit_store *store;    // NULL: every unit is computed and none is stored
  olx_joined_bake *joined;  // holds the scene and the settings; NULL unless units are joined
  bool incomplete;          // units of other parts of the bake are missing
  olx_bake_stats stats;
  double measure_seconds; // total time spent on measuring Embree
} olx_bake_run;

// Runs the stages "plan" and "scene", which precede the first probe: buried probes, selectors and the cells of the
// volume, and the scene's lights. `make` computes the plan where the store has none.
olx_result olx_bake_plan(olx_bake_run *run, olx_result (*make)(olx_bake_run *run));
// Returns whether the store holds every unit of the file.
bool olx_bake_is_stored(const olx_bake_run *run);
// Waits until the store holds every unit of the file (olx_units_await).
olx_result olx_bake_await(const olx_bake_run *run);
// Runs the stage that records statistics of the solved light in the file.
olx_result olx_bake_facts(olx_bake_run *run);
// Runs the stage of irradiance probes; `make` gathers their light where the store has none.
olx_result olx_bake_irradiance(olx_bake_run *run, olx_result (*make)(olx_bake_run *run));
olx_result olx_bake_classic(olx_bake_run *run);
// Runs the stage that packs the surfels and the volume for relighting.
olx_result olx_bake_relight(olx_bake_run *run);
// Runs the stage of light field probes, with their data for relighting.
olx_result olx_bake_probes(olx_bake_run *run);

// Places the probes of a bake whose scene and settings are known. olx_bake_finish is to be called even on failure.
olx_result olx_bake_begin(olx_bake_run *run, const olx_progress *progress);
// Computes the plan: `make` of olx_bake_plan.
olx_result olx_bake_make_plan(olx_bake_run *run);
// Returns whether the bake stores what rays depend on, for bakes of the scene when it was edited.
bool olx_bake_keeps_rays(const olx_bake_run *run);
olx_scene_light_settings olx_bake_light_settings(const olx_bake_run *run);
// The memory of a bake's arrays, without the scene, its light and selectors, for as many threads as the settings say.
uint64_t olx_bake_array_bytes(const olx_bake_run *run);

// Releases everything that a bake holds, whether it wrote a file or not. Returns `result`, or the error of committing
// the file.
olx_result olx_bake_finish(olx_bake_run *run, olx_result result, double start);
// Returns the header of the field, for the file and to compute its size before any stage runs.
olx_field_header olx_bake_header(const olx_bake_run *run);
// Returns the total number of units of progress, in rays; the quadrature of the gather must be known.
uint64_t olx_bake_units(const olx_bake_run *run);
olx_result olx_bake_create_file(olx_bake_run *run, const char *path);
void olx_bake_describe(olx_bake_run *run);

// Checks the settings, and that the machine's memory and the disk suffice, in the words of olx_bake_measure.
olx_result olx_bake_check_machine(const olx_scene *scene, const olx_bake_settings *settings, const char *path);

#endif
