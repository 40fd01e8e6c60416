// Relighting: what follows in closed form, a fresh bake of the changed scene, and the schedule.
#include "scene/bvh.h"
#include "scene/surface.h"
#include "scene_files.h"
#include "shade/relighter.h"
#include "synthetic_field.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>
#include <octalux/octalux.h>

#include <unistd.h>

static void never(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded) {
  (void)user;
  (void)rays;
  memset(occluded, 0, count);
}

// A field of the scene, baked for relighting with small maps.
static olx_field *bake_with(const scene_folder *folder, const char *name, const olx_scene *scene,
                            const uint32_t counts[3], const uint32_t irradiance_counts[3], bool fit,
                            uint32_t irradiance_size) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  ASSERT_OK(olx_scene_probe_grid(scene, counts, &settings.grid));
  ASSERT_OK(olx_scene_probe_grid(scene, irradiance_counts, &settings.irradiance_grid));
  settings.radiance_size = 32;
  settings.irradiance_size = irradiance_size;
  settings.bounces = 12;
  settings.light_samples = 4;
  settings.fit = fit;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/%s", folder->path, name);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *field;
  ASSERT_OK(olx_field_open(path, &field));
  ASSERT_OK(olx_field_verify(field));
  return field;
}

static olx_field *bake(const scene_folder *folder, const char *name, const olx_scene *scene, const uint32_t counts[3],
                       const uint32_t irradiance_counts[3], bool fit) {
  return bake_with(folder, name, scene, counts, irradiance_counts, fit, 32);
}

static const uint32_t two[3] = {2, 2, 2};

static olx_relight *begin(const olx_field *field, const olx_relight_settings *settings) {
  olx_relight *relight;
  ASSERT_OK(olx_relight_create(field, settings, &relight));
  return relight;
}

static uint32_t run(olx_relight *relight, olx_vec3 eye, uint32_t most) {
  olx_relight_stats stats = {.awake = 1};
  uint32_t frames = 0;
  for (; frames < most && stats.awake > 0; frames++) ASSERT_OK(olx_relight_frame(relight, eye, &stats));
  return frames;
}

static olx_vec3 irradiance_at(const olx_field *field, olx_vec3 position, olx_vec3 normal) {
  const olx_sample_settings sample = olx_sample_settings_default();
  return olx_irradiance(field, &sample, position, normal, normal);
}

// ---- A closed box of albedo a that a sky lights through its walls: its surfaces send a L / (1 - a)

static const float albedo = 0.5f;

static olx_scene *dark_box(void) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(albedo, 0.0f);
  tiny_box(scene, &walls);
  scene->has_probe_volume = true;
  scene->probes_min = olx_splat(-0.7f);
  scene->probes_max = olx_splat(0.7f);
  return tiny_finish(scene);
}

static const olx_relight_light sky = {.type = OLX_RELIGHT_SKY, .emission = {1.0f, 2.0f, 0.5f}};

static void assert_near(float value, float expected, float tolerance) {
  if (!(fabsf(value - expected) <= tolerance * expected + 1e-3f)) {
    fail_msg("%g where %g belongs", (double)value, (double)expected);
  }
}

// Whether irradiance on walls and radiance of all texels are those of a furnace in which surfaces send `sent`.
static void assert_furnace(const olx_field *field, olx_vec3 sent, float tolerance) {
  const olx_vec3 places[] = {{0.0f, -1.0f, 0.0f}, {1.0f, 0.2f, -0.3f}, {-0.4f, 0.9f, 1.0f}};
  const olx_vec3 normals[] = {{0.0f, 1.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}};
  for (uint32_t i = 0; i < 3; i++) {
    const olx_vec3 light = irradiance_at(field, places[i], normals[i]);
    assert_near(light.x, OLX_PI * sent.x, tolerance);
    assert_near(light.y, OLX_PI * sent.y, tolerance);
    assert_near(light.z, OLX_PI * sent.z, tolerance);
  }
  for (size_t i = 0; i < field->texels * field->info.probe_count; i++) {
    assert_near(olx_r11g11b10f_unpack(field->radiance[i]).y, sent.y, tolerance);
  }
}

