// Tests the surfaces that light field probes store (material, direct and indirect irradiance, emission, lights) in
// scenes whose light is known.
#include "baked_field.h"
#include "made_scenes.h"

#include "bake/capture/texel_blocks.h"
#include "bake/capture/texel_light.h"
#include "core/octahedral.h"
#include "scene/builtin/builtin_shapes.h"
#include "trace/texel_shade.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIZE = 32 };

static olx_bake_settings settings_at(const olx_scene *scene, olx_vec3 position, olx_bake_light light) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = settings.irradiance_grid = (olx_grid){.origin = position, .count = {1, 1, 1}};
  settings.radiance_size = SIZE;
  settings.irradiance_size = 32;
  settings.threads = 2;
  settings.light = light;
  settings.uncompressed = true; // texels keep captured values with the smallest steps
  return settings;
}

static olx_vec3 towards(uint32_t x, uint32_t y) { return olx_texel_direction(x, y, SIZE); }
static size_t texel_at(uint32_t x, uint32_t y) { return olx_map_index(SIZE + 2, (int32_t)x, (int32_t)y); }

static void assert_near(olx_vec3 found, olx_vec3 truth, float tolerance) {
  const olx_vec3 off = olx_sub(found, truth);
  if (fabsf(off.x) <= tolerance && fabsf(off.y) <= tolerance && fabsf(off.z) <= tolerance) return;
  fail_msg("(%g, %g, %g) where (%g, %g, %g) belongs", (double)found.x, (double)found.y, (double)found.z,
           (double)truth.x, (double)truth.y, (double)truth.z);
}

static float series(float ratio, uint32_t first, uint32_t last) {
  float sum = 0.0f;
  for (uint32_t i = first; i <= last; i++) sum += powf(ratio, (float)i);
  return sum;
}

// Reads one value of a texel; mean_of averages it over the map.
typedef olx_vec3 (*texel_reader)(const olx_field *field, uint32_t probe, size_t texel);
static float mean_of(const olx_field *field, texel_reader read) {
  double sum = 0.0;
  for (uint32_t i = 0; i < SIZE * SIZE; i++) sum += (double)read(field, 0, texel_at(i % SIZE, i / SIZE)).y;
  return (float)(sum / (SIZE * SIZE));
}

// In a closed room that emits, walls reflect the light that they receive, whatever they emit; shading them gives the
// series of all bounces. Nine bits leave a relative error of 2^-9; the means of 1,024 texels have noise of 0.2 %.
static void furnace_keeps_its_light(olx_bake_light light) {
  const float albedo = 0.5f, emission = 2.0f;
  olx_scene *scene = made_scene();
  const uint32_t wall = made_material(scene, &(olx_material){.base_color = olx_splat(albedo),
                                                             .roughness = 1.0f,
                                                             .emission = olx_splat(emission),
                                                             .base_color_texture = OLX_NO_TEXTURE,
                                                             .alpha_texture = OLX_NO_TEXTURE,
                                                             .metallic_roughness_texture = OLX_NO_TEXTURE,
                                                             .emission_texture = OLX_NO_TEXTURE,
                                                             .normal_texture = OLX_NO_TEXTURE});
  made_room(scene, olx_splat(0.0f), 2.0f, wall);
  made_finish(scene);
  for (uint32_t bounces = 0; bounces < 4; bounces += 3) {
    olx_bake_settings settings = settings_at(scene, olx_v3(0.2f, 0.1f, -0.3f), light);
    settings.bounces = bounces;
    settings.light_samples = 4;
    settings.reference_paths = 32;
    olx_field *field = baked_field(scene, &settings, NULL);
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
      const size_t texel = texel_at(i % SIZE, i / SIZE);
      assert_near(olx_texel_emission(field, 0, texel), olx_splat(emission), 0.0f);
      // Half a step of the stored root.
      assert_near(olx_texel_material(field, 0, texel).albedo, olx_splat(albedo), 0.003f);
    }
    const float direct = OLX_PI * emission, indirect = direct * series(albedo, 1, bounces + 1);
    assert_float_equal(mean_of(field, olx_texel_direct), direct, 0.005f * direct);
    assert_float_equal(mean_of(field, olx_texel_indirect), indirect, 0.005f * indirect);
    double sum = 0.0;
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
      const uint32_t x = i % SIZE, y = i / SIZE;
      const size_t texel = texel_at(x, y);
      const olx_vec3 direction = towards(x, y),
                     position = olx_madd(field->probe_positions[0], direction, olx_texel_distance(field, 0, texel));
      const olx_texel_light seen = olx_texel_shade(field, 0, texel, position, direction, false);
      assert_near(seen.lobe, olx_splat(0.0f), 0.0f);
      sum += (double)seen.reflected.x / (SIZE * SIZE);
    }
    // Paths from texels do not separate the share of the last bounce, so that share is not left out.
    const uint32_t surfaces = light == OLX_LIGHT_REFERENCE ? bounces + 2 : bounces + 1;
    const float reflected = emission * series(albedo, 1, surfaces);
    assert_float_equal((float)sum, reflected, 0.008f * reflected);
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

