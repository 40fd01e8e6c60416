// Tests rasterised capture on any Vulkan device, under the validation layers: faces of cubes hold what rays through
// their texels hit, masks have the holes of the ray caster, and bakes do not depend on the number of threads.
#include "baked_field.h"
#include "cast_cubes.h"
#include "cube_raster.h"
#include "made_scenes.h"
#include "pinned_drivers.h"
#include "vulkan_host.h"

#include "field/field_data.h"
#include "scene/bvh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIDE = 66, TEXELS = 6 * SIDE * SIDE, PROBES = 3 };

static gpu_device device;

static int open_device(void **unused) {
  (void)unused;
  pin_drivers();
  gpu_device_open(&(gpu_device_options){.validate = true, .device = UINT32_MAX}, &device);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  return host_close_device(&device);
}

static float distance_of(const olx_scene *scene, const olx_ray *ray, uint32_t triangle) {
  if (triangle == OLX_NO_HIT) return INFINITY;
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
  const olx_vec3 normal = olx_cross(olx_sub(b, a), olx_sub(c, a));
  return olx_dot(normal, olx_sub(a, ray->origin)) / olx_dot(normal, ray->direction);
}

// Returns whether a texel of a cube holds what the ray through its middle hits, or one within a hundredth of a texel:
// devices round corners to a fraction of a texel.
static bool holds_hit(const olx_scene *scene, uint32_t texel, olx_vec3 position, uint32_t drawn) {
  const float step = 0.01f * 2.0f / (float)(SIDE - 2);
  for (uint32_t i = 0; i < 27; i++) {
    olx_ray ray = cast_cube_ray(position, SIDE, texel);
    const olx_vec3 moved = {(float)(i % 3) - 1.0f, (float)(i / 3 % 3) - 1.0f, (float)(i / 9) - 1.0f};
    ray.direction = olx_madd(ray.direction, moved, step);
    const uint32_t hit = olx_bvh_intersect(scene->bvh, &ray).triangle;
    const float truth = distance_of(scene, &ray, hit), found = distance_of(scene, &ray, drawn);
    if (hit == drawn || fabsf(found - truth) <= 1e-4f * truth) return true;
  }
  return false;
}

// Compares the cubes of several probes of one submission with cast ones, and returns the share of texels that differ.
static double compare_cubes(const olx_scene *scene, const olx_vec3 positions[PROBES]) {
  host_need_device(&device);
  cube_raster *raster;
  if (!cube_raster_create(&device, scene, &raster)) fail_msg("%s", device.problem);
  const olx_bake_raster *drawer = cube_raster_interface(raster), caster = cast_cube_raster(scene);
  uint32_t *drawn = calloc(PROBES * TEXELS, sizeof *drawn), *cast = calloc(PROBES * TEXELS, sizeof *cast);
  assert_true(drawn && cast);
  assert_null(caster.look(caster.user, positions, PROBES, SIDE, cast));
  const char *problem = drawer->look(drawer->user, positions, PROBES, SIDE, drawn);
  if (problem) fail_msg("%s", problem);
  uint32_t different = 0, wrong = 0;
  for (uint32_t i = 0; i < PROBES * TEXELS; i++) {
    if (drawn[i] == cast[i]) continue;
    const uint32_t probe = i / TEXELS;
    different++;
    wrong += !holds_hit(scene, i % TEXELS, positions[probe], drawn[i]);
  }
  // Triangles seen from their edge are moved farther by the rounding of corners.
  if (wrong > PROBES * TEXELS / 10000) fail_msg("%u of %u texels hold what no ray hits", wrong, PROBES * TEXELS);
  // A probe that is drawn alone has the texels that it has among others.
  assert_null(drawer->look(drawer->user, positions + 1, 1, SIDE, cast));
  assert_memory_equal(cast, drawn + TEXELS, TEXELS * sizeof *drawn);
  free(drawn);
  free(cast);
  cube_raster_destroy(raster);
  return (double)different / (PROBES * TEXELS);
}

