// Baking: turns a scene and probe positions into a field file. Part of liboctalux-bake.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_BAKE_H
#define OCTALUX_BAKE_H

#include <octalux/field.h>
#include <octalux/scene.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

// Sources of the indirect light of irradiance probes (docs/baking.md).
typedef enum olx_bounce_gather {
  OLX_GATHER_SOLVED = 0, // the light of the scene, solved once; with OLX_LIGHT_REFERENCE, OLX_GATHER_IRRADIANCE
  OLX_GATHER_IRRADIANCE, // bounces between irradiance probes: maps of the last bounce (McGuire et al. 2017, sec. 5.2)
  OLX_GATHER_TRACED      // bounces between irradiance probes: rays, which read what probes stored of the last bounce
} olx_bounce_gather;

// Sources of the indirect light at surfaces that light field probes see.
typedef enum olx_bake_light {
  OLX_LIGHT_CACHE = 0, // solved once in world space, at surfels, and interpolated between them
  OLX_LIGHT_REFERENCE  // paths from every texel: slow, the reference for the cache
} olx_bake_light;

// A finished unit of work, as olx_bake_work.done receives it.
typedef struct olx_bake_unit {
  const char *stage; // its name, such as "plan", "cast" or "probe"; docs/baking.md, "Bakes that resume", lists them all
  uint32_t round, unit, count; // number of the stage's round; number of the unit, of `count` in that round
  bool found;                  // its result was in the work folder already
  double seconds;              // seconds of the clock, to compute or to read it
  uint64_t bytes;              // size of its result in the work folder; 0 when it was not kept there
  const char *why; // why it was computed: "new", "damaged", "unreadable", or what changed since it was stored, some of
                   // "geometry materials lights views", or "another scene" where that is no longer known; "" where
                   // `found`. Valid during the call
} olx_bake_unit;

// Where a bake stores the results of its units, so that it can continue after it was stopped or killed, or be divided
// between machines (docs/baking.md, "Bakes that resume"). The bytes of the field do not depend on it.
typedef struct olx_bake_work {
  const char *folder;   // the caller's; NULL, the default: nothing is stored. Created if missing; must belong to this
                        // user with mode 0700, must not be a link, and must be empty or a work folder of the same bake
  bool fresh;           // discard what the folder holds, even of another bake; default false
  bool keep;            // leave the folder as it is when the field is written; default false: it is removed. A whole
                        // bake also accepts a folder of the same settings whose scene was edited since, and reuses
                        // what still holds
  uint64_t limit_bytes; // the most for all results: beyond it, and where the disk is full, a whole bake stores no more,
                        // with a warning, and a part fails with OLX_ERROR_FILE. A part counts what it found when it
                        // began and what it stores itself. 0, the default: no limit
  uint32_t part, parts; // compute the share `part`, from 1 to `parts`, of the units whose inputs exist, and write no
                        // field, in a `folder` and not with `fresh`; 0, the default: a whole bake
  // Receives each finished unit, on the thread that bakes; NULL, the default: not wanted.
  void (*done)(void *user, const olx_bake_unit *unit);
  // Waits for other parts that run at the same time, on the thread that bakes: called again and again while a unit of
  // theirs is missing, `waited_seconds` after the wait for it began. It sleeps a little and returns true, or returns
  // false to give up. Such a part also computes units of parts that are behind, returns OLX_OK when all parts are done,
  // and OLX_ERROR_INCOMPLETE when a damaged unit was found, which a part 1 of 1 then computes. NULL, the default: a
  // part never waits and returns OLX_ERROR_INCOMPLETE.
  bool (*wait)(void *user, double waited_seconds);
  void *user; // passed to done and wait
} olx_bake_work;

// What rasterises cube maps around light field probes, so that a bake need not cast rays from them (docs/baking.md,
// "Rasterised capture"; McGuire et al. 2017, sections 3, 6). The baker brings none, because it opens no device:
// capture/ has one for Vulkan devices.
typedef struct olx_bake_raster {
  // Names the device and its driver in one line, on which the field's bytes depend; a work folder belongs to one of
  // them.
  const char *name;
  // Finds the triangles that `count` probes see. triangles[((p * 6 + face) * side + row) * side + column] becomes the
  // index of the triangle that is nearest along the middle of a texel, or UINT32_MAX for the sky. Masked-out parts of
  // surfaces are absent. Face 2 a looks along +axis a, face 2 a + 1 along -axis a, for a = 0, 1, 2 (x, y, z). In a
  // direction d, with m = |d[a]|, the coordinates d[(a + 1) mod 3] / m and d[(a + 2) mod 3] / m increase along columns
  // and along rows. They are -1 and 1 at the edges of the inner (side - 2)^2 texels: the outermost ring of texels lies
  // beyond the face. Called on the thread that bakes, for at least 1 probe; positions are in metres. Returns NULL, or
  // a message of what failed, valid until the next call.
  const char *(*look)(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles);
  void *user; // passed to `look`
} olx_bake_raster;

