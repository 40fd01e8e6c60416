// Compares fields of rasterised probes with those of cast ones in built-in and real scenes: as many rays unresolved or
// wrong, errors of both layers of indirect light as small, and no seams along the edges of cubes. Skips real scenes
// that are not there.
#include "baked_field.h"
#include "cube_raster.h"
#include "pinned_drivers.h"
#include "vulkan_host.h"

#include "core/octahedral.h"
#include "field/texels.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIZE = 64, WIDTH = 48, HEIGHT = 27, BOUNCES = 1 };

static gpu_device device;

static int open_device(void **unused) {
  (void)unused;
  pin_drivers();
  gpu_device_open(&(gpu_device_options){.device = UINT32_MAX}, &device);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  return host_close_device(&device);
}

// ---- Seams

// Returns the face of a cube that a direction passes.
static uint32_t face_of(olx_vec3 d) {
  const float x = fabsf(d.x), y = fabsf(d.y), z = fabsf(d.z);
  if (x >= y && x >= z) return d.x > 0.0f ? 0 : 1;
  if (y >= z) return d.y > 0.0f ? 2 : 3;
  return d.z > 0.0f ? 4 : 5;
}

static double brightness(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_vec3 light = olx_add(olx_texel_direct(field, probe, texel), olx_texel_indirect(field, probe, texel));
  return (double)(light.x + light.y + light.z);
}

// Sums the differences of light between neighbouring texels across edges of cubes, and between those beside them.
static void measure_gradients(const olx_field *field, double *across, double *beside) {
  const olx_field_info info = olx_field_describe(field);
  double sums[2] = {0.0};
  uint64_t counts[2] = {0};
  for (uint32_t probe = 0; probe < info.probes.count; probe++) {
    for (uint32_t i = 0; i < SIZE * (SIZE - 3); i++) {
      const uint32_t x = i % (SIZE - 3), y = i / (SIZE - 3);
      uint32_t faces[4];
      double light[4];
      for (uint32_t k = 0; k < 4; k++) {
        faces[k] = face_of(olx_texel_direction(x + k, y, SIZE));
        light[k] = brightness(field, probe, olx_map_index(SIZE + 2, (int32_t)(x + k), (int32_t)y));
      }
      if (faces[1] == faces[2] || faces[0] != faces[1] || faces[2] != faces[3]) continue;
      sums[0] += fabs(light[2] - light[1]);
      sums[1] += 0.5 * (fabs(light[1] - light[0]) + fabs(light[3] - light[2]));
      counts[0]++;
      counts[1]++;
    }
  }
  *across = sums[0] / (double)(counts[0] ? counts[0] : 1);
  *beside = sums[1] / (double)(counts[1] ? counts[1] : 1);
}

// ---- Fields

static double layer_error(const olx_scene *scene, const olx_field *field, const olx_image *truth, olx_layer layer) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = 8;
  olx_camera camera;
  olx_image image;
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  assert_int_equal(olx_render(scene, field, &camera, &settings, NULL, &image, NULL), OLX_OK);
  double error = 0.0, power = 0.0;
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    const olx_vec3 a = image.layers[layer][i], b = truth->layers[layer][i], off = {a.x - b.x, a.y - b.y, a.z - b.z};
    error += (double)(off.x * off.x + off.y * off.y + off.z * off.z);
    power += (double)(b.x * b.x + b.y * b.y + b.z * b.z);
  }
  olx_image_free(&image);
  return error / power;
}

static olx_image path_traced(const olx_scene *scene) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = 64;
  settings.bounces = BOUNCES + 1;
  olx_camera camera;
  olx_image image;
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  assert_int_equal(olx_render(scene, NULL, &camera, &settings, NULL, &image, NULL), OLX_OK);
  return image;
}

static olx_audit_rays judged(const olx_scene *scene, const olx_field *field) {
  olx_audit_settings settings = olx_audit_settings_default();
  settings.rays = 20000;
  settings.points = 1;
  settings.spp = 1;
  olx_audit audit;
  assert_int_equal(olx_audit_field(scene, field, &settings, NULL, &audit), OLX_OK);
  return audit.rays;
}

