// The parts of a relighter (octalux/relight.h): what it keeps for each probe, and the steps of a frame.
#ifndef OLX_SHADE_RELIGHTER_H
#define OLX_SHADE_RELIGHTER_H

#include "core/parallel.h"
#include "shade/corrections.h"
#include "shade/irradiance.h"

#include <octalux/relight.h>

enum {
  OLX_RELIT_MOST_LIGHTS = 256,
  OLX_RELIT_BATCH = 256,     // surfaces that are lit together
  OLX_RELIT_TILE_SIDE = 32,  // texels of a light field map that are scheduled together, at most
  OLX_RELIT_MAP_MOST = 32,   // texels along a side of the maps that probes gather from
  OLX_RELIT_CELLS_MOST = 32, // cells along a side into which surfaces are summed for these
  OLX_RELIT_ROUNDS = 4,      // updates after which lights that vary have been sampled enough
  OLX_RELIT_CHUNKS = 16      // into which sums over points are split, however many threads there are
};

// A probe of either kind in the schedule.
typedef struct olx_relit_probe {
  float pending;   // share of its light that may have changed since its last update began
  uint32_t rounds; // updates since the lights changed
  uint32_t updates, last_frame, woke_frame;
  uint32_t tiles; // of a light field probe: done in the pass that is under way
  olx_vec3 position;
  bool buried;
} olx_relit_probe;

typedef struct olx_relit_tile {
  uint32_t probe, tile;
} olx_relit_tile;

// Whose light a probe gets: rows of a sparse matrix, one a probe, irradiance probes first.
typedef struct olx_relit_shares {
  uint32_t *starts; // of rows, and the end
  uint32_t *probes; // irradiance probes
  float *share;     // of the row's light that comes from there
} olx_relit_shares;

// Points on surfaces to which irradiance is fitted (docs/baking.md).
typedef struct olx_relit_fit {
  uint32_t count;                    // of points; 0 without a fit
  olx_bilinear *texels;              // of the working maps, around the point's normal
  uint32_t *tap_starts, *tap_probes; // probes that answer for a point
  float *tap_weights;
  olx_correction_cells *cells; // of a correction, around the normal
  bool *valid;
  olx_vec3 *measured;
  olx_corrections corrections;
  olx_vec3 *partial;      // OLX_RELIT_CHUNKS times the unknowns
  const olx_vec3 *factor; // that is multiplied now
} olx_relit_fit;

struct olx_relight {
  const olx_field *source; // as it was baked
  olx_field field;         // the same with our maps
  olx_relight_settings settings;
  olx_sample_settings sample;
  float near_metres;
  olx_relight_light *lights;
  uint32_t light_count;
  bool varying;           // some light has an area
  uint32_t light_changes; // how often lights were given
  uint32_t frame;
  bool on_device; // frames are made there: of these probes' state, only the schedule's is kept up to date

  olx_relit_probe *probes[2]; // irradiance, light field
  uint32_t counts[2];
  uint32_t *scheduled; // irradiance probes of this frame
  uint32_t scheduled_count, scheduled_most;
  bool *in_frame;        // an irradiance probe
  olx_relit_tile *tiles; // of light field maps
  uint32_t tile_count, tile_most, tile_side, tiles_a_probe;
  uint32_t current; // light field probe whose pass is under way, or UINT32_MAX
  olx_relit_shares shares;

  // Surfaces: `surfaces` of each irradiance probe, then `hidden` of each, as rays of the fit's points number them.
  size_t surfaces;
  uint32_t hidden;                   // 0 where shadow rays are traced through the field, which does not see hidden surfaces
  uint32_t hidden_most;              // of these places so many are in use at most
  olx_vec3 *direct, *varying_direct; // irradiance of lights without and with an area
  olx_vec3 *radiance;                // that leaves them
  // Working maps of irradiance, `map_size` texels a side.
  uint32_t map_size, cells;
  size_t map_texels;     // with border
  float *moment[3];      // a cell: its directions, integrated over it
  float *surface_share;  // of its cell's solid angle
  olx_vec3 *exact;       // at the probe, map_size^2 each, without border
  olx_vec3 *maps;        // fitted to surfaces, with border
  float *changed, *mean; // of maps, in this frame: sums of luminance over texels
  float *unpacked;       // change since maps were packed, as a share
  // Frames in which maps of `field` were last written, 0: as baked. A light field map has one for each tile, and one for its border.
  uint32_t *map_frames, *tile_frames;
  float level;           // the largest mean there was since the lights changed
  olx_irradiance_source irradiance;
  uint32_t *packed_radiance, *packed_irradiance; // of `field`
  olx_relit_fit fit;
  uint32_t fit_frames; // for which fitting goes on