static void white_furnace_by_cache(void **state) {
  (void)state;
  furnace_keeps_its_light(OLX_LIGHT_CACHE);
}

static void white_furnace_by_reference(void **state) {
  (void)state;
  furnace_keeps_its_light(OLX_LIGHT_REFERENCE);
}

static olx_material plain(olx_vec3 base_color) {
  return (olx_material){.base_color = base_color,
                        .roughness = 1.0f,
                        .base_color_texture = OLX_NO_TEXTURE,
                        .alpha_texture = OLX_NO_TEXTURE,
                        .metallic_roughness_texture = OLX_NO_TEXTURE,
                        .emission_texture = OLX_NO_TEXTURE,
                        .normal_texture = OLX_NO_TEXTURE};
}

static void add_light(olx_scene *scene, const olx_light *light) {
  assert_int_equal(olx_scene_add_light(scene, light), OLX_OK);
}

// The walls of a room with a lamp receive E = I cos / r^2 whether they emit faintly or not, and store no more light
// than without emission.
static void faint_glow_hides_nothing(void **state) {
  (void)state;
  olx_field *field[2];
  const float glow = 0.01f;
  for (uint32_t k = 0; k < 2; k++) {
    olx_scene *scene = made_scene();
    olx_material material = plain(olx_v3(0.8f, 0.4f, 0.2f));
    material.emission = olx_splat(k ? glow : 0.0f);
    made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &material));
    add_light(scene,
              &(olx_light){.type = OLX_LIGHT_POINT, .position = {0.0f, 0.0f, 0.0f}, .emission = {5.0f, 5.0f, 5.0f}});
    made_finish(scene);
    olx_bake_settings settings = settings_at(scene, olx_v3(0.2f, 0.1f, -0.3f), OLX_LIGHT_REFERENCE);
    settings.reference_paths = 4;
    field[k] = baked_field(scene, &settings, NULL);
    olx_scene_free(scene);
  }
  for (uint32_t i = 0; i < SIZE * SIZE; i++) {
    const size_t at = texel_at(i % SIZE, i / SIZE);
    assert_int_equal(field[0]->surfaces.base[at], field[1]->surfaces.base[at]);
    assert_near(olx_texel_emission(field[0], 0, at), olx_splat(0.0f), 0.0f);
    assert_near(olx_texel_emission(field[1], 0, at), olx_splat(glow), glow / 512.0f);
    const olx_vec3 p = olx_madd(olx_field_probe_position(field[1], 0), towards(i % SIZE, i / SIZE),
                                olx_texel_distance(field[1], 0, at));
    const float r = olx_length(p), cosine = -olx_dot(olx_texel_normal(field[1], 0, at), p) / r;
    const float lamp = 5.0f * cosine / (r * r);
    // Samples are up to a quarter of a texel away from its middle in each direction, and light falls with the cube of
    // the distance. The walls' direct light from each other is pi times their emission.
    const float facing = -olx_dot(olx_texel_normal(field[1], 0, at), towards(i % SIZE, i / SIZE));
    const float footprint = olx_texel_distance(field[1], 0, at) * 3.545f / SIZE / facing;
    const float spread = lamp * 3.0f * 0.36f * footprint / r + 0.01f * lamp;
    assert_near(olx_texel_direct(field[0], 0, at), olx_splat(lamp), spread);
  }
  olx_field_close(field[0]);
  olx_field_close(field[1]);
}

