// Tests the path tracer, the reference of all other tests, against values known in closed form.
#include "light/path.h"
#include "scene/emitters.h"
#include "tiny_scenes.h"

static olx_render_settings path_settings(uint32_t size, uint32_t spp, uint32_t bounces) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = settings.height = size;
  settings.spp = spp;
  settings.bounces = bounces;
  return settings;
}

// --- White furnace -------------------------------------------------------------------------------------------------

static const olx_vec3 inside_eye = {0.3f, -0.2f, 0.4f}, inside_target = {-1.0f, 0.5f, -0.7f};

// In a furnace of albedo a and emission 1 each bounce adds the next power of a.
static void check_furnace(float albedo, uint32_t bounces, double direct, double indirect) {
  olx_scene *scene = tiny_furnace(albedo, 1.0f);
  const olx_camera camera = tiny_camera(inside_eye, inside_target, 70);
  const olx_render_settings settings = path_settings(20, 256, bounces);
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  assert_close(tiny_mean(&image, OLX_LAYER_DIRECT), direct, 1e-3, "direct");
  if (indirect > 0) assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE), indirect, 1e-3, "indirect");
  assert_close(tiny_mean(&image, OLX_LAYER_BEAUTY), 1 + direct + indirect, 1e-3, "beauty");
  olx_image_free(&image);
  olx_scene_free(scene);
}

static void test_furnace_with_infinite_bounces(void **state) {
  (void)state;
  const float albedos[] = {0.5f, 0.9f};
  for (int i = 0; i < 2; i++) {
    const double a = (double)albedos[i];
    check_furnace(albedos[i], OLX_BOUNCES_INFINITE, a, a * a / (1 - a));
  }
}

static void test_furnace_with_finite_bounces_is_the_geometric_series(void **state) {
  (void)state;
  const double a = (double)0.8f;
  double indirect = 0, power = a;
  for (uint32_t bounces = 0; bounces <= 6; bounces++) {
    if (bounces > 0) indirect += power *= a;
    if (bounces != 0 && bounces != 1 && bounces != 3 && bounces != 6) continue;
    check_furnace(0.8f, bounces, a, indirect);
  }
}

static void test_irradiance_at_a_point_of_a_furnace(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 2.0f);
  const olx_vec3 position = {0.3f, -1.0f, 0.2f}, up = {0, 1, 0};
  const double pi = (double)OLX_PI, first = 2 * 0.5 * pi;
  const uint32_t bounces[] = {1, 2, OLX_BOUNCES_INFINITE};
  const double expected[] = {first, first * 1.5, first * 2};
  for (int i = 0; i < 3; i++) {
    const olx_vec3 e = olx_path_irradiance(scene, position, up, 1e-5f, bounces[i], 1 << 16, 7);
    assert_close((double)e.y, expected[i], 2e-3, "indirect irradiance");
  }
  const olx_vec3 none = olx_path_irradiance(scene, position, up, 1e-5f, 0, 64, 7);
  assert_true(none.x == 0.0f && none.y == 0.0f && none.z == 0.0f);
  olx_scene_free(scene);
}

// --- Lights --------------------------------------------------------------------------------------------------------

// Returns the mean direct light of the middle of the floor, seen from the side through a very narrow camera.
static double floor_light(const olx_scene *scene, uint32_t spp) {
  const olx_camera camera = tiny_camera(olx_v3(-0.8f, 0.4f, 0), olx_v3(0, 0, 0), 0.01f);
  const olx_render_settings settings = path_settings(8, spp, 0);
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  const double mean = tiny_mean(&image, OLX_LAYER_DIRECT);
  olx_image_free(&image);
  return mean;
}

// Returns the form factor of a rectangle a x b at height h, from a point under one of its corners, parallel to it.
static double corner_form_factor(double a, double b, double h) {
  const double A = a / h, B = b / h, ra = sqrt(1 + A * A), rb = sqrt(1 + B * B);
  return (A / ra * atan(B / ra) + B / rb * atan(A / rb)) / (2 * (double)OLX_PI);
}

