// Tests pictures of a room whose lamp without area hangs one centimetre below a plate: rays that end beside the lamp
// must not show as specks, and no light may be lost.
#include "baked_field.h"
#include "core/bsdf.h"
#include "light/path.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "tiny_scenes.h"

static const float plate_side = 0.1f, lamp_gap = 0.01f, lamp_height = 0.7f, plate_albedo = 0.5f;

enum { SIZE = 16 };

// The light of the floor, in a black box, is that of the plate alone.
static olx_scene *fixture_room(const olx_material *floor) {
  olx_scene *scene = tiny_scene();
  const olx_material plate = tiny_lambert(plate_albedo, 0.0f), black = tiny_lambert(0.0f, 0.0f);
  tiny_box(scene, &black);
  tiny_quad(scene, floor, olx_v3(0.0f, -0.99f, 0.0f), olx_v3(0.0f, 0.0f, 2.0f), olx_v3(2.0f, 0.0f, 0.0f));
  tiny_quad(scene, &plate, olx_v3(0.0f, lamp_height + lamp_gap, 0.0f), olx_v3(plate_side, 0.0f, 0.0f),
            olx_v3(0.0f, 0.0f, plate_side));
  const olx_light lamp = {
      .type = OLX_LIGHT_POINT, .position = olx_v3(0.0f, lamp_height, 0.0f), .emission = olx_splat(1.0f)};
  ASSERT_OK(olx_scene_add_light(scene, &lamp));
  return tiny_finish(scene);
}

typedef enum probe_layout { PROBES_ON_GRID, PROBES_PLACED } probe_layout;

// The probes are at the same positions in both layouts, but a selector of placed probes may ask any of them first.
static olx_field *bake(const olx_scene *scene, probe_layout layout) {
  static const olx_vec3 places[4] = {
      {-0.4f, -0.2f, -0.4f}, {0.4f, -0.2f, -0.4f}, {-0.4f, -0.2f, 0.4f}, {0.4f, -0.2f, 0.4f}};
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = (olx_grid){.origin = places[0], .spacing = {0.8f, 0.8f, 0.8f}, .count = {2, 1, 2}};
  if (layout == PROBES_PLACED) {
    settings.probes = places;
    settings.probe_count = 4;
  }
  settings.radiance_size = 64;
  settings.noise = 0.1f;
  settings.bounces = 1;
  return baked_field(scene, &settings, NULL);
}

static olx_camera floor_camera(void) { return tiny_camera(olx_v3(0.9f, 0.1f, 0.3f), olx_v3(0.1f, -1, 0), 30); }

// Returns the light of the plate that a lobe of the floor reflects to the camera, by a sum over the plate.
static double reflected(const olx_scene *scene, const olx_ray *camera_ray, bool glossy) {
  enum { STEPS = 64 };
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, camera_ray);
  const olx_surface surface = olx_surface_at(scene, &hit, camera_ray->direction);
  const olx_shading shading = olx_shading_make(&surface, camera_ray->direction);
  const float cell = plate_side / STEPS;
  double sum = 0.0;
  for (int i = 0; i < STEPS * STEPS; i++) {
    const float x = ((float)(i % STEPS) + 0.5f) * cell - 0.5f * plate_side;
    const float z = ((float)(i / STEPS) + 0.5f) * cell - 0.5f * plate_side;
    const olx_vec3 way = olx_sub(olx_v3(x, lamp_height + lamp_gap, z), surface.position);
    const olx_vec3 direction = olx_normalize(way), local = olx_shading_local(&shading, direction);
    const float irradiance = lamp_gap / powf(x * x + z * z + lamp_gap * lamp_gap, 1.5f);
    const float lobe =
        glossy ? olx_bsdf_specular(&surface.bsdf, shading.view, local).x : shading.diffuse.x * local.z / OLX_PI;
    sum += (double)(plate_albedo * irradiance / OLX_PI * lobe * direction.y * cell * cell / olx_dot(way, way));
  }
  return sum;
}

static void expect_light_of_plate(const olx_scene *scene, probe_layout layout, const olx_render_settings *settings,
                                  bool glossy) {
  const olx_camera camera = floor_camera();
  olx_camera_frame frame;
  olx_field *field = bake(scene, layout);
  ASSERT_OK(olx_camera_frame_make(&camera, SIZE, SIZE, &frame));
  olx_image image = tiny_render(scene, field, &camera, settings);
  const olx_layer layer = glossy ? OLX_LAYER_INDIRECT_GLOSSY : OLX_LAYER_INDIRECT_DIFFUSE;
  double found = 0.0, wanted = 0.0, squares = 0.0, largest = 0.0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    const olx_ray ray = {
        frame.eye, olx_camera_direction(&frame, ((float)(i % SIZE) + 0.5f) / SIZE, ((float)(i / SIZE) + 0.5f) / SIZE),
        0.0f, INFINITY};
    const double light = (double)image.layers[layer][i].x, truth = reflected(scene, &ray, glossy);
    found += light;
    wanted += truth;
    squares += (light / truth - 1.0) * (light / truth - 1.0);
    largest = fmax(largest, light / truth);
  }
  print_message(
      "%s light, %s probes: %.4f of the truth, pixels off by %.3f (RMS), the brightest %.2f times too bright\n",
      glossy ? "glossy" : "traced diffuse", layout == PROBES_PLACED ? "placed" : "a grid of", found / wanted,
      sqrt(squares / (SIZE * SIZE)), largest);
  assert_true(fabs(found / wanted - 1.0) < 0.03);
  assert_true(largest < 1.2);
  olx_image_free(&image);
  olx_field_close(field);
}

static olx_render_settings picture(void) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = settings.height = SIZE;
  settings.centered = true;
  settings.spp = 8;
  return settings;
}

static void rough_reflections_of_a_fixture_have_no_specks(void **state) {
  (void)state;
  const olx_material floor = tiny_metal(0.5f, 0.6f);
  olx_scene *scene = fixture_room(&floor);
  olx_render_settings settings = picture();
  expect_light_of_plate(scene, PROBES_ON_GRID, &settings, true);
  expect_light_of_plate(scene, PROBES_PLACED, &settings, true);
  olx_scene_free(scene);
}

static void traced_diffuse_light_of_a_fixture_has_no_specks(void **state) {
  (void)state;
  const olx_material floor = tiny_lambert(0.5f, 0.0f);
  olx_scene *scene = fixture_room(&floor);
  olx_render_settings settings = picture();
  settings.diffuse = OLX_DIFFUSE_TRACED;
  settings.diffuse_samples = 4;
  expect_light_of_plate(scene, PROBES_ON_GRID, &settings, false);
  expect_light_of_plate(scene, PROBES_PLACED, &settings, false);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rough_reflections_of_a_fixture_have_no_specks),
      cmocka_unit_test(traced_diffuse_light_of_a_fixture_has_no_specks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