// A square is lit by a uniform sky and a sun; texels that do not show the square show sky.
static void sky_and_sun_light_a_square(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = plain(olx_splat(0.6f));
  made_square(scene, 0.0f, made_material(scene, &material));
  // This sheet, which the probe does not see, casts its shadow on the half x > 0.
  made_quad(scene, olx_v3(1.0f, 50.0f, 0.0f), olx_v3(0.0f, 0.0f, 2.0f), olx_v3(2.0f, 0.0f, 0.0f), 0);
  scene->environment.radiance = olx_v3(0.5f, 1.0f, 2.0f);
  add_light(scene,
            &(olx_light){.type = OLX_LIGHT_SUN, .direction = {0.0f, -1.0f, 0.0f}, .emission = {3.0f, 2.0f, 1.0f}});
  made_finish(scene);
  olx_bake_settings settings = settings_at(scene, olx_v3(0.0f, 0.5f, 0.0f), OLX_LIGHT_REFERENCE);
  settings.reference_paths = 4;
  settings.light_samples = 16;
  settings.samples = 4;
  olx_field *field = baked_field(scene, &settings, NULL);
  uint32_t lit = 0, shaded = 0, sky = 0;
  for (uint32_t i = 0; i < SIZE * SIZE; i++) {
    const size_t at = texel_at(i % SIZE, i / SIZE);
    const float distance = olx_texel_distance(field, 0, at);
    const olx_vec3 d = towards(i % SIZE, i / SIZE), p = olx_madd(olx_v3(0.0f, 0.5f, 0.0f), d, distance);
    if (distance == INFINITY) {
      sky++;
      assert_near(olx_texel_emission(field, 0, at), olx_v3(0.5f, 1.0f, 2.0f), 0.0f);
      assert_near(olx_texel_direct(field, 0, at), olx_splat(0.0f), 0.0f);
      continue;
    }
    if (p.y > 1.0f) continue; // a texel of the sheet
    assert_near(olx_texel_emission(field, 0, at), olx_splat(0.0f), 0.0f);
    if (fabsf(p.x) < 0.2f) continue; // a texel that the shadow's edge may cross
    const olx_vec3 direct =
        olx_madd(p.x < 0.0f ? olx_v3(3.0f, 2.0f, 1.0f) : olx_splat(0.0f), olx_v3(0.5f, 1.0f, 2.0f), OLX_PI);
    assert_near(olx_texel_direct(field, 0, at), direct, 0.02f * direct.z);
    *(p.x < 0.0f ? &lit : &shaded) += 1;
  }
  // The sheet covers 0.0004 of the sphere around a point, and reflects no more than 0.6 of the light that it receives.
  assert_true(mean_of(field, olx_texel_indirect) < 0.01f);
  assert_true(lit > 50 && shaded > 50 && sky > 300);
  const olx_field_light *sun = field->surfaces.lights;
  assert_int_equal(field->surfaces.light_count, 1);
  assert_true(sun->type == OLX_LIGHT_SUN && sun->direction.y == -1.0f && sun->emission.x == 3.0f &&
              sun->position.y == 0.0f);
  olx_field_close(field);
  olx_scene_free(scene);
}

