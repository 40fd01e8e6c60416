// Baking: a scene and probe positions become a field file. Part of liboctalux-bake.
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
  OLX_GATHER_SOLVED = 0, // the light of the scene, solved once; with OLX_LIGHT_REFERENCE the next
  OLX_GATHER_IRRADIANCE, // bounces between them: the irradiance maps of the bounce before (McGuire et al. 2017, section 5.2)
  OLX_GATHER_TRACED      // bounces between them: rays, which find what probes stored of the bounce before
} olx_bounce_gather;

// Sources of the indirect light at surfaces that light field probes see.
typedef enum olx_bake_light {
  OLX_LIGHT_CACHE = 0, // solved once in world space, at surfels, and interpolated between them
  OLX_LIGHT_REFERENCE  // paths from every texel: slow, to judge the other by
} olx_bake_light;

// "cache", "reference".
const char *olx_bake_light_name(olx_bake_light light);

// A unit of work that is done, as olx_bake_work.done gets it.
typedef struct olx_bake_unit {
  const char *stage;           // "plan", "light", "cast", "direct", "facts", "volume", "irradiance", "classic", "relight", "probe"
  uint32_t round, unit, count; // of a stage's rounds; of the `count` units in that round
  bool found;                  // its result was in the work folder already
  double seconds;              // by the clock, to make or to read it
} olx_bake_unit;

// Where a bake keeps the results of its units, so that it can go on after it was stopped or killed, or be shared out
// over machines (docs/baking.md, "Bakes that resume"). Bytes of the field do not depend on it.
typedef struct olx_bake_work {
  const char *folder;   // the caller's; NULL, the default: nothing is kept. Made unless it is there; it must be this user's, with mode
                        // 0700, no link, and empty or a work folder of the same bake
  bool fresh;           // forget what the folder holds, also of another bake; default false
  bool keep;            // leave the folder as it is when the field is written; default false: it goes away
  uint64_t limit_bytes; // that results take at most: beyond it a whole bake keeps no more, with a warning, and a part fails with
                        // OLX_ERROR_FILE; 0, the default: no bound
  uint32_t part, parts; // make the share `part`, from 1 to `parts`, of the units whose inputs are there, and write no field;
                        // 0, the default: a whole bake
  void (*done)(void *user, const olx_bake_unit *unit); // called after each unit, on the thread that bakes; NULL, the default: not wanted
  void *user;                                          // handed to `done`
} olx_bake_work;

typedef struct olx_bake_settings {
  olx_grid grid;            // light field probes; set by olx_bake_settings_default to the scene's grid
  const olx_vec3 *probes;   // light field probes anywhere instead of on `grid`, metres; the caller's; default NULL
  uint32_t probe_count;     // of `probes`, 1 to 2^20
  uint32_t select_mask;     // bit (1 << olx_select) for each structure to bake in (octalux/field.h), 0 for what fits best:
                            // cage for a grid, bricks for `probes`. Bricks are there whatever is said, with up to 65535
                            // probes. The cage needs the grid. Default 0
  uint32_t radiance_size;   // texels along a side: a power of two, 8 to 2048; default 512
  // Also keep light as probes have it (McGuire et al. 2017): radiance as each light field probe saw it (section 3), and
  // irradiance probes with filtered visibility (section 5.2). OLX_HITS_STORED, OLX_DIFFUSE_IRRADIANCE and
  // olx_irradiance read it, and no default picture does (docs/baking.md). Default false, and implied where
  // olx_bake_keeps_probe_light says so. The four settings after it, and `fit`, shape it alone.
  bool probe_light;
  olx_grid irradiance_grid; // irradiance probes; set to olx_bake_irradiance_grid of `grid`
  uint32_t irradiance_size; // a power of two, 8 to 256; default 128
  olx_irradiance_form irradiance_form; // default OLX_IRRADIANCE_OCTAHEDRAL
  olx_bounce_gather bounce_gather;     // default OLX_GATHER_SOLVED
  bool uncompressed;        // keep geometry, material and light as texels instead of blocks, to judge these by; default false
  uint32_t samples;         // samples of surfaces along a texel's side, 1 to 8; default 2 (four a texel)
  uint32_t light_samples;   // shadow rays a sample sends to area lights and to the sky, 1 to 64; default 1
  uint32_t bounces;         // further bounces after direct light, 0 to 64, as long as they bring 2^-10 of the light; default 32
  olx_bake_light light;     // default OLX_LIGHT_CACHE
  float noise;              // upper bound on the standard error of indirect light, as a share of it, 0.001 to 1; default 0.02
  uint32_t reference_paths; // a texel, with OLX_LIGHT_REFERENCE, 1 to 65536; default 64
  uint32_t volume_cells;    // smallest cells of the irradiance volume along the longest side of free space, 0 to 256, and
                            // at most radiance_size / 16; 0, or OLX_LIGHT_REFERENCE: no volume. Default 32
  bool classic;             // also make classic maps, those of the baseline (docs/baking.md); default false
  uint32_t classic_size;    // texels along a side of these: a power of two, 32 to 256; default 128
  uint32_t classic_cube_size; // along a face of the cube maps that they come from: a power of two, 32 to 1024; default 256
  uint32_t classic_sharpness; // exponent of the filter between the two, 64 to 65536; 0, the default: as wide as a texel
  bool relight;                    // also keep what it takes to change lights later (octalux/relight.h); needs OLX_LIGHT_CACHE; default false
  bool fit;                        // fit irradiance maps to the surfaces they light (docs/baking.md); default true
  uint32_t seed;                   // another one draws other random numbers, for an idea of a bake's noise; default 0
  uint32_t threads;                // 0: as many as the machine has; the result does not depend on it
  bool measure_embree; // also time Embree alone on the primary rays, for stats.embree_seconds; default false
  olx_bake_work work;  // default: nothing is kept
} olx_bake_settings;

