// Evaluates classic maps, irradiance probes without visibility: trilinear irradiance, and prefiltered radiance with
// parallax corrected by a box, times a tabulated reflectance. Its twin is shaders/lib/classic.glsl.
#include "shade/classic.h"

#include "core/result.h"
#include "shade/irradiance.h"

olx_result olx_classic_check(const olx_field *field) {
  if (field->classic.size) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: baked without classic maps (octalux bake --classic adds them)", field->name);
}

// Returns the length of a ray along one axis until it leaves [low, high].
static float way_out(float low, float high, float from, float direction) {
  if (direction == 0.0f) return INFINITY;
  return ((direction > 0.0f ? high : low) - from) / direction;
}

olx_vec3 olx_classic_parallax(const olx_classic_box *box, olx_vec3 probe, olx_vec3 position, olx_vec3 direction) {
  const olx_vec3 from = olx_min_each(olx_max_each(position, box->low), box->high);
  const float x = way_out(box->low.x, box->high.x, from.x, direction.x),
              y = way_out(box->low.y, box->high.y, from.y, direction.y),
              z = way_out(box->low.z, box->high.z, from.z, direction.z);
  const float t = olx_min(x, olx_min(y, z));
  const olx_vec3 seen = olx_sub(olx_madd(from, direction, t), probe);
  const float length = olx_length(seen);
  return length > 0.0f && length < INFINITY ? olx_scale(seen, 1.0f / length) : direction;
}

static olx_vec3 map_color(const uint32_t *map, const olx_bilinear *b) {
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < 4; i++) sum = olx_madd(sum, olx_r11g11b10f_unpack(map[b->index[i]]), b->weight[i]);
  return sum;
}

olx_vec2 olx_classic_reflectance(const uint32_t *table, float cosine, float roughness) {
  const float last = (float)(OLX_CLASSIC_TABLE_SIDE - 1);
  const float x = sqrtf(olx_clamp(cosine, 0.0f, 1.0f)) * last, y = olx_clamp(roughness, 0.0f, 1.0f) * last;
  const float x0 = olx_min(floorf(x), last - 1.0f), y0 = olx_min(floorf(y), last - 1.0f);
  const uint32_t *first = table + (uint32_t)y0 * OLX_CLASSIC_TABLE_SIDE + (uint32_t)x0;
  olx_vec2 sum = {0};
  for (uint32_t i = 0; i < 4; i++) {
    const uint32_t code = first[(i >> 1) * OLX_CLASSIC_TABLE_SIDE + (i & 1u)];
    const float weight = (i & 1u ? x - x0 : 1.0f - (x - x0)) * (i >> 1 ? y - y0 : 1.0f - (y - y0));
    sum.x += weight * olx_half_unpack((uint16_t)code);
    sum.y += weight * olx_half_unpack((uint16_t)(code >> 16));
  }
  return sum;
}

olx_vec3 olx_classic_radiance(const olx_classic_maps *maps, uint32_t probe, olx_vec3 direction, float roughness) {
  const uint32_t *record = maps->radiance + maps->radiance_texels * probe;
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const float level = olx_clamp(roughness, 0.0f, 1.0f) * (float)(OLX_CLASSIC_LEVELS - 1);
  const uint32_t below = (uint32_t)olx_min(level, (float)(OLX_CLASSIC_LEVELS - 2));
  const olx_bilinear fine = olx_bilinear_at(uv, olx_classic_side(maps->size, below)),
                     coarse = olx_bilinear_at(uv, olx_classic_side(maps->size, below + 1));
  return olx_mix3(map_color(record + maps->level_first[below], &fine),
                  map_color(record + maps->level_first[below + 1], &coarse), level - (float)below);
}

// Weighs probes trilinearly; of the tests of visibility it keeps only that of buried probes (inside geometry).
static olx_irradiance_weights weigh(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                                    olx_vec3 normal) {
  const olx_irradiance_source source = olx_irradiance_source_of(field);
  return olx_irradiance_weigh(&source, OLX_WEIGHT_TRILINEAR, settings->keep_buried, position, normal, normal);
}

olx_vec3 olx_classic_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                                olx_vec3 normal) {
  const olx_classic_maps *maps = &field->classic;
  if (!maps->size) return olx_splat(0.0f);
  const olx_irradiance_weights weights = weigh(field, settings, position, normal);
  const olx_bilinear texels = olx_bilinear_at(olx_octahedral_encode(normal), maps->size);
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < weights.count; i++) {
    const uint32_t *map = maps->irradiance + maps->irradiance_texels * weights.probe[i];
    sum = olx_madd(sum, map_color(map, &texels), weights.weight[i]);
  }
  return sum;
}

olx_vec3 olx_classic_glossy(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                            olx_vec3 normal, olx_vec3 view, float roughness, olx_vec3 f0, float f90) {
  const olx_classic_maps *maps = &field->classic;
  if (!maps->size) return olx_splat(0.0f);
  const olx_irradiance_weights weights = weigh(field, settings, position, normal);
  const olx_vec3 reflected = olx_reflect(olx_negate(view), normal);
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < weights.count; i++) {
    const uint32_t probe = weights.probe[i];
    const olx_vec3 towards =
        olx_classic_parallax(&maps->boxes[probe], field->irradiance_positions[probe], position, reflected);
    sum = olx_madd(sum, olx_classic_radiance(maps, probe, towards, roughness), weights.weight[i]);
  }
  const olx_vec2 reflectance = olx_classic_reflectance(maps->table, olx_dot(normal, view), roughness);
  return olx_mul(sum, olx_add(olx_scale(f0, reflectance.x), olx_splat(f90 * reflectance.y)));
}
