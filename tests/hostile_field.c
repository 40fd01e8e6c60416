// Uses fields that may be hostile as a host would: opens, verifies, samples and relights them by choices that a seed
// decides, and aborts when a promise does not hold.
#include "hostile_field.h"

#include "core/hooks.h"
#include "export/gltf_boxes.h"
#include "export/map_texels.h"
#include "field/field_data.h"
#include "trace/texel_shade.h"

#include <octalux/octalux.h>

#include <stdio.h>
#include <stdlib.h>

enum { RAYS = 6, POINTS = 3 };

static void fail(const char *problem) {
  fprintf(stderr, "a field: broken promise: %s\n", problem);
  abort();
}

static olx_vec3 draw_point(dice *d, const olx_field *field) {
  const olx_field_info info = olx_field_describe(field);
  switch (draw_below(d, 6)) {
  case 0: return olx_field_probe_position(field, draw_below(d, info.probes.count));
  case 1: return olx_v3(extreme_float(d), extreme_float(d), extreme_float(d));
  case 2: return info.scene.bounds_min;
  default: {
    const olx_vec3 size = olx_sub(info.scene.bounds_max, info.scene.bounds_min);
    return olx_add(info.scene.bounds_min, olx_mul(size, olx_v3(draw_unit(d), draw_unit(d), draw_unit(d))));
  }
  }
}

static olx_vec3 draw_direction(dice *d) {
  switch (draw_below(d, 8)) {
  case 0: return olx_v3(0.0f, -1.0f, 0.0f);
  case 1:
    return olx_v3(draw(d) & 1u ? 1.0f : -0.0f, 0.0f, draw(d) & 1u ? 0.0f : -0.0f); // along an axis, or the zero vector
  case 2: return olx_normalize(olx_v3(1.0f, draw(d) & 1u ? 1.0f : 0.0f, -1.0f));
  case 3: return olx_v3(extreme_float(d), extreme_float(d), extreme_float(d));
  default: return olx_sample_sphere((olx_vec2){draw_unit(d), draw_unit(d)});
  }
}

static float draw_t_max(dice *d) { return draw_below(d, 3) ? INFINITY : extreme_float(d); }

static olx_sample_settings draw_settings(dice *d) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = (olx_tracer)draw_below(d, 3);
  settings.select = (olx_select)draw_below(d, OLX_SELECT_BEST + 1);
  settings.visibility = draw_below(d, 4) ? OLX_VISIBILITY_CHEBYSHEV : OLX_VISIBILITY_NONE;
  if (draw_below(d, 4) == 0) settings.max_probes = extreme_u32(d);
  settings.keep_buried = draw(d) & 1u;
  settings.emitters = draw(d) & 1u;
  settings.hits = draw(d) & 1u ? OLX_HITS_SHADED : OLX_HITS_STORED;
  return settings;
}

static void check_hit(const olx_field *field, const olx_trace_hit *hit) {
  const olx_field_info info = olx_field_describe(field);
  if ((uint32_t)hit->status > OLX_TRACE_UNKNOWN) fail("a ray without a status");
  if (hit->probe != UINT32_MAX && hit->probe >= info.probes.count) fail("a ray answered by no probe");
  if (hit->probes_tried > info.probes.count) fail("a ray asked a probe twice");
  // A ray has four pieces, each crosses a quadrant in steps along two axes, and as many blocks at most.
  if (hit->texel_steps > (uint64_t)hit->probes_tried * 16 * info.maps.size) fail("a ray took too many steps");
}

// Reads a texel of every map that the field has, and the boxes of its exported model.
static void show(dice *d, const olx_field *field) {
  olx_export_boxes boxes = {0};
  for (olx_map map = OLX_MAP_DISTANCE; map < OLX_MAP_COUNT; map++) {
    const uint32_t probe = draw_below(d, 4);
    if (olx_map_check(field, map, probe) != OLX_OK) continue;
    const uint32_t side = olx_map_side(field, map);
    (void)olx_map_texel(field, map, probe, draw_below(d, side), draw_below(d, side));
  }
  (void)(olx_export_volume_cells(field, &boxes) && olx_export_bricks(field, false, &boxes) &&
         olx_export_bricks(field, true, &boxes));
  olx_release(boxes.boxes);
}

static void use(dice *d, const olx_field *field, field_counts *c) {
  show(d, field);
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_sample_settings settings = draw_settings(d);
    const olx_vec3 origin = draw_point(d, field), direction = draw_direction(d);
    const olx_trace_hit hit = olx_trace(field, &settings, origin, direction, draw_t_max(d));
    check_hit(field, &hit);
    const uint32_t probe = draw_below(d, field->info.probes.count), texel = draw_below(d, (uint32_t)field->texels);
    const olx_texel_light seen = olx_texel_shade(field, probe, texel, origin, direction, false);
    const bool known =
        olx_finite(origin) && olx_finite(direction) && fabsf(olx_dot(direction, direction) - 1.0f) < 0.01f;
    if (known && !(olx_finite(seen.reflected) && olx_finite(seen.lobe))) fail("a texel sends light without end");
  }
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_sample_settings settings = draw_settings(d);
    const olx_vec3 position = draw_point(d, field), normal = draw_direction(d), view = draw_direction(d);
    (void)olx_irradiance(field, &settings, position, normal, view);
    float weight, half_cosine;
    const olx_vec2 random = {draw_unit(d), draw_unit(d)};
    const float roughness = draw_below(d, 4) ? draw_unit(d) : extreme_float(d);
    olx_trace_hit hit;
    (void)olx_glossy(field, &settings, position, normal, view, roughness, random, &weight, &half_cosine, &hit);
    check_hit(field, &hit);
    if (olx_classic_check(field) != OLX_OK) continue;
    (void)olx_classic_irradiance(field, &settings, position, normal);
    (void)olx_classic_glossy(field, &settings, position, normal, view, roughness, olx_splat(0.04f), 1.0f);
    c->calls += 2;
  }
  c->calls += RAYS + 2 * POINTS;
}

