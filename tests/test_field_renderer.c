// Tests the field renderer on fields whose content is known, so that its pictures follow in closed form.
#include "analytic_field.h"
#include "baked_field.h"
#include "core/bsdf.h"
#include "field/texels.h"
#include "light/path.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "tiny_scenes.h"

static const analytic_scene room = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const olx_grid grid = {.origin = {-0.4f, -0.4f, -0.4f}, .spacing = {0.8f, 0.8f, 0.8f}, .count = {2, 2, 2}};

// The packed formats hold these numbers exactly. No two of them give the same light, so that the test can determine
// which one was used.
static const float field_radiance = 2.0f, field_irradiance = 6.25f, field_stored = 5.5f;
static const float field_albedo = (128.0f / 255.0f) * (128.0f / 255.0f), field_emission = 4.0f;

// Returns the radiance that the field's surfaces reflect of their stored light.
static double field_shaded(void) { return (double)(field_albedo * field_stored / OLX_PI); }

static olx_field *uniform_field(uint64_t scene_hash) {
  olx_field *field = analytic_field_make(&room, &grid, 64, 16);
  uint32_t *radiance = (uint32_t *)(uintptr_t)field->radiance, *irradiance = (uint32_t *)(uintptr_t)field->irradiance;
  const size_t probes = field->info.probes.count;
  for (size_t i = 0; i < probes * field->texels; i++) radiance[i] = olx_r11g11b10f_pack(olx_splat(field_radiance));
  for (size_t i = 0; i < probes * field->irradiance_texels; i++) {
    irradiance[i] = olx_r11g11b10f_pack(olx_splat(field_irradiance));
  }
  uint32_t *stored = (uint32_t *)(uintptr_t)field->surfaces.indirect;
  uint32_t *base = (uint32_t *)(uintptr_t)field->surfaces.base;
  for (size_t i = 0; i < probes * field->texels; i++) {
    stored[i] = olx_rgb9e5_pack(olx_splat(field_stored));
    base[i] = olx_material_pack(olx_splat(field_albedo), 1.0f, 0.0f, 0.0f).base;
  }
  field->info.scene.hash = scene_hash;
  return field;
}

static void mark_everything_as_emitter(olx_field *field) {
  uint16_t *distance = (uint16_t *)(uintptr_t)field->distance;
  for (size_t i = 0; i < field->info.probes.count * field->texels; i++) distance[i] |= 0x8000u;
  uint32_t *emission = (uint32_t *)(uintptr_t)field->surfaces.emission; // the one tile of an analytic field, for all
  const size_t tiles = (size_t)field->surfaces.tile_side * field->surfaces.tile_side;
  for (size_t i = 0; i < field->info.probes.count * tiles; i++) emission[i] = 1;
}

static olx_scene *unlit_box(const olx_material *walls) {
  olx_scene *scene = tiny_scene();
  tiny_box(scene, walls);
  return tiny_finish(scene);
}

// The camera looks at the middle of the floor under an angle with cosine 0.6.
static const double view_cosine = 0.6;
static olx_camera narrow_camera(void) { return tiny_camera(olx_v3(0.8f, -0.4f, 0), olx_v3(0, -1, 0), 0.01f); }
static olx_camera wide_camera(void) { return tiny_camera(olx_v3(0.5f, 0.3f, 0.6f), olx_v3(-0.4f, -0.6f, -0.5f), 70); }

static olx_render_settings field_settings(uint32_t size, uint32_t spp) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = settings.height = size;
  settings.spp = spp;
  return settings;
}

