// Tests light at the end of a ray on surfaces whose material, light and lamps are known, shaded for the direction of
// the ray.
#include "analytic_field.h"
#include "core/sampling.h"
#include "field/texels.h"
#include "trace/texel_shade.h"

#include <octalux/sample.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static const analytic_scene room = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const olx_grid grid = {.origin = {-0.4f, -0.4f, -0.4f}, .spacing = {0.8f, 0.8f, 0.8f}, .count = {2, 2, 2}};
static const olx_vec3 lamp_intensity = {3.0f, 2.0f, 1.0f};
static const olx_field_light lamp = {
    .type = OLX_LIGHT_POINT, .position = {0.1f, 0.6f, -0.2f}, .emission = {3.0f, 2.0f, 1.0f}};

static olx_vec3 texel_position(const olx_field *field, uint32_t probe, size_t texel) {
  int32_t x, y;
  olx_border_source((int32_t)(texel % field->stride) - 1, (int32_t)(texel / field->stride) - 1, (int32_t)field->n, &x,
                    &y);
  const olx_vec3 direction = olx_texel_direction((uint32_t)x, (uint32_t)y, field->n);
  return olx_madd(field->probe_positions[probe], direction, olx_texel_distance(field, probe, texel));
}

// Returns the irradiance of the lamp where nothing occludes it.
static olx_vec3 lamp_irradiance(olx_vec3 position, olx_vec3 normal) {
  const olx_vec3 way = olx_sub(lamp.position, position);
  const float squared = olx_dot(way, way);
  return olx_scale(lamp_intensity, olx_max(olx_dot(way, normal), 0.0f) / (squared * sqrtf(squared)));
}

// Makes a room whose surfaces all have this material, indirect light `indirect` and, where `lit`, the lamp's light.
static olx_field *room_of(float base, float roughness, float metallic, float weight, bool lit, float indirect) {
  olx_field *field = analytic_field_make(&room, &grid, 256, 16);
  const olx_texel_material_codes codes = olx_material_pack(olx_splat(base), roughness, metallic, weight);
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    for (size_t i = 0; i < field->texels; i++) {
      const size_t at = field->texels * probe + i;
      ((uint32_t *)(uintptr_t)field->surfaces.base)[at] = codes.base;
      ((uint16_t *)(uintptr_t)field->surfaces.specular)[at] = codes.specular;
      ((uint32_t *)(uintptr_t)field->surfaces.indirect)[at] = olx_rgb9e5_pack(olx_splat(indirect));
      const olx_vec3 direct = lamp_irradiance(texel_position(field, probe, i), olx_texel_normal(field, probe, i));
      ((uint32_t *)(uintptr_t)field->surfaces.direct)[at] = olx_rgb9e5_pack(lit ? direct : olx_splat(0.0f));
    }
  }
  field->surfaces.lights = &lamp;
  field->surfaces.light_count = 1;
  return field;
}

// Returns the direction of a ray from inside the room.
static olx_vec3 ray_direction(uint32_t i) {
  const olx_vec2 random = {olx_unit_float(olx_hash2(i, 1)), olx_unit_float(olx_hash2(i, 2))};
  return olx_sample_sphere(random);
}
static const olx_vec3 eye = {0.15f, -0.1f, 0.2f};

// Returns the light of the lamp that the specular lobe reflects to the eye, computed with the reflection model.
static olx_vec3 known_highlight(const olx_bsdf *bsdf, olx_vec3 position, olx_vec3 normal, olx_vec3 direction) {
  olx_vec3 tangent, bitangent;
  olx_basis(normal, &tangent, &bitangent);
  const olx_vec3 way = olx_sub(lamp.position, position), to = olx_normalize(way), view = olx_negate(direction);
  const olx_vec3 local_view = {olx_dot(view, tangent), olx_dot(view, bitangent), olx_dot(view, normal)},
                 local_to = {olx_dot(to, tangent), olx_dot(to, bitangent), olx_dot(to, normal)};
  return olx_scale(olx_mul(olx_bsdf_specular(bsdf, local_view, local_to), lamp_intensity), 1.0f / olx_dot(way, way));
}