static bool occluded_by_chance(uint32_t i) { return olx_hash(i) & 1u; }

static void occlude_by_chance(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded) {
  (void)user;
  for (uint32_t i = 0; i < count; i++) occluded[i] = occluded_by_chance(olx_float_bits(rays[i].direction.x));
}

static olx_light draw_light(dice *d, const olx_field *field) {
  const bool wild = draw_below(d, 4) == 0;
  const float strength = wild ? extreme_float(d) : 5.0f * draw_unit(d);
  return (olx_light){.type = (olx_light_type)draw_below(d, OLX_LIGHT_SKY + 1),
                     .emission = olx_splat(strength),
                     .position = draw_point(d, field),
                     .direction = wild ? draw_direction(d) : olx_v3(0.0f, -1.0f, 0.0f),
                     .cosine_inner = draw_unit(d),
                     .cosine_outer = wild ? extreme_float(d) : -0.5f,
                     .edge_u = olx_v3(draw_unit(d), 0.0f, 0.0f),
                     .edge_v = olx_v3(0.0f, draw_unit(d), draw_unit(d)),
                     .both_sides = draw(d) & 1u};
}

static void refused(olx_result result, field_counts *c) {
  if (olx_last_error()[0] == 0) fail("a refusal without a message");
  if (result < OLX_ERROR_ARGUMENT || result > OLX_ERROR_GPU) fail("a refusal without a reason");
  c->refused[result]++;
}

// Relights a field with arbitrary lights and viewpoints, and checks that it stays as valid as it was.
static void relight(dice *d, const olx_field *field, field_counts *c) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.shadow_rays = draw_below(d, 3) ? 500 : extreme_u32(d);
  settings.surfels = draw_below(d, 3) ? 30 : extreme_u32(d);
  settings.texels = draw_below(d, 3) ? 1000 : extreme_u32(d);
  if (draw_below(d, 3) == 0) settings.volume_probes = extreme_u32(d);
  if (draw_below(d, 3) == 0) settings.light_samples = 1 + draw_below(d, 4);
  if (draw_below(d, 4) == 0) settings.light_samples = extreme_u32(d);
  if (draw_below(d, 4) == 0) settings.near_metres = extreme_float(d);
  if (draw(d) & 1u) settings.occlusion = occlude_by_chance;
  if (draw_below(d, 8) == 0) settings.sleep = extreme_float(d);
  olx_relight *relighter;
  olx_result result = olx_relight_create(field, &settings, &relighter);
  if (result != OLX_OK) {
    if (relighter) fail("a refused relighter was left");
    refused(result, c);
    return;
  }
  olx_light lights[3];
  for (uint32_t i = 0; i < 3; i++) lights[i] = draw_light(d, field);
  result = olx_relight_set_lights(relighter, lights, draw_below(d, 4));
  if (result != OLX_OK) refused(result, c);
  for (uint32_t frame = 0; frame < 3; frame++) {
    if (olx_relight_frame(relighter, draw_point(d, field), NULL) != OLX_OK) fail("a frame failed");
  }
  const olx_sample_settings sample = olx_sample_settings_default();
  (void)olx_irradiance(olx_relight_field(relighter), &sample, draw_point(d, field), draw_direction(d),
                       draw_direction(d));
  (void)olx_surface_irradiance(olx_relight_field(relighter), &sample, draw_point(d, field), draw_direction(d),
                               draw_direction(d), draw_direction(d));
  (void)olx_relight_probe_state(relighter, extreme_u32(d));
  olx_relight_free(relighter);
  c->calls += 8;
}

void hostile_field_use(dice *d, const void *bytes, size_t size_bytes, field_counts *c) {
  olx_field *field;
  olx_result result = olx_field_open_memory(bytes, size_bytes, &field);
  if (result != OLX_OK) {
    if (field) fail("a refused file left a field");
    refused(result, c);
    return;
  }
  c->opened++;
  result = olx_field_verify(field);
  if (result == OLX_OK) c->verified++;
  else refused(result, c);
  for (uint32_t i = 0; i < olx_field_describe(field).probes.count; i++) (void)olx_field_probe_buried(field, i);
  use(d, field, c);
  if (olx_field_describe(field).bytes.relight) relight(d, field, c);
  olx_field_close(field);
}