static void test_diffuse_light_is_reflectance_times_irradiance(void **state) {
  (void)state;
  const double schlick = pow(1 - view_cosine, 5), pi = (double)OLX_PI;
  const olx_material materials[] = {tiny_lambert(0.5f, 0), tiny_plastic(0.5f, 0.4f), tiny_metal(0.5f, 0.4f)};
  const double reflectance[] = {0.5, 0.5 * (1 - 0.04 - 0.96 * schlick), 0};
  for (int m = 0; m < 3; m++) {
    olx_scene *scene = unlit_box(&materials[m]);
    olx_field *field = uniform_field(scene->hash);
    olx_render_settings settings = field_settings(4, 2);
    const olx_camera camera = narrow_camera();
    assert_int_equal(settings.diffuse, OLX_DIFFUSE_SURFACE);
    olx_image image = tiny_render(scene, field, &camera, &settings);
    const double stored = tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE);
    assert_true(tiny_mean(&image, OLX_LAYER_DIRECT) == 0);
    olx_image_free(&image);
    settings.diffuse = OLX_DIFFUSE_IRRADIANCE;
    image = tiny_render(scene, field, &camera, &settings);
    const double interpolated = tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE);
    olx_image_free(&image);
    settings.diffuse = OLX_DIFFUSE_TRACED;
    image = tiny_render(scene, field, &camera, &settings);
    const double traced = tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE);
    olx_image_free(&image);
    settings.sample.hits = OLX_HITS_STORED;
    image = tiny_render(scene, field, &camera, &settings);
    const double as_seen = tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE);
    olx_image_free(&image);
    if (m == 2) {
      assert_true(stored == 0 && interpolated == 0 && traced == 0 && as_seen == 0);
    } else {
      assert_close(stored, reflectance[m] * (double)field_stored / pi, 1e-4, "stored");
      assert_close(interpolated, reflectance[m] * (double)field_irradiance / pi, 1e-4, "interpolated");
      assert_close(traced, reflectance[m] * field_shaded(), 1e-4, "traced");
      assert_close(as_seen, reflectance[m] * (double)field_radiance, 1e-4, "traced, as probes saw it");
    }
    analytic_field_free(field);
    olx_scene_free(scene);
  }
}

static void test_glossy_light_is_directional_albedo_times_radiance(void **state) {
  (void)state;
  const float roughness[] = {0.0f, 0.3f, 0.8f};
  for (int i = 0; i < 3; i++) {
    const olx_material materials[] = {tiny_metal(0.7f, roughness[i]), tiny_plastic(0.5f, roughness[i])};
    for (int m = 0; m < 2; m++) {
      olx_scene *scene = unlit_box(&materials[m]);
      olx_field *field = uniform_field(scene->hash);
      olx_render_settings settings = field_settings(8, 16);
      settings.glossy_samples = 8;
      const olx_camera camera = narrow_camera();
      olx_image image = tiny_render(scene, field, &camera, &settings);
      const double f0 = m ? 0.04 : 0.7;
      const double albedo = roughness[i] > 0 ? tiny_directional_albedo(f0, (double)roughness[i], view_cosine)
                                             : f0 + (1 - f0) * pow(1 - view_cosine, 5);
      assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY), albedo * field_shaded(), 5e-3, "glossy");
      olx_image_free(&image);
      analytic_field_free(field);
      olx_scene_free(scene);
    }
  }
}

// A floor whose normals lean by `lean` radians away from the camera, below a ceiling of the same metal.
static olx_scene *leaning_floor(const olx_material *metal, float lean) {
  const olx_vec3 corners[4] = {{-1, -1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}};
  const olx_vec3 normal = {-sinf(lean), cosf(lean), 0}, normals[4] = {normal, normal, normal, normal};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  olx_scene *scene = tiny_scene();
  uint32_t material = 0;
  tiny_quad(scene, metal, olx_v3(0, 1, 0), olx_v3(2, 0, 0), olx_v3(0, 0, 2));
  ASSERT_OK(olx_scene_add_material(scene, metal, &material));
  ASSERT_OK(olx_scene_add_mesh(scene, "floor", corners, normals, NULL, 4, indices, 2, material));
  return tiny_finish(scene);
}

