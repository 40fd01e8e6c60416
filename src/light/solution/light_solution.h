// The state of a solution of a scene's light while it is computed.
#ifndef OLX_LIGHT_LIGHT_SOLUTION_H
#define OLX_LIGHT_LIGHT_SOLUTION_H

#include "light/solution/light_settings.h"

enum {
  OLX_LIGHT_HIDDEN_ROUNDS = 2,   // rounds in which surfels are added where rays end without one
  OLX_LIGHT_REFINEMENTS = 3,     // rounds in which rays are added where noise is high
  OLX_LIGHT_GATHERINGS = 2,      // rounds of rays that leave no links, where noise is still high
  OLX_LIGHT_DIVISIONS = 3,       // rounds in which cells are divided where light varies
  OLX_LIGHT_MOST_RECORDS = 4,    // most records for each visible surfel, in the mean
  OLX_LIGHT_MOST_RAYS = 16384,   // most rays of a surfel with high variance in a round
  OLX_LIGHT_UNIT_RAYS = 1 << 19, // rays of a unit of casting: about one second of one processor
  OLX_LIGHT_MOST_BATCHES = 1 + OLX_LIGHT_HIDDEN_ROUNDS + OLX_LIGHT_REFINEMENTS * 11,
  OLX_LIGHT_MOST_STEPS =
      3 + OLX_LIGHT_HIDDEN_ROUNDS + OLX_LIGHT_REFINEMENTS + OLX_LIGHT_GATHERINGS + OLX_LIGHT_DIVISIONS
};

// The next phase of the solution.
typedef enum olx_scene_light_phase {
  OLX_LIGHT_EXPLORING = 0, // first rays of new surfels
  OLX_LIGHT_DIRECT,        // direct light of all surfels
  OLX_LIGHT_REFINING,      // guided rays
  OLX_LIGHT_GATHERING,     // guided rays that leave no links (final_gather.h)
  OLX_LIGHT_DIVIDING,      // light of new records (light_records.h)
  OLX_LIGHT_FINISHED
} olx_scene_light_phase;

// The places between which light is interpolated (light_records.h).
typedef struct olx_light_records {
  olx_light_surfels places; // a place for each record, and its cell; without points, and found by the lookup alone
  uint32_t *surfel_of;      // the surfel whose cell the record's is part of
  olx_vec3 *irradiance;     // W/m^2
  uint32_t lit, round;      // number of records that have light; number of the round that makes more
  olx_surfel_lookup lookup; // of the records with light
} olx_light_records;

// The replacements, in order, of links that ended without a surfel.
typedef struct olx_link_patch {
  olx_link *links;
  float *fixed;
  uint32_t count;
} olx_link_patch;

// Where the sun reaches the points of a cell: nowhere, everywhere and about evenly, or (both) neither.
enum { OLX_SUN_MISSES = 1, OLX_SUN_REACHES = 2, OLX_SUN_UNEVEN = OLX_SUN_MISSES | OLX_SUN_REACHES };

// The direct light of a surfel.
typedef struct olx_surfel_lit {
  olx_vec3 light, sky; // W/m^2: all, and the part that comes from the sky
  uint32_t sun;        // OLX_SUN_MISSES and OLX_SUN_REACHES
} olx_surfel_lit;

struct olx_scene_light {
  const olx_scene *scene;
  olx_scene_light_settings settings;
  const olx_vec3 *positions; // positions of probes, while the light is solved
  const uint8_t *flags;
  uint32_t probe_count;
  olx_scene_light_phase phase;
  uint32_t round;                                   // round of casting: the next one, or the last
  olx_light_surfels surfels;                        // without points unless they were loaded
  uint32_t point_ends[OLX_LIGHT_HIDDEN_ROUNDS + 1]; // number of points after the first surfaces were found, and after
                                                    // each round
  olx_link_batch batches[OLX_LIGHT_MOST_BATCHES];   // without links unless they were loaded
  uint32_t rounds_of[OLX_LIGHT_MOST_BATCHES];       // round in which each batch is cast
  olx_link_patch patches[OLX_LIGHT_HIDDEN_ROUNDS];
  olx_point_list unserved; // ends of the round's rays without a surfel
  olx_light_links links;
  olx_ray_guide guide;
  olx_vec3 *direct, *irradiance; // per surfel
  olx_vec3 *sky;                 // per surfel, the part of `direct` that an even sky brings; NULL: there is none
  olx_surfel_lit *lit;           // per surfel, while direct light is found
  olx_vec3 *passed_on;           // direct light and all bounces but the last, which surfels reflect to others
  float *noise;                  // per surfel
  olx_ray_sum *gathered;         // per visible surfel, of its links and final rays; NULL: there are no final rays
  olx_ray_sum *found;            // per visible surfel, of the final rays of this round
  uint32_t *final_rays;          // per visible surfel, number of final rays in this round
  uint32_t gathering;            // number of the current round of final rays
  uint32_t visible;    // number of surfels on surfaces that probes see; the others, which only pass light on, come
                       // after them
  uint32_t served;     // number of surfels that have rays or get them next
  uint32_t first_rays; // rays of each surfel in the first round
  olx_light_records records;
  olx_scene_light_report report;
  atomic_uint_fast64_t reused_rays; // rays that were not cast, because they were for another scene and still hold
};

static inline olx_surfel_direct olx_light_direct(const olx_scene_light *l) {
  return (olx_surfel_direct){l->direct, l->sky};
}

static inline const olx_ray_pool *olx_light_pool(const olx_scene_light *l, uint32_t surfel) {
  return &l->guide.pools[l->guide.pool_of[surfel]];
}

#endif
