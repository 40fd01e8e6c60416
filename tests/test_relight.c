// Tests relighting against closed forms and against a fresh bake of the changed scene, and tests its schedule.
#include "field/texels.h"
#include "relight/relighter.h"
#include "relight/relit_tiles.h"
#include "scene/bvh.h"
#include "scene/surface.h"
#include "scene_files.h"
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

// Bakes a field of the scene for relighting, with small maps.
static olx_field *bake(const scene_folder *folder, const char *name, const olx_scene *scene, const uint32_t counts[3]) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  ASSERT_OK(olx_scene_probe_grid(scene, counts, &settings.grid));
  settings.radiance_size = 64;
  settings.volume_cells = 4;
  settings.light_samples = 4;
  settings.noise = 0.03f;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/%s", folder->path, name);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *field;
  ASSERT_OK(olx_field_open(path, &field));
  ASSERT_OK(olx_field_verify(field));
  return field;
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
  return olx_surface_irradiance(field, &sample, position, normal, normal, normal);
}

// ---- A closed box of albedo a that a sky lights through its walls: its surfaces reflect a L / (1 - a)

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

static const olx_light sky = {.type = OLX_LIGHT_SKY, .emission = {1.0f, 2.0f, 0.5f}};

static void assert_near(float value, float expected, float tolerance) {
  if (!(fabsf(value - expected) <= tolerance * expected + 1e-3f)) {
    fail_msg("%g where %g belongs", (double)value, (double)expected);
  }
}

static void assert_color(olx_vec3 value, olx_vec3 expected, float tolerance) {
  assert_near(value.x, expected.x, tolerance);
  assert_near(value.y, expected.y, tolerance);
  assert_near(value.z, expected.z, tolerance);
}

// Asserts that walls, all texels and free space have the light of a furnace in which surfaces emit `sent`.
static void assert_furnace(const olx_field *field, olx_vec3 sent, float tolerance) {
  const olx_vec3 places[] = {{0.0f, -1.0f, 0.0f}, {1.0f, 0.2f, -0.3f}, {-0.4f, 0.9f, 1.0f}};
  const olx_vec3 normals[] = {{0.0f, 1.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}};
  const olx_vec3 light = olx_scale(sent, OLX_PI);
  for (uint32_t i = 0; i < 3; i++) assert_color(irradiance_at(field, places[i], normals[i]), light, tolerance);
  for (uint32_t i = 0; i < 3; i++)
    assert_color(olx_volume_irradiance(field, olx_splat(0.1f), normals[i]), light, 2.0f * tolerance);
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    for (size_t i = 0; i < field->texels; i++) assert_color(olx_texel_indirect(field, probe, i), light, tolerance);
  }
}

static void assert_direct(const olx_field *field, olx_vec3 irradiance) {
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    for (size_t i = 0; i < field->texels; i++) assert_color(olx_texel_direct(field, probe, i), irradiance, 0.01f);
  }
}

static void test_furnace(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = dark_box();
  olx_field *field = bake(folder, "box.olx", scene, two);
  const olx_vec3 dark = {0}, sent = olx_scale(sky.emission, albedo / (1.0f - albedo));
  assert_furnace(field, dark, 0.0f);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = never;
  settings.sleep = 0.0005f;
  olx_relight *relight = begin(field, &settings);
  ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
  assert_true(run(relight, dark, 200) < 200);
  assert_furnace(olx_relight_field(relight), sent, 0.02f);
  assert_direct(olx_relight_field(relight), olx_scale(sky.emission, OLX_PI));
  // Giving the same lights again changes nothing.
  ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
  for (uint32_t i = 0; i < 20; i++) {
    ASSERT_OK(olx_relight_frame(relight, dark, NULL));
    assert_furnace(olx_relight_field(relight), sent, 0.02f);
  }
  // Without lights the field becomes dark.
  ASSERT_OK(olx_relight_set_lights(relight, NULL, 0));
  assert_true(run(relight, dark, 200) < 200);
  assert_furnace(olx_relight_field(relight), dark, 0.0f);
  assert_direct(olx_relight_field(relight), dark);
  // The baked field itself never changes.
  assert_furnace(field, dark, 0.0f);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- Cornell boxes with a second lamp, which hangs away from the blocks, since light near blocks is less precise

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
  olx_light lights[LIGHTS];
  uint32_t count;
  ASSERT_OK(olx_scene_relight_lights(scene, lights, LIGHTS, &count));
  assert_int_equal(count, 3); // the ceiling lamp is two triangles
  ASSERT_OK(olx_relight_set_lights(relight, lights, count));
}

