// What rays found, kept with what they depend on, so that after an edit of the scene a ray is cast again only where it
// would find something else.
//
// The rays of a surfel are the same as before when its check is, which covers everything that they are drawn from but
// their number: a guide changes only how many there are in each of its bins (ray_guide.h). A ray finds the same when no
// material that it met has changed, nor any emitter where it looked for light, nor geometry in a brick of space that it
// crossed, nor the surfels where it ended (former_surfels.h).
#ifndef OLX_LIGHT_KEPT_RAYS_H
#define OLX_LIGHT_KEPT_RAYS_H

#include "light/links/former_surfels.h"
#include "light/links/link_batch.h"

// What one ray depends on, and what it brings without its link.
typedef struct olx_kept_ray {
  uint64_t needs;                 // slots of olx_scene_inputs
  olx_brick_set crossed;          // bricks that it and those that it continued as crossed, and those to lights
  olx_vec3 fixed[OLX_CHAIN_MOST]; // as in olx_ray_end
  olx_vec3 near;                  // the same
  uint32_t weight;                // of its link, if it counts as one of evenly drawn rays
  uint32_t cast;                  // rays cast in all, with those that it continued as and those to lights
} olx_kept_ray;

// The rays of a unit, while it is cast.
typedef struct olx_kept_rays {
  uint64_t *checks;   // one for each surfel; NULL: nothing is kept
  uint16_t *bins;     // OLX_GUIDE_BINS for each surfel, with its rays in each bin; NULL: there is no guide
  olx_kept_ray *rays; // one for each link
} olx_kept_rays;

olx_result olx_kept_rays_create(olx_kept_rays *kept, const olx_link_batch *batch);
void olx_kept_rays_free(olx_kept_rays *kept);
// Saves what a unit's rays depend on, or that nothing is kept.
void olx_kept_rays_save(const olx_kept_rays *kept, const olx_link_batch *batch, const olx_scene_inputs *inputs,
                        olx_byte_writer *to);
// Skips what olx_kept_rays_save wrote.
void olx_kept_rays_skip(olx_byte_reader *from);

// The rays of one round for another scene.
typedef struct olx_former_rays {
  const olx_former_surfels *surfels; // of that scene; NULL: none are known, and they have to be the same
  const olx_light_surfels *now;
  olx_scene_inputs inputs; // of now (olx_surfels_inputs)
  struct olx_former_unit *units;
  uint32_t unit_count;
  uint32_t *place; // two for each surfel: its unit plus 1, 0 for none, and its number there
} olx_former_rays;

// Adds a unit as light_units.c saved it, whose bytes are taken over. Units that keep nothing, or whose surfels or
// surfaces are neither those of now nor the known earlier ones, are released at once.
olx_result olx_former_rays_add(olx_former_rays *former, void *data, size_t size_bytes);
void olx_former_rays_free(olx_former_rays *former);

// The rays of a surfel for another scene, as an iterator.
typedef struct olx_former_surfel {
  const olx_former_rays *rays;
  const struct olx_former_unit *unit; // NULL: there are none that are drawn the same
  const uint16_t *bins;               // rays in each bin; NULL: all are in the first
  uint32_t bin;                       // of the ray that was asked for last
  size_t first, at;                   // the first ray of this bin, and the next ray, in the unit
  uint32_t point, light;              // the next point without a surfel, and the next light
} olx_former_surfel;

// What a ray found.
typedef struct olx_former_ray {
  bool holds;
  olx_link link;
  const olx_surfel_point *point; // where the link is unserved
  olx_kept_ray kept;
} olx_former_ray;

// Finds the rays of a surfel, if their check is the same. former may be NULL.
olx_former_surfel olx_former_rays_find(const olx_former_rays *former, uint32_t surfel, uint64_t check);
// Returns the ray at a place, which is behind those that were asked for before. It does not hold where there is none.
olx_former_ray olx_former_ray_at(olx_former_surfel *surfel, olx_ray_place place);

#endif
