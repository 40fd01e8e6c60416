// What the parts of the experiment `surfaces` share: one scene at a time, its probes, its field and its reference.
#ifndef OCTALUX_BENCH_SURFACES_H
#define OCTALUX_BENCH_SURFACES_H

#include "experiment.h"

typedef struct surface_run {
  bench *b;
  const char *name, *what; // of the scene; what the list of scenes says besides
  olx_scene *scene;
  bool placed;   // where light field probes stand
  olx_grid grid; // where they are not placed
  olx_camera cameras[BENCH_CAMERAS];
  uint32_t camera_count;
  bench_images *reference;
  bench_table *light, *fields, *leaks, *thin, *modes;
} surface_run;

// Placed probes, and the grid unless a quick look is enough.
uint32_t surface_ways(const surface_run *r);
const char *surface_where(const surface_run *r);
// A field as `place` and `bake` make it by default, or with probe light, which some modes and audits need. Close
// it in any case.
olx_result surface_bake(const surface_run *r, uint32_t seed, bool probe_light, bench_field *made);
// Path traced from the run's cameras, with one bounce more than the field has and that many times the usual paths.
olx_result surface_reference(surface_run *r, uint32_t paths, bool centered);
// Keeps these cameras of the scene alone.
olx_result surface_keep_cameras(surface_run *r, uint32_t count, const char *const *names);

// The kinds of diffuse light that a renderer chooses from, the default first.
enum { SURFACE_MODES = 4 };
// Pictures through the centres of pixels.
bench_way surface_mode(const surface_run *r, const olx_field *field, uint32_t mode);

// Mean of indirect diffuse light over a picture, summed over channels; NAN without a picture.
double surface_mean_light(const olx_image *image);
double surface_camera_light(bench_images *images, uint32_t camera);
// Of `side` x `side` pixels.
double surface_block_light(const olx_image *image, uint32_t left, uint32_t top, uint32_t side);
// The least and the greatest ratio of light among blocks of 8 x 8 pixels that are not dark in the reference.
void surface_compare_blocks(const olx_image *image, const olx_image *reference, double *least, double *most);

// Processor time of a point in the diffuse pass, nanoseconds: from light stored at surfaces, and at irradiance probes.
// Both are rendered in turns, and the median of the turns counts.
olx_result surface_times(const surface_run *r, const olx_field *field, double *surface_ns, double *irradiance_ns);

// Measurements of one scene each, which is open already; r->placed says whether its probes are placed or on a grid.
olx_result surface_pictures(surface_run *r);  // also in all modes, from the camera that r->what names
olx_result surface_all_modes(surface_run *r); // from the camera that r->what names, or from all
olx_result surface_leak(surface_run *r);      // past the wall that r->what names
olx_result surface_thin_wall(surface_run *r); // through it, in all modes
// Rows of the modes' table, from the camera of that name or from all with NULL.
olx_result surface_add_modes(const surface_run *r, const olx_field *field, const char *camera);

void surface_light_tables(surface_run *r);
void surface_leak_tables(surface_run *r);
void surface_mode_table(surface_run *r);

#endif