typedef struct difference {
  double mean, rms; // differences as shares of the mean irradiance
} difference;

// Compares the irradiance of two fields on the surfaces that a camera in the room's middle sees.
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
  olx_scene *scene = companion(folder, "[0.2, 0.42, 0.2]"), *moved = companion(folder, "[0.25, 0.3, 0.05]");
  olx_field *field = bake(folder, "a.olx", scene, two), *fresh = bake(folder, "b.olx", moved, two);
  assert_true(compare(scene, field, fresh).rms > 0.25);
  olx_relight_settings settings = olx_relight_settings_default();
  for (uint32_t traced = 0; traced < 2; traced++) {
    settings.occlusion = traced ? NULL : olx_scene_occlusion;
    settings.user = scene;
    olx_relight *relight = begin(field, &settings);
    give_lights(relight, moved);
    for (uint32_t frame = 0; frame < 30; frame++) ASSERT_OK(olx_relight_frame(relight, olx_splat(0.28f), NULL));
    const difference d = compare(scene, olx_relight_field(relight), fresh);
    print_message("traced %u: mean off by %.3f, rms %.3f\n", traced, d.mean, d.rms);
    assert_true(fabs(d.mean) < 0.03 && d.rms < 0.04);
    olx_relight_free(relight);
  }
  olx_field_close(field);
  olx_field_close(fresh);
  olx_scene_free(scene);
  olx_scene_free(moved);
}

// Returns how much light changes when a field is relit by the lights of its bake.
static difference relit_by_its_own_lights(const scene_folder *folder, const char *lamp) {
  olx_scene *scene = companion(folder, lamp);
  olx_field *field = bake(folder, "a.olx", scene, two);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = scene;
  olx_relight *relight = begin(field, &settings);
  give_lights(relight, scene);
  assert_true(run(relight, olx_splat(0.28f), 200) < 200);
  const difference d = compare(scene, olx_relight_field(relight), field);
  print_message("mean off by %.3f, rms %.3f\n", d.mean, d.rms);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
  return d;
}

// Relit by the lights of its bake, a field keeps its baked light.
static void test_lights_of_the_bake_change_little(void **state) {
  const difference d = relit_by_its_own_lights(*state, "[0.2, 0.42, 0.2]");
  assert_true(fabs(d.mean) < 0.03 && d.rms < 0.04);
}

// Close to a block light varies over shorter distances than surfels are spaced: a limit of relighting that
// docs/relighting.md describes.
static void test_light_close_to_a_lamp_is_coarse(void **state) {
  const difference d = relit_by_its_own_lights(*state, "[0.1, 0.12, 0.1]");
  assert_true(fabs(d.mean) < 0.05 && d.rms < 0.15);
}

static void assert_same_light(const olx_relight *a, const olx_relight *b) {
  const olx_field *x = olx_relight_field(a), *y = olx_relight_field(b);
  const size_t bytes = 4 * x->texels * x->info.probes.count;
  assert_memory_equal(x->surfaces.direct, y->surfaces.direct, bytes);
  assert_memory_equal(x->surfaces.indirect, y->surfaces.indirect, bytes);
  assert_memory_equal(x->volume.irradiance, y->volume.irradiance,
                      2 * (size_t)OLX_VOLUME_HALVES * x->info.volume.probe_count);
}