typedef struct olx_bake_settings {
  olx_grid grid;          // grid of light field probes; olx_bake_settings_default sets it to the scene's grid
  const olx_vec3 *probes; // light field probes anywhere instead of on `grid`, metres; the caller's; default NULL
  uint32_t probe_count;   // of `probes`, 1 to 2^20
  uint32_t select_mask;   // bit (1 << olx_select) for each structure to bake in (octalux/field.h), besides bricks,
                          // which are always baked with up to 65,535 probes; 0, the default: the cage for a grid.
                          // The cage needs the grid. With more probes bricks, voronoi and octree are refused
                          // (OLX_ERROR_ARGUMENT), and `probes` without them are searched one by one
  uint32_t radiance_size; // texels along a side: a power of two, 8 to 2048; default 512
  // Also store light as probes see it (McGuire et al. 2017): the radiance that each light field probe saw (section 3),
  // and irradiance probes with filtered visibility (section 5.2). OLX_HITS_STORED, OLX_DIFFUSE_IRRADIANCE and
  // olx_irradiance read it; default pictures do not (docs/baking.md). Default false, and implied where
  // olx_bake_keeps_probe_light returns true. Only the next four settings and `fit` shape it.
  bool probe_light;
  olx_grid irradiance_grid;            // of irradiance probes; default olx_bake_irradiance_grid of the scene's grid,
                                       // which does not follow changes of `grid`
  uint32_t irradiance_size;            // a power of two, 8 to 256; default 128
  olx_irradiance_form irradiance_form; // default OLX_IRRADIANCE_OCTAHEDRAL
  olx_bounce_gather bounce_gather;     // default OLX_GATHER_SOLVED
  bool uncompressed;        // store geometry, material and light as texels, as a reference for blocks; default false
  uint32_t samples;         // samples of surfaces along a texel's side, 1 to 8; default 2 (four a texel)
  uint32_t light_samples;   // shadow rays a sample sends to area lights and to the sky, 1 to 64; default 1
  uint32_t bounces;         // further bounces after direct light, 0 to 256, as long as they bring 2^-10 of the
                            // light; default 128
  olx_bake_light light;     // default OLX_LIGHT_CACHE
  float noise;              // greatest standard error of indirect light, as a share of it, 0.001 to 1; default 0.02
  uint32_t reference_paths; // paths a texel, with OLX_LIGHT_REFERENCE, 1 to 65536; default 64
  uint32_t volume_cells;    // cells of the irradiance volume along the longest side of free space, 0 to 256, of which
                            // radiance_size / 16, at least 1, are used; some are halved (docs/baking.md, "The
                            // irradiance volume"); 0, or OLX_LIGHT_REFERENCE: no volume. Default 32
  bool classic;             // also bake classic maps: irradiance probes without visibility (docs/baking.md); default no
  uint32_t classic_size;    // texels along a side of classic maps: a power of two, 32 to 256; default 128
  uint32_t classic_cube_size; // along a face of their source cube maps: a power of two, 32 to 1024; default 256
  uint32_t classic_sharpness; // exponent of the filter from cube maps, 64 to 65536; 0, the default: as wide as a texel
  bool relight;               // also store the data for relighting (octalux/relight.h); needs OLX_LIGHT_CACHE; off
  bool fit;                   // fit irradiance maps to the surfaces they light (docs/baking.md); default true
  uint32_t seed;              // of the random numbers; a second seed gives an idea of a bake's noise; default 0
  uint32_t threads;           // 0: as many as the machine has; the result does not depend on it
  bool measure_embree;        // also time Embree alone on the primary rays, for stats.embree_seconds; default false
  // Finds what light field probes see, in place of primary rays; NULL, the default: rays. The caller's. A failure of it
  // ends the bake with OLX_ERROR_GPU.
  const olx_bake_raster *raster;
  // The most memory of the whole process while it bakes, in bytes; 0, the default: no limit. Below what a bake takes
  // without a limit, links between surfels are kept in files without names, beside the output or a part's work folder,
  // and fewer threads work; the field's bytes are the same. A limit below olx_bake_memory.least_bytes is refused.
  uint64_t memory_limit_bytes;
  olx_bake_work work; // default: nothing is stored
} olx_bake_settings;

