// Captures what light field probes see: the surfaces' material, their direct and indirect irradiance, emission, and the
// radiance that reaches the probe.
#ifndef OLX_BAKE_SURFACE_CAPTURE_H
#define OLX_BAKE_SURFACE_CAPTURE_H

#include "bake/capture/capture.h"
#include "bake/capture/direct_merge.h"
#include "field/field_writer.h"
#include "field/geometry_map_encode.h"
#include "field/surface_encode.h"
#include "light/scene_light.h"
#include "scene/sky_guide.h"

#include <octalux/bake.h>

// One probe at a time: the maps hold the surfaces of the probe that was captured last.
typedef struct olx_surface_capture {
  olx_capture *capture;         // of the same probe, done before
  const olx_scene_light *light; // NULL: indirect light is the plain reference
  olx_gather_row *rows;         // one for each row of blocks of texels, to keep gathers; NULL: none are kept
  olx_vec3 *irradiance;         // indirect, where `light` gives it
  float last_bounce;            // share of indirect light that its last bounce adds, which radiance leaves out
  uint32_t *base, *direct, *indirect, *emission, *radiance; // `radiance` is NULL without probe light
  uint16_t *specular;
  olx_direct_estimate *estimates;
  olx_sky_guide *skies;        // one for each tile (sky_tiles.h); NULL where the sky sends no light
  olx_surface_maker tiles;     // makes tiles of the maps above, where the field stores tiles
  olx_geometry_maker geometry; // makes blocks of the geometry in `capture`, where the field stores blocks
  atomic_uint_fast64_t rays;   // cast so far
} olx_surface_capture;

// The fields up to `light` are the caller's to fill.
olx_result olx_surface_capture_create(olx_surface_capture *surfaces);
// Returns the bytes that the maps of a probe take, according to the fields described so far except `light`; `solved`
// says whether a solution of light will exist.
uint64_t olx_surface_capture_bytes(const olx_surface_capture *surfaces, bool solved);
void olx_surface_capture_free(olx_surface_capture *surfaces);

// Returns the units of progress that a probe takes, in samples of texels.
uint64_t olx_surface_capture_units(const olx_surface_capture *surfaces);

// *maps points into `surfaces`; surfaces->radiance is filled as well where the settings request it. For a probe that is
// `buried`, indirect light is taken as 0: there are no surfels inside geometry, so that each texel would have to gather
// light by rays.
olx_result olx_surface_capture_probe(olx_surface_capture *surfaces, bool buried, olx_surface_maps *maps);

// Collects the lights of a scene that have no area, as a field stores them; the caller releases *lights with
// olx_release.
olx_result olx_surface_lights(const olx_scene *scene, olx_field_light **lights);

#endif