static void test_irradiance_under_a_rectangle_light(void **state) {
  (void)state;
  const double heights[] = {0.1, 0.5, 2.0};
  for (int i = 0; i < 3; i++) {
    olx_scene *scene = tiny_scene();
    const olx_material floor = tiny_lambert(0.5f, 0);
    tiny_floor(scene, &floor);
    // The light spans x = -0.1 to 0.3 and z = -0.2 to 0.1, so that the origin is under none of its lines of symmetry.
    ASSERT_OK(olx_scene_add_rect_light(scene, olx_v3(0.1f, (float)heights[i], -0.05f), olx_v3(0.4f, 0, 0),
                                       olx_v3(0, 0, 0.3f), olx_splat(3.0f)));
    tiny_finish(scene);
    const double h = heights[i];
    const double form_factor = corner_form_factor(0.1, 0.2, h) + corner_form_factor(0.1, 0.1, h) +
                               corner_form_factor(0.3, 0.2, h) + corner_form_factor(0.3, 0.1, h);
    assert_close(floor_light(scene, 1024), 0.5 * 3.0 * form_factor, 2e-3, "light under a rectangle");
    olx_scene_free(scene);
  }
}

static void test_rectangle_lights_shine_on_one_side(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_lambert(0.5f, 0);
  tiny_floor(scene, &floor);
  ASSERT_OK(
      olx_scene_add_rect_light(scene, olx_v3(0, 0.4f, 0), olx_v3(0, 0, 0.3f), olx_v3(0.4f, 0, 0), olx_splat(3.0f)));
  tiny_finish(scene);
  assert_true(floor_light(scene, 64) == 0.0);
  olx_scene_free(scene);
}

static double floor_under_light(const olx_light *light) {
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_lambert(0.5f, 0);
  tiny_floor(scene, &floor);
  ASSERT_OK(olx_scene_add_light(scene, light));
  tiny_finish(scene);
  const double value = floor_light(scene, 4);
  olx_scene_free(scene);
  return value;
}

static void test_lights_without_area(void **state) {
  (void)state;
  const double pi = (double)OLX_PI;
  const olx_light sun = {.type = OLX_LIGHT_SUN, .direction = {0.6f, -0.8f, 0}, .emission = {7, 7, 7}};
  assert_close(floor_under_light(&sun), 0.5 / pi * 7 * 0.8, 1e-3, "sun");
  const olx_light point = {.type = OLX_LIGHT_POINT, .position = {0.3f, 0.4f, 0}, .emission = {2, 2, 2}};
  assert_close(floor_under_light(&point), 0.5 / pi * 2 * 0.8 / 0.25, 1e-3, "point");
  olx_light spot = {.type = OLX_LIGHT_SPOT,
                    .position = {0.3f, 0.4f, 0},
                    .direction = {-0.6f, -0.8f, 0},
                    .emission = {2, 2, 2},
                    .cosine_inner = 0.95f,
                    .cosine_outer = 0.9f};
  assert_close(floor_under_light(&spot), 0.5 / pi * 2 * 0.8 / 0.25, 1e-3, "spot, inside its cone");
  spot.direction = olx_v3(0.6f, -0.8f, 0);
  assert_true(floor_under_light(&spot) == 0.0);
}

static void test_many_lights_add_up(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_lambert(0.5f, 0);
  tiny_floor(scene, &floor);
  double expected = 0;
  for (int i = 0; i < 40; i++) {
    const float x = 0.1f * (float)(i % 7) - 0.3f, z = 0.1f * (float)(i % 5) - 0.2f, power = 0.1f + 0.02f * (float)i;
    const olx_light light = {.type = OLX_LIGHT_POINT, .position = {x, 0.8f, z}, .emission = {power, power, power}};
    ASSERT_OK(olx_scene_add_light(scene, &light));
    const double d2 = (double)(x * x + z * z) + 0.64;
    expected += 0.5 / (double)OLX_PI * (double)power * 0.8 / (d2 * sqrt(d2));
  }
  tiny_finish(scene);
  assert_close(floor_light(scene, 1024), expected, 1e-3, "forty lights");
  olx_scene_free(scene);
}