// Stripes of red and blue are a tenth of a texel wide, so many samples see about as much of both. Makes a black room of
// side 2 with a square window in the wall at x = 1, through which an even sky of radiance 1 shines.
static olx_scene *room_with_a_window(float half) {
  olx_scene *scene = made_scene();
  const olx_material black = plain(olx_splat(0.0f));
  const uint32_t paint = made_material(scene, &black);
  const olx_vec3 x = {2, 0, 0}, y = {0, 2, 0}, z = {0, 0, 2};
  made_quad(scene, olx_v3(-1, 0, 0), y, z, paint);
  made_quad(scene, olx_v3(0, -1, 0), z, x, paint);
  made_quad(scene, olx_v3(0, 1, 0), x, z, paint);
  made_quad(scene, olx_v3(0, 0, -1), x, y, paint);
  made_quad(scene, olx_v3(0, 0, 1), y, x, paint);
  for (float side = -0.5f; side < 1.0f; side += 1.0f) {
    const float middle = side * (1.0f + half);
    made_quad(scene, olx_v3(1, middle, 0), z, olx_v3(0, 1.0f - half, 0), paint);
    made_quad(scene, olx_v3(1, 0, middle), olx_v3(0, 0, 1.0f - half), olx_v3(0, 2.0f * half, 0), paint);
  }
  scene->environment.radiance = olx_splat(1.0f);
  return made_finish(scene);
}

// Returns the irradiance at a point of the wall opposite the window.
static double light_of_window(olx_vec3 p, float half) {
  enum { PARTS = 16 };
  double sum = 0.0;
  for (uint32_t i = 0; i < PARTS * PARTS; i++) {
    const float y = half * (2.0f * ((float)(i % PARTS) + 0.5f) / PARTS - 1.0f),
                z = half * (2.0f * ((float)(i / PARTS) + 0.5f) / PARTS - 1.0f);
    const olx_vec3 way = olx_sub(olx_v3(1, y, z), p);
    const double squared = (double)olx_dot(way, way);
    sum += (double)(way.x * way.x) / (squared * squared);
  }
  return sum * 4.0 * (double)(half * half) / (PARTS * PARTS);
}

// Eight rays a texel meet a window of 0.3 m rarely: each texel for itself would have several times its light as noise.
static void a_distant_window_lights_a_wall_evenly(void **state) {
  (void)state;
  enum { N = 256 };
  const float half = 0.15f;
  const olx_vec3 eye = {0.2f, 0.1f, -0.1f};
  olx_scene *scene = room_with_a_window(half);
  olx_bake_settings settings = settings_at(scene, eye, OLX_LIGHT_REFERENCE);
  settings.radiance_size = N;
  settings.reference_paths = 4;
  olx_field *field = baked_field(scene, &settings, NULL);
  double error = 0.0, squares = 0.0, found_sum = 0.0, truth_sum = 0.0;
  for (uint32_t i = 0; i < N * N; i++) {
    const size_t at = olx_map_index(N + 2, (int32_t)(i % N), (int32_t)(i / N));
    const olx_vec3 direction = olx_texel_direction(i % N, i / N, N);
    const float distance = olx_texel_distance(field, 0, at);
    if (distance == INFINITY) continue;
    const olx_vec3 p = olx_madd(eye, direction, distance);
    if (p.x > -0.98f) continue;
    const double truth = light_of_window(p, half), found = (double)olx_texel_direct(field, 0, at).y;
    error += (found - truth) * (found - truth);
    squares += truth * truth;
    found_sum += found;
    truth_sum += truth;
  }
  print_message("light of a window: relative MSE %.4f, mean %.4f of the truth\n", error / squares,
                found_sum / truth_sum);
  assert_true(squares > 0.0 && error < 0.2 * squares && fabs(found_sum / truth_sum - 1.0) < 0.05);
  olx_field_close(field);
  olx_scene_free(scene);
}

