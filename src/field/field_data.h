// A field in memory: pointers into the mapped file, ready for the runtime's inner loops. docs/format.md describes the
// file.
#ifndef OLX_FIELD_FIELD_DATA_H
#define OLX_FIELD_FIELD_DATA_H

#include "block/geometry_block.h"
#include "core/pack.h"
#include "field/pyramid.h"

#include "field/brick_data.h"
#include "field/classic_data.h"
#include "field/harmonic_data.h"
#include "field/relight_data.h"
#include "field/surface_data.h"
#include "field/volume_data.h"

#include <octalux/field.h>

#define OLX_SELECT_STORED OLX_SELECT_EXHAUSTIVE // the number of selectors that may be baked in

// Light field maps carry a one-texel border, so that filtering across its edges is exact: texel (x, y) of a probe, x
// and y from -1 to n, lies at (y + 1) * (n + 2) + x + 1.
//
// Distances are divided by distance_scale. The sign bit marks texels that see an emitter; +infinity marks the sky.
struct olx_field {
  const void *data; // the file
  size_t size_bytes;
  bool mapped; // whether the runtime mapped the file and must unmap it
  olx_field_info info;
  double origin[3]; // positions are relative to this point

  const olx_vec3 *probe_positions;
  const uint8_t *probe_flags; // OLX_PROBE_*
  const olx_vec3 *irradiance_positions;
  const uint8_t *irradiance_flags;

  uint32_t n, stride;       // info.maps.size and n + 2
  size_t texels;            // of a light field map with its border: stride * stride
  const uint32_t *radiance; // R11G11B10F, `texels` a probe; NULL without probe light, like every irradiance map
  // The geometry of light field maps, either as texels or as blocks; what the field does not hold is NULL. There are (n
  // / 4)^2 blocks a probe, without border.
  const uint16_t *normal;   // olx_normal_pack of the surface's normal, on the probe's side
  const uint16_t *distance; // half float
  const olx_geometry_block *geometry;
  olx_plane_pool planes; // of all probes
  olx_field_surfaces surfaces;
  bool relit; // surfaces and volume hold the light of changed lights; `radiance` and `irradiance` hold the bake's

  olx_pyramid_shape pyramid;
  const uint16_t *least, *greatest; // half floats: the pyramids over |distance|

  uint32_t irradiance_n, irradiance_stride;
  size_t irradiance_texels;
  const uint32_t *irradiance; // R11G11B10F, W/m^2, indirect light only, no emitters and sky; where NULL, see harmonics
  const uint16_t *harmonics;  // half floats, `harmonic_halves` a probe
  uint32_t bands, harmonic_halves; // 0 for maps
  const uint32_t *moments; // half floats: mean distance (low 16 bits), mean squared distance; the sky counts as 1

  // What the bake made for each selector in info.select_mask; NULL and 0 where it needs no data.
  const void *select_data[OLX_SELECT_STORED];
  size_t select_bytes[OLX_SELECT_STORED];
  olx_bricks bricks; // points into select_data

  olx_classic_maps classic;
  olx_relight_data relight;
  olx_volume volume;

  float distance_scale;

  char *name; // name of the file, for messages
};

static inline olx_vec3 olx_grid_position(const olx_grid *grid, uint32_t probe) {
  const uint32_t x = probe % grid->count[0], y = probe / grid->count[0] % grid->count[1],
                 z = probe / grid->count[0] / grid->count[1];
  return olx_v3(grid->origin.x + (float)x * grid->spacing.x, grid->origin.y + (float)y * grid->spacing.y,
                grid->origin.z + (float)z * grid->spacing.z);
}

#endif