static void test_furnace(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = dark_box();
  for (uint32_t fit = 0; fit < 2; fit++) {
    olx_field *field = bake(folder, "box.olx", scene, two, two, fit);
    assert_furnace(field, olx_splat(0.0f), 0.0f);
    olx_relight_settings settings = olx_relight_settings_default();
    settings.occlusion = never;
    settings.sleep = 0.0005f;
    olx_relight *relight = begin(field, &settings);
    ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
    const olx_vec3 sent = olx_scale(sky.emission, albedo / (1.0f - albedo));
    assert_true(run(relight, olx_splat(0.0f), 200) < 200);
    assert_true(olx_relight_field(relight)->relit && !field->relit); // so that surfaces' light of before is not read
    assert_furnace(olx_relight_field(relight), sent, 0.02f);
    // The same lights again change nothing.
    ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
    for (uint32_t i = 0; i < 20; i++) {
      ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL));
      assert_furnace(olx_relight_field(relight), sent, 0.02f);
    }
    // Without lights it gets dark.
    ASSERT_OK(olx_relight_set_lights(relight, NULL, 0));
    assert_true(run(relight, olx_splat(0.0f), 200) < 200);
    assert_furnace(olx_relight_field(relight), olx_splat(0.0f), 0.0f);
    // And the field that was baked never changed.
    assert_furnace(field, olx_splat(0.0f), 0.0f);
    olx_relight_free(relight);
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

static void test_history_slows_and_arrives(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = dark_box();
  olx_field *field = bake(folder, "box.olx", scene, two, two, false);
  float light[2];
  for (uint32_t i = 0; i < 2; i++) {
    olx_relight_settings settings = olx_relight_settings_default();
    settings.occlusion = never;
    settings.history = i ? 0.8f : 0.0f;
    settings.sleep = 0.0f;
    olx_relight *relight = begin(field, &settings);
    ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
    for (uint32_t frame = 0; frame < 4; frame++) ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL));
    light[i] = irradiance_at(olx_relight_field(relight), olx_v3(0, -1, 0), olx_v3(0, 1, 0)).x;
    run(relight, olx_splat(0.0f), 80);
    assert_float_equal(irradiance_at(olx_relight_field(relight), olx_v3(0, -1, 0), olx_v3(0, 1, 0)).x, OLX_PI, 0.07);
    olx_relight_free(relight);
  }
  assert_true(light[1] < 0.9f * light[0]);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- Cornell boxes whose lamp has a companion

static olx_scene *companion(const scene_folder *folder, const char *position) {
  char text[400];
  snprintf(text, sizeof text,
           "{\"model\": \"builtin:cornell\", \"probes\": {\"min\": [0.08, 0.08, 0.08], \"max\": [0.47, 0.47, 0.48]},"
           " \"lights\": [{\"type\": \"point\", \"position\": %s, \"intensity\": [0.4, 0.3, 0.5]}]}",
           position);
  olx_scene *scene;
  ASSERT_OK(olx_scene_load(scene_folder_write_text(folder, "cornell.json", text), &scene));
  return scene;
}

enum { LIGHTS = 16 };

static void give_lights(olx_relight *relight, const olx_scene *scene) {
  olx_relight_light lights[LIGHTS];
  uint32_t count;
  ASSERT_OK(olx_scene_relight_lights(scene, lights, LIGHTS, &count));
  assert_int_equal(count, 3); // the lamp is two triangles
  ASSERT_OK(olx_relight_set_lights(relight, lights, count));
}

typedef struct difference {
  double mean, rms; // shares of the mean
} difference;

