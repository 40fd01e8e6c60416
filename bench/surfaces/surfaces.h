// Shared by the parts of the experiment `surfaces`: one scene at a time, its probes, its field and its reference.
#ifndef OCTALUX_BENCH_SURFACES_H
#define OCTALUX_BENCH_SURFACES_H

#include "experiment.h"
#include "picture_blocks.h"

typedef struct surface_run {
  bench *b;
  const char *name, *what; // name of the scene; additional parameter from the list of scenes
  olx_scene *scene;
  bool placed;   // whether light field probes are placed
  olx_grid grid; // the grid where they are not placed
  olx_camera cameras[BENCH_CAMERAS];
  uint32_t camera_count;
  bench_images *reference;
  bench_table *light, *fields, *leaks, *thin, *modes;
} surface_run;

// Returns whether placed probes, or those of the grid, are measured: what --probes names; else both, but with --quick
// placed probes alone.
bool surface_wants(const surface_run *r, bool placed);
const char *surface_where(const surface_run *r);
// Bakes a field as `place` and `bake` do by default, or with probe light, which some modes and audits need. The caller
// closes it, also after a failure.
olx_result surface_bake(const surface_run *r, uint32_t seed, bool probe_light, bench_field *made);
// Path traces the reference from the run's cameras, with one bounce more than the field and `paths` times the usual
// number of paths.
olx_result surface_reference(surface_run *r, uint32_t paths, bool centered);
// Restricts the scene to these cameras.
olx_result surface_keep_cameras(surface_run *r, uint32_t count, const char *const *names);

// The kinds of diffuse light that a renderer chooses from, the default first.
enum { SURFACE_MODES = 4 };
// Returns settings for images through pixel centres in a mode.
bench_way surface_mode(const surface_run *r, const olx_field *field, uint32_t mode);

// Returns the mean indirect diffuse light of a camera's image, summed over channels; NaN without an image.
double surface_camera_light(bench_images *images, uint32_t camera);

// Measures the processor time per point in the diffuse pass in nanoseconds, from light stored at surfaces and from
// irradiance probes. Both are rendered in turns; the result is the median.
olx_result surface_times(const surface_run *r, const olx_field *field, double *surface_ns, double *irradiance_ns);

// Measurements of one open scene each; r->placed selects placed probes or a grid.
olx_result surface_pictures(surface_run *r);  // also in all modes, from the camera that r->what names
olx_result surface_all_modes(surface_run *r); // all modes from the camera that r->what names, or from all cameras
olx_result surface_leak(surface_run *r);      // light that leaks past the wall that r->what names
olx_result surface_thin_wall(surface_run *r); // light that leaks through a thin wall, in all modes
// Adds rows to the modes' table, from the camera of that name or, with NULL, from all.
olx_result surface_add_modes(const surface_run *r, const olx_field *field, const char *camera);

void surface_light_tables(surface_run *r);
void surface_leak_tables(surface_run *r);
void surface_mode_table(surface_run *r);

#endif