static void test_constant_environment(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_lambert(0.5f, 0);
  tiny_floor(scene, &floor);
  scene->environment.radiance = olx_splat(1.5f);
  tiny_finish(scene);
  assert_close(floor_light(scene, 1024), 0.75, 1e-3, "floor under a constant sky");
  olx_scene_free(scene);
}

// Adds a sky that is mostly dim, with a small bright sun, rotated by an arbitrary angle.
static void add_image_environment(olx_scene *scene) {
  enum { W = 64, H = 32 };
  scene->environment.width = W;
  scene->environment.height = H;
  scene->environment.radiance = olx_splat(1.0f);
  scene->environment.rotation_radians = 0.7f;
  scene->environment.texels = olx_allocate((size_t)3 * W * H, sizeof(float));
  assert_non_null(scene->environment.texels);
  for (uint32_t y = 0; y < H; y++) {
    for (uint32_t x = 0; x < W; x++) {
      const float value = y == 6 && x == 20 ? 200.0f : y < 16 ? 0.2f + 0.02f * (float)(x % 16) : 0.05f;
      for (uint32_t c = 0; c < 3; c++) scene->environment.texels[3 * (y * W + x) + c] = value;
    }
  }
}

// Adds a room of black walls, 2 m high and wide, with a window of 40 cm in the middle of its ceiling.
static void add_room_with_a_window(olx_scene *scene) {
  const olx_material floor = tiny_lambert(0.5f, 0), wall = tiny_lambert(0, 0);
  const olx_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  tiny_quad(scene, &floor, olx_splat(0), olx_scale(x, 2), olx_scale(z, 2));
  for (int side = -1; side <= 1; side += 2) {
    const float s = (float)side;
    tiny_quad(scene, &wall, olx_v3(s, 1, 0), olx_scale(y, 2), olx_scale(z, 2));
    tiny_quad(scene, &wall, olx_v3(0, 1, s), olx_scale(y, 2), olx_scale(x, 2));
    tiny_quad(scene, &wall, olx_v3(0.6f * s, 2, 0), olx_scale(x, 0.8f), olx_scale(z, 2));
    tiny_quad(scene, &wall, olx_v3(0, 2, 0.6f * s), olx_scale(x, 0.4f), olx_scale(z, 0.8f));
  }
}

// The form factor of a square window of half side a, seen from distance c below its middle.
static double window_form_factor(double a, double c) {
  const double r = sqrt(a * a + c * c);
  return 4 * (a / r * atan(a / r)) / (double)OLX_PI;
}

// Pixels learn where the window is: without that a sample finds it once in 60 times, and pixels would be off by their
// own value.
static void test_sky_through_a_window(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  add_room_with_a_window(scene);
  scene->environment.radiance = olx_splat(3.0f);
  tiny_finish(scene);
  const olx_camera camera = tiny_camera(olx_v3(0.5f, 0.8f, 0.1f), olx_splat(0), 2);
  const olx_render_settings settings = path_settings(32, 64, 0);
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  const double expected = 0.5 * 3.0 * window_form_factor(0.2, 2.0);
  assert_close(tiny_mean(&image, OLX_LAYER_DIRECT), expected, 0.01, "floor below a window");
  double squares = 0;
  for (int i = 0; i < 32 * 32; i++) {
    const double off = (double)image.layers[OLX_LAYER_DIRECT][i].x / expected - 1;
    squares += off * off / (32 * 32);
  }
  if (!(sqrt(squares) < 0.4)) fail_msg("pixels are off by %.3f of their value", sqrt(squares));
  olx_image_free(&image);
  olx_scene_free(scene);
}

