// Tests the solved light of a lamp in its fixture: light that arrives from surfaces close to a lamp without area, on
// walls, beside the fixture and in the irradiance volume, and the rays that it costs.
#include "bake/volume/volume_light.h"
#include "core/harmonics.h"
#include "field/harmonic_data.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "solved_rooms.h"

static const float plate_side = 0.1f, lamp_gap = 0.01f, lamp_height = 0.7f;

// Makes a room of side 2 with a lamp without area, one centimetre below a plate of albedo 0.5, and a smooth metal.
static olx_scene *fixture_room(float wall_albedo) {
  olx_scene *scene = made_scene();
  olx_material wall = olx_material_default(), plate = wall, metal = wall;
  wall.base_color = olx_splat(wall_albedo);
  plate.base_color = olx_splat(0.5f);
  metal.base_color = olx_splat(wall_albedo);
  metal.metallic = metal.specular_weight = 1.0f;
  metal.roughness = 0.1f;
  made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &wall));
  made_quad(scene, olx_v3(0.0f, lamp_height + lamp_gap, 0.0f), olx_v3(plate_side, 0.0f, 0.0f),
            olx_v3(0.0f, 0.0f, plate_side), made_material(scene, &plate));
  made_quad(scene, olx_v3(-0.99f, 0.0f, 0.0f), olx_v3(0.0f, 1.0f, 0.0f), olx_v3(0.0f, 0.0f, 1.0f),
            made_material(scene, &metal));
  const olx_light lamp = {
      .type = OLX_LIGHT_POINT, .position = olx_v3(0.0f, lamp_height, 0.0f), .emission = olx_splat(1.0f)};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  return made_finish(scene);
}

// Returns the power that the plate catches, for an intensity of 1: the solid angle of the plate.
static float caught_by_plate(void) {
  const float half = 0.5f * plate_side;
  return 4.0f * atanf(half * half / (lamp_gap * sqrtf(2.0f * half * half + lamp_gap * lamp_gap)));
}