// The settings of a bake where nothing else is said. `scene` may be NULL: both grids are left without probes then, and
// are to be set by olx_scene_probe_grid and olx_bake_irradiance_grid.
olx_bake_settings olx_bake_settings_default(const olx_scene *scene);

// Whether a bake with these settings keeps probe light: because probe_light says so; because of `classic`, whose maps
// belong to irradiance probes; because of an irradiance_form or bounce_gather other than the default; or because there
// will be no irradiance volume (volume_cells 0, OLX_LIGHT_REFERENCE), so that nothing else has light in free space.
bool olx_bake_keeps_probe_light(const olx_bake_settings *settings);

// The default grid of irradiance probes for a grid of light field probes: the same one, or one of half the spacing when
// that has at most 64 probes, since irradiance probes are small.
olx_grid olx_bake_irradiance_grid(const olx_grid *grid);

typedef struct olx_bake_stats {
  uint64_t rays;         // primary, shadow and bounce rays together
  uint64_t primary_rays; // of the light field probes
  double seconds;        // everything but writing the file
  double light_seconds;  // of them, for solving the light of the scene
  double irradiance_seconds; // and for irradiance probes
  double capture_seconds;    // and for what light field probes see
  uint32_t surfels;      // at which it was gathered
  double noise;          // standard error of indirect light that was reached, as a share of it
  uint64_t light_bytes;  // memory that surfels and their links took
  uint32_t volume_probes, volume_cells; // of the irradiance volume: probes, and sides of cells that have some
  uint64_t volume_bytes;                // in the file
  double volume_unserved; // share of surfaces in sight of light field probes, by solid angle, where it has no cell
  double volume_seconds;  // of `seconds`, for the volume
  double write_seconds;
  double classic_seconds; // of them, for classic maps
  double relight_seconds; // and for what relighting needs
  double embree_seconds;  // the same primary rays with nothing but ray casting; 0 unless measured
  uint64_t peak_memory_bytes;
  uint64_t file_bytes;
  uint32_t buried, irradiance_buried;
  double
      unseen; // OLX_GATHER_TRACED: share of the rays that met a surface which no probe nearby sees; they count for nothing
} olx_bake_stats;

// The sizes of a bake, computed by the code that allocates and lays out, without casting a ray.
typedef struct olx_bake_sizes {
  uint64_t probes, irradiance_probes; // 0 of irradiance without probe light
  uint64_t file_bytes; // what the description makes certain. On top come structures of other selectors than the cage, the
                       // irradiance volume, up to 4 bytes a texel where probes see emitters or the sky, and planes of
                       // fine surfaces, up to a third of a byte a texel in the scenes that were measured and 8 at most
  uint64_t expected_bytes; // file_bytes with what furnished rooms have on top, as olx_light_field_bytes reckons it
  uint64_t device_bytes; // that a Vulkan device holds of it, before alignment; 0 for irradiance as spherical harmonics
  uint64_t memory_bytes; // that the bake takes at most at once, beside the scene, structures of selectors, and surfels with
                         // their links (olx_bake_stats.light_bytes)
  uint64_t link_bytes;   // that links between surfels take at most; most scenes need less. 0 with OLX_LIGHT_REFERENCE
  uint64_t work_bytes;   // that a work folder takes at most: what the light of the scene may take, and maps beside the file's
  uint64_t rays;         // of all probes, before shadows and reflections
  uint64_t available_memory_bytes, available_disk_bytes; // UINT64_MAX: not known
} olx_bake_sizes;

// Computes the sizes of a bake to `path`. OLX_ERROR_ARGUMENT as olx_bake; OLX_ERROR_MEMORY or OLX_ERROR_FILE when the
// machine's memory or the disk is too small for it, which olx_bake answers in the same words before it begins: *sizes
// is complete then, too.
olx_result olx_bake_measure(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                            olx_bake_sizes *sizes);

// Estimates how long the bake would take on this machine as busy as it is, without writing the file and without
// building selectors. Bakes eight probes of each kind, at most, to a temporary file, and multiplies. docs/baking.md
// says how far off it is.
olx_result olx_bake_estimate_seconds(const olx_scene *scene, const olx_bake_settings *settings,
                                     const olx_progress *progress, double *seconds);

// Bake and write `path`: beside, synced, renamed, so that a failure or a kill at any moment leaves the old file or the
// new one. The bytes depend on the scene and the settings alone, not on threads or runs. stats may be NULL.
//
// With a work folder a bake goes on where another one of the same scene, settings, build and machine left off.
// OLX_ERROR_ARGUMENT when the folder is another bake's, and OLX_ERROR_FILE when it is no work folder, or in use. A
// damaged result is named in a warning and made again. A part writes no field (`path` is not looked at) and never
// waits: OLX_OK when there is nothing left to make, OLX_ERROR_INCOMPLETE when units of others are missing; call it
// again then. Any number of parts may run at once, of any `parts`, more than once; while they do a whole bake is
// refused where the file system has locks. OLX_ERROR_UNSUPPORTED for classic maps with bounces between irradiance
// probes, which cannot be kept.
olx_result olx_bake(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                    const olx_progress *progress, olx_bake_stats *stats);

// Write the field of a work folder whose units are all there, without the scene. The folder goes away unless `keep`.
// OLX_ERROR_INCOMPLETE when units are missing, OLX_ERROR_CHECKSUM when one is damaged, OLX_ERROR_ARGUMENT when another
// build of Octalux made them. Of *stats, which may be NULL, only what is known without baking is set.
olx_result olx_bake_join(const char *folder, const char *path, bool keep, const olx_progress *progress,
                         olx_bake_stats *stats);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
