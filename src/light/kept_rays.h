// What packets of rays found, kept with what they depend on, so that after an edit of the scene a packet is cast again
// only where it would find something else.
//
// A packet's rays are the same as before when its check is, which covers everything that they are drawn from. They find
// the same when no material that they met has changed, nor any emitter where they looked for light. All of this holds
// only while geometry and surfels are unchanged.
#ifndef OLX_LIGHT_KEPT_RAYS_H
#define OLX_LIGHT_KEPT_RAYS_H

#include "light/links.h"
#include "scene/scene_parts.h"
#include "work/byte_stream.h"

// One packet of a surfel's rays.
typedef struct olx_kept_packet {
  uint64_t check; // hash of what its rays are drawn from
  uint64_t needs; // slots of olx_scene_inputs
  olx_fixed_light fixed;
  uint32_t rays;     // cast in all
  uint32_t unserved; // links that end at points without a surfel
} olx_kept_packet;

// Results of a unit of cast rays for another scene, as pointers into its bytes.
typedef struct olx_former_unit {
  void *data;                    // owned
  uint64_t changed;              // slots of the scene's inputs that differ
  uint32_t count, rays, packets; // surfels, rays and packets of each
  const olx_link *links;
  const float *fixed; // NULL where rays are guided
  const olx_kept_packet *kept;
  const olx_surface_point *points;
  uint32_t *first_point; // of each packet; owned
} olx_former_unit;

// The rays of one round for another scene.
typedef struct olx_former_rays {
  olx_former_unit *units;
  uint32_t unit_count, surfel_count;
  uint32_t *place; // two for each surfel: its unit plus 1, 0 for none, and its number there
} olx_former_rays;

// A packet for another scene.
typedef struct olx_former_packet {
  const olx_kept_packet *kept; // NULL: there is none that holds
  const olx_link *links;
  const float *fixed;
  const olx_surface_point *points;
} olx_former_packet;

// Hashes the surfels, and how they are found.
uint64_t olx_surfels_hash(const olx_light_surfels *surfels);

// Saves what a unit's packets depend on, before its links. `kept` has `packets` for each surfel of the batch.
void olx_kept_rays_save(const olx_link_batch *batch, const olx_kept_packet *kept, uint64_t surfels_hash,
                        const olx_scene_inputs *inputs, olx_byte_writer *to);
// Skips what olx_kept_rays_save wrote.
void olx_kept_rays_skip(olx_byte_reader *from);

// Adds a unit as light_units.c saved it, whose bytes are taken over. Units whose surfels or surfaces differ are released
// at once.
olx_result olx_former_rays_add(olx_former_rays *former, void *data, size_t size_bytes, uint32_t surfel_count,
                               uint64_t surfels_hash, const olx_scene_inputs *inputs);
void olx_former_rays_free(olx_former_rays *former);
// Finds packet number `packet` of a surfel that has the same check and still holds. former may be NULL.
olx_former_packet olx_former_rays_find(const olx_former_rays *former, uint32_t surfel, uint32_t packet, uint64_t check);

#endif
