// The parts of a relighter (octalux/relight.h): its state, and the steps of a frame. Surfels get direct light, links
// carry light between them, and surfels light the texels of light field probes and the irradiance volume.
#ifndef OLX_SHADE_RELIGHTER_PARTS_H
#define OLX_SHADE_RELIGHTER_PARTS_H

#include "core/parallel.h"
#include "field/lights.h"

#include <octalux/relight.h>
#include <octalux/sample.h>

enum {
  OLX_RELIT_MOST_LIGHTS = 256,
  OLX_RELIT_BATCH = 256,    // places that are lit together
  OLX_RELIT_TILE_SIDE = 32, // at most, the side of a tile in texels of a light field map
  OLX_RELIT_ROUNDS = 4      // samples of lights with an area whose mean is the direct light of a place
};

// A tile: a square of a light field map that is scheduled as a whole.
typedef struct olx_relit_tile {
  uint32_t probe, first_x, first_y;
  uint32_t rounds;     // number of samples of its direct light
  uint32_t solution;   // the solution of surfels from which its indirect light was computed
  uint32_t last_frame; // in which it last changed or lights were set; 0: as baked
  float distance;      // mean distance in metres from the probe to what it sees; 0: it sees the sky alone
  olx_vec3 direction;  // mean direction from the probe, unit
} olx_relit_tile;

// A tile that waits for its turn.
typedef struct olx_relit_due {
  float urgency;
  uint32_t tile;
} olx_relit_due;

struct olx_relight {
  const olx_field *source; // the baked field
  olx_field field;         // a copy of it with the relighter's own maps
  olx_relight_settings settings;
  olx_sample_settings sample;
  float near_metres;
  olx_light *lights;
  olx_field_light *field_lights; // the lights without area, in the form that fields store
  uint32_t light_count, field_light_count;
  bool varying;           // some light has an area
  uint32_t light_changes; // how often lights were set
  uint32_t frame;
  bool on_device; // frames run on a device

  // Surfels
  olx_vec3 *values;              // direct plus indirect irradiance of each surfel
  olx_vec3 *direct, *irradiance; // of each surfel, W/m^2
  olx_vec3 *beams;      // of each surfel: its direct light's luminance by lights without area, along the way to them
  olx_vec3 *highlights; // of each surfel: specular reflections of direct light that arrive, W/m^2
  uint32_t *queue;      // surfels or volume probes whose turn it is
  uint8_t *rounds;      // of each surfel: number of samples of its direct light
  uint32_t next_direct, next_bounce; // the first surfels of the next frame
  uint32_t dark;                     // number of surfels that lack samples
  uint32_t swept;                    // number of surfels whose links were followed in the current sweep
  double *job_changes, *job_sums;    // of each job of a frame
  bool shining, stale;               // the current sweep recomputes highlights; the next one must
  double change, sum;                // of light in this sweep
  bool settled;                      // the last sweep changed too little to go on, or no lights have been set
  uint32_t solution;                 // number of sweeps that changed light

  // Texels
  uint32_t *direct_map, *indirect_map; // RGB9E5; the maps of `field`
  olx_relit_tile *tiles;
  uint32_t tile_count, tile_side, tiles_a_probe;
  uint32_t *scheduled, scheduled_count; // the tiles of this frame
  bool *lit;                            // whether each of them gets direct light too
  olx_relit_due *due;
  // The frames in which parts of `field` were last written, 0: as baked. Parts are, probe after probe, each tile of the
  // map and then its border.
  uint32_t *part_frames;

  // The irradiance volume
  uint16_t *volume;          // the irradiance of `field`
  uint32_t *volume_solution; // of each probe: the solution of surfels from which it was lit
  uint32_t next_volume, volume_waiting;
  uint32_t volume_frame; // the frame that last wrote to it

  atomic_uint_fast64_t shadow_rays;
};

// ---- Light of lights (relighter_light.c)

typedef struct olx_relit_batch {
  uint32_t count;
  olx_vec3 position[OLX_RELIT_BATCH], normal[OLX_RELIT_BATCH]; // position: moved slightly off the surface
  uint32_t seed[OLX_RELIT_BATCH], sequence[OLX_RELIT_BATCH];
  uint32_t slot[OLX_RELIT_BATCH];       // the surfel or texel to which the place belongs
  olx_vec3 irradiance[OLX_RELIT_BATCH]; // W/m^2, directly from lights
  olx_vec3 beam[OLX_RELIT_BATCH];       // its luminance by lights without area, along the way to them
} olx_relit_batch;

// Returns the number of shadow rays from a place to a light.
static inline uint32_t olx_relit_samples(const olx_relight *relight, const olx_light *light) {
  return olx_light_varies(light) ? relight->settings.light_samples : 1;
}

void olx_relit_direct(olx_relight *relight, olx_relit_batch *batch);
// Returns the greatest number of shadow rays from a place to all lights.
uint32_t olx_relit_rays(const olx_relight *relight);

// ---- Surfels (relighter_surfels.c)

// Returns the number of samples of direct light that a surfel or a texel needs.
static inline uint32_t olx_relit_surfel_rounds(const olx_relight *r) {
  return r->varying ? OLX_RELIGHT_POINTS * 2 : OLX_RELIGHT_POINTS;
}
static inline uint32_t olx_relit_texel_rounds(const olx_relight *r) { return r->varying ? OLX_RELIT_ROUNDS : 1; }

olx_result olx_relit_surfels_create(olx_relight *relight);
void olx_relit_surfels_free(olx_relight *relight);
// Adds a sample of direct light to the surfels whose turn it is, within `rays` shadow rays; returns how many were lit.
uint32_t olx_relit_light_surfels(olx_relight *relight, uint64_t rays);
// Carries light over links to the surfels whose turn it is; returns their number.
uint32_t olx_relit_bounce(olx_relight *relight);
// Returns the specular reflections of direct light that arrive at a surfel, W/m^2 (relighter_highlights.c).
olx_vec3 olx_relit_highlights(const olx_relight *relight, uint32_t surfel);

// ---- Texels (relighter_texels.c, relighter_schedule.c)

olx_result olx_relit_texels_create(olx_relight *relight);
void olx_relit_texels_free(olx_relight *relight);
void olx_relit_light_tiles(olx_relight *relight);
bool olx_relit_tile_waits(const olx_relight *relight, const olx_relit_tile *tile);
uint32_t olx_relit_tiles_waiting(const olx_relight *relight);

// Returns the indirect irradiance of a texel, interpolated from the surfels of its site, W/m^2.
olx_vec3 olx_relit_told(const olx_relight *relight, uint32_t probe, uint32_t x, uint32_t y);

// ---- The volume (relighter_volume.c)

olx_result olx_relit_volume_create(olx_relight *relight);
void olx_relit_volume_free(olx_relight *relight);
// Lights volume probes from surfels; returns how many were lit.
uint32_t olx_relit_light_volume(olx_relight *relight);

#endif
