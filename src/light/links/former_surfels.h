// What an earlier scene, as a work folder remembers it, has in common with the scene of a bake: the bricks of space
// whose geometry differs, and which of its surfels serve the same surfaces under which number.
//
// A ray of the earlier scene finds the same when it crosses no changed brick and ends where the same surfel is found.
// Which surfel is found at a place depends on the smallest cell there that is known, on the surfels of this cell, and
// on which of its eighths are known; shadow rays between surfels cross bricks like any others.
#ifndef OLX_LIGHT_FORMER_SURFELS_H
#define OLX_LIGHT_FORMER_SURFELS_H

#include "light/links/link_batch.h"
#include "scene/scene_parts.h"
#include "scene/space_bricks.h"
#include "work/byte_stream.h"

// The scene and the surfels that rays were cast among.
typedef struct olx_surfels_name {
  uint64_t surfaces; // olx_scene_inputs.surfaces
  uint64_t surfels;  // olx_surfels_hash
} olx_surfels_name;

typedef struct olx_former_surfels {
  olx_surfels_name name; // of the earlier ones; zero where none are known
  olx_brick_set changed; // bricks
  uint32_t count;        // number of earlier surfels
  uint32_t *now;         // the number of the surfel that lies where an earlier one was; OLX_CELL_NONE: none
  uint32_t *served_by;   // the surfel that rays find now which found an earlier one; OLX_CELL_NONE: not the same
  olx_cell_table table;  // the cells of the earlier surfels
  olx_cell_table same;   // those in which the same is found now
} olx_former_surfels;

// Hashes the surfels, and how they are found.
uint64_t olx_surfels_hash(const olx_light_surfels *surfels);

// Returns the names that inputs hold.
static inline olx_surfels_name olx_surfels_name_of(const olx_scene_inputs *inputs) {
  return (olx_surfels_name){inputs->surfaces, inputs->slots[OLX_INPUT_SURFELS]};
}

static inline bool olx_surfels_same_name(const olx_surfels_name *a, const olx_surfels_name *b) {
  return a->surfaces == b->surfaces && a->surfels == b->surfels;
}

// Returns the inputs of rays among these surfels: those of the scene with the light near lamps and the surfels.
olx_scene_inputs olx_surfels_inputs(const olx_light_surfels *surfels, uint64_t surfels_hash,
                                    const olx_scene_inputs *scene);

// Saves surfels and their inputs (olx_surfels_inputs).
void olx_surfels_remember(const olx_light_surfels *surfels, const olx_scene_inputs *inputs, olx_byte_writer *to);
// Compares what olx_surfels_remember saved with the surfels and inputs of a bake. Where the bytes are damaged, or the
// bounds of the scene differ, nothing is in common, and `former` stays empty. Fails when memory runs out.
olx_result olx_former_surfels_read(olx_former_surfels *former, olx_byte_reader *from, const olx_light_surfels *now,
                                   const olx_scene_inputs *inputs);
void olx_former_surfels_free(olx_former_surfels *former);

// Returns whether a ray of the earlier scene that found `link` ends at the same now, and gives the link its surfel's
// number of now. `point` is read where the link is unserved. Without `former` the surfels are the same.
bool olx_link_still_ends(olx_link *link, const olx_surfel_point *point, const olx_former_surfels *former,
                         const olx_light_surfels *now);

#endif