// Of irradiance on what a camera in the room's middle sees.
static difference compare(const olx_scene *scene, const olx_field *a, const olx_field *b) {
  const olx_vec3 eye = {0.28f, 0.27f, 0.1f};
  double sum = 0.0, off = 0.0, squares = 0.0;
  uint32_t count = 0;
  for (uint32_t i = 0; i < 32 * 32; i++) {
    const olx_ray ray = {eye, olx_texel_direction(i % 32, i / 32, 32), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    const double wanted = (double)olx_luminance(irradiance_at(b, surface.position, surface.shading_normal));
    const double got = (double)olx_luminance(irradiance_at(a, surface.position, surface.shading_normal));
    sum += wanted;
    off += got - wanted;
    squares += (got - wanted) * (got - wanted);
    count++;
  }
  return (difference){off / sum, sqrt(squares * count) / sum};
}

static void test_arrives_at_a_fresh_bake(void **state) {
  const scene_folder *folder = *state;
  const uint32_t three[3] = {3, 3, 3};
  olx_scene *scene = companion(folder, "[0.1, 0.12, 0.1]"), *moved = companion(folder, "[0.44, 0.4, 0.3]");
  olx_field *field = bake(folder, "a.olx", scene, two, three, true),
            *fresh = bake(folder, "b.olx", moved, two, three, true);
  assert_true(compare(scene, field, fresh).rms > 0.25);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.surface_texels = 9 * 1024; // of 27 * 1024
  for (uint32_t traced = 0; traced < 2; traced++) {
    settings.occlusion = traced ? NULL : olx_scene_occlusion;
    settings.user = scene;
    olx_relight *relight = begin(field, &settings);
    give_lights(relight, moved);
    for (uint32_t frame = 0; frame < 30; frame++) ASSERT_OK(olx_relight_frame(relight, olx_splat(0.28f), NULL));
    const difference d = compare(scene, olx_relight_field(relight), fresh);
    if (fabs(d.mean) > (traced ? 0.1 : 0.03) || d.rms > (traced ? 0.15 : 0.05)) {
      fail_msg("traced %u: mean off by %.3f, rms %.3f", traced, d.mean, d.rms);
    }
    olx_relight_free(relight);
  }
  olx_field_close(field);
  olx_field_close(fresh);
  olx_scene_free(scene);
  olx_scene_free(moved);
}

static void test_same_for_any_number_of_threads(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = companion(folder, "[0.1, 0.12, 0.1]");
  olx_field *field = bake(folder, "a.olx", scene, two, two, true);
  olx_relight *relights[2];
  for (uint32_t i = 0; i < 2; i++) {
    olx_relight_settings settings = olx_relight_settings_default();
    settings.occlusion = olx_scene_occlusion;
    settings.user = scene;
    settings.threads = i ? 5 : 1;
    settings.surface_texels = 3000;
    settings.radiance_texels = 1500;
    relights[i] = begin(field, &settings);
    give_lights(relights[i], scene);
    for (uint32_t frame = 0; frame < 6; frame++) ASSERT_OK(olx_relight_frame(relights[i], olx_splat(0.2f), NULL));
  }
  const olx_field *a = olx_relight_field(relights[0]), *b = olx_relight_field(relights[1]);
  assert_memory_equal(a->irradiance, b->irradiance, 4 * a->irradiance_texels * a->info.irradiance_probe_count);
  assert_memory_equal(a->radiance, b->radiance, 4 * a->texels * a->info.probe_count);
  for (uint32_t i = 0; i < 2; i++) olx_relight_free(relights[i]);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- A niche behind a wall, round whose end no irradiance probe looks

static const olx_relight_light niche_lamp = {
    .type = OLX_RELIGHT_POINT, .emission = {2.0f, 2.0f, 2.0f}, .position = {0.75f, 0.3f, -0.2f}};

static olx_scene *niche(bool lit) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(0.7f, 0.0f);
  const olx_vec3 along = {0.0f, 0.0f, 1.5f}, up = {0.0f, 2.0f, 0.0f};
  tiny_box(scene, &walls);
  tiny_quad(scene, &walls, olx_v3(0.45f, 0.0f, -0.25f), along, up);
  tiny_quad(scene, &walls, olx_v3(0.5f, 0.0f, -0.25f), up, along);
  if (lit) {
    const olx_light lamp = {.type = OLX_LIGHT_POINT, .position = niche_lamp.position, .emission = niche_lamp.emission};
    ASSERT_OK(olx_scene_add_light(scene, &lamp));
  }
  scene->has_probe_volume = true;
  scene->probes_min = olx_splat(-0.7f);
  scene->probes_max = olx_v3(0.1f, 0.7f, 0.3f);
  return tiny_finish(scene);
}

// The same field as it would have been written before there were hidden surfaces.
static olx_field without_hidden(const olx_field *field, uint32_t **fit) {
  const size_t words = olx_fit_words(&field->relight) * field->relight.points * field->info.irradiance_probe_count;
  const uint32_t first = field->relight.size * field->relight.size * field->info.irradiance_probe_count;
  olx_field before = *field;
  *fit = olx_allocate(words, sizeof **fit);
  memcpy(*fit, field->relight.fit, words * sizeof **fit);
  uint32_t turned = 0;
  for (size_t i = 0; i < words; i++) {
    if (i % olx_fit_words(&field->relight) < 4 || (*fit)[i] < first || (*fit)[i] >= OLX_FIT_RAY_UNKNOWN) continue;
    (*fit)[i] = OLX_FIT_RAY_UNKNOWN;
    turned++;
  }
  assert_true(turned > words / 200);
  before.relight.fit = *fit;
  before.relight.hidden = before.info.relight_hidden = 0;
  before.relight.hidden_surfaces = NULL;
  return before;
}

static olx_relight *lit_niche(const olx_field *field, const olx_scene *scene, uint32_t threads, uint32_t frames) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = scene ? olx_scene_occlusion : NULL;
  settings.user = (void *)(uintptr_t)scene;
  settings.threads = threads;
  olx_relight *relight = begin(field, &settings);
  ASSERT_OK(olx_relight_set_lights(relight, &niche_lamp, 1));
  for (uint32_t i = 0; i < frames; i++) ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL));
  return relight;
}