// Directions of the lobe around an interpolated normal that lead into the surface bring no light, as in path tracing.
static void test_nothing_is_reflected_from_below_the_surface(void **state) {
  (void)state;
  const olx_material metal = tiny_metal(0.7f, 0.5f);
  olx_scene *scene = leaning_floor(&metal, 0.6f);
  olx_field *field = uniform_field(scene->hash);
  olx_render_settings settings = field_settings(8, 16);
  settings.glossy_samples = 8;
  const olx_camera camera = narrow_camera();
  olx_image image = tiny_render(scene, field, &camera, &settings);
  const olx_ray ray = {camera.eye, olx_normalize(olx_sub(camera.target, camera.eye)), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
  const olx_shading shading = olx_shading_make(&surface, ray.direction);
  enum { DRAWS = 65536 };
  double reflected = 0, below = 0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    const olx_lobe_ray lobe = olx_lobe_ray_specular(&shading, olx_stratified2(i, 1));
    reflected += (double)lobe.weight.x / DRAWS;
    below += (double)(lobe.direction.y <= 0.0f) / DRAWS;
  }
  assert_true(below > 0.2);
  assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY), reflected * field_shaded(), 1e-2, "glossy");
  olx_image_free(&image);
  analytic_field_free(field);
  olx_scene_free(scene);
}

static void test_surfaces_without_a_specular_lobe_trace_nothing(void **state) {
  (void)state;
  const olx_material walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = unlit_box(&walls);
  olx_field *field = uniform_field(scene->hash);
  olx_render_settings settings = field_settings(8, 2);
  settings.diffuse_samples = 5;
  const olx_camera camera = wide_camera();
  for (int traced = 0; traced < 2; traced++) {
    settings.diffuse = traced ? OLX_DIFFUSE_TRACED : OLX_DIFFUSE_IRRADIANCE;
    olx_image image;
    olx_render_stats stats;
    ASSERT_OK(olx_render(scene, field, &camera, &settings, NULL, &image, &stats));
    assert_int_equal(stats.field_rays, traced ? 8 * 8 * 2 * 5 : 0);
    assert_int_equal(stats.rays, 8 * 8 * 2); // only camera rays, since nothing emits
    assert_true(tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY) == 0);
    assert_true(stats.seconds > 0 && stats.primary_seconds > 0 && stats.diffuse_seconds > 0);
    olx_image_free(&image);
  }
  analytic_field_free(field);
  olx_scene_free(scene);
}

static void test_mirror_floor_shows_the_room_in_place(void **state) {
  (void)state;
  const olx_material floor = tiny_metal(0.9f, 0), walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = tiny_scene();
  tiny_box(scene, &walls);
  // This quad is slightly above the floor of the box, so that the field's geometry agrees with the scene's.
  tiny_quad(scene, &floor, olx_v3(0, -0.9999f, 0), olx_v3(0, 0, 2), olx_v3(2, 0, 0));
  tiny_finish(scene);
  olx_field *field = analytic_field_make(&room, &grid, 256, 16);
  field->info.scene.hash = scene->hash;
  const olx_camera camera = tiny_camera(olx_v3(0.2f, 0.3f, 0.1f), olx_v3(0.1f, -1, -0.1f), 60);
  const olx_render_settings settings = field_settings(48, 1);
  olx_image image = tiny_render(scene, field, &camera, &settings);
  olx_camera_frame frame;
  ASSERT_OK(olx_camera_frame_make(&camera, 48, 48, &frame));
  double error = 0, reference = 0;
  for (uint32_t i = 0; i < 48 * 48; i++) {
    if (image.layers[OLX_LAYER_INDIRECT_GLOSSY][i].x == 0.0f) continue; // a pixel beside the mirror
    const olx_vec3 d = olx_camera_direction(&frame, ((float)(i % 48) + 0.5f) / 48, ((float)(i / 48) + 0.5f) / 48);
    const olx_vec3 on_floor = olx_madd(frame.eye, d, (-0.9999f - frame.eye.y) / d.y);
    const olx_vec3 reflected = olx_v3(d.x, -d.y, d.z);
    const analytic_hit hit = analytic_cast(&room, on_floor, reflected);
    const float fresnel = 0.9f + 0.1f * olx_pow5(1 - reflected.y);
    const olx_vec3 expected = olx_scale(analytic_radiance(olx_madd(on_floor, reflected, hit.t), hit.normal), fresnel);
    const olx_vec3 difference = olx_sub(image.layers[OLX_LAYER_INDIRECT_GLOSSY][i], expected);
    error += (double)olx_dot(difference, difference);
    reference += (double)olx_dot(expected, expected);
  }
  assert_true(reference > 1000);
  print_message("relative error of the mirror image %.2g\n", error / reference);
  assert_true(error < 5e-4 * reference);
  olx_image_free(&image);
  analytic_field_free(field);
  olx_scene_free(scene);
}