static void texels_average_textures(void **state) {
  (void)state;
  enum { STRIPES = 256 };
  uint8_t texels[STRIPES][4];
  for (uint32_t i = 0; i < STRIPES; i++) {
    texels[i][0] = i % 2 ? 255 : 0;
    texels[i][2] = i % 2 ? 0 : 255;
    texels[i][1] = 0;
    texels[i][3] = 255;
  }
  olx_scene *scene = made_scene();
  olx_material material = plain(olx_splat(0.9f));
  material.base_color_texture = made_texture(scene, STRIPES, 1, &texels[0][0], false);
  made_square(scene, 0.0f, made_material(scene, &material));
  made_finish(scene);
  olx_bake_settings settings = settings_at(scene, olx_v3(0.0f, 0.5f, 0.0f), OLX_LIGHT_REFERENCE);
  settings.reference_paths = 1;
  double off[2];
  for (uint32_t k = 0; k < 2; k++) {
    settings.samples = k ? 8 : 1;
    olx_field *field = baked_field(scene, &settings, NULL);
    off[k] = 0.0;
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
      const size_t at = texel_at(i % SIZE, i / SIZE);
      if (olx_texel_distance(field, 0, at) == INFINITY) continue;
      const olx_vec3 albedo = olx_texel_material(field, 0, at).albedo;
      assert_float_equal(albedo.x + albedo.z, 0.9f, 0.008f);
      off[k] += fabs((double)albedo.x - 0.45);
    }
    olx_field_close(field);
  }
  assert_true(off[1] < 0.3 * off[0]);
  olx_scene_free(scene);
}

// Stored materials agree with the originals to within a byte's step.
static void materials_survive(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material material = plain(olx_v3(0.9f, 0.3f, 0.01f));
  material.roughness = 0.4f;
  material.metallic = 0.25f;
  material.specular_weight = 1.0f;
  material.specular_in_alpha = true;
  material.metallic_roughness_texture = made_texture(scene, 1, 1, (const uint8_t[4]){0, 255, 255, 128}, false);
  const float weight = 128.0f / 255.0f;
  made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &material));
  add_light(scene, &(olx_light){.type = OLX_LIGHT_SPOT,
                                .position = {0.1f, 0.2f, 0.3f},
                                .direction = {0.0f, -1.0f, 0.0f},
                                .emission = {1.0f, 2.0f, 3.0f},
                                .cosine_inner = 0.9f,
                                .cosine_outer = 0.7f});
  made_finish(scene);
  olx_bake_settings settings = settings_at(scene, olx_v3(0.2f, 0.1f, -0.3f), OLX_LIGHT_REFERENCE);
  settings.reference_paths = 1;
  olx_field *field = baked_field(scene, &settings, NULL);
  const olx_bsdf truth = olx_bsdf_make(material.base_color, 0.25f, 0.4f, weight);
  for (uint32_t i = 0; i < SIZE * SIZE; i++) {
    const olx_bsdf stored = olx_texel_material(field, 0, texel_at(i % SIZE, i / SIZE));
    assert_near(stored.albedo, truth.albedo, 0.004f);
    assert_near(stored.f0, truth.f0, 0.004f);
    assert_float_equal(stored.f90, truth.f90, 0.004f);
    assert_float_equal(stored.dielectric_weight, weight, 0.002f);
    assert_float_equal(sqrtf(stored.alpha), 0.4f, 0.002f);
  }
  const olx_field_light *spot = field->surfaces.lights;
  assert_true(spot->type == OLX_LIGHT_SPOT && spot->cosine_inner == 0.9f && spot->cosine_outer == 0.7f &&
              spot->position.z == 0.3f && spot->emission.y == 2.0f);
  olx_field_close(field);
  olx_scene_free(scene);
}

static void any_threads_make_the_same_bytes(void **state) {
  (void)state;
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  olx_bake_settings settings = settings_at(scene, olx_v3(0.0f, 1.0f, 0.0f), OLX_LIGHT_REFERENCE);
  settings.reference_paths = 2;
  baked_field_at_any_threads(scene, &settings);
  settings.uncompressed = false;
  baked_field_at_any_threads(scene, &settings);
  olx_scene_free(scene);
}

// Asserts that the light of surfaces in one bake is near that in another.
static void assert_alike(const olx_field *a, const olx_field *b, texel_reader read, double most) {
  double off = 0.0, all = 0.0;
  for (uint32_t i = 0; i < SIZE * SIZE; i++) {
    const size_t at = texel_at(i % SIZE, i / SIZE);
    if (olx_texel_distance(a, 0, at) == INFINITY) continue;
    const olx_vec3 difference = olx_sub(read(a, 0, at), read(b, 0, at)), light = read(b, 0, at);
    off += (double)olx_dot(difference, difference);
    all += (double)olx_dot(light, light);
  }
  print_message("relative MSE of blocks: %.2g\n", off / all);
  assert_true(all > 0.0 && off / all < most);
}