static void test_light_from_where_no_probe_looks(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = niche(false), *lit = niche(true);
  olx_field *field = bake_with(folder, "dark.olx", scene, two, two, true, 64),
            *fresh = bake_with(folder, "lit.olx", lit, two, two, true, 64);
  uint32_t *fit;
  const olx_field before = without_hidden(field, &fit);
  olx_relight *with = lit_niche(field, scene, 1, 30), *without = lit_niche(&before, scene, 1, 30);
  const difference d = compare(scene, olx_relight_field(with), fresh),
                   guessed = compare(scene, olx_relight_field(without), fresh);
  print_message("mean off by %.3f, rms %.3f; guessed: %.3f, %.3f\n", d.mean, d.rms, guessed.mean, guessed.rms);
  assert_true(fabs(d.mean) < 0.05 && d.rms < 0.05);
  assert_true(guessed.mean < -0.6 && guessed.rms > 0.6);
  olx_relight_free(with);
  olx_relight_free(without);
  olx_release(fit);
  olx_field_close(field);
  olx_field_close(fresh);
  olx_scene_free(scene);
  olx_scene_free(lit);
}

static void assert_same_maps(const olx_relight *a, const olx_relight *b) {
  const olx_field *x = olx_relight_field(a), *y = olx_relight_field(b);
  assert_memory_equal(x->irradiance, y->irradiance, 4 * x->irradiance_texels * x->info.irradiance_probe_count);
  assert_memory_equal(x->radiance, y->radiance, 4 * x->texels * x->info.probe_count);
}

// Through the field shadow rays do not get to where probes do not look, and the frame is the one without hidden surfaces.
static void test_traced_shadows_leave_hidden_surfaces_unknown(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = niche(false);
  olx_field *field = bake(folder, "dark.olx", scene, two, two, true);
  uint32_t *fit;
  const olx_field before = without_hidden(field, &fit);
  olx_relight *with = lit_niche(field, NULL, 2, 5), *without = lit_niche(&before, NULL, 2, 5);
  assert_same_maps(with, without);
  olx_relight_free(with);
  olx_relight_free(without);
  olx_release(fit);
  olx_field_close(field);
  olx_scene_free(scene);
}

// Of a probe, the places before the last that is in use.
static uint32_t most_hidden(const olx_field *field) {
  const uint32_t places = field->relight.hidden;
  uint32_t most = 0;
  for (uint32_t i = 0; i < places * field->info.irradiance_probe_count; i++) {
    const bool used = field->relight.hidden_surfaces[i].normal != OLX_FIT_NO_POINT;
    if (used && i % places >= most) most = i % places + 1;
  }
  assert_true(most > 0 && most <= places);
  return most;
}

