// How bakes sample the surfaces behind a texel of a light field probe: by rays through the parts of the texel, from
// which those count that lie on the surface at its middle.
#ifndef OLX_SCENE_TEXEL_SAMPLES_H
#define OLX_SCENE_TEXEL_SAMPLES_H

#include "core/octahedral.h"
#include "scene/sampler.h"
#include "scene/surface.h"

enum {
  OLX_TEXEL_SALT_DIRECT = 0x44495245,
  OLX_TEXEL_LIGHT_SIDE = 4 // texels along the side of a block whose samples of lights are stratified together
};

// Offset of samples from the centres of a texel's parts: from a probe placed symmetrically in a room, rays through the
// centres would hit edges of walls exactly, where it is undetermined which wall they hit.
static inline olx_vec2 olx_texel_sample_offset(void) { return (olx_vec2){0.5078125f, 0.48828125f}; }

// Returns the direction of sample `k` of side * side in texel (x, y) of a map of n x n texels.
static inline olx_vec3 olx_texel_sample_direction(uint32_t x, uint32_t y, uint32_t n, uint32_t side, uint32_t k) {
  const olx_vec2 offset = olx_texel_sample_offset();
  const float step = 1.0f / (float)(n * side);
  const olx_vec2 uv = {((float)(x * side + k % side) + offset.x) * step,
                       ((float)(y * side + k / side) + offset.y) * step};
  return olx_octahedral_decode(uv);
}

// Returns how far samples of a texel may lie from the plane of the surface at its middle, at a distance in metres.
static inline float olx_texel_tolerance(const olx_surface *middle, float distance, uint32_t n) {
  return 0.25f * (distance * OLX_TEXEL_ANGLE / (float)n) + middle->epsilon;
}

// Returns whether a sample lies on the surface at the texel's middle: it has the same material and side, and there is
// no step in between.
static inline bool olx_texel_is_on_surface(const olx_surface *middle, const olx_surface *sample, float tolerance) {
  if (sample->material != middle->material || sample->back_face != middle->back_face) return false;
  if (sample->triangle == middle->triangle) return true;
  if (olx_dot(sample->geometric_normal, middle->geometric_normal) < 0.9f) return false;
  const olx_vec3 step = olx_sub(sample->position, middle->position);
  return fabsf(olx_dot(step, middle->geometric_normal)) <= tolerance;
}

// Returns the surface without its normal map, as light that ignores normal maps sees it.
static inline olx_surface olx_texel_smooth_surface(const olx_scene *scene, const olx_ray_hit *hit,
                                                   const olx_surface *surface) {
  olx_surface s = *surface;
  s.shading_normal = olx_surface_vertex_normal(scene, hit, surface);
  return s;
}

// Returns the sampler of the first light sample for sample `k` of a texel of a probe, which has side * side samples and
// `lights` light samples for each. Neighbouring texels divide the samples of lights among themselves.
static inline olx_sampler olx_texel_light_sampler(uint32_t probe, uint32_t seed, uint32_t x, uint32_t y, uint32_t n,
                                                  uint32_t samples, uint32_t k, uint32_t lights) {
  const uint32_t place = y % OLX_TEXEL_LIGHT_SIDE * OLX_TEXEL_LIGHT_SIDE + x % OLX_TEXEL_LIGHT_SIDE,
                 block = y / OLX_TEXEL_LIGHT_SIDE * n + x / OLX_TEXEL_LIGHT_SIDE;
  return (olx_sampler){.seed = olx_hash3(probe, block, OLX_TEXEL_SALT_DIRECT) ^ seed,
                       .index = (place * samples * samples + k) * lights};
}

#endif