// Asserts that points are at most a quarter of a footprint from their planes, and that the same texels emit.
static void assert_same_place(const olx_field *texels, const olx_field *blocks, uint32_t x, uint32_t y) {
  const size_t at = texel_at(x, y);
  assert_int_equal(olx_texel_emits(texels, 0, at), olx_texel_emits(blocks, 0, at));
  const float distance = olx_texel_distance(texels, 0, at);
  const olx_texel_geometry seen = olx_texel_geometry_of(blocks, 0, at);
  assert_int_equal(distance == INFINITY, seen.distance == INFINITY);
  if (distance == INFINITY) return;
  const float cosine = -olx_dot(seen.normal, towards(x, y)), footprint = 4.6f * distance / (float)SIZE;
  assert_true(fabsf(seen.distance - distance) * cosine <= 0.26f * footprint + 0x1p-10f * distance);
  assert_true(olx_dot(seen.normal, olx_texel_normal(texels, 0, at)) > 0.79f);
}

// Bounds the error of blocks against texels, and checks that nothing else differs.
static void blocks_hold_what_texels_hold(void **state) {
  (void)state;
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  const olx_scene_info info = olx_scene_describe(scene);
  const olx_vec3 middle = olx_scale(olx_add(info.bounds_min, info.bounds_max), 0.5f);
  olx_bake_settings settings = settings_at(scene, middle, OLX_LIGHT_CACHE);
  settings.noise = 0.1f;
  olx_field *texels = baked_field(scene, &settings, NULL);
  settings.uncompressed = false;
  olx_field *blocks = baked_field(scene, &settings, NULL);
  assert_true(texels->distance && !texels->geometry && blocks->geometry && !blocks->distance && !blocks->normal);
  for (uint32_t i = 0; i < SIZE * SIZE; i++) assert_same_place(texels, blocks, i % SIZE, i / SIZE);
  assert_memory_equal(texels->surfaces.tiles, blocks->surfaces.tiles,
                      sizeof *texels->surfaces.tiles * OLX_EMISSION_TILE_TEXELS * texels->surfaces.tile_count);
  assert_int_equal(texels->surfaces.tile_count, blocks->surfaces.tile_count);
  assert_alike(blocks, texels, olx_texel_direct, 2e-3);
  assert_alike(blocks, texels, olx_texel_indirect, 2e-3);
  olx_field_close(texels);
  olx_field_close(blocks);
  olx_scene_free(scene);
}

// The edge of a pond: water meets a slope of 20 degrees along x = 0, below a probe. Texels of one block share gathered
// light on the same side of the edge alone, since light differs on both sides of an edge.
static void texels_share_no_light_across_an_edge(void **state) {
  (void)state;
  enum { MAP = 256 };
  const float turn = 20.0f * OLX_PI / 180.0f;
  olx_scene *scene = made_scene();
  const olx_material material = plain(olx_splat(0.5f));
  const uint32_t ground = made_material(scene, &material);
  made_quad(scene, olx_v3(-1.0f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, 2.0f), olx_v3(2.0f, 0.0f, 0.0f), ground);
  const olx_vec3 down = olx_v3(2.0f * cosf(turn), -2.0f * sinf(turn), 0.0f);
  made_quad(scene, olx_scale(down, 0.5f), olx_v3(0.0f, 0.0f, 2.0f), down, ground);
  made_finish(scene);
  const olx_bake_settings settings = olx_bake_settings_default(scene);
  olx_bake_context context = {.scene = scene, .settings = &settings, .distance_scale = 4.0f};
  olx_capture capture = {.context = &context, .size = MAP};
  assert_int_equal(olx_capture_create(&capture), OLX_OK);
  // The block in the map's first corner looks straight down and towards -x and -z.
  assert_int_equal(olx_capture_probe(&capture, 0, olx_v3(0.015f, 1.0f, 0.0f)), OLX_OK);
  olx_block_surfaces seen;
  olx_block_look(&capture, 0, &seen);
  uint32_t alike = 0, across = 0;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    for (uint32_t j = 0; j < OLX_BLOCK_TEXELS; j++) {
      const bool same = seen.surface[i].geometric_normal.x == seen.surface[j].geometric_normal.x;
      assert_true(olx_block_shares(&capture, 0, &seen, i, j) == same);
      *(same ? &alike : &across) += i != j;
    }
  }
  assert_true(alike > 0 && across > 0);
  olx_capture_free(&capture);
  olx_scene_free(scene);
}