static void test_hidden_surfaces_are_counted_and_do_not_depend_on_threads(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = niche(false);
  olx_field *field = bake(folder, "dark.olx", scene, two, two, true);
  olx_relight *one = lit_niche(field, scene, 1, 3), *five = lit_niche(field, scene, 5, 3);
  assert_same_maps(one, five);
  olx_relight_stats stats;
  ASSERT_OK(olx_relight_set_lights(one, &niche_lamp, 1));
  ASSERT_OK(olx_relight_frame(one, olx_splat(0.0f), &stats));
  assert_int_equal(stats.irradiance_probes, 8);
  assert_int_equal(stats.surface_texels, 8 * (32 * 32 + most_hidden(field)));
  assert_true(stats.surface_texels <= 8 * 32 * 32 * 5 / 4);
  olx_relight_free(one);
  olx_relight_free(five);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- The schedule

static void test_near_first_and_none_starves(void **state) {
  const scene_folder *folder = *state;
  const uint32_t row[3] = {12, 1, 1}, few[3] = {5, 1, 1};
  olx_scene *scene = dark_box();
  olx_field *field = bake(folder, "row.olx", scene, few, row, false);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = never;
  settings.near_metres = 0.3f;
  settings.surface_texels = 2 * 1024;
  settings.radiance_texels = 1024;
  settings.sleep = 0.0f;
  olx_relight *relight = begin(field, &settings);
  ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
  const olx_vec3 eye = field->irradiance_positions[3];
  uint32_t first[12] = {0}, updates[12] = {0};
  for (uint32_t frame = 1; frame <= 96; frame++) {
    olx_relight_stats stats;
    ASSERT_OK(olx_relight_frame(relight, eye, &stats));
    assert_int_equal(stats.irradiance_probes, 2);
    assert_int_equal(stats.surface_texels, 2048);
    assert_int_equal(stats.radiance_texels, 1024);
    for (uint32_t i = 0; i < 12; i++) {
      const olx_relight_state s = olx_relight_irradiance_state(relight, i);
      if (s.updates && !first[i]) first[i] = frame;
      updates[i] = s.updates;
      assert_true(s.waited <= 12 * 8 / 2);
      assert_int_equal(s.waited, frame - s.last_frame);
    }
    for (uint32_t i = 0; i < 5; i++) assert_true(olx_relight_radiance_state(relight, i).waited <= 5 * 8);
  }
  for (uint32_t i = 0; i < 12; i++) {
    assert_true(first[i] > 0);
    for (uint32_t j = 0; j < 12; j++) {
      const float a = olx_length(olx_sub(field->irradiance_positions[i], eye)),
                  b = olx_length(olx_sub(field->irradiance_positions[j], eye));
      if (!(a < 0.3f && b > 0.6f)) continue;
      assert_true(first[i] <= first[j]);
      assert_true(updates[i] > 2 * updates[j]);
    }
  }
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
}

// In two rooms without a door a lamp in one concerns the probes of the other once.
static void test_who_sees_no_change_sleeps(void **state) {
  const scene_folder *folder = *state;
  const uint32_t row[3] = {4, 2, 1};
  olx_scene *scene;
  ASSERT_OK(olx_scene_load("builtin:two-rooms-sealed", &scene));
  olx_field *field = bake(folder, "rooms.olx", scene, row, row, false);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = scene;
  settings.surface_texels = 2048;
  olx_relight *relight = begin(field, &settings);
  const olx_vec3 lit = field->irradiance_positions[0];
  const olx_relight_light lamp = {.type = OLX_RELIGHT_POINT, .emission = olx_splat(3.0f), .position = lit};
  ASSERT_OK(olx_relight_set_lights(relight, &lamp, 1));
  assert_true(run(relight, lit, 300) < 300);
  uint32_t most = 0, least = UINT32_MAX;
  for (uint32_t i = 0; i < 8; i++) {
    const olx_relight_state s = olx_relight_irradiance_state(relight, i);
    assert_false(s.awake);
    most = s.updates > most ? s.updates : most;
    least = s.updates < least ? s.updates : least;
  }
  assert_int_equal(least, 1);
  assert_true(most >= 4);
  const olx_relight_state none = olx_relight_irradiance_state(relight, 8),
                          neither = olx_relight_radiance_state(relight, UINT32_MAX);
  assert_true(none.updates == 0 && !none.awake && neither.updates == 0 && !neither.awake);
  // Asleep, a frame costs nothing and changes nothing.
  const olx_field *now = olx_relight_field(relight);
  const size_t bytes = 4 * now->irradiance_texels * now->info.irradiance_probe_count;
  uint32_t *before = olx_allocate(bytes, 1);
  for (uint32_t i = 0; i < 16; i++) ASSERT_OK(olx_relight_frame(relight, lit, NULL)); // corrections settle
  memcpy(before, now->irradiance, bytes);
  olx_relight_stats stats;
  ASSERT_OK(olx_relight_frame(relight, lit, &stats));
  assert_int_equal(stats.irradiance_probes + stats.radiance_texels + stats.shadow_rays + stats.lookups, 0);
  assert_memory_equal(before, now->irradiance, bytes);
  olx_release(before);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- What must be refused

static void test_refuses_settings_and_lights(void **state) {
  const scene_folder *folder = *state;
  const synthetic_shape shape = {.grid = {1, 1, 1},
                                 .irradiance_grid = {2, 1, 1},
                                 .n = 8,
                                 .irradiance_n = 8,
                                 .relight_size = 16,
                                 .relight_points = 3,
                                 .relight_rays = 4,
                                 .relight_hidden = 5};
  char path[400];
  snprintf(path, sizeof path, "%s/s.olx", folder->path);
  ASSERT_OK(synthetic_write(path, &shape, NULL));
  size_t size_bytes;
  unsigned char *bytes = synthetic_read_file(path, &size_bytes);
  olx_field *field;
  ASSERT_OK(olx_field_open_memory(bytes, size_bytes, &field));
  const olx_relight_settings good = olx_relight_settings_default();
  olx_relight *relight;
#define REFUSED(change)                                                                                                \
  do {                                                                                                                 \
    olx_relight_settings settings = good;                                                                              \
    settings.change;                                                                                                   \
    assert_int_equal(olx_relight_create(field, &settings, &relight), OLX_ERROR_ARGUMENT);                              \
    assert_null(relight);                                                                                              \
  } while (0)
  REFUSED(surface_texels = 0);
  REFUSED(light_samples = 0);
  REFUSED(light_samples = 65);
  REFUSED(fit_steps = 65);
  REFUSED(history = -0.1f);
  REFUSED(history = 0.96f);
  REFUSED(history = NAN);
  REFUSED(sleep = 1.5f);
  REFUSED(sleep = NAN);
  REFUSED(near_metres = -1.0f);
  REFUSED(near_metres = INFINITY);
#undef REFUSED
  relight = begin(field, &good);
  const olx_relight_light sun = {.type = OLX_RELIGHT_SUN, .emission = {1, 1, 1}, .direction = {0, -1, 0}};
  ASSERT_OK(olx_relight_set_lights(relight, &sun, 1));
#define REFUSED(change)                                                                                                \
  do {                                                                                                                 \
    olx_relight_light light = sun;                                                                                     \
    light.change;                                                                                                      \
    assert_int_equal(olx_relight_set_lights(relight, &light, 1), OLX_ERROR_ARGUMENT);                                  \
  } while (0)
  REFUSED(type = (olx_relight_light_type)6);
  REFUSED(emission.y = NAN);
  REFUSED(emission.y = -1.0f);
  REFUSED(direction = olx_splat(0.0f));
  REFUSED(direction.x = INFINITY);
#undef REFUSED
  static olx_relight_light many[257];
  assert_int_equal(olx_relight_set_lights(relight, many, 257), OLX_ERROR_ARGUMENT);
  // After a refusal the lights are those given before; an eye that is nowhere is one in the middle.
  ASSERT_OK(olx_relight_frame(relight, olx_splat(NAN), NULL));
  olx_relight_free(relight);
  // A hidden surface that is nowhere, or without a normal; a ray to a surface that there is not.
  olx_hidden_surface *hidden = (olx_hidden_surface *)(uintptr_t)&field->relight.hidden_surfaces[6];
  const olx_hidden_surface good_surface = *hidden;
  hidden->position.y = NAN;
  assert_int_equal(olx_relight_create(field, &good, &relight), OLX_ERROR_FORMAT);
  *hidden = good_surface;
  hidden->normal = 0x10000;
  assert_int_equal(olx_relight_create(field, &good, &relight), OLX_ERROR_FORMAT);
  *hidden = good_surface;
  ((uint32_t *)(uintptr_t)field->relight.fit)[4] = 2 * (256 + 5);
  assert_int_equal(olx_relight_create(field, &good, &relight), OLX_ERROR_FORMAT);
  assert_null(relight);
  olx_field_close(field);
  olx_release(bytes);
}

static int set_up(void **state) {
  static scene_folder folder;
  *state = &folder;
  return scene_folder_create(&folder) ? 0 : -1;
}

static int tear_down(void **state) {
  scene_folder_remove(*state);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_furnace, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_history_slows_and_arrives, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_arrives_at_a_fresh_bake, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_same_for_any_number_of_threads, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_light_from_where_no_probe_looks, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_traced_shadows_leave_hidden_surfaces_unknown, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_hidden_surfaces_are_counted_and_do_not_depend_on_threads, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_near_first_and_none_starves, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_who_sees_no_change_sleeps, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_settings_and_lights, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
