// Changing lights while a program runs: a field's maps are lit anew a few probes a frame, from what the probes stored when they
// were baked (`olx_bake_settings.relight`, `octalux bake --relight`). Per-frame updates of the dissertation of 2022, section 6.2.
//
// A relighter keeps radiance and irradiance maps of its own beside a field that stays as it is. In a frame, surfaces that the
// scheduled probes see get the direct light of the lights given last, with shadows, and reflect the irradiance of the frame
// before; from those surfaces come new irradiance maps. So every frame carries light one bounce further, and many frames
// converge to many bounces. Hidden surfaces, which light what probes see but are seen by none, are lit with the probe next to
// them. Geometry does not change, and neither does what is seen of emitters and of the sky themselves.
// Surfaces reflect like matte ones with the same average albedo (docs/relighting.md).
//
// Threads: calls on one relighter must not overlap, and nobody may sample its field during olx_relight_frame; frames use
// several threads themselves. Results do not depend on how many.
#ifndef OCTALUX_RELIGHT_H
#define OCTALUX_RELIGHT_H

#include <octalux/base.h>
#include <octalux/field.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_relight olx_relight;

typedef enum olx_relight_light_type {
  OLX_RELIGHT_SUN = 0,
  OLX_RELIGHT_POINT,
  OLX_RELIGHT_SPOT,
  OLX_RELIGHT_RECT,     // a parallelogram
  OLX_RELIGHT_TRIANGLE, // half of one
  OLX_RELIGHT_SKY       // the same radiance from wherever a ray meets nothing
} olx_relight_light_type;

typedef struct olx_relight_light {
  olx_relight_light_type type;
  olx_vec3 emission;  // sun: irradiance on a surface facing it; point, spot: radiant intensity; others: radiance
  olx_vec3 position;  // metres; point, spot; a corner of rect and triangle
  olx_vec3 direction; // of travel, unit: sun, spot
  float cosine_inner, cosine_outer; // spot: full light inside, none outside, smooth between
  olx_vec3 edge_u, edge_v;          // rect, triangle: from the corner; they shine on the side of edge_u x edge_v
  bool both_sides;                  // rect, triangle: and on the other
} olx_relight_light;

// From a surface towards a light.
typedef struct olx_shadow_ray {
  olx_vec3 origin;     // metres, a little off the surface
  olx_vec3 direction;  // unit
  float length_metres; // infinite for sun and sky
} olx_shadow_ray;

// Whether anything lies on each of `count` rays: occluded[i] becomes 1 or 0. Called from several threads at once. A host answers
// from its shadow maps or its ray caster; olx_scene_occlusion (octalux/scene.h) is one.
typedef void (*olx_occlusion)(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded);

typedef struct olx_relight_settings {
  uint32_t surface_texels;  // of irradiance probes, with hidden surfaces, lit anew in a frame, rounded up to whole probes;
                            // default 262144
  uint32_t radiance_texels; // of light field probes, rounded up to 1024; 0: radiance stays as it is; default 65536
  uint32_t light_samples;   // shadow rays a texel to each light with an area and to the sky, 1 to 64; default 1
  uint32_t fit_steps; // of conjugate gradients a frame, by which irradiance is fitted to surfaces, 0 to 64; default 6
  float history;      // share of a probe's earlier irradiance that an update keeps, 0 to 0.95; default 0
  float sleep;        // probes that get less than this share of new light sleep, 0 to 1; default 0.004
  float
      near_metres; // probes nearer to the eye are updated most often; at each doubling of the distance half as often, at
                   // least an eighth; 0, the default: an eighth of the scene's diagonal
  olx_occlusion occlusion; // NULL, the default: shadow rays are traced through the field, and light of hidden surfaces is
                           // guessed
  void *user;              // handed to it
  uint32_t threads;        // 0: as many as the machine has
} olx_relight_settings;

olx_relight_settings olx_relight_settings_default(void);

// OLX_ERROR_ARGUMENT, with a message, for settings out of range and for a field that was baked without what relighting needs;
// OLX_ERROR_FORMAT when the field's surfaces contradict themselves. The field must outlive the relighter. On success *relight is
// the caller's to free, on failure it is NULL. It takes some 10 ms an irradiance probe.
olx_result olx_relight_create(const olx_field *field, const olx_relight_settings *settings, olx_relight **relight);
// NULL is allowed.
void olx_relight_free(olx_relight *relight);

// All lights there are from now on, copied. They replace those of the bake and those given before; probes wake. At most 256.
olx_result olx_relight_set_lights(olx_relight *relight, const olx_relight_light *lights, uint32_t count);

// What a frame did.
typedef struct olx_relight_stats {
  uint32_t irradiance_probes;    // updated
  uint64_t surface_texels;       // of them, with hidden surfaces
  uint64_t radiance_texels;      // of light field probes
  uint64_t shadow_rays, lookups; // lookups: of irradiance
  uint32_t awake;                // probes of both kinds that wait, after the frame
  double seconds;                // of the clock
} olx_relight_stats;

// One frame, seen from `eye` (metres). stats may be NULL. When no probe is awake nothing is done. OLX_ERROR_ARGUMENT once frames are
// made on a device (octalux/vulkan.h, olx_vulkan_relight_create); the field below then stays as it was.
olx_result olx_relight_frame(olx_relight *relight, olx_vec3 eye, olx_relight_stats *stats);

// The field with its radiance and irradiance as they are now: for octalux/sample.h and octalux/render.h. It belongs to the
// relighter, must not be closed, and changes with olx_relight_frame.
const olx_field *olx_relight_field(const olx_relight *relight);

// How a probe stands in the schedule.
typedef struct olx_relight_state {
  uint32_t updates;    // since the relighter was made; of a light field probe: whole passes over its map
  uint32_t last_frame; // that changed it, counted from 1; 0: none yet
  uint32_t waited;     // frames since then, or since it woke
  bool awake;
} olx_relight_state;

// The state of a probe of each kind; all 0 for an index that no probe has.
olx_relight_state olx_relight_irradiance_state(const olx_relight *relight, uint32_t probe);
olx_relight_state olx_relight_radiance_state(const olx_relight *relight, uint32_t probe);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
