// The light of the irradiance volume: irradiance at its probes from the solved light of the scene.
#ifndef OLX_BAKE_VOLUME_LIGHT_H
#define OLX_BAKE_VOLUME_LIGHT_H

#include "core/parallel.h"
#include "field/volume_data.h"
#include "light/ray_light.h"

typedef struct olx_volume_light {
  const olx_scene *scene;
  const olx_scene_light *light;
  uint32_t rays; // a probe
  uint32_t seed, threads;
  olx_task *task;
  uint64_t rays_cast; // set
} olx_volume_light;

// Computes the irradiance of `count` probes, OLX_VOLUME_HALVES numbers each.
olx_result olx_volume_light_make(olx_volume_light *volume, const olx_vec3 *positions, uint32_t count,
                                 uint16_t *irradiance);

// Finds the share of the surfaces that probes at `positions` with flags[i] == 0 see, by solid angle, at which the
// volume has no cell.
olx_result olx_volume_unserved(const olx_scene *scene, const olx_volume *volume, const olx_vec3 *positions,
                               const uint8_t *flags, uint32_t count, uint32_t threads, double *share);

#endif