static void test_image_environment(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_lambert(0.5f, 0);
  tiny_floor(scene, &floor);
  add_image_environment(scene);
  tiny_finish(scene);
  enum { STEPS = 2048 };
  double irradiance = 0;
  for (int i = 0; i < STEPS; i++) { // steps of sin^2 of the angle from the zenith, which weigh the same
    const double s = (i + 0.5) / STEPS, sine = sqrt(s), cosine = sqrt(1 - s);
    for (int j = 0; j < STEPS; j++) {
      const double phi = 2 * (double)OLX_PI * (j + 0.5) / STEPS;
      const olx_vec3 d = {(float)(sine * cos(phi)), (float)cosine, (float)(sine * sin(phi))};
      irradiance += (double)olx_environment_radiance(scene, d).x;
    }
  }
  irradiance *= (double)OLX_PI / ((double)STEPS * STEPS);
  assert_close(floor_light(scene, 8192), 0.5 * irradiance / (double)OLX_PI, 1e-3, "floor under an image");
  olx_scene_free(scene);
}

// --- Reflection ----------------------------------------------------------------------------------------------------

static olx_scene *floor_in_uniform_sky(const olx_material *material) {
  olx_scene *scene = tiny_scene();
  tiny_floor(scene, material);
  scene->environment.radiance = olx_splat(1.0f);
  return tiny_finish(scene);
}

static olx_camera camera_at_angle(double cosine) {
  const double sine = sqrt(1 - cosine * cosine);
  return tiny_camera(olx_v3((float)sine, (float)cosine, 0), olx_v3(0, 0, 0), 0.01f);
}

static void test_directional_albedo_of_ggx(void **state) {
  (void)state;
  const float roughness[] = {0.05f, 0.2f, 0.5f, 1.0f};
  const double cosines[] = {0.9999, 0.6, 0.2};
  for (int i = 0; i < 4; i++) {
    const olx_material materials[] = {tiny_metal(0.7f, roughness[i]), tiny_plastic(0.0f, roughness[i])};
    for (int m = 0; m < 2; m++) {
      olx_scene *scene = floor_in_uniform_sky(&materials[m]);
      for (int k = 0; k < 3; k++) {
        const olx_camera camera = camera_at_angle(cosines[k]);
        const olx_render_settings settings = path_settings(8, 256, 0);
        olx_image image = tiny_render(scene, NULL, &camera, &settings);
        const double expected = tiny_directional_albedo(m ? 0.04 : 0.7, (double)roughness[i], cosines[k]);
        assert_close(tiny_mean(&image, OLX_LAYER_DIRECT), expected, 5e-3, m ? "plastic" : "metal");
        olx_image_free(&image);
      }
      olx_scene_free(scene);
    }
  }
}

// After a mirror the tracer follows one of two lobes and weighs it by both, so the light must be the same.
static void test_surface_of_two_lobes_seen_in_a_mirror(void **state) {
  (void)state;
  const float roughness[] = {0.0f, 0.1f, 0.4f, 1.0f};
  for (int i = 0; i < 4; i++) {
    olx_scene *scene = tiny_scene();
    const olx_material floor = tiny_plastic(0.6f, roughness[i]), mirror = tiny_metal(0.8f, 0);
    tiny_floor(scene, &floor);
    // The eye looks along x; a small mirror turns its ray to (0.6, -0.8, 0), onto the floor.
    const olx_vec3 level = {1, 0, 0}, down = {0.6f, -0.8f, 0}, normal = olx_normalize(olx_sub(down, level));
    const olx_vec3 z = {0, 0, 1e-3f};
    tiny_quad(scene, &mirror, olx_v3(0.3f, 0.5f, 0), z, olx_cross(normal, z));
    scene->environment.radiance = olx_splat(1.0f);
    tiny_finish(scene);
    const olx_camera camera = tiny_camera(olx_v3(-0.5f, 0.5f, 0), olx_v3(0.5f, 0.5f, 0), 0.01f);
    const olx_render_settings settings = path_settings(8, 1024, 1);
    olx_image image = tiny_render(scene, NULL, &camera, &settings);
    const double mirror_fresnel = 0.8 + 0.2 * pow(1 - sqrt(0.2), 5), floor_fresnel = 0.04 + 0.96 * pow(0.2, 5);
    const double specular = roughness[i] > 0 ? tiny_directional_albedo(0.04, (double)roughness[i], 0.8) : floor_fresnel;
    const double expected = mirror_fresnel * (specular + 0.6 * (1 - floor_fresnel));
    assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY), expected, 2e-3, "in the mirror");
    olx_image_free(&image);
    olx_scene_free(scene);
  }
}