static void faces_hold_what_rays_hit(void **unused) {
  (void)unused;
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:temple", &scene), OLX_OK);
  const olx_vec3 middle = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  const olx_vec3 positions[PROBES] = {middle, olx_add(middle, olx_v3(1.3f, -0.6f, 2.1f)),
                                      olx_add(middle, olx_v3(-2.2f, 0.9f, -1.7f))};
  assert_true(compare_cubes(scene, positions) < 0.01);
  olx_scene_free(scene);
}

// A plate whose holes come from its base colour, another one from an alpha texture in the second set of coordinates,
// through vertices of alpha below 1.
static olx_scene *masked_scene(void) {
  static const uint8_t holes[4 * 4] = {9, 9, 9, 255, 9, 9, 9, 20, 9, 9, 9, 0, 9, 9, 9, 230};
  static const uint8_t stripes[3 * 4] = {255, 0, 0, 255, 90, 0, 0, 255, 180, 0, 0, 255};
  olx_scene *scene = made_scene();
  olx_material plate = {.base_color = olx_splat(0.5f), .alpha = 1.0f, .alpha_cutoff = 0.5f};
  plate.alpha_texture = plate.metallic_roughness_texture = plate.emission_texture = plate.normal_texture =
      OLX_NO_TEXTURE;
  plate.base_color_texture = made_texture(scene, 2, 2, holes, true);
  made_square(scene, 0.5f, made_material(scene, &plate));
  plate.base_color_texture = OLX_NO_TEXTURE;
  plate.alpha_texture = made_texture(scene, 3, 1, stripes, false);
  plate.alpha = 0.9f;
  made_square(scene, -0.5f, made_material(scene, &plate));
  made_room(scene, olx_v3(0, 0, 0), 4.0f, made_material(scene, &(olx_material){.base_color = olx_splat(0.5f)}));
  return made_finish(scene);
}

static void masks_have_the_holes_of_rays(void **unused) {
  (void)unused;
  olx_scene *scene = masked_scene();
  const olx_vec3 positions[PROBES] = {olx_v3(0.1f, 0.0f, 0.2f), olx_v3(0.4f, 0.9f, -0.3f), olx_v3(-0.6f, -1.1f, 0.5f)};
  assert_true(compare_cubes(scene, positions) < 0.01);
  olx_scene_free(scene);
}

// Bakes eight probes of the room on the device: the same bytes at any number of threads, and nearly all texels are
// those of cast rays.
static void bakes_are_those_of_rays(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  cube_raster *raster;
  if (!cube_raster_create(&device, scene, &raster)) fail_msg("%s", device.problem);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  for (uint32_t axis = 0; axis < 3; axis++) settings.grid.count[axis] = 2;
  settings.irradiance_grid = settings.grid;
  settings.radiance_size = 32;
  settings.noise = 1.0f;
  settings.bounces = 0;
  settings.volume_cells = 8;
  settings.samples = 1;
  settings.uncompressed = true;
  olx_field *cast = baked_field(scene, &settings, NULL);
  settings.raster = cube_raster_interface(raster);
  baked_field_at_any_threads(scene, &settings);
  olx_bake_stats stats;
  olx_field *drawn = baked_field(scene, &settings, &stats);
  assert_int_equal(drawn->size_bytes, cast->size_bytes);
  assert_true(stats.raster_rays < stats.primary_rays / 10);
  const uint32_t texels = 8 * 34 * 34;
  uint32_t different = 0;
  for (uint32_t i = 0; i < texels; i++) {
    different += drawn->distance[i] != cast->distance[i] || drawn->normal[i] != cast->normal[i];
  }
  if (different > texels / 1000) fail_msg("%u of %u texels differ", different, texels);
  olx_field_close(drawn);
  olx_field_close(cast);
  cube_raster_destroy(raster);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(faces_hold_what_rays_hit),
                                     cmocka_unit_test(masks_have_the_holes_of_rays),
                                     cmocka_unit_test(bakes_are_those_of_rays)};
  return cmocka_run_group_tests_name("capture_vulkan", tests, open_device, close_device);
}
