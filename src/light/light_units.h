// The solution of a scene's light while it is made: what it consists of, and its steps as units that a store can hold.
//
// Steps follow each other: rays of a round are cast, then one job settles what they found and decides on the next round. Casting is
// many units, settling one, whose result is all that is known but links.
#ifndef OLX_LIGHT_LIGHT_UNITS_H
#define OLX_LIGHT_LIGHT_UNITS_H

#include "light/scene_light.h"

enum {
  OLX_LIGHT_HIDDEN_ROUNDS = 2, // how often surfels are added where rays end without one
  OLX_LIGHT_REFINEMENTS = 3,   // how often rays are added where noise is high
  OLX_LIGHT_MOST_BATCHES = 1 + OLX_LIGHT_HIDDEN_ROUNDS + OLX_LIGHT_REFINEMENTS * 11,
  OLX_LIGHT_MOST_STEPS = 3 + OLX_LIGHT_HIDDEN_ROUNDS + OLX_LIGHT_REFINEMENTS
};

// What comes next.
typedef enum olx_scene_light_phase {
  OLX_LIGHT_EXPLORING = 0, // first rays of new surfels
  OLX_LIGHT_DIRECT,        // direct light of all surfels
  OLX_LIGHT_REFINING,      // guided rays
  OLX_LIGHT_FINISHED
} olx_scene_light_phase;

// What links that ended without a surfel became, in their order.
typedef struct olx_link_patch {
  olx_link *links;
  float *fixed;
  uint32_t count;
} olx_link_patch;

struct olx_scene_light {
  const olx_scene *scene;
  olx_scene_light_settings settings;
  const olx_vec3 *positions; // of probes, while the light is solved
  const uint8_t *flags;
  uint32_t probe_count;
  olx_scene_light_phase phase;
  uint32_t round;                                   // of casting: that comes next, or was the last
  olx_light_surfels surfels;                        // without points where they were not loaded
  uint32_t point_ends[OLX_LIGHT_HIDDEN_ROUNDS + 1]; // points there were after surfaces were found, and after each round
  olx_link_batch batches[OLX_LIGHT_MOST_BATCHES];   // without links where they were not loaded
  uint32_t rounds_of[OLX_LIGHT_MOST_BATCHES];       // round in which a batch is cast
  olx_link_patch patches[OLX_LIGHT_HIDDEN_ROUNDS];
  olx_point_list unserved; // ends of the round's rays without a surfel
  olx_light_links links;
  olx_ray_guide guide;
  olx_vec3 *direct, *irradiance; // of surfels
  olx_vec3 *passed_on;           // direct light and all bounces but the last: what the surfels' surfaces reflect
  float *noise;                  // of surfels
  uint32_t visible;    // surfels on surfaces that probes see; the others, which only pass light on, come after them
  uint32_t served;     // surfels that have rays, or get them next
  uint32_t first_rays; // of every surfel
  olx_surfel_lookup lookup;
  olx_scene_light_report report;
};

// The steps themselves (scene_light.c): the first, which finds surfaces; direct light of some surfels; and what follows when the rays of
// a round, or direct light, are there.
olx_result olx_scene_light_begin(olx_scene_light *light);
olx_result olx_scene_light_direct(olx_scene_light *light, uint32_t first, uint32_t count, uint64_t *rays);
olx_result olx_scene_light_settle(olx_scene_light *light);
// Releases what was made.
void olx_scene_light_clear(olx_scene_light *light);

// Light between two bounces, stored when the last time was a second ago.
typedef struct olx_light_checkpoint {
  olx_scene_light *light;
  uint32_t round; // of the stage "bounce"
  double last;    // seconds of the clock
  olx_bounce_state state;
} olx_light_checkpoint;

// Begins to keep the bounces of a step: all of them with `all`, or else a few.
olx_bounce_keeper olx_light_checkpoint_begin(olx_light_checkpoint *checkpoint, olx_scene_light *light, bool all);

// Makes the table by which surfels are found, or loads it.
olx_result olx_light_units_look_up(olx_scene_light *light);

// Runs all steps, or loads what the store has of them.
olx_result olx_light_units_run(olx_scene_light *light);

#endif