static void test_mirror_shows_lamps_as_direct_and_walls_as_indirect_light(void **state) {
  (void)state;
  const olx_material mirror = tiny_metal(0.8f, 0), lamp = tiny_lambert(0.5f, 3), wall = tiny_lambert(0.5f, 0);
  const olx_material *shown[] = {&lamp, &wall};
  for (int i = 0; i < 2; i++) {
    olx_scene *scene = tiny_scene();
    tiny_floor(scene, &mirror);
    tiny_quad(scene, shown[i], olx_v3(-1.1f, 1, 0), olx_v3(0, 2, 0), olx_v3(0, 0, 2));
    const olx_light sun = {.type = OLX_LIGHT_SUN, .direction = {-1, 0, 0}, .emission = {2, 2, 2}};
    ASSERT_OK(olx_scene_add_light(scene, &sun));
    tiny_finish(scene);
    const olx_camera camera = tiny_camera(olx_v3(1, 1, 0), olx_v3(0, 0, 0), 0.01f);
    const olx_render_settings settings = path_settings(8, 16, 1);
    olx_image image = tiny_render(scene, NULL, &camera, &settings);
    const double fresnel = 0.8 + 0.2 * pow(1 - sqrt(0.5), 5);
    const double direct = tiny_mean(&image, OLX_LAYER_DIRECT);
    if (i == 0) assert_close(direct, fresnel * 3, 1e-3, "mirror image of a lamp");
    if (i == 1) assert_true(direct == 0.0);
    assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY), fresnel * 0.5 * 2 / (double)OLX_PI, 1e-3, "of a wall");
    olx_image_free(&image);
    olx_scene_free(scene);
  }
}

static void test_no_surface_returns_more_than_it_receives(void **state) {
  (void)state;
  const olx_material materials[] = {tiny_metal(0.95f, 0.05f),   tiny_metal(0.95f, 0.5f),   tiny_metal(0.95f, 1.0f),
                                    tiny_plastic(0.95f, 0.05f), tiny_plastic(0.95f, 0.5f), tiny_plastic(0.95f, 1.0f)};
  olx_scene *scene = tiny_scene();
  for (int i = 0; i < 6; i++) {
    // Two strips form corners, so that light also bounces between surfaces of the same material.
    const float x = (float)i - 2.5f;
    tiny_quad(scene, &materials[i], olx_v3(x, 0, 0), olx_v3(0, 0, 1), olx_v3(1, 0, 0));
    tiny_quad(scene, &materials[i], olx_v3(x, 0.5f, -0.5f), olx_v3(1, 0, 0), olx_v3(0, 1, 0));
  }
  scene->environment.radiance = olx_splat(1.0f);
  tiny_finish(scene);
  const olx_camera camera = tiny_camera(olx_v3(0, 1.2f, 4), olx_v3(0, 0.3f, 0), 70);
  olx_render_settings settings = path_settings(32, 256, OLX_BOUNCES_INFINITE);
  settings.standard_error = true;
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  for (uint32_t i = 0; i < 32 * 32; i++) {
    const float error = image.layers[OLX_LAYER_STANDARD_ERROR][i].x, value = image.layers[OLX_LAYER_BEAUTY][i].x;
    if (value > 1.0f + 4 * error + 1e-5f) fail_msg("pixel %u: %g +- %g", i, (double)value, (double)error);
  }
  olx_image_free(&image);
  olx_scene_free(scene);
}

// --- The estimator -------------------------------------------------------------------------------------------------

