// Shared by experiments: fields baked for one experiment, references, errors without the noise of either side, and
// times of several methods measured in turns.
#ifndef OCTALUX_BENCH_MEASURE_H
#define OCTALUX_BENCH_MEASURE_H

#include <octalux/bake.h>
#include <octalux/place.h>
#include <octalux/render.h>

// A folder for temporary fields, under TMPDIR. Its owner empties and removes it.
typedef struct bench_folder {
  char path[3072];
} bench_folder;
bool bench_folder_make(bench_folder *folder);
void bench_folder_remove(const bench_folder *folder);

// The positions of a field's probes and the resolution of their maps.
typedef struct bench_probes {
  uint32_t grid[3];      // number along each axis, over the description's volume; 0: placed
  const olx_grid *exact; // a given grid with as many probes instead; or NULL
  olx_place_method method;
  uint32_t count;
  olx_place_optimizer optimize;
  uint32_t texels;  // texels along a side of a map
  const char *file; // file of positions from `octalux place`, used instead of all the above; or NULL
} bench_probes;

// A name such as "8x4x4 grid", "64 medial + gibbs", "20 cover, 1024^2".
typedef struct bench_name {
  char text[64];
} bench_name;
bench_name bench_probes_name(const bench_probes *probes);

// The noise bound of light with --quick.
#define BENCH_ROUGH_NOISE 0.05f
// The noise bound of light in models of real scenes, except in experiments that measure default settings. For the
// default, a fifth of it, Sponza takes four times as many rays (docs/studies/light.md).
#define BENCH_MODEL_NOISE 0.1f

// The settings by which all fields of an experiment are baked.
typedef struct bench_bake {
  olx_grid irradiance_grid; // the same for all fields, so that the diffuse light of irradiance probes is the same
  uint32_t irradiance_size, light_samples, bounces, threads;
  olx_bounce_gather gather;
  olx_irradiance_form form;
  uint32_t classic_size;         // texels along a side of classic maps (the baseline); 0: none
  float noise;                   // noise bound of the solved light; 0: as bench_bake_field chooses
  bool rough;                    // place with few samples, for --quick
  bool plain;                    // only the selectors that a bake always builds
  bool no_probe_light;           // without probe light, as by default
  uint32_t seed;                 // seed of random numbers
  const olx_bake_raster *raster; // what rasterises the probes' surroundings; NULL: rays
} bench_bake;

typedef struct bench_field {
  olx_field *field;
  olx_field_info info;
  double place_seconds, bake_seconds;     // processor time in seconds
  double classic_seconds;                 // of bake_seconds, the share of classic maps
  double capture_seconds, raster_seconds; // of bake_seconds, the share of what probes see, and of its cube maps
  double coverage;                        // coverage of placed probes (olx_place_report); 0 for a grid
  char path[4096];
} bench_field;

// Places probes, bakes to a file of that number in the folder, and opens it. The caller closes it, also after a
// failure.
olx_result bench_field_make(const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            const bench_folder *folder, uint32_t number, const olx_progress *progress,
                            bench_field *made);
void bench_field_close(bench_field *made);
// Returns the bytes of geometry, with its pyramid, and of light and material of all light field probes' maps. A field
// with probe light holds light at surfaces, and radiance as the probes saw it.
uint64_t bench_geometry_bytes(const olx_field_info *info);
uint64_t bench_light_bytes(const olx_field_info *info);
// Returns the bytes of both for each texel.
double bench_texel_bytes(const olx_field_info *info);

enum { BENCH_CAMERAS = 16 };

// Images from some cameras of a scene, each rendered twice with independent noise.
typedef struct bench_images {
  uint32_t cameras;
  olx_camera camera[BENCH_CAMERAS];
  olx_image half[BENCH_CAMERAS][2];
  olx_image mean[BENCH_CAMERAS]; // means of both halves, light alone; computed on demand
  bool frames;                   // single frames: each half is what a viewer sees, with its noise
  olx_render_stats stats;        // sums over all images
} bench_images;

// Finds the cameras of a scene, at most BENCH_CAMERAS.
uint32_t bench_scene_cameras(const olx_scene *scene, olx_camera cameras[BENCH_CAMERAS]);

// A method of rendering images: with `frames`, like a real-time renderer that renders that many with the camera at
// rest.
typedef struct bench_way {
  const char *name;
  const olx_field *field;
  olx_render_settings settings;
  uint32_t frames;
} bench_way;

// Renders with the method's settings, whose seed is replaced: images of different `stream` are independent. The caller
// frees them, also after a failure.
olx_result bench_images_render(const olx_scene *scene, const olx_camera *cameras, uint32_t count, const bench_way *way,
                               uint32_t stream, const olx_progress *progress, bench_images *images);
void bench_images_free(bench_images *images);
// Returns the image of a camera: the mean of both halves, or the first of two frames. Returns NULL when memory runs
// out.
const olx_image *bench_images_mean(bench_images *images, uint32_t camera);

// The light that is compared: a layer, or the sum of both indirect ones.
typedef enum bench_light { BENCH_DIFFUSE, BENCH_GLOSSY, BENCH_INDIRECT, BENCH_BEAUTY } bench_light;

// Errors of images against references. With halves a0, a1 and b0, b1, the mean of (a0 - b0) (a1 - b1) over pixels and
// channels estimates the mean square error of what both converge to: noise adds nothing on average. For frames it is
// the mean of (a0 - b0) (a0 - b1), which includes the frames' own noise. `noise` is an upper bound of the standard
// error of the estimate.
typedef struct bench_error {
  double mse, noise;
  double relative_mse; // relative to the reference's mean square, estimated by the same method
  double bias;         // relative to the reference's mean
  double mean, reference_mean;
} bench_error;

// Returns the error of one camera, or of all with camera = BENCH_CAMERAS. The error of all indirect light is that of
// the final image where both take direct light from the same estimator.
bench_error bench_error_of(const bench_images *images, const bench_images *references, bench_light light,
                           uint32_t camera);

double bench_median(double *values, uint32_t count);

#endif