// A room with a lamp and a board 3 cm below the ceiling. Within a few centimetres of the board's edge the ceiling above
// it is dark.
static olx_scene *room_with_a_gap(void) {
  olx_scene *scene = made_scene();
  const olx_material material = plain(olx_splat(0.5f));
  const uint32_t grey = made_material(scene, &material);
  made_box(scene, olx_v3(-1.5f, 0, -1.5f), olx_v3(1.5f, 2.5f, 1.5f), false, grey);
  made_box(scene, olx_v3(-1, 2.45f, -0.5f), olx_v3(0, 2.47f, 0.5f), true, grey);
  add_light(scene, &(olx_light){.type = OLX_LIGHT_POINT, .position = {0.4f, 0.5f, 0}, .emission = olx_splat(1.0f)});
  return made_finish(scene);
}

// A room whose only light is a lit spot of the floor, 30 cm wide, and a board 30 cm below the ceiling that hides it from
// one half of the ceiling. The shadow's edge is 4 cm wide.
static olx_scene *room_with_a_board(void) {
  olx_scene *scene = made_scene();
  const olx_material material = plain(olx_splat(0.5f));
  const uint32_t grey = made_material(scene, &material);
  made_box(scene, olx_v3(-1.5f, 0, -1.5f), olx_v3(1.5f, 2.5f, 1.5f), false, grey);
  made_box(scene, olx_v3(-1.4f, 2.18f, -1.4f), olx_v3(0, 2.2f, 1.4f), true, grey);
  add_light(scene, &(olx_light){.type = OLX_LIGHT_SPOT,
                                .position = {0, 1.5f, 0},
                                .direction = {0, -1, 0},
                                .emission = olx_splat(10.0f),
                                .cosine_inner = 0.9955f,
                                .cosine_outer = 0.995f});
  return made_finish(scene);
}

enum { SHARING_MAP = 512 };

// A texel's light is off above this multiple of the light that it would gather itself, or below its inverse.
static const float MOST_OFF = 1.5f;

// Counts the texels that see a part of a scene, and those whose light is off the light that they would gather
// themselves.
typedef struct counted_texels {
  uint32_t seen, off;
} counted_texels;

// Returns whether a texel counts, by its number in a map of SHARING_MAP x SHARING_MAP and the position that it sees.
typedef bool texel_counts(uint32_t texel, olx_vec3 position);