// Makes a box with a lamp, a sun that enters through no window, and surfaces of every kind.
static olx_scene *mixed_room(void) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(0.7f, 0), panel = tiny_metal(0.9f, 0.6f), table = tiny_plastic(0.5f, 0.5f);
  tiny_box(scene, &walls);
  tiny_quad(scene, &panel, olx_v3(-0.95f, 0, 0), olx_v3(0, 1, 0), olx_v3(0, 0, 1));
  tiny_quad(scene, &table, olx_v3(0, -0.6f, 0), olx_v3(0, 0, 1), olx_v3(1, 0, 0));
  ASSERT_OK(olx_scene_add_rect_light(scene, olx_v3(0, 0.98f, 0), olx_v3(0.5f, 0, 0), olx_v3(0, 0, 0.5f), olx_splat(8)));
  const olx_light point = {.type = OLX_LIGHT_POINT, .position = {0.6f, 0.1f, -0.6f}, .emission = {0.2f, 0.1f, 0.05f}};
  ASSERT_OK(olx_scene_add_light(scene, &point));
  return tiny_finish(scene);
}

static olx_image render_room(const olx_scene *scene, const olx_render_settings *settings) {
  const olx_camera camera = tiny_camera(olx_v3(0.8f, 0.3f, 0.8f), olx_v3(-0.5f, -0.4f, -0.3f), 75);
  return tiny_render(scene, NULL, &camera, settings);
}

static double squared_error(const olx_image *a, const olx_image *b) {
  double sum = 0;
  for (uint32_t i = 0; i < a->width * a->height; i++) {
    const olx_vec3 d = olx_sub(a->layers[OLX_LAYER_BEAUTY][i], b->layers[OLX_LAYER_BEAUTY][i]);
    sum += (double)olx_dot(d, d);
  }
  return sum / (a->width * a->height);
}

static void test_error_falls_with_the_root_of_the_samples(void **state) {
  (void)state;
  olx_scene *scene = mixed_room();
  olx_render_settings settings = path_settings(16, 1 << 11, 3);
  olx_image reference = render_room(scene, &settings);
  settings.standard_error = true;
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  enum { STEPS = 5 };
  for (int i = 0; i < STEPS; i++) {
    settings.spp = 4u << i;
    olx_image image = render_room(scene, &settings);
    const double mse = squared_error(&image, &reference), x = log((double)settings.spp), y = 0.5 * log(mse);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
    double predicted = 0;
    for (uint32_t k = 0; k < 256; k++) {
      const olx_vec3 e = image.layers[OLX_LAYER_STANDARD_ERROR][k];
      predicted += (double)olx_dot(e, e) / 256;
    }
    print_message("spp %u: rmse %.5f, standard error %.5f\n", settings.spp, sqrt(mse), sqrt(predicted));
    // Stratification makes the true error smaller than that of independent samples, or at most slightly larger.
    assert_true(mse < 1.5 * predicted);
    assert_true(mse > 0.05 * predicted);
    olx_image_free(&image);
  }
  const double slope = (STEPS * sxy - sx * sy) / (STEPS * sxx - sx * sx);
  print_message("slope %.3f\n", slope);
  assert_true(slope < -0.47 && slope > -0.9);
  olx_image_free(&reference);
  olx_scene_free(scene);
}

static void assert_same_images(const olx_image *a, const olx_image *b) {
  for (int layer = 0; layer < OLX_LAYER_COUNT; layer++) {
    assert_int_equal(a->layers[layer] != NULL, b->layers[layer] != NULL);
    if (!a->layers[layer]) continue;
    assert_memory_equal(a->layers[layer], b->layers[layer], (size_t)a->width * a->height * sizeof(olx_vec3));
  }
}

static void test_same_bytes_at_any_number_of_threads(void **state) {
  (void)state;
  olx_scene *scene = mixed_room();
  olx_render_settings settings = path_settings(37, 5, OLX_BOUNCES_INFINITE);
  settings.height = 21;
  settings.standard_error = true;
  settings.threads = 1;
  olx_image one = render_room(scene, &settings);
  const uint32_t threads[] = {2, 5};
  for (int i = 0; i < 2; i++) {
    settings.threads = threads[i];
    olx_image other = render_room(scene, &settings);
    assert_same_images(&one, &other);
    olx_image_free(&other);
  }
  olx_image_free(&one);
  olx_scene_free(scene);
}

