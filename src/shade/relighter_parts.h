// The parts of a relighter (octalux/relight.h): what it keeps, and the steps of a frame. Surfels get direct light,
// light goes over links between them, and by surfels the texels of light field probes and the irradiance volume are
// lit.
#ifndef OLX_SHADE_RELIGHTER_PARTS_H
#define OLX_SHADE_RELIGHTER_PARTS_H

#include "core/parallel.h"
#include "field/field_data.h"

#include <octalux/relight.h>
#include <octalux/sample.h>

enum {
  OLX_RELIT_MOST_LIGHTS = 256,
  OLX_RELIT_BATCH = 256,    // places that are lit together
  OLX_RELIT_TILE_SIDE = 32, // texels of a light field map that are scheduled together, along a side, at most
  OLX_RELIT_ROUNDS = 4      // samples of lights with an area that the direct light of a place is the mean of
};

// Part of a light field map.
typedef struct olx_relit_tile {
  uint32_t probe, first_x, first_y;
  uint32_t rounds;     // samples that its direct light is the mean of
  uint32_t solution;   // of surfels, from which its indirect light comes
  uint32_t last_frame; // that changed it, 0: as baked; or in which lights were given
  float distance;      // metres from the probe to what it sees, on average; 0: it sees the sky alone
  olx_vec3 direction;  // from there, unit
} olx_relit_tile;

// A tile that waits.
typedef struct olx_relit_due {
  float urgency;
  uint32_t tile;
} olx_relit_due;

struct olx_relight {
  const olx_field *source; // as it was baked
  olx_field field;         // the same with our maps
  olx_relight_settings settings;
  olx_sample_settings sample;
  float near_metres;
  olx_relight_light *lights;
  olx_field_light *field_lights; // those of them without area, as the field has them
  uint32_t light_count, field_light_count;
  bool varying;           // some light has an area
  uint32_t light_changes; // how often lights were given
  uint32_t frame;
  bool on_device; // frames are made there

  // Surfels
  olx_vec3 *values;              // direct and indirect irradiance of surfels
  olx_vec3 *direct, *irradiance; // of surfels; W/m^2
  olx_vec3 *beams;      // of a surfel: luminance of its direct light from lights without area, along the way to them
  olx_vec3 *highlights; // of a surfel: what arrives as specular reflections of direct light, W/m^2
  uint32_t *queue;      // surfels or volume probes whose turn it is
  uint8_t *rounds;      // of a surfel: samples that its direct light is the mean of
  uint32_t next_direct, next_bounce; // surfels that come first in the next frame
  uint32_t dark;                     // surfels that lack samples
  uint32_t swept;                    // surfels whose links were followed since the sweep under way began
  double *job_changes, *job_sums;    // of a frame's jobs
  bool shining, stale;               // the sweep under way finds highlights anew; the next one must
  double change, sum;                // of light in this sweep
  bool settled;                      // the last sweep changed too little to go on, or no lights were given yet
  uint32_t solution;                 // sweeps that changed light

  // Texels
  uint32_t *direct_map, *indirect_map; // RGB9E5, of `field`
  olx_relit_tile *tiles;
  uint32_t tile_count, tile_side, tiles_a_probe;
  uint32_t *scheduled, scheduled_count; // tiles of this frame
  bool *lit;                            // of each of them: direct light, too
  olx_relit_due *due;
  // Frames in which parts of `field` were last written, 0: as baked: each tile of a map, then its border, probe after
  // probe.
  uint32_t *part_frames;

  // The irradiance volume
  uint16_t *volume;          // irradiance of `field`
  uint32_t *volume_solution; // of surfels, from which a probe's light comes
  uint32_t next_volume, volume_waiting;
  uint32_t volume_frame; // in which some was last written

  atomic_uint_fast64_t shadow_rays;
};

// ---- Light of lights (relighter_light.c)

typedef struct olx_relit_batch {
  uint32_t count;
  olx_vec3 position[OLX_RELIT_BATCH], normal[OLX_RELIT_BATCH]; // moved a little off the surface
  uint32_t seed[OLX_RELIT_BATCH], sequence[OLX_RELIT_BATCH];
  uint32_t slot[OLX_RELIT_BATCH];       // whose it is
  olx_vec3 irradiance[OLX_RELIT_BATCH]; // W/m^2, straight from lights
  olx_vec3 beam[OLX_RELIT_BATCH];       // luminance of it from lights without area, along the way to them
} olx_relit_batch;

static inline bool olx_relit_varies(const olx_relight_light *light) { return light->type >= OLX_RELIGHT_RECT; }

// Shadow rays that a place takes to a light.
static inline uint32_t olx_relit_samples(const olx_relight *relight, const olx_relight_light *light) {
  return olx_relit_varies(light) ? relight->settings.light_samples : 1;
}

void olx_relit_direct(olx_relight *relight, olx_relit_batch *batch);
// Shadow rays that a place takes, at most.
uint32_t olx_relit_rays(const olx_relight *relight);

// ---- Surfels (relighter_surfels.c)

// Samples that direct light of a surfel, or of a texel, is the mean of.
static inline uint32_t olx_relit_surfel_rounds(const olx_relight *r) {
  return r->varying ? OLX_RELIGHT_POINTS * 2 : OLX_RELIGHT_POINTS;
}
static inline uint32_t olx_relit_texel_rounds(const olx_relight *r) { return r->varying ? OLX_RELIT_ROUNDS : 1; }

olx_result olx_relit_surfels_create(olx_relight *relight);
void olx_relit_surfels_free(olx_relight *relight);
// Adds a sample of direct light to the surfels whose turn it is, within `rays` shadow rays; returns how many were lit.
uint32_t olx_relit_light_surfels(olx_relight *relight, uint64_t rays);
// Carries light over links to the surfels whose turn it is; returns how many they are.
uint32_t olx_relit_bounce(olx_relight *relight);
// What arrives at a surfel as specular reflections of direct light, W/m^2 (relighter_highlights.c).
olx_vec3 olx_relit_highlights(const olx_relight *relight, uint32_t surfel);

// ---- Texels (relighter_texels.c, relighter_schedule.c)

olx_result olx_relit_texels_create(olx_relight *relight);
void olx_relit_texels_free(olx_relight *relight);
void olx_relit_light_tiles(olx_relight *relight);
bool olx_relit_tile_waits(const olx_relight *relight, const olx_relit_tile *tile);
uint32_t olx_relit_tiles_waiting(const olx_relight *relight);

// The indirect irradiance of a texel, interpolated from the surfels of its site.
olx_vec3 olx_relit_told(const olx_relight *relight, uint32_t probe, uint32_t x, uint32_t y);

// ---- The volume (relighter_volume.c)

olx_result olx_relit_volume_create(olx_relight *relight);
void olx_relit_volume_free(olx_relight *relight);
// Returns how many probes were lit.
uint32_t olx_relit_light_volume(olx_relight *relight);

#endif
