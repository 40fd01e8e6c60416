// What the rays of gathers found (scene_light.h), kept with what they depend on, so that after an edit of the scene
// only rays that would find something else are cast again (kept_rays.h). The gathers of a row of texels are kept in
// order.
#ifndef OLX_LIGHT_KEPT_GATHERS_H
#define OLX_LIGHT_KEPT_GATHERS_H

#include "light/links/former_surfels.h"

enum { OLX_GATHER_RAYS = 256 }; // of a gather

// Light that a ray of a gather brings without its link, after `surfaces` + 1 surfaces; OLX_CHAIN_MOST: its sample of
// surfaces near lamps.
typedef struct olx_gather_light {
  uint16_t ray, surfaces;
  olx_vec3 light;
} olx_gather_light;

// What rays of one kind depend on.
typedef struct olx_gather_kind {
  uint64_t needs;        // slots of olx_scene_inputs
  olx_brick_set crossed; // bricks
} olx_gather_kind;

// One gather, as it is kept.
typedef struct olx_kept_gather {
  const uint16_t *bins;  // OLX_GUIDE_BINS: rays in each bin of directions
  const olx_link *links; // OLX_GATHER_RAYS, bin by bin
  const uint8_t *kinds;  // the same
  const uint64_t *needs; // slots of olx_scene_inputs, of each kind of ray
  const uint8_t *bricks; // of each kind: how many, and their numbers
  const olx_gather_light *lights;
  uint32_t kind_count, light_count, brick_count; // brick_count: bytes of `bricks`
} olx_kept_gather;

// The gathers of one row. Zero-initialize.
typedef struct olx_gather_row {
  olx_byte_writer kept;
  olx_byte_reader former;            // reads gathers kept for another scene, from the first that was not passed yet
  uint64_t changed;                  // slots that differ from that scene's
  uint64_t rays, reused;             // first rays of all gathers, and those that were not cast
  const olx_former_surfels *earlier; // that scene's surfels; NULL: they are the same
} olx_gather_row;

// Finds the next gather with this check, which covers everything that its rays are drawn from but their number in each
// bin; returns false where there is none near.
bool olx_gather_row_find(olx_gather_row *row, uint64_t check, olx_kept_gather *gather);
void olx_gather_row_keep(olx_gather_row *row, uint64_t check, const olx_kept_gather *gather);

// Most bytes that the bricks of a kind take.
enum { OLX_KIND_BYTES = 64 };
// Writes a set's bricks as a kind's, and returns the number of bytes. A set that does not fit is written as empty, and
// *needs becomes everything.
uint32_t olx_gather_write_bricks(const olx_brick_set *set, uint8_t bytes[OLX_KIND_BYTES], uint64_t *needs);
// Reads the kinds of a gather, of which there are at most 256; returns false when they are damaged.
bool olx_gather_read_kinds(const olx_kept_gather *gather, olx_gather_kind *kinds);

#endif