// Returns the default settings of a bake. `scene` may be NULL: then both grids have no probes and must be set by
// olx_scene_probe_grid and olx_bake_irradiance_grid.
olx_bake_settings olx_bake_settings_default(const olx_scene *scene);

// Returns whether a bake with these settings stores probe light: because probe_light is set; because of `classic`,
// whose maps belong to irradiance probes; because of an irradiance_form or bounce_gather other than the default; or
// because there will be no irradiance volume (volume_cells 0, OLX_LIGHT_REFERENCE), and nothing else has light in free
// space.
bool olx_bake_keeps_probe_light(const olx_bake_settings *settings);

// Returns the default grid of irradiance probes for a grid of light field probes: the same one, or one of half the
// spacing when that has at most 64 probes, because irradiance probes are small.
olx_grid olx_bake_irradiance_grid(const olx_grid *grid);

typedef struct olx_bake_stats {
  uint64_t rays;                        // primary, shadow and bounce rays together; where rays are kept for bakes of
                                        // the edited scene, with those that texels gather light by
  uint64_t primary_rays;                // of the light field probes
  double seconds;                       // everything except writing the file, measuring the memory that a limit needs,
                                        // and measure_embree
  double light_seconds;                 // of `seconds`, for solving the light of the scene
  double irradiance_seconds;            // of `seconds`, for irradiance probes
  double capture_seconds;               // of `seconds`, for what light field probes see
  uint32_t surfels;                     // number of surfels at which light was gathered
  double noise;                         // standard error of indirect light that the bake reached, as a share of it
  uint64_t light_bytes;                 // memory for surfels and their links
  uint32_t volume_probes, volume_cells; // of the irradiance volume; each side of a divided cell counts as one
  uint64_t volume_bytes;                // in the file
  double volume_unserved; // share of surfaces in sight of light field probes, by solid angle, where it has no cell
  double volume_seconds;  // of `seconds`, for the volume
  double write_seconds;
  double classic_seconds;     // of `seconds`, for classic maps
  double relight_seconds;     // of `seconds`, for the data for relighting
  double embree_seconds;      // of the same primary rays with ray casting alone; 0 unless measured
  double raster_seconds;      // of capture_seconds, for rasterising cube maps; 0 without a raster
  uint64_t raster_rays;       // primary rays that were cast although there was a raster
  uint64_t peak_memory_bytes; // the most that the process has held since it began, with the scene and all of the host
  uint64_t file_bytes;
  uint32_t buried, irradiance_buried;
  double unseen; // OLX_GATHER_TRACED: share of rays that met a surface which no probe nearby sees; they bring no light
  uint64_t reused_rays; // of `rays`: found in the work folder, which holds them from before an edit of the scene
} olx_bake_stats;

// The sizes of a bake, computed by the code that allocates and lays out. Only for expected_bytes rays are cast: through
// at most 1,024 tiles of 8 x 8 texels, with the bake's samples of each texel and their shadow rays.
typedef struct olx_bake_sizes {
  uint64_t probes, irradiance_probes; // irradiance_probes is 0 without probe light
  uint64_t file_bytes; // what the description determines. Not included are structures of selectors other than the cage,
                       // the irradiance volume, up to 4 bytes a texel where probes see emitters or the sky, planes of
                       // fine surfaces, up to a third of a byte a texel in the measured scenes and 8 at most, and
                       // blocks of tiles of surfaces, 1.1 to 2.1 bytes in the measured scenes and 3.5 at most
  uint64_t expected_bytes; // file_bytes plus an estimate of what it does not include, from what a sample of texels sees
                           // (docs/baking.md, "What a bake takes"): mostly within 6 % of the file, but without other
                           // selectors than the cage and bricks, and without the data for relighting
  uint64_t device_bytes; // of the file on a Vulkan device that reads blocks, before alignment; with `relight` surfaces
                         // take 14 bytes a texel there instead, which are not included. 0 for irradiance as
                         // spherical harmonics
  uint64_t memory_bytes; // the bake's most at once, without the scene, structures of selectors, and surfels with their
                         // links (olx_bake_stats.light_bytes)
  uint64_t link_bytes;   // the most for links between surfels; most scenes need less. 0 with OLX_LIGHT_REFERENCE
  uint64_t work_bytes;   // the most in a work folder: the light of the scene, and maps in addition to those of the
                         // file; 0 for classic maps with bounces between irradiance probes, which none can keep
  uint64_t rays;         // of all probes, without shadows and reflections
  uint64_t available_memory_bytes, available_disk_bytes; // UINT64_MAX: unknown
} olx_bake_sizes;