// --- Direct light and emitters ---------------------------------------------------------------------------------------

static olx_scene *lit_box(bool lamp) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_plastic(0.7f, 0.4f);
  tiny_box(scene, &walls);
  const olx_light point = {.type = OLX_LIGHT_POINT, .position = {0.2f, 0.5f, 0.1f}, .emission = {1, 2, 3}};
  ASSERT_OK(olx_scene_add_light(scene, &point));
  if (lamp) {
    const olx_vec3 u = {0.5f, 0, 0}, v = {0, 0, 0.5f};
    ASSERT_OK(olx_scene_add_rect_light(scene, olx_v3(0, 0.98f, 0), u, v, olx_splat(8)));
  }
  return tiny_finish(scene);
}

static olx_image render_lit(const olx_scene *scene, const olx_field *field, const olx_render_settings *settings) {
  const olx_camera camera = wide_camera();
  return tiny_render(scene, field, &camera, settings);
}

static void test_direct_light_is_the_path_tracers(void **state) {
  (void)state;
  for (int lamp = 0; lamp < 2; lamp++) {
    olx_scene *scene = lit_box(lamp == 1);
    olx_field *field = uniform_field(scene->hash);
    olx_render_settings settings = field_settings(16, lamp ? 256 : 4);
    olx_image a = render_lit(scene, field, &settings);
    settings.method = OLX_METHOD_PATH;
    settings.bounces = 0;
    olx_image b = render_lit(scene, NULL, &settings);
    const olx_vec3 *direct_a = a.layers[OLX_LAYER_DIRECT], *direct_b = b.layers[OLX_LAYER_DIRECT];
    if (!lamp) assert_memory_equal(direct_a, direct_b, 16 * 16 * sizeof(olx_vec3));
    assert_close(tiny_mean(&a, OLX_LAYER_DIRECT), tiny_mean(&b, OLX_LAYER_DIRECT), 2e-3, "direct light");
    olx_image_free(&a);
    olx_image_free(&b);
    analytic_field_free(field);
    olx_scene_free(scene);
  }
}

static void test_emitters_are_counted_once(void **state) {
  (void)state;
  olx_scene *with_lamp = lit_box(true), *without = lit_box(false);
  olx_field *field = uniform_field(with_lamp->hash);
  olx_render_settings settings = field_settings(16, 4);
  settings.diffuse = OLX_DIFFUSE_TRACED;
  olx_image dark = render_lit(with_lamp, field, &settings);
  mark_everything_as_emitter(field);
  // Direct light samples emitters, so traced light leaves out their emission, and keeps their reflected light.
  olx_image sampled = render_lit(with_lamp, field, &settings);
  const size_t bytes = 16 * 16 * sizeof(olx_vec3);
  assert_memory_equal(sampled.layers[OLX_LAYER_INDIRECT_DIFFUSE], dark.layers[OLX_LAYER_INDIRECT_DIFFUSE], bytes);
  assert_memory_equal(sampled.layers[OLX_LAYER_INDIRECT_GLOSSY], dark.layers[OLX_LAYER_INDIRECT_GLOSSY], bytes);
  // With traced emitters, the indirect layers contain emission, and direct light comes only from lamps without area.
  settings.sample.emitters = true;
  olx_image traced = render_lit(with_lamp, field, &settings);
  const double more = 1 + (double)field_emission / field_shaded();
  for (int layer = OLX_LAYER_INDIRECT_DIFFUSE; layer <= OLX_LAYER_INDIRECT_GLOSSY; layer++) {
    const double reflected = tiny_mean(&sampled, (olx_layer)layer);
    assert_true(reflected > 0.01);
    assert_close(tiny_mean(&traced, (olx_layer)layer), more * reflected, 1e-4, "emitted and reflected");
  }
  field->info.scene.hash = without->hash;
  olx_image points = render_lit(without, field, &settings);
  assert_close(tiny_mean(&traced, OLX_LAYER_DIRECT), tiny_mean(&points, OLX_LAYER_DIRECT), 2e-2, "direct light");
  assert_true(tiny_mean(&traced, OLX_LAYER_DIRECT) < 0.8 * tiny_mean(&sampled, OLX_LAYER_DIRECT));
  olx_image_free(&dark);
  olx_image_free(&sampled);
  olx_image_free(&traced);
  olx_image_free(&points);
  analytic_field_free(field);
  olx_scene_free(with_lamp);
  olx_scene_free(without);
}