static void a_metal_under_a_lamp_has_its_highlight(void **state) {
  (void)state;
  olx_field *field = room_of(0.9f, 0.4f, 1.0f, 1.0f, true, 0.0f);
  const olx_bsdf bsdf = olx_texel_material(field, 0, olx_map_index(field->stride, 40, 50));
  const olx_sample_settings settings = olx_sample_settings_default();
  double error = 0.0, power = 0.0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_vec3 direction = ray_direction(i);
    const analytic_hit truth = analytic_cast(&room, eye, direction);
    const olx_trace_hit hit = olx_trace(field, &settings, eye, direction, INFINITY);
    const olx_vec3 known = known_highlight(&bsdf, olx_madd(eye, direction, truth.t), truth.normal, direction);
    const olx_vec3 off = olx_sub(olx_sub(hit.radiance, hit.lobe), known);
    error += (double)olx_dot(off, off);
    power += (double)olx_dot(known, known);
  }
  print_message("highlight of a metal: relative MSE %.5f\n", error / power);
  assert_true(power > 1.0 && error < 0.003 * power);
  analytic_field_free(field);
}

static void a_shadow_hides_the_highlight(void **state) {
  (void)state;
  olx_field *field = room_of(0.9f, 0.4f, 1.0f, 1.0f, false, 0.0f);
  const olx_sample_settings settings = olx_sample_settings_default();
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_trace_hit hit = olx_trace(field, &settings, eye, ray_direction(i), INFINITY);
    assert_int_equal(hit.status, OLX_TRACE_HIT);
    assert_true(olx_max3(hit.radiance) == 0.0f);
  }
  analytic_field_free(field);
}

// A sun that would be much brighter than what is stored does not reach the surface, and what is stored is the lamp's.
static void a_lamp_brings_no_highlight_of_a_sun_that_is_shadowed(void **state) {
  (void)state;
  olx_field *field = room_of(0.9f, 0.4f, 1.0f, 1.0f, true, 0.0f);
  const olx_vec3 to_sun = olx_normalize(olx_v3(0.5f, 0.7f, 0.3f));
  const float sun_irradiance = 1000.0f;
  const olx_field_light lights[2] = {
      lamp, {.type = OLX_LIGHT_SUN, .direction = olx_negate(to_sun), .emission = olx_splat(sun_irradiance)}};
  const olx_sample_settings settings = olx_sample_settings_default();
  uint32_t facing = 0;
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_vec3 direction = ray_direction(i);
    const olx_trace_hit alone = olx_trace(field, &settings, eye, direction, INFINITY);
    field->surfaces.lights = lights;
    field->surfaces.light_count = 2;
    const olx_trace_hit both = olx_trace(field, &settings, eye, direction, INFINITY);
    field->surfaces.lights = &lamp;
    field->surfaces.light_count = 1;
    const float unshadowed = sun_irradiance * olx_dot(to_sun, alone.normal);
    if (unshadowed < 4.0f * olx_max3(olx_texel_direct(field, alone.probe, alone.texel))) continue;
    facing++;
    assert_true(olx_max3(alone.radiance) > 0.0f);
    assert_memory_equal(&both.radiance, &alone.radiance, sizeof both.radiance);
    assert_memory_equal(&both.lobe, &alone.lobe, sizeof both.lobe);
  }
  assert_true(facing > 300);
  analytic_field_free(field);
}

// Forty lamps at the place of one, each a fortieth as strong, are the same light.
static void many_lamps_have_the_highlights_of_one_as_strong(void **state) {
  (void)state;
  enum { LAMPS = 40 };
  olx_field *field = room_of(0.9f, 0.2f, 1.0f, 1.0f, true, 0.5f);
  olx_field_light lamps[LAMPS];
  for (uint32_t i = 0; i < LAMPS; i++) {
    lamps[i] = lamp;
    lamps[i].emission = olx_scale(lamp.emission, 1.0f / LAMPS);
  }
  const olx_sample_settings settings = olx_sample_settings_default();
  double one = 0.0, many = 0.0, lobes = 0.0;
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_vec3 direction = ray_direction(i);
    const olx_trace_hit alone = olx_trace(field, &settings, eye, direction, INFINITY);
    field->surfaces.lights = lamps;
    field->surfaces.light_count = LAMPS;
    const olx_trace_hit all = olx_trace(field, &settings, eye, direction, INFINITY);
    field->surfaces.lights = &lamp;
    field->surfaces.light_count = 1;
    one += (double)olx_luminance(olx_sub(alone.radiance, alone.lobe));
    many += (double)olx_luminance(olx_sub(all.radiance, all.lobe));
    lobes += (double)olx_luminance(alone.lobe);
  }
  print_message("forty lamps: %.5f of the highlights of one\n", many / one);
  assert_true(one > lobes && fabs(many - one) < 0.001 * one);
  analytic_field_free(field);
}