// Bakes a scene both ways, and compares the fields.
static void compare_captures(const char *name, const char *path) {
  host_need_device(&device);
  olx_scene *scene;
  if (olx_scene_load(path, &scene) != OLX_OK) {
    printf("%s: skipped: %s\n", name, olx_last_error());
    skip();
  }
  cube_raster *raster;
  if (!cube_raster_create(&device, scene, &raster)) fail_msg("%s", device.problem);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  assert_int_equal(olx_scene_probe_grid(scene, (uint32_t[3]){2, 2, 2}, &settings.grid), OLX_OK);
  settings.irradiance_grid = olx_bake_irradiance_grid(&settings.grid);
  settings.radiance_size = SIZE;
  settings.noise = 1.0f; // both fields have the same light of the scene
  settings.bounces = BOUNCES;
  settings.volume_cells = 8;
  settings.uncompressed = true; // light of texels is compared
  olx_image truth = path_traced(scene);
  olx_field *fields[2];
  olx_audit_rays rays[2];
  double diffuse[2], glossy[2], across[2], beside[2];
  olx_bake_stats stats;
  for (uint32_t i = 0; i < 2; i++) {
    settings.raster = i ? cube_raster_interface(raster) : NULL;
    fields[i] = baked_field(scene, &settings, &stats);
    rays[i] = judged(scene, fields[i]);
    diffuse[i] = layer_error(scene, fields[i], &truth, OLX_LAYER_INDIRECT_DIFFUSE);
    glossy[i] = layer_error(scene, fields[i], &truth, OLX_LAYER_INDIRECT_GLOSSY);
    measure_gradients(fields[i], &across[i], &beside[i]);
    printf("%-14s %-4s unresolved %.3f %%, wrong %.3f %%, error of diffuse %.5f, of glossy %.5f, gradient across edges "
           "%.4f of that beside",
           name, i ? "cube" : "cast", 100.0 * rays[i].unresolved, 100.0 * rays[i].wrong, diffuse[i], glossy[i],
           across[i] / beside[i]);
    if (i) printf("; cast %.2f %%", 100.0 * (double)stats.raster_rays / (double)stats.primary_rays);
    printf("\n");
  }
  assert_true(fabs(rays[1].unresolved - rays[0].unresolved) < 0.003);
  assert_true(fabs(rays[1].wrong - rays[0].wrong) < 0.003);
  assert_true(diffuse[1] < 1.25 * diffuse[0] && glossy[1] < 1.25 * glossy[0]);
  // What the scene itself has along these directions, cast capture shows.
  assert_true(across[1] / beside[1] < 1.1 * fmax(1.0, across[0] / beside[0]));
  for (uint32_t i = 0; i < 2; i++) olx_field_close(fields[i]);
  olx_image_free(&truth);
  cube_raster_destroy(raster);
  olx_scene_free(scene);
}

static void cornell_glossy(void **unused) {
  (void)unused;
  compare_captures("cornell-glossy", "builtin:cornell-glossy");
}

static void temple(void **unused) {
  (void)unused;
  compare_captures("temple", "builtin:temple");
}

static void living_room(void **unused) {
  (void)unused;
  compare_captures("living-room", OLX_SOURCE_DIR "/scenes/living-room.json");
}

static void sponza(void **unused) {
  (void)unused;
  compare_captures("sponza", OLX_SOURCE_DIR "/scenes/sponza.json");
}

int main(void) {
  setenv("OCTALUX_SCENES", OLX_SOURCE_DIR "/../shared/scenes", 0);
  const struct CMUnitTest tests[] = {cmocka_unit_test(cornell_glossy), cmocka_unit_test(temple),
                                     cmocka_unit_test(living_room), cmocka_unit_test(sponza)};
  return cmocka_run_group_tests_name("capture_vulkan", tests, open_device, close_device);
}
