// One row of the benchmark: a cooked scene and a field, drawn and lit repeatedly, and timed.
#ifndef OCTALUX_BENCH_ROW_H
#define OCTALUX_BENCH_ROW_H

#include "bench_probe.h"

typedef struct bench_settings {
  uint32_t width, height;
  uint32_t frames;
  bool quick;           // coarse shadows and a short warm-up
  bool compare;         // only compare glossy light by two-level + cage with hi-Z + bricks, in turns
  const char *camera;   // name of the camera; NULL: the scene's first
  double gigabytes;     // bandwidth in gigabytes per second, for lower bounds
  uint32_t ray_spacing; // pixels between the rays of a frame, 1 or 2
  olx_sample_settings sample;
} bench_settings;

typedef struct bench_row {
  const char *name, *title;
  const char *scene, *field;          // names of files, without extension
  uint32_t probes, radiance_size;     // number and map size of the paper's probes; 0: any
  double paper_diffuse, paper_glossy; // milliseconds in McGuire et al. 2017, Table 1; below 0: not published
} bench_row;

// Returns a row of the paper's table, NULL past the last.
const bench_row *bench_row_at(uint32_t index);

typedef enum bench_part {
  BENCH_SHADOW = 0,
  BENCH_GBUFFER,
  BENCH_DIRECT,
  BENCH_IRRADIANCE,
  BENCH_GLOSSY,
  BENCH_DENOISE, // denoising of glossy light alone
  BENCH_COMPOSITE,
  BENCH_TONE,
  BENCH_FLOOR_DIFFUSE, // passes with the least work
  BENCH_FLOOR_GLOSSY,
  BENCH_FRAME_PARTS,
  // The paper's denoised method: one Lambertian ray per pixel in place of irradiance probes.
  BENCH_DIFFUSE_RAYS = BENCH_FRAME_PARTS,
  BENCH_GLOSSY_RAYS,
  BENCH_DENOISE_BOTH,
  BENCH_PARTS
} bench_part;

const char *bench_part_name(bench_part part);

// Returns the least bytes per pixel that a pass must read and write in the frame's images.
uint32_t bench_part_bytes(bench_part part);

enum { BENCH_OLD = 0, BENCH_NEW, BENCH_PAIR }; // the two methods compared: two-level + cage, and hi-Z + bricks

typedef enum bench_state { BENCH_SKIPPED = 0, BENCH_DONE, BENCH_FAILED } bench_state;

typedef struct bench_result {
  bench_state state;
  char problem[768]; // reason when skipped or failed
  uint32_t probes, radiance_size, lamps, shadow_maps;
  uint64_t triangles, scene_bytes, field_bytes; // bytes of device memory
  bool other_scene;                             // the field was baked from another scene
  double milliseconds[BENCH_PARTS];             // medians over the frames
  double least[BENCH_PARTS];                    // minima over the frames
  bench_counts counts;
  double pair_milliseconds[BENCH_PAIR]; // glossy light, when methods are compared
  bench_counts pair_counts[BENCH_PAIR];
} bench_result;

// Runs a row. Errors are stored in the result; the device can be used again.
void bench_run(gpu_device *device, const char *scene_path, const char *field_path, const bench_settings *settings,
               bench_result *result);

#endif