// The lamp's light is not counted twice: its highlight replaces the specular lobe's share of the lamp's irradiance.
static void the_lobe_gets_what_is_not_the_lamps(void **state) {
  (void)state;
  const float indirect = 2.0f;
  olx_field *field = room_of(0.5f, 1.0f, 0.0f, 1.0f, true, indirect);
  const olx_sample_settings settings = olx_sample_settings_default();
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_vec3 direction = ray_direction(i);
    const olx_trace_hit hit = olx_trace(field, &settings, eye, direction, INFINITY);
    const olx_bsdf bsdf = olx_texel_material(field, hit.probe, hit.texel);
    const float cosine = fabsf(olx_dot(direction, hit.normal));
    const float known = olx_bsdf_specular_albedo(&bsdf, cosine).x * indirect / OLX_PI;
    // The bound allows for rounding of the stored light of the lamp, and for its position, the middle of the texel.
    const float away = olx_length(olx_sub(hit.position, lamp.position)),
                doubt = 0.03f + 3.0f * hit.footprint_metres / away;
    const olx_vec3 direct = olx_texel_direct(field, hit.probe, hit.texel);
    const float slack = olx_bsdf_specular_albedo(&bsdf, cosine).x * doubt * direct.x / OLX_PI;
    assert_true(fabsf(hit.lobe.x - known) <= 1e-5f + slack);
  }
  analytic_field_free(field);
}

// What a ray finds behind a surface reflects indirect light alone, be it the surface's own back or one that no probe
// sees: the lamp shines on the side that is stored.
static void behind_a_surface_there_is_no_direct_light(void **state) {
  (void)state;
  const float indirect = 2.0f;
  olx_field *field = room_of(0.5f, 1.0f, 0.0f, 0.0f, true, indirect);
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_vec3 direction = ray_direction(i);
    const size_t texel = olx_texel_towards(field, direction);
    const olx_vec3 position = olx_madd(field->probe_positions[0], direction, olx_texel_distance(field, 0, texel));
    const olx_texel_light front = olx_texel_shade(field, 0, texel, position, direction, false),
                          back = olx_texel_shade(field, 0, texel, position, olx_negate(direction), false),
                          vanished = olx_texel_shade(field, 0, texel, position, direction, true);
    const float albedo = olx_texel_material(field, 0, texel).albedo.x, direct = olx_texel_direct(field, 0, texel).x;
    assert_true(direct > 0.0f);
    assert_true(fabsf(front.reflected.x - albedo * (direct + indirect) / OLX_PI) <= 1e-5f * front.reflected.x);
    assert_true(fabsf(back.reflected.x - albedo * indirect / OLX_PI) <= 1e-5f * back.reflected.x);
    assert_true(vanished.reflected.x == back.reflected.x);
  }
  analytic_field_free(field);
}