// --- Baked fields ----------------------------------------------------------------------------------------------------

// Bakes few light field probes, since each sees all of a box, and as many irradiance probes as by default.
static olx_bake_settings bake_settings(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = grid;
  settings.radiance_size = 64;
  settings.noise = 0.05f;
  return settings;
}

static olx_field *bake(const olx_scene *scene, uint32_t bounces, bool fit) {
  olx_bake_settings settings = bake_settings(scene);
  settings.probe_light = true;
  settings.irradiance_size = 16;
  settings.bounces = bounces;
  settings.fit = fit;
  return baked_field(scene, &settings, NULL);
}

// Default pictures do not read probe light: they have the same bytes with and without it. Settings that read it are
// refused without it, except dim lobes beside traced light, which take the light of surfaces.
static void test_a_field_without_probe_light_gives_the_same_picture(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 1.0f);
  olx_bake_settings wanted = bake_settings(scene);
  wanted.bounces = 1;
  olx_field *plain = baked_field(scene, &wanted, NULL), *full = bake(scene, 1, true);
  assert_int_equal(olx_field_describe(plain).irradiance.probe_count, 0);
  olx_render_settings settings = field_settings(24, 4);
  const olx_camera camera = wide_camera();
  olx_image pictures[] = {tiny_render(scene, plain, &camera, &settings), tiny_render(scene, full, &camera, &settings)};
  assert_true(tiny_mean(&pictures[0], OLX_LAYER_INDIRECT_DIFFUSE) > 0);
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; layer++) {
    if (!pictures[0].layers[layer]) continue;
    assert_memory_equal(pictures[0].layers[layer], pictures[1].layers[layer], sizeof(olx_vec3) * 24 * 24);
  }
  for (int i = 0; i < 2; i++) olx_image_free(&pictures[i]);
  settings.dim_lobe = 1.0f;
  settings.diffuse = OLX_DIFFUSE_TRACED;
  olx_image traced = tiny_render(scene, plain, &camera, &settings);
  olx_image_free(&traced);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE;
  olx_image image;
  assert_int_equal(olx_render(scene, plain, &camera, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "bake --probe-light"));
  settings.diffuse = OLX_DIFFUSE_SURFACE;
  settings.sample.hits = OLX_HITS_STORED;
  assert_int_equal(olx_render(scene, plain, &camera, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "bake --probe-light"));
  olx_field_close(plain);
  olx_field_close(full);
  olx_scene_free(scene);
}