static void test_layers_sum_to_beauty(void **state) {
  (void)state;
  olx_scene *scene = mixed_room();
  const olx_render_settings settings = path_settings(24, 8, OLX_BOUNCES_INFINITE);
  olx_image image = render_room(scene, &settings);
  bool glossy = false, diffuse = false;
  for (uint32_t i = 0; i < 24 * 24; i++) {
    const olx_vec3 d = image.layers[OLX_LAYER_INDIRECT_DIFFUSE][i], g = image.layers[OLX_LAYER_INDIRECT_GLOSSY][i];
    const olx_vec3 sum = olx_add(olx_add(image.layers[OLX_LAYER_DIRECT][i], d), g);
    const olx_vec3 beauty = image.layers[OLX_LAYER_BEAUTY][i];
    glossy |= g.y > 0, diffuse |= d.y > 0;
    assert_true(olx_finite(beauty));
    // The camera does not see the lamp, so the layers of light sum to the whole picture.
    assert_true(olx_length(olx_sub(beauty, sum)) <= 1e-5f * olx_length(beauty));
  }
  assert_true(glossy && diffuse);
  olx_image_free(&image);
  olx_scene_free(scene);
}

static void test_no_bounces_is_direct_light_alone(void **state) {
  (void)state;
  olx_scene *scene = mixed_room();
  olx_render_settings settings = path_settings(16, 4, OLX_BOUNCES_INFINITE);
  olx_image all = render_room(scene, &settings);
  settings.bounces = 0;
  olx_image direct = render_room(scene, &settings);
  const size_t bytes = 16 * 16 * sizeof(olx_vec3);
  assert_memory_equal(all.layers[OLX_LAYER_DIRECT], direct.layers[OLX_LAYER_DIRECT], bytes);
  assert_true(tiny_mean(&all, OLX_LAYER_INDIRECT_DIFFUSE) > 0);
  assert_true(tiny_mean(&direct, OLX_LAYER_INDIRECT_DIFFUSE) == 0);
  assert_true(tiny_mean(&direct, OLX_LAYER_INDIRECT_GLOSSY) == 0);
  olx_image_free(&all);
  olx_image_free(&direct);
  olx_scene_free(scene);
}

// --- The image -----------------------------------------------------------------------------------------------------

static void test_surface_layers(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material wall = tiny_lambert(0.4f, 2);
  // The wall is 3 m ahead and fills the right half of the image.
  tiny_quad(scene, &wall, olx_v3(50, 0, -3), olx_v3(100, 0, 0), olx_v3(0, 100, 0));
  scene->environment.radiance = olx_v3(1, 2, 3);
  tiny_finish(scene);
  const olx_camera camera = {.eye = {0, 0, 0}, .target = {0, 0, -1}, .up = {0, 1, 0}, .fov_y_degrees = 60};
  const olx_render_settings settings = path_settings(8, 1, 0);
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  for (uint32_t y = 0; y < 8; y++) {
    const uint32_t left = 8 * y, right = 8 * y + 7;
    assert_true(isinf(image.layers[OLX_LAYER_DEPTH][left].x));
    assert_true(olx_length(image.layers[OLX_LAYER_NORMAL][left]) == 0.0f);
    assert_true(olx_length(image.layers[OLX_LAYER_DIRECT][left]) == 0.0f);
    assert_true(image.layers[OLX_LAYER_BEAUTY][left].z == 3.0f);
    assert_close((double)image.layers[OLX_LAYER_DEPTH][right].x, 3, 1e-5, "depth along the axis");
    assert_close((double)image.layers[OLX_LAYER_ALBEDO][right].y, 0.4, 1e-6, "albedo");
    assert_true(image.layers[OLX_LAYER_NORMAL][right].z == 1.0f);
    const float seen = image.layers[OLX_LAYER_BEAUTY][right].x - image.layers[OLX_LAYER_DIRECT][right].x;
    assert_close((double)seen, 2, 1e-5, "emission seen by the eye");
  }
  assert_null(image.layers[OLX_LAYER_STANDARD_ERROR]);
  olx_image_free(&image);
  olx_scene_free(scene);
}