// Glossy light that meets a smooth metal floor in a matte room shows the floor's reflection.
static void a_mirror_is_followed_by_one_further_ray(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&room, &grid, 256, 16);
  const olx_texel_material_codes mirror = olx_material_pack(olx_splat(0.8f), 0.0f, 1.0f, 1.0f);
  for (size_t i = 0; i < field->texels * field->info.probes.count; i++) {
    if (olx_normal_unpack(field->normal[i]).y < 0.9f) continue;
    ((uint32_t *)(uintptr_t)field->surfaces.base)[i] = mirror.base;
    ((uint16_t *)(uintptr_t)field->surfaces.specular)[i] = mirror.specular;
  }
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_bsdf bsdf = olx_material_unpack(mirror);
  double error = 0.0, power = 0.0;
  uint32_t floor_hits = 0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_vec3 direction = ray_direction(i), position = {0.999f, 0.3f * direction.x, 0.5f * direction.z};
    float weight, half_cosine;
    olx_trace_hit hit;
    // A mirror whose normal is along `direction` reflects the ray straight back, which shows the surface in that
    // direction.
    const olx_vec3 down = olx_normalize(olx_v3(-0.5f - fabsf(direction.x), -1.0f, 0.5f * direction.z));
    const olx_vec3 light =
        olx_glossy(field, &settings, position, down, down, 0.0f, (olx_vec2){0.5f, 0.5f}, &weight, &half_cosine, &hit);
    const analytic_hit first = analytic_cast(&room, position, down);
    if (first.normal.y < 0.9f) continue;
    floor_hits++;
    const olx_vec3 on_floor = olx_madd(position, down, first.t), up = olx_reflect(down, first.normal);
    const analytic_hit second = analytic_cast(&room, on_floor, up);
    if (second.normal.y > 0.9f) continue;
    const olx_vec3 seen = analytic_radiance(olx_madd(on_floor, up, second.t), second.normal);
    const olx_vec3 known = olx_mul(seen, olx_fresnel(&bsdf, -olx_dot(down, first.normal)));
    const olx_vec3 off = olx_sub(light, known);
    error += (double)olx_dot(off, off);
    power += (double)olx_dot(known, known);
  }
  print_message("mirrored light: relative MSE %.5f over %u rays\n", error / power, floor_hits);
  assert_true(floor_hits > 1000 && error < 1e-3 * power);
  analytic_field_free(field);
}

// Emission is included at the end of a further ray, and by a setting at the end of the first ray.
static void emission_is_apart_from_what_a_surface_reflects(void **state) {
  (void)state;
  olx_field *field = room_of(0.5f, 1.0f, 0.0f, 0.0f, false, OLX_PI);
  uint16_t *distance = (uint16_t *)(uintptr_t)field->distance;
  uint32_t *emission = (uint32_t *)(uintptr_t)field->surfaces.emission;
  for (size_t i = 0; i < field->texels * field->info.probes.count; i++) distance[i] |= 0x8000u;
  const size_t tiles = (size_t)field->surfaces.tile_side * field->surfaces.tile_side;
  for (size_t i = 0; i < tiles * field->info.probes.count; i++) emission[i] = 1; // 4 W/(sr m^2)
  olx_sample_settings settings = olx_sample_settings_default();
  for (int hits = OLX_HITS_SHADED; hits <= OLX_HITS_STORED; hits++) {
    settings.hits = (olx_hits)hits;
    const olx_trace_hit hit = olx_trace(field, &settings, eye, ray_direction(3), INFINITY);
    assert_true(hit.emitter);
    assert_float_equal(hit.radiance.x, 0.5f, 0.005f);
    assert_float_equal(hit.emission.x, 4.0f, 0.0f);
    for (int emitters = 0; emitters < 2; emitters++) {
      settings.emitters = emitters == 1;
      float weight, half_cosine;
      const olx_vec3 light = olx_glossy(field, &settings, eye, olx_v3(0, 1, 0), olx_v3(0, 1, 0), 0.0f,
                                        (olx_vec2){0.5f, 0.5f}, &weight, &half_cosine, NULL);
      assert_float_equal(light.x, (emitters ? 4.5f : 0.5f), 0.005f);
    }
  }
  analytic_field_free(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_metal_under_a_lamp_has_its_highlight),
      cmocka_unit_test(a_shadow_hides_the_highlight),
      cmocka_unit_test(a_lamp_brings_no_highlight_of_a_sun_that_is_shadowed),
      cmocka_unit_test(many_lamps_have_the_highlights_of_one_as_strong),
      cmocka_unit_test(the_lobe_gets_what_is_not_the_lamps),
      cmocka_unit_test(behind_a_surface_there_is_no_direct_light),
      cmocka_unit_test(a_mirror_is_followed_by_one_further_ray),
      cmocka_unit_test(emission_is_apart_from_what_a_surface_reflects),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