// In a furnace of albedo a and emission 1, a bake with N bounces contains reflected light a + a^2 + ... + a^(N + 1).
static void test_baked_furnace(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 1.0f);
  for (uint32_t bounces = 0; bounces <= 3; bounces += 3) {
    olx_field *field = bake(scene, bounces, true);
    const double reflected = bounces ? 0.5 + 0.25 + 0.125 + 0.0625 : 0.5;
    olx_render_settings settings = field_settings(16, 16);
    olx_image image = render_lit(scene, field, &settings);
    assert_close(tiny_mean(&image, OLX_LAYER_DIRECT), 0.5, 2e-3, "direct");
    assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE), 0.5 * reflected, 5e-3, "indirect");
    assert_close(tiny_mean(&image, OLX_LAYER_BEAUTY), 1.5 + 0.5 * reflected, 5e-3, "beauty");
    olx_image_free(&image);
    // When emitters are traced instead of sampled, rays find emission and reflected light together.
    settings.sample.emitters = true;
    settings.diffuse = OLX_DIFFUSE_TRACED;
    image = render_lit(scene, field, &settings);
    assert_true(tiny_mean(&image, OLX_LAYER_DIRECT) == 0);
    assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE), 0.5 * (1 + reflected), 5e-3, "traced with emitters");
    olx_image_free(&image);
    settings.sample.emitters = false;
    image = render_lit(scene, field, &settings);
    assert_close(tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE), 0.5 * reflected, 5e-3, "traced");
    olx_image_free(&image);
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// In a glossy box under a lamp, walls that emit faintly keep their reflected light.
static void test_faintly_emitting_box_is_the_path_tracers(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  olx_material walls = tiny_plastic(0.7f, 0.4f);
  walls.emission = olx_splat(0.01f);
  tiny_box(scene, &walls);
  const olx_light point = {.type = OLX_LIGHT_POINT, .position = {0.2f, 0.5f, 0.1f}, .emission = {1, 2, 3}};
  ASSERT_OK(olx_scene_add_light(scene, &point));
  tiny_finish(scene);
  olx_field *field = bake(scene, 3, true);
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = settings.height = 24;
  settings.spp = 256;
  settings.bounces = 4;
  olx_image reference = render_lit(scene, NULL, &settings);
  settings = field_settings(24, 16);
  settings.diffuse = OLX_DIFFUSE_TRACED;
  for (int hits = OLX_HITS_SHADED; hits <= OLX_HITS_STORED; hits++) {
    settings.sample.hits = (olx_hits)hits;
    olx_image image = render_lit(scene, field, &settings);
    for (int layer = OLX_LAYER_INDIRECT_DIFFUSE; layer <= OLX_LAYER_INDIRECT_GLOSSY; layer++) {
      olx_metrics metrics;
      ASSERT_OK(olx_compare(&image, &reference, (olx_layer)layer, &metrics));
      print_message("hits %d, %s: bias %.4f, relative mse %.5f\n", hits, olx_layer_name((olx_layer)layer), metrics.bias,
                    metrics.relative_mse);
      assert_true(fabs(metrics.bias) < 0.03);
    }
    olx_image_free(&image);
  }
  olx_image_free(&reference);
  olx_field_close(field);
  olx_scene_free(scene);
}

static const olx_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

// At a probe's position nothing is interpolated: a bake without bounces has the irradiance that a path tracer finds
// with one.
static void test_irradiance_at_probes_is_the_path_tracers(void **state) {
  (void)state;
  olx_scene *scene = lit_box(true);
  olx_field *field = bake(scene, 0, false);
  const olx_sample_settings settings = olx_sample_settings_default();
  double sum = 0, reference = 0;
  for (uint32_t probe = 0; probe < 64; probe += 7) {
    const olx_vec3 position = field->irradiance_positions[probe];
    for (int k = 0; k < 6; k++) {
      const olx_vec3 e = olx_irradiance(field, &settings, position, axes[k], axes[k]);
      const olx_vec3 truth = olx_path_irradiance(scene, position, axes[k], 0, 1, 1 << 12, probe);
      assert_close((double)e.y, (double)truth.y, 0.03, "irradiance");
      sum += (double)e.y, reference += (double)truth.y;
    }
  }
  assert_close(sum, reference, 3e-3, "mean irradiance");
  olx_field_close(field);
  olx_scene_free(scene);
}

static void compare_with_path_tracer(const olx_scene *scene, const olx_field *field, const double limits[2][3]) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = settings.height = 24;
  settings.spp = 1024;
  settings.bounces = 1;
  olx_image reference = render_lit(scene, NULL, &settings);
  settings = field_settings(24, 16);
  for (int traced = 0; traced < 2; traced++) {
    settings.diffuse = traced ? OLX_DIFFUSE_TRACED : OLX_DIFFUSE_IRRADIANCE;
    olx_image image = render_lit(scene, field, &settings);
    const olx_layer layers[] = {OLX_LAYER_DIRECT, OLX_LAYER_INDIRECT_DIFFUSE, OLX_LAYER_INDIRECT_GLOSSY};
    for (int i = 0; i < 3; i++) {
      olx_metrics metrics;
      ASSERT_OK(olx_compare(&image, &reference, layers[i], &metrics));
      print_message("%s, %s: bias %.4f, relative mse %.5f\n", traced ? "traced" : "interpolated",
                    olx_layer_name(layers[i]), metrics.bias, metrics.relative_mse);
      assert_true(metrics.relative_mse <= limits[traced][i]);
    }
    olx_image_free(&image);
  }
  olx_image_free(&reference);
}

