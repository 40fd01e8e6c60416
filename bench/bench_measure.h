// What experiments share: fields that are baked for the occasion, references, errors without the noise of either side,
// and times of several ways taken in turns.
#ifndef OCTALUX_BENCH_MEASURE_H
#define OCTALUX_BENCH_MEASURE_H

#include <octalux/bake.h>
#include <octalux/place.h>
#include <octalux/render.h>

// A folder for temporary fields, under TMPDIR. Empty and remove it when done.
typedef struct bench_folder {
  char path[3072];
} bench_folder;
bool bench_folder_make(bench_folder *folder);
void bench_folder_remove(const bench_folder *folder);

// The positions of a field's probes and the resolution of their maps.
typedef struct bench_probes {
  uint32_t grid[3];      // on the description's volume; 0: placed
  const olx_grid *exact; // on this one instead, of as many probes; NULL
  olx_place_method method;
  uint32_t count;
  olx_place_optimizer optimize;
  uint32_t texels;  // along a map
  const char *file; // positions that `octalux place` wrote, instead of all that; NULL
} bench_probes;

// "8x4x4 grid", "64 medial + gibbs", "20 cover, 1024^2".
typedef struct bench_name {
  char text[64];
} bench_name;
bench_name bench_probes_name(const bench_probes *probes);

// The noise of light in a quick look.
#define BENCH_ROUGH_NOISE 0.05f

// How all fields of an experiment are baked.
typedef struct bench_bake {
  olx_grid irradiance_grid; // the same for all, so that diffuse light of irradiance probes is
  uint32_t irradiance_size, light_samples, bounces, threads;
  olx_bounce_gather gather;
  olx_irradiance_form form;
  uint32_t classic_size; // of the baseline's maps; 0: none
  float noise;           // of the solved light; 0: the default of bakes
  bool rough;            // place with few samples, for a quick look
  bool plain;            // no structures of selectors but those that a bake makes anyway
  bool no_probe_light;   // as by default
  uint32_t seed;         // of random numbers
} bench_bake;

typedef struct bench_field {
  olx_field *field;
  olx_field_info info;
  double place_seconds, bake_seconds; // of processors
  double classic_seconds;             // of these
  double coverage;                    // of placed probes (olx_place_report); 0 for a grid
  char path[4096];
} bench_field;

// Place, bake to a file of that number in the folder, and open it. Close it in any case.
olx_result bench_field_make(const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            const bench_folder *folder, uint32_t number, const olx_progress *progress,
                            bench_field *made);
void bench_field_close(bench_field *made);

enum { BENCH_CAMERAS = 16 };

// Pictures from some cameras of a scene, each twice, with independent noise.
typedef struct bench_images {
  uint32_t cameras;
  olx_camera camera[BENCH_CAMERAS];
  olx_image half[BENCH_CAMERAS][2];
  olx_image mean[BENCH_CAMERAS]; // of both halves, light alone; made when asked for
  bool frames;                   // single frames: each half is what a viewer sees, noise and all
  olx_render_stats stats;        // of all
} bench_images;

// All cameras of a scene, at most BENCH_CAMERAS.
uint32_t bench_scene_cameras(const olx_scene *scene, olx_camera cameras[BENCH_CAMERAS]);

// One way to make pictures: with `frames`, as a real-time renderer makes that many with the camera at rest.
typedef struct bench_way {
  const char *name;
  const olx_field *field;
  olx_render_settings settings;
  uint32_t frames;
} bench_way;

// Render with the way's settings, whose seed is replaced: images of different `stream` are independent. Free them in
// any case.
olx_result bench_images_render(const olx_scene *scene, const olx_camera *cameras, uint32_t count, const bench_way *way,
                               uint32_t stream, const olx_progress *progress, bench_images *images);
void bench_images_free(bench_images *images);
// The picture of a camera: the mean of both halves, or the first of two frames. NULL when there is no memory.
const olx_image *bench_images_mean(bench_images *images, uint32_t camera);

// Light that is compared: a layer, or the sum of both indirect ones.
typedef enum bench_light { BENCH_DIFFUSE, BENCH_GLOSSY, BENCH_INDIRECT, BENCH_BEAUTY } bench_light;

// Errors of pictures against references. With halves a0, a1 and b0, b1 the mean of (a0 - b0) (a1 - b1) over pixels and
// channels estimates the mean square error of what both would converge to: noise adds nothing to it on average. Of
// frames it is that of (a0 - b0) (a0 - b1), to which the frames' own noise belongs. `noise` is no less than the
// standard error that noise leaves in it.
typedef struct bench_error {
  double mse, noise;
  double relative_mse; // over the reference's mean square, estimated alike
  double bias;         // over the reference's mean
  double mean, reference_mean;
} bench_error;

// Of one camera, or of all with camera = BENCH_CAMERAS. The error of all indirect light is that of the final picture
// where both take direct light from the same estimator.
bench_error bench_error_of(const bench_images *images, const bench_images *references, bench_light light,
                           uint32_t camera);

double bench_median(double *values, uint32_t count);

#endif