static void test_same_for_any_number_of_threads(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = companion(folder, "[0.2, 0.42, 0.2]");
  olx_field *field = bake(folder, "a.olx", scene, two);
  olx_relight *relights[2];
  for (uint32_t i = 0; i < 2; i++) {
    olx_relight_settings settings = olx_relight_settings_default();
    settings.occlusion = olx_scene_occlusion;
    settings.user = scene;
    settings.threads = i ? 5 : 1;
    settings.shadow_rays = 10000;
    settings.surfels = 700;
    settings.texels = 9000;
    settings.volume_probes = 30;
    relights[i] = begin(field, &settings);
    give_lights(relights[i], scene);
    for (uint32_t frame = 0; frame < 6; frame++) ASSERT_OK(olx_relight_frame(relights[i], olx_splat(0.2f), NULL));
  }
  assert_same_light(relights[0], relights[1]);
  for (uint32_t i = 0; i < 2; i++) olx_relight_free(relights[i]);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- Frames that are cancelled

// A progress callback's state, which cancels at report number `at`; 0: never.
typedef struct canceller {
  uint32_t at, reports;
} canceller;

static bool count_reports(void *user, const char *stage, float done) {
  (void)stage, (void)done;
  canceller *c = user;
  return ++c->reports != c->at;
}

typedef struct watched_frame {
  olx_relight *relight;
  olx_relight_stats stats;
} watched_frame;

static olx_result frame_watched(void *user) {
  watched_frame *w = user;
  return olx_relight_frame(w->relight, olx_splat(0.28f), &w->stats);
}

static olx_result run_watched(olx_relight *relight, uint32_t cancel_at) {
  canceller c = {.at = cancel_at};
  const olx_progress progress = {.report = count_reports, .user = &c};
  watched_frame w = {.relight = relight};
  return olx_watch(&progress, "relighting", frame_watched, &w);
}

// Takes longer than the time between two reports of progress.
static void slowly(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded) {
  atomic_flag *has_slept = user;
  if (!atomic_flag_test_and_set(has_slept)) usleep(250000);
  never(NULL, rays, count, occluded);
}

// A frame does all of its work or, cancelled before it begins, none: light is then that of frames without a watch.
static void test_a_cancelled_frame_does_nothing(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = companion(folder, "[0.2, 0.42, 0.2]");
  olx_field *field = bake(folder, "a.olx", scene, two);
  atomic_flag has_slept = ATOMIC_FLAG_INIT;
  olx_relight_settings settings = olx_relight_settings_default();
  settings.shadow_rays = 20000;
  settings.texels = 9000;
  settings.threads = 1;
  settings.occlusion = never;
  olx_relight *plain = begin(field, &settings);
  settings.occlusion = slowly;
  settings.user = &has_slept;
  olx_relight *watched = begin(field, &settings);
  give_lights(plain, scene);
  give_lights(watched, scene);
  const uint32_t awake = olx_relit_awake(watched->schedule);
  assert_int_equal(run_watched(watched, 1), OLX_ERROR_CANCELLED);
  assert_int_equal(olx_relit_frames(watched->schedule), 0);
  assert_int_equal(olx_relit_awake(watched->schedule), awake);
  for (uint32_t i = 0; i < 3; i++) {
    ASSERT_OK(run_watched(watched, 2)); // a second report, which would cancel, is due within the first frame
    ASSERT_OK(olx_relight_frame(plain, olx_splat(0.28f), NULL));
    assert_same_light(plain, watched);
  }
  assert_true(atomic_flag_test_and_set(&has_slept));
  olx_relight_free(plain);
  olx_relight_free(watched);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- A niche behind a wall, whose end no probe can look around

static const olx_light niche_lamp = {
    .type = OLX_LIGHT_POINT, .emission = {2.0f, 2.0f, 2.0f}, .position = {0.75f, 0.3f, -0.2f}};

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

static void test_light_from_where_no_probe_looks(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = niche(false), *lit = niche(true);
  olx_field *field = bake(folder, "dark.olx", scene, two), *fresh = bake(folder, "lit.olx", lit, two);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = scene;
  olx_relight *relight = begin(field, &settings);
  ASSERT_OK(olx_relight_set_lights(relight, &niche_lamp, 1));
  assert_true(run(relight, olx_splat(0.0f), 200) < 200);
  const difference d = compare(scene, olx_relight_field(relight), fresh);
  print_message("mean off by %.3f, rms %.3f\n", d.mean, d.rms);
  // Surfels that no probe sees are few, and each represents more surface than those that are seen: docs/relighting.md.
  assert_true(fabs(d.mean) < 0.03 && d.rms < 0.12);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_field_close(fresh);
  olx_scene_free(scene);
  olx_scene_free(lit);
}

// ---- The schedule

// Returns the frame that last lit a tile of maps of four.
static uint32_t last_frame(const olx_relight *relight, uint32_t tile) {
  return olx_relit_part_frames(relight->schedule)[tile / 4 * 5 + tile % 4];
}

static float distance_to(const olx_field *field, const olx_relit_tile_state *state, olx_vec3 eye) {
  const olx_vec3 probe = field->probe_positions[state->tile.probe];
  return olx_length(olx_sub(olx_madd(probe, state->direction, state->distance), eye));
}

static void test_near_first_and_none_starves(void **state) {
  const scene_folder *folder = *state;
  const uint32_t few[3] = {5, 1, 1};
  olx_scene *scene = dark_box();
  olx_field *field = bake(folder, "row.olx", scene, few);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = never;
  settings.near_metres = 0.3f;
  settings.texels = 1024;
  settings.shadow_rays = 2048;
  settings.surfels = 100;
  settings.volume_probes = 1;
  settings.sleep = 0.0f;
  olx_relight *relight = begin(field, &settings);
  ASSERT_OK(olx_relight_set_lights(relight, &sky, 1));
  olx_relit_tiles all;
  ASSERT_OK(olx_relit_tiles_create(field, &settings, &all));
  assert_int_equal(all.count, 5 * 4);
  const olx_vec3 eye = {1.0f, 0.0f, 0.0f}; // at a wall
  uint32_t times[5 * 4] = {0};
  for (uint32_t frame = 1; frame <= 20 * all.count; frame++) {
    olx_relight_stats stats;
    ASSERT_OK(olx_relight_frame(relight, eye, &stats));
    // One tile a frame, but where none is left that waits.
    assert_true(stats.texels == 1024 || (stats.texels == 0 && olx_relit_tiles_waiting(relight->schedule) == 0));
    assert_true(stats.volume_probes <= 1 && stats.surfels_gathered <= 100 && stats.shadow_rays <= 3072);
    for (uint32_t i = 0; i < all.count; i++) times[i] += last_frame(relight, i) == frame;
    for (uint32_t i = 0; i < 5; i++) assert_true(olx_relight_probe_state(relight, i).waited <= 8 * all.count);
  }
  for (uint32_t i = 0; i < all.count; i++) {
    assert_true(times[i] > 0);
    for (uint32_t j = 0; j < all.count; j++) {
      if (distance_to(field, &all.states[i], eye) < 0.6f && distance_to(field, &all.states[j], eye) > 1.3f) {
        assert_true(times[i] > times[j]);
      }
    }
  }
  const olx_relight_state none = olx_relight_probe_state(relight, 5);
  assert_true(none.last_frame == 0 && none.tiles_waiting == 0 && none.waited == 0);
  olx_relit_tiles_free(&all);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
}

enum { FEW_SURFELS = 5 };

static olx_field *few_surfels(const scene_folder *folder) {
  const synthetic_shape shape = {.grid = {1, 1, 1}, .n = 8, .relight_surfels = FEW_SURFELS};
  char path[400];
  snprintf(path, sizeof path, "%s/few.olx", folder->path);
  ASSERT_OK(synthetic_write(path, &shape, NULL));
  olx_field *field;
  ASSERT_OK(olx_field_open(path, &field));
  return field;
}

// Surfels take turns cyclically, within half of the shadow rays, until each has its eight samples.
static void test_surfels_take_turns(void **state) {
  olx_field *field = few_surfels(*state);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.shadow_rays = 13; // six for surfels: three, by two rays each
  olx_relit_schedule *schedule;
  ASSERT_OK(olx_relit_schedule_create(field, &settings, &schedule));
  assert_int_equal(olx_relit_take_surfels(schedule).count, 0); // as baked
  olx_relit_wake(schedule, 2, 2, false);
  uint32_t samples[FEW_SURFELS] = {0}, next = 0;
  for (uint32_t left = FEW_SURFELS * OLX_RELIGHT_POINTS; left > 0;) {
    const olx_relit_surfel_turns turns = olx_relit_take_surfels(schedule);
    assert_int_equal(turns.count, left < 3 ? left : 3);
    assert_int_equal(turns.first, next);
    for (uint32_t i = 0; i < turns.count; i++) {
      assert_int_equal(samples[next], turns.round + (i >= turns.before));
      samples[next]++;
      next = (next + 1) % FEW_SURFELS;
    }
    left -= turns.count;
  }
  for (uint32_t i = 0; i < FEW_SURFELS; i++) assert_int_equal(samples[i], OLX_RELIGHT_POINTS);
  assert_int_equal(olx_relit_take_surfels(schedule).count, 0);
  olx_relit_schedule_free(schedule);
  olx_field_close(field);
}

// A report of a device about a frame that came before lights were set again is ignored.
static void test_late_records_of_earlier_lights_are_ignored(void **state) {
  olx_field *field = few_surfels(*state);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.surfels = 3;
  olx_relit_schedule *schedule;
  ASSERT_OK(olx_relit_schedule_create(field, &settings, &schedule));
  assert_int_equal(olx_relit_take_links(schedule).count, 0); // as baked
  olx_relit_wake(schedule, 1, 1, false);
  const olx_relit_link_turns earlier = olx_relit_take_links(schedule);
  assert_true(earlier.count == 3 && !earlier.ends && earlier.dark && earlier.shines);
  olx_relit_wake(schedule, 1, 1, false);
  for (uint32_t i = 0; i < OLX_RELIGHT_POINTS; i++) olx_relit_take_surfels(schedule);
  const olx_relit_link_turns begins = olx_relit_take_links(schedule), ends = olx_relit_take_links(schedule);
  assert_true(begins.count == 3 && !begins.ends && ends.count == 2 && ends.ends && ends.shines && !ends.dark);
  olx_relit_links_followed(schedule, &begins, 0.0, 1.0);
  olx_relit_links_followed(schedule, &earlier, 1.0, 1.0); // all light changed, but by lights of the past
  olx_relit_links_followed(schedule, &ends, 0.0, 1.0);
  assert_int_equal(olx_relit_take_links(schedule).count, 0); // nothing changed: light has settled
  olx_relit_schedule_free(schedule);
  olx_field_close(field);
}

// In two rooms without a door a lamp in one leaves the other dark; and when light has arrived a frame costs nothing.
static void test_other_rooms_stay_dark_and_rest_costs_nothing(void **state) {
  const scene_folder *folder = *state;
  const uint32_t row[3] = {4, 2, 1};
  olx_scene *scene;
  ASSERT_OK(olx_scene_load("builtin:two-rooms-sealed", &scene));
  olx_field *field = bake(folder, "rooms.olx", scene, row);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = scene;
  settings.sleep = 1e-6f; // the baked light, which was in both rooms, fades to about this share
  olx_relight *relight = begin(field, &settings);
  const olx_vec3 lit = field->probe_positions[3];
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .emission = olx_splat(3.0f), .position = lit};
  ASSERT_OK(olx_relight_set_lights(relight, &lamp, 1));
  assert_true(run(relight, lit, 300) < 300);
  const olx_field *now = olx_relight_field(relight);
  double light[2] = {0}; // the light on the lamp's side of the wall, and on the other side
  for (uint32_t probe = 0; probe < 8; probe++) {
    const bool other = (field->probe_positions[probe].x > 0.0f) != (lit.x > 0.0f);
    for (size_t i = 0; i < now->texels; i++) light[other] += (double)olx_luminance(olx_texel_indirect(now, probe, i));
  }
  print_message("%g of the light in the other room\n", light[1] / light[0]);
  assert_true(light[0] > 0.0 && light[1] < 1e-4 * light[0]);
  olx_relight_stats stats;
  const uint32_t frame = olx_relit_frames(relight->schedule);
  ASSERT_OK(olx_relight_frame(relight, lit, &stats));
  assert_true(stats.awake == 0 && stats.texels == 0 && stats.shadow_rays == 0 && stats.surfels_gathered == 0);
  for (uint32_t i = 0; i < 8; i++) assert_true(olx_relight_probe_state(relight, i).last_frame <= frame);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- Refusals

static void test_refuses_settings_and_lights(void **state) {
  const scene_folder *folder = *state;
  const synthetic_shape shape = {.grid = {1, 1, 1}, .n = 8, .relight_surfels = 5};
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
  REFUSED(shadow_rays = 0);
  REFUSED(surfels = 0);
  REFUSED(texels = 0);
  REFUSED(volume_probes = 0);
  REFUSED(light_samples = 0);
  REFUSED(light_samples = 65);
  REFUSED(sleep = 1.5f);
  REFUSED(sleep = NAN);
  REFUSED(near_metres = -1.0f);
  REFUSED(near_metres = INFINITY);
#undef REFUSED
  relight = begin(field, &good);
  const olx_light sun = {.type = OLX_LIGHT_SUN, .emission = {1, 1, 1}, .direction = {0, -1, 0}};
  ASSERT_OK(olx_relight_set_lights(relight, &sun, 1));
#define REFUSED(change)                                                                                                \
  do {                                                                                                                 \
    olx_light light = sun;                                                                                             \
    light.change;                                                                                                      \
    assert_int_equal(olx_relight_set_lights(relight, &light, 1), OLX_ERROR_ARGUMENT);                                  \
  } while (0)
  REFUSED(type = (olx_light_type)6);
  REFUSED(emission.y = NAN);
  REFUSED(emission.y = -1.0f);
  REFUSED(emission.x = 2.0f * OLX_MOST_EMISSION);
  REFUSED(direction = olx_splat(0.0f));
  REFUSED(direction.x = INFINITY);
  REFUSED(type = OLX_LIGHT_SPOT; light.cosine_inner = 1.5f);
  REFUSED(type = OLX_LIGHT_SPOT; light.cosine_outer = 0.5f); // the inner cone is the wider one
  REFUSED(type = OLX_LIGHT_SPOT; light.cosine_outer = -2.0f);
#undef REFUSED
  static olx_light many[257];
  assert_int_equal(olx_relight_set_lights(relight, many, 257), OLX_ERROR_ARGUMENT);
  // After a refusal the earlier lights remain; a viewpoint that is not finite counts as one in the middle.
  ASSERT_OK(olx_relight_frame(relight, olx_splat(NAN), NULL));
  olx_relight_free(relight);
  olx_field_close(field);
  olx_release(bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_furnace, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_lights_of_the_bake_change_little, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_light_close_to_a_lamp_is_coarse, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_arrives_at_a_fresh_bake, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_same_for_any_number_of_threads, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_a_cancelled_frame_does_nothing, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_light_from_where_no_probe_looks, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_near_first_and_none_starves, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_surfels_take_turns, scene_folder_set_up, scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_late_records_of_earlier_lights_are_ignored, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_other_rooms_stay_dark_and_rest_costs_nothing, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_settings_and_lights, scene_folder_set_up, scene_folder_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