static void test_pixels_run_right_and_down(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material lamp = tiny_lambert(0, 1);
  // A lamp to the right of the axis and above it.
  tiny_quad(scene, &lamp, olx_v3(1, 1, -2), olx_v3(0.5f, 0, 0), olx_v3(0, 0.5f, 0));
  tiny_finish(scene);
  const olx_camera camera = {.eye = {0, 0, 0}, .target = {0, 0, -1}, .up = {0, 1, 0}, .fov_y_degrees = 90};
  const olx_render_settings settings = path_settings(8, 1, 0);
  olx_image image = tiny_render(scene, NULL, &camera, &settings);
  for (uint32_t i = 0; i < 64; i++) {
    const bool lit = image.layers[OLX_LAYER_BEAUTY][i].x > 0;
    if (lit) assert_true(i % 8 > 3 && i / 8 < 4);
  }
  assert_true(tiny_mean(&image, OLX_LAYER_BEAUTY) > 0);
  olx_image_free(&image);
  olx_scene_free(scene);
}

static bool stop_at_once(void *user, const char *stage, float done) {
  ++*(int *)user;
  assert_true(strlen(stage) > 0 && done >= 0 && done <= 1);
  return false;
}

static void test_cancelling_leaves_no_image(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 1.0f);
  const olx_camera camera = tiny_camera(inside_eye, inside_target, 70);
  const olx_render_settings settings = path_settings(64, 4, 1);
  int calls = 0;
  const olx_progress progress = {stop_at_once, &calls};
  olx_image image;
  assert_int_equal(olx_render(scene, NULL, &camera, &settings, &progress, &image, NULL), OLX_ERROR_CANCELLED);
  assert_int_equal(calls, 1);
  assert_null(image.layers[OLX_LAYER_BEAUTY]);
  olx_scene_free(scene);
}

static void test_settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 1.0f);
  const olx_camera good = tiny_camera(inside_eye, inside_target, 70);
  olx_camera bad = good;
  olx_image image;
  olx_render_settings settings = path_settings(0, 1, 0);
  assert_int_equal(olx_render(scene, NULL, &good, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  settings = path_settings(16385, 1, 0);
  assert_int_equal(olx_render(scene, NULL, &good, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  settings = path_settings(8, 0, 0);
  assert_int_equal(olx_render(scene, NULL, &good, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  settings = path_settings(8, 1, 0);
  bad.fov_y_degrees = 180;
  assert_int_equal(olx_render(scene, NULL, &bad, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  bad = good;
  bad.target = bad.eye;
  assert_int_equal(olx_render(scene, NULL, &bad, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  settings.method = OLX_METHOD_FIELD;
  assert_int_equal(olx_render(scene, NULL, &good, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "field"));
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_furnace_with_infinite_bounces),
      cmocka_unit_test(test_furnace_with_finite_bounces_is_the_geometric_series),
      cmocka_unit_test(test_irradiance_at_a_point_of_a_furnace),
      cmocka_unit_test(test_irradiance_under_a_rectangle_light),
      cmocka_unit_test(test_rectangle_lights_shine_on_one_side),
      cmocka_unit_test(test_lights_without_area),
      cmocka_unit_test(test_many_lights_add_up),
      cmocka_unit_test(test_constant_environment),
      cmocka_unit_test(test_image_environment),
      cmocka_unit_test(test_sky_through_a_window),
      cmocka_unit_test(test_directional_albedo_of_ggx),
      cmocka_unit_test(test_surface_of_two_lobes_seen_in_a_mirror),
      cmocka_unit_test(test_mirror_shows_lamps_as_direct_and_walls_as_indirect_light),
      cmocka_unit_test(test_no_surface_returns_more_than_it_receives),
      cmocka_unit_test(test_error_falls_with_the_root_of_the_samples),
      cmocka_unit_test(test_same_bytes_at_any_number_of_threads),
      cmocka_unit_test(test_layers_sum_to_beauty),
      cmocka_unit_test(test_no_bounces_is_direct_light_alone),
      cmocka_unit_test(test_surface_layers),
      cmocka_unit_test(test_pixels_run_right_and_down),
      cmocka_unit_test(test_cancelling_leaves_no_image),
      cmocka_unit_test(test_settings_out_of_range_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
