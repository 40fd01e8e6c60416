// Changing lights while a program runs: every frame renews a part of a field's light, from data stored by the bake
// (`olx_bake_settings.relight`, `octalux bake --relight`). These are the per-frame updates that the dissertation of
// 2022 proposes in section 6.2, on the links between surfaces that the bake found.
//
// A relighter keeps light of its own beside a field that does not change: the light of surfels, which are points on the
// scene's surfaces, and of the texels and the irradiance volume that surfels light. In a frame, surfels get the direct
// light of the current lights, with shadows, and links between surfels carry light one surface further. Then the texels
// nearest to the eye receive light from the surfels. Geometry does not change, and neither does the visible emission of
// emitters and of the sky. Probe light (radiance as probes saw it, and irradiance probes) keeps the light of the bake
// (docs/relighting.md).
//
// Threads: calls on one relighter must not overlap, and no other thread may sample its field during olx_relight_frame
// or olx_relight_set_lights. Frames use several threads; results do not depend on how many.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_RELIGHT_H
#define OCTALUX_RELIGHT_H

#include <octalux/base.h>
#include <octalux/field.h>
#include <octalux/light.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_relight olx_relight;

// A ray from a surface towards a light.
typedef struct olx_shadow_ray {
  olx_vec3 origin;     // metres, slightly off the surface
  olx_vec3 direction;  // unit
  float length_metres; // infinite for sun and sky
} olx_shadow_ray;

// Tests whether anything lies on each of `count` rays: occluded[i] becomes 1 or 0. Called from several threads at once.
// A host implements it by its shadow maps or its ray caster; olx_scene_occlusion (octalux/scene.h) is an example.
typedef void (*olx_occlusion)(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded);

// The budgets of a frame. Remaining work waits for later frames, and none waits forever.
typedef struct olx_relight_settings {
  uint32_t shadow_rays;   // at least 1; a whole tile of texels may exceed it; default 262144
  uint32_t surfels;       // surfels that gather light from others, at least 1; default 131072
  uint32_t texels;        // of light field probes whose light is renewed, rounded up to tiles of 32 x 32, at least 1;
                          // default 524288
  uint32_t volume_probes; // probes of the irradiance volume, at least 1; default 4096
  uint32_t light_samples; // shadow rays from a place to each light with an area and to the sky, 1 to 64; default 1
  float sleep;            // light that changes by less than this share has settled, 0 to 1; default 0.002
  float near_metres; // what is nearer to the eye is renewed most often; at each doubling of the distance half as often,
                     // at least an eighth; 0, the default: an eighth of the scene's diagonal
  olx_occlusion occlusion; // NULL, the default: shadow rays are traced through the field
  void *user;              // passed to it
  uint32_t threads;        // 0: as many as the machine has
} olx_relight_settings;

olx_relight_settings olx_relight_settings_default(void);

// Creates a relighter. OLX_ERROR_ARGUMENT, with a message, for settings out of range and for a field baked without the
// data for relighting. The field must outlive the relighter. On success the caller must free *relight, on failure it is
// NULL. It takes 8 bytes a texel of light field maps and 84 a surfel.
olx_result olx_relight_create(const olx_field *field, const olx_relight_settings *settings, olx_relight **relight);
// Frees a relighter. NULL is allowed.
void olx_relight_free(olx_relight *relight);

// Sets all lights from now on, at most 256, which are copied. They replace the lights of the bake and those of earlier
// calls. Before the first call nothing waits, and the field has the light of the bake; no lights (count 0) make it
// dark. Previous light stays until it is replaced. With more than 64 suns, points and spots, rays find no single
// highlights of them where they end (docs/maths.md). Rays of point and spot lights, at most 256 of each, are traced
// through the field to find the surfaces near them. OLX_ERROR_ARGUMENT, with a message, for too many lights and for a
// light out of range (octalux/light.h), OLX_ERROR_MEMORY when memory runs out; the lights then stay as they were.
olx_result olx_relight_set_lights(olx_relight *relight, const olx_light *lights, uint32_t count);

// The work that a frame did.
typedef struct olx_relight_stats {
  uint32_t surfels_lit, surfels_gathered; // got a sample of direct light; gathered light from others
  uint64_t texels;                        // of light field probes
  uint32_t volume_probes;
  uint64_t shadow_rays;
  uint32_t awake; // tiles, surfels and volume probes that wait after the frame; 0: all light has settled
  double seconds; // of the clock
} olx_relight_stats;

// Runs one frame, seen from `eye` (metres). stats may be NULL. Does nothing when nothing is awake. OLX_ERROR_ARGUMENT
// once frames run on a device (octalux/vulkan.h, olx_vulkan_relight_create), and OLX_ERROR_CANCELLED when a progress
// around it (octalux/base.h, olx_watch) was cancelled before it began; the field below and *stats then stay as they
// were. A frame that has begun is completed.
olx_result olx_relight_frame(olx_relight *relight, olx_vec3 eye, olx_relight_stats *stats);

// Returns the field with its present light, for octalux/sample.h and octalux/render.h. It belongs to the relighter,
// must not be closed, and changes with olx_relight_frame and olx_relight_set_lights. Once frames run on a device
// (octalux/vulkan.h, olx_vulkan_relight_create), only its list of lights still changes.
const olx_field *olx_relight_field(const olx_relight *relight);

// The state of a light field probe in the schedule.
typedef struct olx_relight_state {
  uint32_t last_frame;    // the last one that changed a part of its map, counted from 1; 0: none yet
  uint32_t tiles_waiting; // parts of its map that wait
  uint32_t waited;        // the most frames that one of them has waited
} olx_relight_state;

// Returns the state of a light field probe; all 0 for an index without a probe.
olx_relight_state olx_relight_probe_state(const olx_relight *relight, uint32_t probe);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