  atomic_uint_fast64_t shadow_rays, lookups, texels;
};

// ---- A frame (relighter.c)

// Its schedule.
void olx_relit_begin_frame(olx_relight *relight, olx_vec3 eye);
// Whether there are maps to be fitted in this frame; asked once a frame.
bool olx_relit_fits(olx_relight *relight);
// Count the updates of scheduled irradiance probes, whose maps are done.
void olx_relit_count_updates(olx_relight *relight);
uint32_t olx_relit_count_awake(const olx_relight *relight);

// ---- Light of lights (relighter_light.c)

typedef struct olx_relit_batch {
  uint32_t count;
  olx_vec3 position[OLX_RELIT_BATCH], normal[OLX_RELIT_BATCH]; // moved a little off the surface
  uint32_t seed[OLX_RELIT_BATCH], sequence[OLX_RELIT_BATCH];
  uint32_t slot[OLX_RELIT_BATCH];                            // whose it is
  olx_vec3 fixed[OLX_RELIT_BATCH], varying[OLX_RELIT_BATCH]; // irradiance of lights without and with an area
} olx_relit_batch;

static inline bool olx_relit_varies(const olx_relight_light *light) { return light->type >= OLX_RELIGHT_RECT; }

// The irradiance of lights that do not vary, if `fixed`, and of those that do, if `varying`.
void olx_relit_direct(olx_relight *relight, olx_relit_batch *batch, bool fixed, bool varying);

// ---- Which probes (relighter_schedule.c)

// Fills scheduled, in_frame and tiles.
void olx_relit_schedule(olx_relight *relight, olx_vec3 eye);
// What this frame's changes mean for those who get light from changed probes.
void olx_relit_pass_on(olx_relight *relight);
bool olx_relit_awake(const olx_relight *relight, const olx_relit_probe *probe);
void olx_relit_wake_all(olx_relight *relight);
olx_result olx_relit_find_shares(olx_relight *relight);

// ---- Maps (relighter_maps.c)

olx_result olx_relit_make_quadrature(olx_relight *relight);
// The exact map of a probe from its surfaces, with the share `history` of the one before.
void olx_relit_gather(olx_relight *relight, uint32_t probe, float history);
// maps from exact maps and corrections; and into the field what changed.
void olx_relit_finish_map(olx_relight *relight, uint32_t probe);
// Whether a map that is not scheduled has changed enough to be packed again; `sum` is its luminance over all texels.
bool olx_relit_pack_due(const olx_relight *relight, uint32_t probe, float sum);
// Working maps from what the field has.
void olx_relit_read_map(olx_relight *relight, uint32_t probe);
void olx_relit_fill_border(uint32_t *map, uint32_t n);

// ---- The fit (relighter_fit.c)

olx_result olx_relit_fit_create(olx_relight *relight);
void olx_relit_fit_free(olx_relit_fit *fit);
// Irradiance at a probe's points from the surfaces that their rays meet.
void olx_relit_fit_measure(olx_relight *relight, uint32_t probe);
// So many steps of conjugate gradients from the solution before.
olx_result olx_relit_fit_solve(olx_relight *relight, uint32_t steps);
olx_vec3 olx_relit_correction(const olx_relit_fit *fit, uint32_t probe, olx_vec2 uv);

// ---- Surfaces (relighter.c)

// Those of an irradiance probe that are lit, and where each of them is among all probes'.
static inline size_t olx_relit_surfaces(const olx_relight *r) { return r->surfaces + r->hidden_most; }
static inline size_t olx_relit_surface_index(const olx_relight *r, uint32_t probe, size_t i) {
  if (i < r->surfaces) return r->surfaces * probe + i;
  return r->surfaces * r->counts[0] + (size_t)r->hidden * probe + i - r->surfaces;
}
static inline size_t olx_relit_surface_count(const olx_relight *r) { return (r->surfaces + r->hidden) * r->counts[0]; }

static inline olx_vec3 olx_relit_albedo(uint32_t code) {
  return olx_min_each(olx_r11g11b10f_unpack(code), olx_splat(1.0f));
}

#endif
