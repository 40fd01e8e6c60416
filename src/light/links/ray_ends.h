// Casts rays from surfaces, and follows each through specular reflections to the surfel whose light it carries.
#ifndef OLX_LIGHT_RAY_ENDS_H
#define OLX_LIGHT_RAY_ENDS_H

#include "light/links/link_batch.h"
#include "scene/bvh.h"
#include "scene/space_bricks.h"

// What rays are cast with.
typedef struct olx_ray_caster {
  const olx_light_surfels *surfels;
  bool ends_unserved; // rays that meet a surface without a surfel end there; otherwise they continue
  olx_ray_log *log;   // of the scene that the surfels lie in; NULL: bricks are not recorded
} olx_ray_caster;

// A scene with surfels whose rays are recorded, for one thread.
typedef struct olx_watched_surfels {
  olx_ray_log log;
  olx_bvh bvh, light_bvh;
  olx_scene scene;
  olx_light_surfels surfels;
} olx_watched_surfels;

// Has the rays of a caster recorded from here on, in `watched`.
void olx_ray_caster_watch(olx_ray_caster *caster, olx_watched_surfels *watched);

// How a ray is drawn.
typedef struct olx_ray_draw {
  olx_vec2 point;       // of the unit square, which stands for a cosine-distributed direction about the shading normal
  uint32_t seed, index; // of the random numbers beyond the first surface
} olx_ray_draw;

// Draws ray `number` in a bin of a guide's square (ray_guide.h), which depends on nothing else.
static inline olx_ray_draw olx_ray_draw_in_bin(const olx_bin_sequence *sequence, uint32_t bin, uint32_t number) {
  const uint32_t index = olx_bin_sequence_index(sequence, bin, number);
  return (olx_ray_draw){olx_bin_sequence_point(sequence, index), sequence->seed, index};
}

// What one ray brings, if it counts as one of evenly drawn rays.
typedef struct olx_ray_end {
  olx_link link;
  olx_surfel_point point;         // valid where the link is unserved
  olx_vec3 fixed[OLX_CHAIN_MOST]; // as in olx_fixed_light, without the factor pi
  olx_vec3 near;                  // a sample of the light of surfaces near lamps, in the unit of `fixed`
  uint64_t needs;                 // slots of olx_scene_inputs that it depends on
  olx_brick_set crossed;          // bricks that it depends on, where rays are recorded
  uint64_t cast;                  // rays cast for it
  bool known;                     // it need not be cast
} olx_ray_end;

static inline olx_ray_end olx_ray_end_none(void) { return (olx_ray_end){.link = {.end = OLX_LINK_NOWHERE}}; }

static inline bool olx_ray_end_is_unserved(const olx_ray_end *end) {
  return olx_link_end(&end->link) == OLX_LINK_UNSERVED;
}

// Casts up to OLX_LINK_PACKET rays of a surface, but for those whose ends are known. What a ray finds does not depend
// on which others are cast with it.
void olx_ray_ends_cast(const olx_ray_caster *caster, const olx_surface *surface, const olx_ray_draw *draws,
                       uint32_t count, olx_ray_end *ends);

// The light that surfels pass on: direct irradiance, and with it indirect irradiance of all bounces but the last of
// `bounces`.
typedef struct olx_passed_light {
  olx_surfel_direct direct;
  const olx_vec3 *all;
  uint32_t bounces;
} olx_passed_light;

// Returns the irradiance in W/m^2 that a ray brings: `factor` times what it found, and `near_factor` times its sample
// of the light of surfaces near lamps.
olx_vec3 olx_ray_end_light(const olx_ray_end *end, float factor, float near_factor, const olx_passed_light *light);

// Continues a ray that ended at a surface without a surfel by a cosine-distributed ray from there. `chain` is the
// number of surfaces that passed it on before, and `weight` what its link carried.
olx_ray_end olx_ray_end_go_on(const olx_light_surfels *surfels, const olx_surface *surface, uint32_t chain,
                              olx_vec3 weight, uint32_t seed, uint32_t index, uint64_t *rays);

#endif