// Between probes, light differs by the error of interpolation and by reflections that a probe sees from its own
// position; traced diffuse light has neither error.
static void test_baked_room_agrees_with_the_path_tracer(void **state) {
  (void)state;
  olx_scene *scene = lit_box(false);
  olx_field *field = bake(scene, 0, true);
  compare_with_path_tracer(scene, field, (const double[2][3]){{1e-4, 0.02, 0.012}, {1e-4, 5e-4, 0.012}});
  olx_field_close(field);
  olx_scene_free(scene);
}

// The texels around a lamp contain none of its light, since traced rays would count it twice.
static void test_surfaces_beside_a_lamp_hold_none_of_its_light(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(0.7f, 0);
  const olx_vec3 u = {0.2f, 0, 0}, v = {0, 0, 0.2f};
  tiny_box(scene, &walls);
  ASSERT_OK(olx_scene_add_rect_light(scene, olx_v3(0.1f, 0.98f, 0), u, v, olx_splat(40)));
  tiny_finish(scene);
  olx_field *field = bake(scene, 0, true);
  compare_with_path_tracer(scene, field, (const double[2][3]){{1e-3, 0.02, 0}, {1e-3, 1e-3, 0}});
  olx_field_close(field);
  olx_scene_free(scene);
}

// --- The image -------------------------------------------------------------------------------------------------------

static void test_same_bytes_at_any_number_of_threads(void **state) {
  (void)state;
  olx_scene *scene = lit_box(true);
  olx_field *field = analytic_field_make(&room, &grid, 64, 16);
  field->info.scene.hash = scene->hash;
  olx_render_settings settings = field_settings(29, 3);
  settings.diffuse_samples = 4;
  settings.standard_error = true;
  for (int diffuse = OLX_DIFFUSE_SURFACE; diffuse <= OLX_DIFFUSE_TRACED; diffuse++) {
    settings.diffuse = (olx_diffuse)diffuse;
    settings.threads = 1;
    olx_image one = render_lit(scene, field, &settings);
    for (uint32_t threads = 2; threads <= 5; threads += 3) {
      settings.threads = threads;
      olx_image other = render_lit(scene, field, &settings);
      for (int layer = 0; layer < OLX_LAYER_COUNT; layer++) {
        assert_memory_equal(one.layers[layer], other.layers[layer], 29 * 29 * sizeof(olx_vec3));
      }
      olx_image_free(&other);
    }
    olx_image_free(&one);
  }
  analytic_field_free(field);
  olx_scene_free(scene);
}

static void count_warnings(void *user, olx_log_level level, const char *message) {
  if (level == OLX_LOG_WARNING && strstr(message, "another scene")) ++*(int *)user;
}

static olx_audit_settings audit_settings(void) {
  return (olx_audit_settings){.rays = 1, .points = 1, .spp = 1, .sample = olx_sample_settings_default()};
}

// Rendering and the audit warn alike. A field whose lights have changed has the hash 0, and is of no scene in
// particular.
static void test_field_of_another_scene_is_used_with_a_warning(void **state) {
  (void)state;
  const olx_material walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = unlit_box(&walls);
  const uint64_t hashes[] = {scene->hash, 0, scene->hash + 1};
  int warnings = 0;
  const olx_hooks hooks = {.user = &warnings, .log = count_warnings};
  olx_set_hooks(&hooks);
  for (int i = 0; i < 3; i++) {
    olx_field *field = uniform_field(hashes[i]);
    const olx_render_settings settings = field_settings(4, 1);
    olx_image image = render_lit(scene, field, &settings);
    assert_int_equal(warnings, i / 2);
    assert_true(tiny_mean(&image, OLX_LAYER_INDIRECT_DIFFUSE) > 0);
    olx_image_free(&image);
    const olx_audit_settings audit = audit_settings();
    olx_audit found;
    ASSERT_OK(olx_audit_field(scene, field, &audit, NULL, &found));
    assert_int_equal(warnings, i / 2 * 2);
    analytic_field_free(field);
  }
  olx_set_hooks(NULL);
  olx_scene_free(scene);
}

