// What a field keeps so that its light can change: albedo for light field probes; for irradiance probes the surfaces that they
// see, and, where irradiance is fitted to surfaces, the points that it is fitted to, each with the surfaces that its rays meet,
// and those of them that no irradiance probe sees.
#ifndef OLX_BAKE_RELIGHT_BAKE_H
#define OLX_BAKE_RELIGHT_BAKE_H

#include "bake/hidden_surfaces.h"
#include "bake/surface_fit.h"
#include "field/field_writer.h"

enum { OLX_RELIGHT_RAYS = OLX_FIT_RAYS }; // of the fit's points that are kept: all of them

typedef struct olx_relight_bake {
  const olx_scene *scene;
  const olx_vec3 *positions; // of irradiance probes
  const uint8_t *flags;
  const olx_grid *grid;
  uint32_t probe_count, size, threads;
  uint32_t radiance_size, samples; // of light field probes
  float distance_scale;
  olx_task *task;
  uint64_t rays;                // cast so far
  olx_surface_sample *surfaces; // size^2 a probe
  uint32_t *fit;                // words of one probe's points
  uint32_t *met;                // the surfaces that their rays meet
  olx_ray_end *ends;            // where those rays end that no probe sees there
  olx_hidden_surface *hidden;   // olx_relight_hidden of them
  const olx_surface_fit *fitted;
  uint32_t probe; // that is worked on
  olx_vec3 position;
  uint32_t *albedo; // packed, radiance_size^2
} olx_relight_bake;

// Surfaces along a side that go with irradiance maps of `irradiance_size` texels.
uint32_t olx_relight_surface_size(uint32_t irradiance_size);
// Places for hidden surfaces a probe that go with `surface_size` surfaces along a side.
uint32_t olx_relight_hidden(uint32_t surface_size);

// The fields up to `task` are the caller's to fill. Casts rays from all irradiance probes.
olx_result olx_relight_bake_create(olx_relight_bake *bake);
// The memory that it holds. It need not be created.
uint64_t olx_relight_bake_bytes(const olx_relight_bake *bake);
void olx_relight_bake_free(olx_relight_bake *bake);

// Surfaces and points of all irradiance probes, to the file. `fit` may be NULL.
olx_result olx_relight_bake_write(olx_relight_bake *bake, const olx_surface_fit *fit, olx_field_writer *writer);

// The albedo map of a light field probe, into bake->albedo.
olx_result olx_relight_bake_albedo(olx_relight_bake *bake, olx_vec3 position);

#endif