static counted_texels count_texels(olx_scene *scene, olx_vec3 probe, texel_counts *counts) {
  const uint8_t flags[1] = {0};
  olx_scene_light_settings solving = olx_scene_light_settings_default();
  solving.noise = 0.05f;
  solving.map_size = SHARING_MAP;
  olx_scene_light *light;
  assert_int_equal(olx_scene_light_create(scene, &solving, &probe, flags, 1, &light), OLX_OK);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  olx_bake_context context = {.scene = scene, .settings = &settings, .distance_scale = 4.0f};
  olx_capture capture = {.context = &context, .size = SHARING_MAP};
  assert_int_equal(olx_capture_create(&capture), OLX_OK);
  assert_int_equal(olx_capture_probe(&capture, 0, probe), OLX_OK);
  olx_vec3 *irradiance = calloc((size_t)SHARING_MAP * SHARING_MAP, sizeof *irradiance),
           *again = calloc((size_t)SHARING_MAP * SHARING_MAP, sizeof *again);
  assert_true(irradiance && again);
  settings.threads = 1;
  assert_int_equal(olx_light_texels(&capture, light, NULL, irradiance), OLX_OK);
  settings.threads = 3; // the light that texels share does not depend on which thread lights which
  assert_int_equal(olx_light_texels(&capture, light, NULL, again), OLX_OK);
  assert_memory_equal(irradiance, again, (size_t)SHARING_MAP * SHARING_MAP * sizeof *again);
  counted_texels counted = {0};
  for (uint32_t i = 0; i < SHARING_MAP * SHARING_MAP; i++) {
    const olx_vec3 direction = olx_texel_direction(i % SHARING_MAP, i / SHARING_MAP, SHARING_MAP);
    const olx_surface surface = olx_surface_at(scene, &capture.hits[i], direction);
    if (!counts(i, surface.position)) continue;
    const float own = olx_luminance(olx_scene_light_gather(light, &surface, NULL).irradiance);
    const float ratio = olx_luminance(irradiance[i]) / own;
    counted.seen++;
    counted.off += ratio > MOST_OFF || ratio < 1.0f / MOST_OFF;
  }
  free(again);
  free(irradiance);
  olx_capture_free(&capture);
  olx_scene_light_free(light);
  olx_scene_free(scene);
  return counted;
}

// Returns whether a texel sees the ceiling above the end of a board, or above the gap beside it.
static bool is_above_the_end(uint32_t texel, olx_vec3 p) {
  (void)texel;
  return p.y > 2.4999f && fabsf(p.x) < 0.05f && fabsf(p.z) < 0.4f;
}

// Texels of a block share the light that one of them has gathered as far as light hardly changes: in a gap that is a
// centimetre, and a block here is five wide. Of the texels that see the ceiling beside the board and behind its edge
// hardly one differs from what it would gather itself.
static void texels_share_no_light_out_of_a_gap(void **state) {
  (void)state;
  const counted_texels c = count_texels(room_with_a_gap(), olx_v3(0.9f, 1.2f, 0.1f), is_above_the_end);
  print_message("beside a gap %u of %u texels differ from what they would gather\n", c.off, c.seen);
  assert_true(c.seen > 200 && c.off * 50 < c.seen);
}

// Returns whether a texel at a corner of a block sees that part of the ceiling. The other texels of a plane block are
// interpolated between these.
static bool is_corner_above_the_end(uint32_t texel, olx_vec3 p) {
  const uint32_t x = texel % SHARING_MAP % OLX_BLOCK_SIDE, y = texel / SHARING_MAP % OLX_BLOCK_SIDE;
  if (x % (OLX_BLOCK_SIDE - 1) != 0 || y % (OLX_BLOCK_SIDE - 1) != 0) return false;
  return is_above_the_end(texel, p);
}

// Texels share gathered light only where it hardly changes between them, so that an edge as narrow as the square over
// which they may share is drawn where it is. When each took the light of the nearest that had gathered, 18 % of these
// texels were off; single gathers, which texels store, differ by noise.
static void texels_draw_a_narrow_edge_of_bounced_light(void **state) {
  (void)state;
  const counted_texels c = count_texels(room_with_a_board(), olx_v3(0.5f, 1.2f, 0.1f), is_corner_above_the_end);
  print_message("at an edge %u of %u texels differ from what they would gather\n", c.off, c.seen);
  assert_true(c.seen > 200 && c.off * 12 < c.seen);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(texels_share_no_light_out_of_a_gap),
      cmocka_unit_test(texels_draw_a_narrow_edge_of_bounced_light),
      cmocka_unit_test(texels_share_no_light_across_an_edge),
      cmocka_unit_test(white_furnace_by_cache),
      cmocka_unit_test(white_furnace_by_reference),
      cmocka_unit_test(faint_glow_hides_nothing),
      cmocka_unit_test(sky_and_sun_light_a_square),
      cmocka_unit_test(a_distant_window_lights_a_wall_evenly),
      cmocka_unit_test(texels_average_textures),
      cmocka_unit_test(materials_survive),
      cmocka_unit_test(any_threads_make_the_same_bytes),
      cmocka_unit_test(blocks_hold_what_texels_hold),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