// Of two cameras each gets rays of both kinds, even if only one of them sees a surface.
static void test_each_camera_is_judged_by_both_kinds_of_rays(void **state) {
  (void)state;
  const olx_material walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = tiny_scene();
  tiny_box(scene, &walls);
  const olx_camera cameras[] = {wide_camera(), tiny_camera(olx_v3(0, 50, 0), olx_v3(0, 90, 0), 60)};
  for (int i = 0; i < 2; i++) ASSERT_OK(olx_scene_add_camera(scene, &cameras[i]));
  tiny_finish(scene);
  olx_field *field = uniform_field(scene->hash);
  olx_audit_settings settings = audit_settings();
  settings.rays = 400;
  olx_audit found;
  ASSERT_OK(olx_audit_field(scene, field, &settings, NULL, &found));
  assert_true(found.cosine.count > 80 && found.mirror.count > 80);
  analytic_field_free(field);
  olx_scene_free(scene);
}

static void test_settings_out_of_range_are_refused(void **state) {
  (void)state;
  const olx_material walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = unlit_box(&walls);
  olx_field *field = uniform_field(scene->hash);
  const olx_camera camera = wide_camera();
  olx_image image;
  const olx_render_settings good = field_settings(4, 1);
  olx_render_settings bad[] = {good, good, good, good};
  bad[0].glossy_samples = 0;
  bad[1].glossy_samples = 4097;
  bad[2].diffuse_samples = 0;
  bad[3].diffuse = (olx_diffuse)7;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(olx_render(scene, field, &camera, &bad[i], NULL, &image, NULL), OLX_ERROR_ARGUMENT);
    assert_true(strlen(olx_last_error()) > 0);
  }
  analytic_field_free(field);
  olx_scene_free(scene);
}

static void test_audit_refuses_settings_out_of_range(void **state) {
  (void)state;
  const olx_material walls = tiny_lambert(0.5f, 0);
  olx_scene *scene = unlit_box(&walls);
  olx_field *field = uniform_field(scene->hash);
  const olx_audit_settings good = audit_settings();
  olx_audit_settings bad[] = {good, good, good, good};
  bad[0].spp = 0;
  bad[1].rays = (1u << 30) + 1;
  bad[2].points = (1u << 30) + 1;
  bad[3].space_points = (1u << 26) + 1;
  olx_audit found;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(olx_audit_field(scene, field, &bad[i], NULL, &found), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "audit: "));
  }
  ASSERT_OK(olx_audit_field(scene, field, &good, NULL, &found));
  analytic_field_free(field);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_each_camera_is_judged_by_both_kinds_of_rays),
      cmocka_unit_test(test_diffuse_light_is_reflectance_times_irradiance),
      cmocka_unit_test(test_glossy_light_is_directional_albedo_times_radiance),
      cmocka_unit_test(test_nothing_is_reflected_from_below_the_surface),
      cmocka_unit_test(test_surfaces_without_a_specular_lobe_trace_nothing),
      cmocka_unit_test(test_mirror_floor_shows_the_room_in_place),
      cmocka_unit_test(test_direct_light_is_the_path_tracers),
      cmocka_unit_test(test_emitters_are_counted_once),
      cmocka_unit_test(test_a_field_without_probe_light_gives_the_same_picture),
      cmocka_unit_test(test_baked_furnace),
      cmocka_unit_test(test_faintly_emitting_box_is_the_path_tracers),
      cmocka_unit_test(test_irradiance_at_probes_is_the_path_tracers),
      cmocka_unit_test(test_baked_room_agrees_with_the_path_tracer),
      cmocka_unit_test(test_surfaces_beside_a_lamp_hold_none_of_its_light),
      cmocka_unit_test(test_same_bytes_at_any_number_of_threads),
      cmocka_unit_test(test_field_of_another_scene_is_used_with_a_warning),
      cmocka_unit_test(test_settings_out_of_range_are_refused),
      cmocka_unit_test(test_audit_refuses_settings_out_of_range),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
