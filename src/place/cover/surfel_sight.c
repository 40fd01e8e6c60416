// Rates how well a probe sees a surfel without occlusion, by the angle at the surfel and by the size of a texel's
// footprint on it.
#include "place/cover/surfel_sight.h"

olx_sight olx_sight_create(float diagonal, float min_cosine, float max_footprint, uint32_t resolution) {
  return (olx_sight){
      .min_cosine = min_cosine,
      .max_footprint = max_footprint * diagonal,
      .texel_radians = sqrtf(4.0f * OLX_PI) / (float)resolution,
  };
}

uint8_t olx_sight_quality(const olx_sight *sight, olx_vec3 place, const olx_surfel *surfel) {
  const olx_vec3 way = olx_sub(place, surfel->position);
  const float along = olx_dot(way, surfel->normal);
  if (!(along > 0.0f)) return 0;
  const float length = olx_length(way);
  if (along < sight->min_cosine * length) return 0;
  const float footprint = length * length / along * sight->texel_radians;
  if (!(footprint <= sight->max_footprint)) return 0;
  const float good = 1.0f - sqrtf(footprint / sight->max_footprint);
  return (uint8_t)((float)OLX_QUALITY_LEAST + good * (255.0f - (float)OLX_QUALITY_LEAST));
}