// Computes the sizes of a bake to `path`. OLX_ERROR_ARGUMENT as for olx_bake. OLX_ERROR_MEMORY or OLX_ERROR_FILE when
// the machine's memory or the disk is too small, in the words in which olx_bake refuses to begin; *sizes is complete
// then too.
olx_result olx_bake_measure(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                            olx_bake_sizes *sizes);

// Sets *radiance_size to the largest size of maps, from 2048 texels along a side down to 8, with which the field is
// expected to take at most `budget_mb` megabytes (10^6 bytes; olx_bake_sizes.expected_bytes) and all other settings as
// they are; settings->radiance_size is not read. Probes are kept: olx_place finds as many as fit a budget.
// OLX_ERROR_ARGUMENT as for olx_bake, for a budget not above 0 or not below 10^12, and where the smallest maps take
// more: the message says how many megabytes.
olx_result olx_bake_size_for_budget(const olx_scene *scene, const olx_bake_settings *settings, double budget_mb,
                                    uint32_t *radiance_size);
// The memory that the process of a bake takes at most, in bytes: with what it held before, such as the scene.
typedef struct olx_bake_memory {
  uint64_t most_bytes;  // without a limit
  uint64_t least_bytes; // the least settings.memory_limit_bytes, with a margin of 1/16 and 3 MB in which refusals may
                        // differ from run to run, because the memory of the process itself does
} olx_bake_memory;

// Finds how much memory a bake to `path` takes, by finding buried probes, selectors, cells of the volume and surfels,
// which are then forgotten. That takes as long as those stages of the bake, and as much memory. memory_limit_bytes is
// ignored. Errors as of olx_bake: a bake that olx_bake_measure finds too large for the machine is not examined.
olx_result olx_bake_measure_memory(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                                   const olx_progress *progress, olx_bake_memory *memory);

// Estimates how long the bake would take on this machine under its present load, without writing the file and without
// what selectors of all probes take. Bakes at most eight probes of each kind twice, to a temporary file in $TMPDIR,
// else in /tmp, and extrapolates; so progress runs from 0 to 1 twice. `work` and memory_limit_bytes are ignored. Errors
// as of olx_bake, but a bake that is too large for the machine has an estimate, too. docs/baking.md gives its error.
olx_result olx_bake_estimate_seconds(const olx_scene *scene, const olx_bake_settings *settings,
                                     const olx_progress *progress, double *seconds);

// Bakes a field and writes it to `path`, through a temporary file that is synced and renamed, so that a failure or a
// kill at any moment leaves the old file or the new one. The bytes depend on the scene and the settings alone, not on
// threads or runs. stats may be NULL; after a failure *stats is incomplete or as it was. A bake with a memory limit
// measures its memory first (olx_bake_measure_memory), and returns OLX_ERROR_MEMORY, with the least limit that
// suffices, before it creates a file or a folder.
//
// With a work folder, a bake continues where another one of the same scene, settings, build and machine stopped.
// OLX_ERROR_ARGUMENT when the folder belongs to another bake, and OLX_ERROR_FILE when it is not a work folder or is in
// use. A damaged result is named in a warning and computed again. One that cannot be read now is kept, and is computed
// again or ends the bake with OLX_ERROR_FILE. A part writes no field (`path` is ignored and may be NULL) and without
// work.wait does not wait: it returns OLX_OK when nothing is left to compute, and OLX_ERROR_INCOMPLETE when units of
// other parts are missing; call it again then. Any number of parts may run at once, of any `parts`, more than once;
// meanwhile a whole bake is refused where the file system has locks. OLX_ERROR_UNSUPPORTED for classic maps with
// bounces between irradiance probes, which cannot be stored.
olx_result olx_bake(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                    const olx_progress *progress, olx_bake_stats *stats);

// Makes the checks that come before a bake to `path`, and creates the work folder, or checks that it is of this bake;
// with work.fresh what it holds is discarded. Bakes nothing. For programs that then run all parts of the bake, whose
// settings must not say `fresh`; settings->work.part is ignored. Errors as of olx_bake.
olx_result olx_bake_prepare(const olx_scene *scene, const olx_bake_settings *settings, const char *path);

// Writes the field of a work folder that has all units, without the scene. The folder is removed unless `keep`.
// OLX_ERROR_INCOMPLETE when units are missing, OLX_ERROR_CHECKSUM when one is damaged, OLX_ERROR_ARGUMENT when another
// build of Octalux computed them. Members of *stats that are not known without baking become 0; stats may be NULL.
olx_result olx_bake_join(const char *folder, const char *path, bool keep, const olx_progress *progress,
                         olx_bake_stats *stats);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
