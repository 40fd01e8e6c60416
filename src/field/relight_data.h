// What a field holds so that its light can change: the diffuse reflectance of what light field probes see, surfaces that
// irradiance probes see, points on surfaces to which irradiance is fitted, and what the rays from these points meet that no
// irradiance probe sees (docs/format.md, "Relighting").
#ifndef OLX_FIELD_RELIGHT_DATA_H
#define OLX_FIELD_RELIGHT_DATA_H

#include "core/octahedral.h"

#define OLX_FIT_RAY_SKY UINT32_MAX            // a ray that meets nothing
#define OLX_FIT_RAY_UNKNOWN (UINT32_MAX - 1u) // one that meets what no irradiance probe sees
#define OLX_SURFACE_MOST (1u << 31)           // surfaces of a field

enum { OLX_FIT_MOST_POINTS = 4096, OLX_FIT_MOST_RAYS = 256, OLX_HIDDEN_MOST = 1024 };

// RLIT.
typedef struct olx_relight_header {
  uint32_t size;         // surfaces along a side of an irradiance probe's map: 16, 32, 64 or 128
  uint32_t points, rays; // points a probe, and rays from each; 0 and 0 when irradiance was not fitted
  uint32_t hidden;       // places for hidden surfaces a probe; 0 when there are none
  uint32_t zero[12];
} olx_relight_header;

_Static_assert(sizeof(olx_relight_header) == 64, "docs/format.md");

// SURF: what a probe sees through one place of a texel.
typedef struct olx_surface_sample {
  uint32_t albedo;   // R11G11B10F
  uint16_t normal;   // olx_normal_pack; what shading takes for the normal
  uint16_t distance; // half, over the distance scale; infinite for the sky
} olx_surface_sample;

_Static_assert(sizeof(olx_surface_sample) == 8, "docs/format.md");

// FITP: a point, followed by its rays, a u32 each: the index of the surface that a ray meets (size^2 a probe, then `hidden` a
// probe), or one of the two codes above.
typedef struct olx_fit_place {
  olx_vec3 position; // metres
  uint32_t normal;   // olx_normal_pack; OLX_FIT_NO_POINT: there is no point here
} olx_fit_place;

#define OLX_FIT_NO_POINT UINT32_MAX

_Static_assert(sizeof(olx_fit_place) == 16, "docs/format.md");

// HIDN: a surface that rays from points meet and no irradiance probe sees.
typedef struct olx_hidden_surface {
  olx_vec3 position; // metres; a little off the surface
  uint32_t normal;   // as of a point; OLX_FIT_NO_POINT: the place is empty
  uint32_t albedo;   // R11G11B10F
} olx_hidden_surface;

_Static_assert(sizeof(olx_hidden_surface) == 20, "docs/format.md");

// The direction in which surface (x, y) is looked for: off its texel's middle, because from probes that stand symmetrically in a
// room the middles' rays would meet edges of walls exactly.
static inline olx_vec3 olx_surface_direction(uint32_t x, uint32_t y, uint32_t size) {
  const float step = 1.0f / (float)size;
  return olx_octahedral_decode((olx_vec2){((float)x + 0.5078125f) * step, ((float)y + 0.48828125f) * step});
}

// The maps of a field, `size` 0 where there are none.
typedef struct olx_relight_maps {
  uint32_t size, points, rays, hidden;
  const uint32_t *albedo;                    // as radiance
  const olx_surface_sample *surfaces;        // size^2 a probe, row by row, without border
  const uint32_t *fit;                       // `points` times (4 + rays) words a probe
  const olx_hidden_surface *hidden_surfaces; // `hidden` a probe
} olx_relight_maps;

static inline size_t olx_fit_words(const olx_relight_maps *maps) { return 4 + (size_t)maps->rays; }

#endif