// The plate reflects half of the light that it catches, to a black room like a small lamp of that power.
static void the_light_of_a_fixture_is_all_there(void **state) {
  (void)state;
  olx_scene *scene = fixture_room(0.0f);
  olx_scene_light *light = solve_room(scene, 0.02f);
  const float height = 1.0f + lamp_height + lamp_gap, caught = caught_by_plate();
  double found = 0.0, wanted = 0.0;
  for (uint32_t i = 0; i < 16; i++) {
    const olx_vec2 uv = olx_hammersley(i, 16);
    const olx_vec3 from = {uv.x - 0.5f, 0.0f, uv.y - 0.5f};
    const olx_ray ray = {from, olx_v3(0.0f, -1.0f, 0.0f), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface floor = olx_surface_at(scene, &hit, ray.direction);
    const float squared = from.x * from.x + from.z * from.z + height * height;
    found += (double)olx_luminance(olx_scene_light_irradiance(light, &floor));
    wanted += (double)(0.5f * caught / OLX_PI * height * height / (squared * squared));
  }
  print_message("light of the fixture: %.4f of what it reflects\n", found / wanted);
  assert_true(fabs(found / wanted - 1.0) < 0.03);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// Rays that meet the plate beside the lamp, or the lamp's image in the metal, would bring thousands of times the mean.
static void a_lamp_in_its_fixture_costs_few_rays(void **state) {
  (void)state;
  olx_scene *scene = fixture_room(0.5f);
  olx_scene_light *light = solve_room(scene, 0.04f);
  const olx_scene_light_report report = olx_scene_light_describe(light);
  print_message("noise %.4f with %.2f million rays\n", report.noise, (double)report.rays * 1e-6);
  assert_true(report.noise <= 0.04);
  assert_true(report.rays < 300000);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// A probe of the volume in a black room sees the lit plate alone, which is so bright beside the lamp that the rays that
// happen to end there would decide the light.
static void the_volume_has_the_light_of_a_fixture(void **state) {
  (void)state;
  enum { PROBES = 16 };
  olx_scene *scene = fixture_room(0.0f);
  olx_scene_light *light = solve_room(scene, 0.02f);
  olx_volume_light volume = {.scene = scene, .light = light, .rays = 256};
  olx_vec3 places[PROBES];
  uint16_t halves[PROBES * OLX_VOLUME_HALVES];
  for (uint32_t i = 0; i < PROBES; i++) places[i] = olx_v3(0.3f, -0.2f - 0.04f * (float)i, 0.2f);
  assert_int_equal(olx_volume_light_make(&volume, places, PROBES, halves), OLX_OK);
  double worst = 0.0;
  for (uint32_t i = 0; i < PROBES; i++) {
    const olx_vec3 way = olx_sub(olx_v3(0.0f, lamp_height + lamp_gap, 0.0f), places[i]);
    float values[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_normalize(way), values);
    const float found = olx_harmonics_irradiance(halves + OLX_VOLUME_HALVES * i, OLX_VOLUME_BANDS, values).x;
    const float squared = olx_dot(way, way), cosine = way.y / sqrtf(squared);
    // Three bands of harmonics make the light of one direction 17/16 as bright as it is.
    const float wanted = 17.0f / 16.0f * 0.5f * caught_by_plate() / OLX_PI * cosine / squared;
    worst = fmax(worst, fabs((double)(found / wanted) - 1.0));
  }
  print_message("light of the fixture in the volume: off by %.4f at most\n", worst);
  assert_true(worst < 0.1);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

enum { PLACES = 64 };

// Returns a place up to 4 cm below the plate and beside the lamp.
static olx_vec3 place_beside(uint32_t i) {
  const olx_vec2 uv = olx_hammersley(i, PLACES);
  return olx_v3(0.02f + 0.02f * uv.x, lamp_height + lamp_gap - 0.01f - 0.03f * uv.y, 0.02f * uv.y - 0.01f);
}

// What the plate sends to a place, as irradiance about +y, and as what three bands of harmonics make of that.
typedef struct plate_light {
  float irradiance, harmonics;
} plate_light;

static plate_light light_of_plate(olx_vec3 place) {
  enum { STEPS = 100 };
  const float step = plate_side / STEPS;
  plate_light sum = {0};
  for (uint32_t i = 0; i < STEPS * STEPS; i++) {
    const olx_vec3 at = {step * ((float)(i % STEPS) + 0.5f) - 0.5f * plate_side, lamp_height + lamp_gap,
                         step * ((float)(i / STEPS) + 0.5f) - 0.5f * plate_side};
    const float away = sqrtf(at.x * at.x + at.z * at.z + lamp_gap * lamp_gap);
    const float radiance = 0.5f / OLX_PI * lamp_gap / (away * away * away);
    const olx_vec3 way = olx_sub(at, place);
    const float squared = olx_dot(way, way), cosine = way.y / sqrtf(squared);
    const float arriving = radiance * step * step * cosine / squared;
    sum.irradiance += cosine * arriving;
    sum.harmonics += (0.25f + 0.5f * cosine + 5.0f / 32.0f * (3.0f * cosine * cosine - 1.0f)) * arriving;
  }
  return sum;
}

// A few centimetres from the plate its points bring only a part of its light, which stays bounded, and rays that end on
// the plate the rest. Points alone brought 0.61 of this light.
static void nothing_is_lost_beside_a_fixture(void **state) {
  (void)state;
  olx_scene *scene = fixture_room(0.0f);
  olx_scene_light *light = solve_room(scene, 1.0f);
  const olx_ray up = {olx_splat(0.0f), olx_v3(0.0f, 1.0f, 0.0f), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &up);
  olx_surface surface = olx_surface_at(scene, &hit, up.direction);
  surface.geometric_normal = surface.shading_normal = up.direction;
  olx_volume_light volume = {.scene = scene, .light = light, .rays = 1024};
  olx_vec3 places[PLACES];
  uint16_t halves[PLACES * OLX_VOLUME_HALVES];
  float values[OLX_HARMONICS_MOST];
  double on_surfaces = 0.0, in_volume = 0.0, wanted = 0.0, wanted_in_volume = 0.0;
  for (uint32_t i = 0; i < PLACES; i++) places[i] = place_beside(i);
  assert_int_equal(olx_volume_light_make(&volume, places, PLACES, halves), OLX_OK);
  olx_harmonics_at(up.direction, values);
  for (uint32_t i = 0; i < PLACES; i++) {
    const plate_light truth = light_of_plate(places[i]);
    surface.position = places[i];
    on_surfaces += (double)olx_luminance(olx_scene_light_irradiance(light, &surface));
    in_volume += (double)olx_harmonics_irradiance(halves + OLX_VOLUME_HALVES * i, OLX_VOLUME_BANDS, values).x;
    wanted += (double)truth.irradiance;
    wanted_in_volume += (double)truth.harmonics;
  }
  on_surfaces /= wanted;
  in_volume /= wanted_in_volume;
  print_message("beside the fixture: %.4f of its light on surfaces, %.4f in the volume\n", on_surfaces, in_volume);
  assert_true(fabs(on_surfaces - 1.0) < 0.03);
  assert_true(fabs(in_volume - 1.0) < 0.03);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_light_of_a_fixture_is_all_there),
      cmocka_unit_test(a_lamp_in_its_fixture_costs_few_rays),
      cmocka_unit_test(the_volume_has_the_light_of_a_fixture),
      cmocka_unit_test(nothing_is_lost_beside_a_fixture),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
