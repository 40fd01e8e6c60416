// The light of the irradiance volume.
#ifndef OLX_RELIGHT_RELIT_VOLUME_H
#define OLX_RELIGHT_RELIT_VOLUME_H

#include "field/field_data.h"
#include "relight/relit_turns.h"

typedef struct olx_relit_volume {
  const olx_relight_data *data;
  uint16_t *irradiance; // OLX_VOLUME_HALVES a probe
} olx_relit_volume;

// Creates a volume with the light of the bake.
olx_result olx_relit_volume_create(const olx_field *source, olx_relit_volume *volume);
void olx_relit_volume_free(olx_relit_volume *volume);

// Lights the probes whose turn it is, from the direct plus indirect irradiance of each surfel, W/m^2.
void olx_relit_light_volume(olx_relit_volume *volume, uint32_t threads, const olx_vec3 *surfels,
                            const olx_relit_volume_turns *turns);

#endif
